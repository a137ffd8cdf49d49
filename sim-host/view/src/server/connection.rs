//! One browser's connection: a request, then a file or a WebSocket.

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

/// Longest message of a page, bytes.
const LONGEST_MESSAGE: usize = 64 << 10;
/// Texts that wait for a page that does not read.
const UNREAD: usize = 512;
/// Bytes on their way to a page at most: a scene and a frame of a million robots.
const MOST_BYTES: usize = 256 << 20;

/// Frames on their way to a page that says what it has drawn.
const AHEAD: u64 = 3;

/// What came of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// It goes on.
    Goes,
    /// It has become a page's.
    Opened,
    /// It asked for what it does not get, and is being told so.
    Refused,
    /// It is over.
    Ended,
}

enum State {
    /// Says what it wants, until some time.
    Asking { heard: Vec<u8>, until: Instant },
    /// Is given an answer, until some time.
    Answering { left: Vec<u8>, at: usize, until: Instant },
    /// A page.
    Live(Box<Live>),
}

struct Live {
    texts: VecDeque<Utf8Bytes>,
    frame: Option<Bytes>,
    /// Bytes are in its buffer.
    is_behind: bool,
    /// Frames that were sent.
    sent: u64,
    /// Of them, those that it says it has drawn; `None`: it has said nothing yet.
    seen: Option<u64>,
}

pub(super) struct Connection {
    /// `None` only while it changes hands.
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

    /// Takes it off the poll; `is_over`: because nothing is served any more, which a page is told.
    pub fn end(self, registry: &Registry, is_over: bool) {
        match self.stream {
            // It is closed in any case.
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

    /// Reads what there is. `has_room`: for another page; `hear` takes its words, and says whether it could.
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
            // What is said while an answer goes out is not heard.
            _ => Outcome::Goes,
        }
    }

    /// Becomes a page's.
    fn upgrade(&mut self, key: &str) -> Outcome {
        let Some(Stream::Plain(mut stream)) = self.stream.take() else {
            return Outcome::Ended;
        };
        let accept = derive_accept_key(key.as_bytes());
        let head = format!(
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {accept}\r\n\r\n"
        );
        // The first bytes on a connection: they fit, or something is wrong with it.
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

    /// Says something to a page.
    pub fn say(&mut self, text: Utf8Bytes) {
        if let State::Live(live) = &mut self.state {
            live.texts.push_back(text);
        }
    }

    /// Shows a page a frame, unless a newer one comes before it can be sent.
    pub fn show(&mut self, frame: Bytes) {
        if let State::Live(live) = &mut self.state {
            live.frame = Some(frame);
        }
    }

    /// It has drawn so many frames.
    pub fn seen(&mut self, frames: u64) {
        if let State::Live(live) = &mut self.state {
            live.seen = Some(frames.min(live.sent));
        }
    }

    /// Sends what can be sent now.
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
                // All of it has been sent: whatever was not read before it is closed would cut it off.
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
            // Pages send no bytes; pings are answered below.
            Ok(Message::Binary(_)) => return Outcome::Ended,
            Ok(_) => {}
            Err(error) if would_block(&error) => return Outcome::Goes,
            Err(_) => return Outcome::Ended,
        }
    }
}

/// What a request gets that asks for no WebSocket, or for one more than there can be; and whether that is not what it asked for.
fn answer(request: &Request, files: &[File]) -> (Vec<u8>, bool) {
    let file = match request {
        Request::File(name) => files.iter().find(|file| file.name == name),
        _ => None,
    };
    let (status, kind, text) = match (request, file) {
        (_, Some(file)) => ("200 OK", file.kind, file.text.as_str()),
        (Request::File(_), None) => ("404 Not Found", "text/plain", "There is no such file.\n"),
        (Request::Live(_), _) => ("503 Service Unavailable", "text/plain", "Too many pages look at this run.\n"),
        (Request::Refused(Refused::Method), _) => ("405 Method Not Allowed", "text/plain", "Only GET.\n"),
        (Request::Refused(Refused::Forbidden), _) => {
            let text = "Only by the address that was printed, with its token.\n";
            ("403 Forbidden", "text/plain", text)
        }
        _ => ("400 Bad Request", "text/plain", "This is no request.\n"),
    };
    // Without one nothing inline runs.
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
