use super::metered::{Metered, TURN};
use super::request::{LONGEST, Refused, Request, Rules};
use crate::page::File;
use mio::Registry;
use mio::net::TcpStream;
use std::collections::VecDeque;
use std::io::{ErrorKind, Read as _, Write as _};
use std::time::Instant;
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::frame::Frame;
use tungstenite::protocol::frame::coding::{CloseCode, Data, OpCode};
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Bytes, Error, Message, Utf8Bytes, WebSocket};

const LONGEST_MESSAGE: usize = 64 << 10;
/// Limits of queued texts, beyond which a page is disconnected. The bytes do not include the
/// longest text, since a scene of a million robots has hundreds of megabytes.
const UNREAD: usize = 512;
const UNREAD_BYTES: usize = 8 << 20;
/// Longer messages are sent in pieces of this size, since a page's write buffer holds a copy.
const PIECE: usize = 64 << 10;
/// Bytes sent to a page in one turn.
const MOST_SENT: usize = 1 << 20;
/// A piece, and answers to pings.
const WRITE_BUFFER: usize = 2 * PIECE;

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
    /// It has sent more than it may.
    Exceeded,
}

enum State {
    Asking { heard: Vec<u8>, until: Instant },
    Answering { left: Vec<u8>, at: usize, until: Instant },
    Live(Box<Live>),
}

#[derive(Default)]
struct Live {
    texts: VecDeque<Utf8Bytes>,
    unread_bytes: usize,
    frame: Option<Bytes>,
    /// The rest of a message that is being sent, and how its next piece begins.
    rest: Option<(Data, Bytes)>,
    /// The write buffer is not empty.
    is_behind: bool,
    /// The bound of a turn is reached.
    has_more: bool,
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
    Plain(Metered),
    Socket(Box<WebSocket<Metered>>),
}

impl Stream {
    fn metered(&self) -> &Metered {
        match self {
            Self::Plain(stream) => stream,
            Self::Socket(socket) => socket.get_ref(),
        }
    }

    fn metered_mut(&mut self) -> &mut Metered {
        match self {
            Self::Plain(stream) => stream,
            Self::Socket(socket) => socket.get_mut(),
        }
    }
}

impl Live {
    fn is_late(&self, stream: Option<&Stream>, now: Instant) -> bool {
        let is_stalled = self.is_behind && stream.is_some_and(|stream| stream.metered().is_stalled(now));
        let longest = || self.texts.iter().map(|text| text.len()).max().unwrap_or_default();
        let has_too_many_bytes = self.unread_bytes > UNREAD_BYTES && self.unread_bytes - longest() > UNREAD_BYTES;
        is_stalled || self.texts.len() > UNREAD || has_too_many_bytes
    }

    /// The next piece of the present message, or the first one of the next message.
    fn next_piece(&mut self) -> Option<Frame> {
        let (kind, mut left) = self.rest.take().or_else(|| self.next_message())?;
        let piece = left.split_to(left.len().min(PIECE));
        let is_last = left.is_empty();
        self.rest = (!is_last).then_some((Data::Continue, left));
        Some(Frame::message(piece, OpCode::Data(kind), is_last))
    }

    fn next_message(&mut self) -> Option<(Data, Bytes)> {
        if let Some(text) = self.texts.pop_front() {
            self.unread_bytes -= text.len();
            return Some((Data::Text, text.into()));
        }
        let is_ready = self.seen.is_none_or(|seen| self.sent < seen + AHEAD);
        let frame = self.frame.take_if(|_| is_ready)?;
        self.sent += 1;
        Some((Data::Binary, frame))
    }
}

impl Connection {
    pub fn new(stream: TcpStream, until: Instant) -> Self {
        let stream = Some(Stream::Plain(Metered::new(stream)));
        Self { stream, state: State::Asking { heard: Vec::new(), until } }
    }

    pub fn input_arrived(&mut self) {
        if let Some(stream) = &mut self.stream {
            stream.metered_mut().input_arrived();
        }
    }

    /// Whether there may be input to read. During an answer there is none.
    pub fn has_input(&self) -> bool {
        let is_answering = matches!(self.state, State::Answering { .. });
        !is_answering && self.stream.as_ref().is_some_and(|stream| stream.metered().has_input())
    }

    /// Whether it has work that no event reports.
    pub fn has_more(&self) -> bool {
        self.has_input() || matches!(&self.state, State::Live(live) if live.has_more)
    }

    pub const fn is_live(&self) -> bool {
        matches!(self.state, State::Live(_))
    }

    pub fn is_late(&self, now: Instant) -> bool {
        match &self.state {
            State::Asking { until, .. } | State::Answering { until, .. } => now > *until,
            State::Live(live) => live.is_late(self.stream.as_ref(), now),
        }
    }

    /// With `is_over` a page gets the message that the server ends.
    pub fn end(self, registry: &Registry, is_over: bool) {
        match self.stream {
            Some(Stream::Plain(mut stream)) => drop(registry.deregister(stream.stream())),
            Some(Stream::Socket(mut socket)) => {
                let farewell = CloseFrame { code: CloseCode::Away, reason: "over".into() };
                let _ = socket.close(is_over.then_some(farewell));
                let _ = socket.flush();
                drop(registry.deregister(socket.get_mut().stream()));
            }
            None => {}
        }
    }

    /// Reads at most [`TURN`] bytes. `has_room`: another page is allowed. `hear` returns whether it
    /// had room for a message.
    pub fn read(
        &mut self,
        rules: &Rules,
        files: &[File],
        has_room: bool,
        hear: &mut dyn FnMut(String) -> bool,
    ) -> Outcome {
        if let Some(stream) = &mut self.stream {
            stream.metered_mut().begin_turn();
        }
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
            .read_buffer_size(TURN)
            .write_buffer_size(0)
            .max_write_buffer_size(WRITE_BUFFER);
        let socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
        self.stream = Some(Stream::Socket(Box::new(socket)));
        self.state = State::Live(Box::default());
        Outcome::Opened
    }

    pub fn say(&mut self, text: Utf8Bytes) {
        if let State::Live(live) = &mut self.state {
            live.unread_bytes += text.len();
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

    /// Sends a little more than [`MOST_SENT`] at most.
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
                let _ = stream.stream().shutdown(std::net::Shutdown::Write);
                let mut rest = [0; 2048];
                stream.begin_turn();
                while stream.read(&mut rest).is_ok_and(|count| count > 0) {}
                Outcome::Ended
            }
            (Some(Stream::Socket(socket)), State::Live(live)) => {
                live.has_more = false;
                let mut sent = 0;
                while sent < MOST_SENT {
                    if live.is_behind {
                        match socket.flush() {
                            Ok(()) => live.is_behind = false,
                            Err(error) if would_block(&error) => return Outcome::Goes,
                            Err(_) => return Outcome::Ended,
                        }
                    }
                    let Some(piece) = live.next_piece() else {
                        return Outcome::Goes;
                    };
                    live.is_behind = true;
                    sent += piece.len();
                    socket.get_mut().begin_message();
                    match socket.write(Message::Frame(piece)) {
                        Ok(()) => {}
                        Err(error) if would_block(&error) => {}
                        Err(_) => return Outcome::Ended,
                    }
                }
                live.has_more = true;
                Outcome::Goes
            }
            _ => Outcome::Goes,
        }
    }
}

fn would_block(error: &Error) -> bool {
    matches!(error, Error::Io(error) if error.kind() == ErrorKind::WouldBlock)
}

fn read_words(socket: &mut WebSocket<Metered>, hear: &mut dyn FnMut(String) -> bool) -> Outcome {
    loop {
        let read = socket.read();
        let stream = socket.get_mut();
        if read.is_ok() {
            stream.count_message();
        }
        if stream.is_exceeded() {
            return Outcome::Exceeded;
        }
        match read {
            Ok(Message::Text(text)) => {
                if !hear(text.as_str().to_owned()) {
                    return Outcome::Exceeded;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::metered::STALLED;
    use std::time::Duration;

    #[test]
    fn a_page_is_late_once_it_took_nothing_for_half_a_minute() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port is free");
        let _other = std::net::TcpStream::connect(listener.local_addr().expect("an address")).expect("it listens");
        let (stream, _) = listener.accept().expect("it connects");
        stream.set_nonblocking(true).expect("a socket");
        let mut page = Connection::new(TcpStream::from_std(stream), Instant::now());
        assert_eq!(page.upgrade("key"), Outcome::Opened);
        let later = || Instant::now() + STALLED + Duration::from_secs(1);
        assert_eq!((page.write(), page.is_late(later())), (Outcome::Goes, false), "nothing waits");
        page.show(vec![0; 64 << 20].into());
        let mut turns = 0;
        loop {
            assert_eq!(page.write(), Outcome::Goes);
            turns += 1;
            if !page.has_more() {
                break;
            }
        }
        assert!((2..64).contains(&turns), "{turns}");
        assert!(!page.is_late(Instant::now()) && page.is_late(later()));
    }
}
