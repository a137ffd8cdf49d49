use super::request::{LONGEST, Refused, Request, Rules};
use crate::page::File;
use mio::Registry;
use mio::net::TcpStream;
use std::collections::VecDeque;
use std::io::{ErrorKind, Read as _, Write as _};
use std::time::Instant;
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Bytes, Error, Message, Utf8Bytes, WebSocket};

const LONGEST_MESSAGE: usize = 64 << 10;
/// Limit of queued texts, beyond which a page is disconnected.
const UNREAD: usize = 512;
/// A scene and a frame of a million robots.
const MOST_BYTES: usize = 256 << 20;

/// Frames in transit to a page that confirms them.
const AHEAD: u64 = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Goes,
    /// It became a page.
    Opened,
    /// The answer is being sent.
    Refused,
    Ended,
}

enum State {
    Asking { heard: Vec<u8>, until: Instant },
    Answering { left: Vec<u8>, at: usize, until: Instant },
    Live(Box<Live>),
}

struct Live {
    texts: VecDeque<Utf8Bytes>,
    frame: Option<Bytes>,
    is_behind: bool,
    sent: u64,
    /// `None` if it confirms none.
    seen: Option<u64>,
}

pub(super) struct Connection {
    /// `None` only during the upgrade.
    stream: Option<Stream>,
    state: State,
}

enum Stream {
    Plain(TcpStream),
    Socket(Box<WebSocket<TcpStream>>),
}

impl Connection {
    pub fn new(stream: TcpStream, until: Instant) -> Self {
        Self { stream: Some(Stream::Plain(stream)), state: State::Asking { heard: Vec::new(), until } }
    }

    pub const fn is_live(&self) -> bool {
        matches!(self.state, State::Live(_))
    }

    pub fn is_late(&self, now: Instant) -> bool {
        match &self.state {
            State::Asking { until, .. } | State::Answering { until, .. } => now > *until,
            State::Live(live) => live.texts.len() > UNREAD,
        }
    }

    /// With `is_over` a page gets the message that the server ends.
    pub fn end(self, registry: &Registry, is_over: bool) {
        match self.stream {
            Some(Stream::Plain(mut stream)) => drop(registry.deregister(&mut stream)),
            Some(Stream::Socket(mut socket)) => {
                let farewell = CloseFrame { code: CloseCode::Away, reason: "over".into() };
                let _ = socket.close(is_over.then_some(farewell));
                let _ = socket.flush();
                drop(registry.deregister(socket.get_mut()));
            }
            None => {}
        }
    }

    /// `has_room`: another page is allowed. `hear` returns whether it had room for a message.
    pub fn read(
        &mut self,
        rules: &Rules,
        files: &[File],
        has_room: bool,
        hear: &mut dyn FnMut(String) -> bool,
    ) -> Outcome {
        match (&mut self.stream, &mut self.state) {
            (Some(Stream::Socket(socket)), State::Live(_)) => read_words(socket, hear),
            (Some(Stream::Plain(stream)), State::Asking { heard, until }) => {
                let mut bytes = [0; 2048];
                loop {
                    match stream.read(&mut bytes) {
                        Ok(0) => return Outcome::Ended,
                        Ok(count) => heard.extend_from_slice(&bytes[..count]),
                        Err(error) if error.kind() == ErrorKind::WouldBlock => return Outcome::Goes,
                        Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                        Err(_) => return Outcome::Ended,
                    }
                    let request = match rules.read(heard) {
                        Request::Partial if heard.len() < LONGEST => continue,
                        request => request,
                    };
                    if let Request::Live(key) = &request
                        && has_room
                    {
                        let key = key.clone();
                        return self.upgrade(&key);
                    }
                    let until = *until;
                    let (left, is_refusal) = answer(&request, files);
                    self.state = State::Answering { left, at: 0, until };
                    return if is_refusal { Outcome::Refused } else { Outcome::Goes };
                }
            }
            _ => Outcome::Goes,
        }
    }

    fn upgrade(&mut self, key: &str) -> Outcome {
        let Some(Stream::Plain(mut stream)) = self.stream.take() else {
            return Outcome::Ended;
        };
        let accept = derive_accept_key(key.as_bytes());
        let head = format!(
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {accept}\r\n\r\n"
        );
        if stream.write(head.as_bytes()).ok() != Some(head.len()) {
            return Outcome::Ended;
        }
        let config = WebSocketConfig::default()
            .max_message_size(Some(LONGEST_MESSAGE))
            .max_frame_size(Some(LONGEST_MESSAGE))
            .max_write_buffer_size(MOST_BYTES);
        let socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
        self.stream = Some(Stream::Socket(Box::new(socket)));
        self.state =
            State::Live(Box::new(Live { texts: VecDeque::new(), frame: None, is_behind: false, sent: 0, seen: None }));
        Outcome::Opened
    }

    pub fn say(&mut self, text: Utf8Bytes) {
        if let State::Live(live) = &mut self.state {
            live.texts.push_back(text);
        }
    }

    /// Replaces a frame that was not sent yet.
    pub fn show(&mut self, frame: Bytes) {
        if let State::Live(live) = &mut self.state {
            live.frame = Some(frame);
        }
    }

    pub fn seen(&mut self, frames: u64) {
        if let State::Live(live) = &mut self.state {
            live.seen = Some(frames.min(live.sent));
        }
    }

    pub fn write(&mut self) -> Outcome {
        match (&mut self.stream, &mut self.state) {
            (Some(Stream::Plain(stream)), State::Answering { left, at, .. }) => {
                while *at < left.len() {
                    match stream.write(&left[*at..]) {
                        Ok(0) => return Outcome::Ended,
                        Ok(count) => *at += count,
                        Err(error) if error.kind() == ErrorKind::WouldBlock => return Outcome::Goes,
                        Err(error) if error.kind() == ErrorKind::Interrupted => {}
                        Err(_) => return Outcome::Ended,
                    }
                }
                // Unread input would make the system reset the connection and cut off the answer.
                let _ = stream.shutdown(std::net::Shutdown::Write);
                let mut rest = [0; 2048];
                while stream.read(&mut rest).is_ok_and(|count| count > 0) {}
                Outcome::Ended
            }
            (Some(Stream::Socket(socket)), State::Live(live)) => loop {
                if live.is_behind {
                    match socket.flush() {
                        Ok(()) => live.is_behind = false,
                        Err(error) if would_block(&error) => return Outcome::Goes,
                        Err(_) => return Outcome::Ended,
                    }
                }
                let next = live.texts.pop_front().map(Message::Text);
                let is_ready = live.seen.is_none_or(|seen| live.sent < seen + AHEAD);
                let frame = || live.frame.take_if(|_| is_ready).map(Message::Binary);
                let Some(message) = next.or_else(frame) else {
                    return Outcome::Goes;
                };
                live.sent += u64::from(message.is_binary());
                live.is_behind = true;
                match socket.write(message) {
                    Ok(()) => {}
                    Err(error) if would_block(&error) => {}
                    Err(_) => return Outcome::Ended,
                }
            },
            _ => Outcome::Goes,
        }
    }
}

fn would_block(error: &Error) -> bool {
    matches!(error, Error::Io(error) if error.kind() == ErrorKind::WouldBlock)
}

fn read_words(socket: &mut WebSocket<TcpStream>, hear: &mut dyn FnMut(String) -> bool) -> Outcome {
    loop {
        match socket.read() {
            Ok(Message::Text(text)) => {
                if !hear(text.as_str().to_owned()) {
                    return Outcome::Ended;
                }
            }
            // Pages send no binary messages. The library answers pings.
            Ok(Message::Binary(_)) => return Outcome::Ended,
            Ok(_) => {}
            Err(error) if would_block(&error) => return Outcome::Goes,
            Err(_) => return Outcome::Ended,
        }
    }
}

/// The answer to a request other than for a WebSocket, and whether it is a rejection.
fn answer(request: &Request, files: &[File]) -> (Vec<u8>, bool) {
    let name = match request {
        Request::Page => Some(""),
        Request::File(name) => Some(name.as_str()),
        _ => None,
    };
    let file = files.iter().find(|file| Some(file.name) == name);
    let (status, kind, text) = match (request, file) {
        (_, Some(file)) => ("200 OK", file.kind, file.text.as_str()),
        (Request::Page | Request::File(_), None) => ("404 Not Found", "text/plain", "File not found.\n"),
        (Request::Live(_), _) => {
            ("503 Service Unavailable", "text/plain", "Too many pages are connected. Close one and reload.\n")
        }
        (Request::Refused(Refused::Method), _) => ("405 Method Not Allowed", "text/plain", "Use GET.\n"),
        (Request::Refused(Refused::Forbidden), _) => {
            let text = "Open the address that the program printed, with its token.\n";
            ("403 Forbidden", "text/plain", text)
        }
        _ => ("400 Bad Request", "text/plain", "Invalid request.\n"),
    };
    let nonce = super::random_hex().unwrap_or_default();
    let text = if kind == "text/html" { text.replace("NONCE", &nonce) } else { text.to_owned() };
    let length = text.len();
    let policy = format!(
        "default-src 'none'; script-src 'self' 'nonce-{nonce}'; style-src 'self' 'nonce-{nonce}'; connect-src 'self'; \
         img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    let mut answer = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {length}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nContent-Security-Policy: {policy}\r\n\r\n"
    )
    .into_bytes();
    answer.extend(text.into_bytes());
    (answer, file.is_none())
}
