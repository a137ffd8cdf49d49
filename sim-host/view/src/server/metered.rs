use mio::net::TcpStream;
use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// Bytes that a connection may send in one turn of the server's loop.
pub(super) const TURN: usize = 16 << 10;
/// Bytes and messages that a page may send in a second.
const BYTES: usize = 1 << 20;
const MESSAGES: usize = 4096;
/// Time in which a page must take some of the bytes that wait for it.
pub(super) const STALLED: Duration = Duration::from_secs(30);

/// A stream that gives a bounded number of bytes in each turn and counts them.
#[derive(Debug)]
pub(super) struct Metered {
    stream: TcpStream,
    /// Bytes that may still be read in this turn.
    left: usize,
    has_input: bool,
    /// Start of the second in which bytes and messages are counted.
    second: Instant,
    bytes: usize,
    messages: usize,
    /// When the other end last took bytes, or could begin to.
    taken: Instant,
}

impl Metered {
    pub fn new(stream: TcpStream) -> Self {
        let now = Instant::now();
        Self { stream, left: 0, has_input: false, second: now, bytes: 0, messages: 0, taken: now }
    }

    pub const fn stream(&mut self) -> &mut TcpStream {
        &mut self.stream
    }

    /// The system reports input once; it counts until a read finds none.
    pub const fn input_arrived(&mut self) {
        self.has_input = true;
    }

    pub const fn has_input(&self) -> bool {
        self.has_input
    }

    pub fn begin_turn(&mut self) {
        self.left = TURN;
        let now = Instant::now();
        if now.duration_since(self.second) >= Duration::from_secs(1) {
            (self.second, self.bytes, self.messages) = (now, 0, 0);
        }
    }

    pub const fn count_message(&mut self) {
        self.messages += 1;
    }

    /// Whether the other end has sent more than a page may send in a second.
    pub const fn is_exceeded(&self) -> bool {
        self.bytes > BYTES || self.messages > MESSAGES
    }

    pub fn begin_message(&mut self) {
        self.taken = Instant::now();
    }

    pub fn is_stalled(&self, now: Instant) -> bool {
        now.duration_since(self.taken) > STALLED
    }
}

impl Read for Metered {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(ErrorKind::WouldBlock.into());
        }
        let most = buffer.len().min(self.left);
        let read = self.stream.read(&mut buffer[..most]);
        match &read {
            Ok(count) => {
                self.left -= count;
                self.bytes += count;
            }
            Err(error) => self.has_input &= error.kind() != ErrorKind::WouldBlock,
        }
        read
    }
}

impl Write for Metered {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.stream.write(bytes)?;
        self.taken = Instant::now();
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
