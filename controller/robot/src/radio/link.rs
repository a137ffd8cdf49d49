use super::{Counts, Framing, Receiver, Sender};
use embedded_io::{Read, ReadReady, Write, WriteReady};
use staya_controller::wire::Postcard;

pub(super) const PIECE: usize = 32;

/// Frames of the wire format `F` over a line `U`. `IN` and `OUT` are the buffer sizes in bytes;
/// `OUT` is at least [`OUTBOX`](staya_controller::agent::OUTBOX).
///
/// Call [`Self::take`] once for each step and [`Self::send`] after it. In between, move the bytes:
///
/// - over a line that reports whether it is ready (`embedded-io`), by [`Self::pump`], at least as
///   often as the HAL's own buffer fills up (at 115,200 baud a byte arrives every 87 µs);
/// - over two halves of an asynchronous line (`embedded-io-async`, feature `async`), by `serve`.
///
/// If the HAL's UART has neither, use a [`Receiver`] and a [`Sender`] directly.
#[derive(Clone, Debug)]
pub struct PacketLink<U, F = Postcard, const IN: usize = 1024, const OUT: usize = 512> {
    pub(super) line: U,
    pub(super) receiver: Receiver<F, IN>,
    pub(super) sender: Sender<F, OUT>,
}

impl<U, F: Framing, const IN: usize, const OUT: usize> PacketLink<U, F, IN, OUT> {
    /// Creates a link over `line` with empty buffers.
    #[must_use]
    pub const fn new(line: U) -> Self {
        Self { line, receiver: Receiver::new(), sender: Sender::new() }
    }

    /// The frames received since the last call, for [`Inputs`](staya_controller::agent::Inputs).
    #[must_use]
    pub fn take(&mut self) -> &[u8] {
        self.receiver.take()
    }

    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox).
    pub fn send(&mut self, outbox: &[u8]) {
        self.sender.send(outbox);
    }

    /// The counts of reception and transmission.
    #[must_use]
    pub const fn counts(&self) -> (Counts, Counts) {
        (self.receiver.counts(), self.sender.counts())
    }

    /// The line itself; the link does not see bytes read or written here.
    #[must_use]
    pub const fn line_mut(&mut self) -> &mut U {
        &mut self.line
    }

    /// Returns the line.
    #[must_use]
    pub fn release(self) -> U {
        self.line
    }
}

impl<U, F: Framing, const IN: usize, const OUT: usize> PacketLink<U, F, IN, OUT>
where
    U: Read + ReadReady + Write + WriteReady,
{
    /// Moves all bytes that can be moved without waiting; reads at most `IN`.
    ///
    /// # Errors
    /// The line's first error. It is counted, and the next call continues.
    pub fn pump(&mut self) -> Result<(), U::Error> {
        let heard = self.hear();
        if heard.is_err() {
            self.receiver.line_error();
        }
        let said = self.say();
        if said.is_err() {
            self.sender.line_error();
        }
        heard.and(said)
    }

    fn hear(&mut self) -> Result<(), U::Error> {
        let mut piece = [0; PIECE];
        let mut left = IN;
        while left > 0 && self.line.read_ready()? {
            let len = self.line.read(&mut piece)?;
            let Some(bytes) = piece.get(..len).filter(|bytes| !bytes.is_empty()) else {
                break;
            };
            self.receiver.push(bytes);
            left = left.saturating_sub(bytes.len());
        }
        Ok(())
    }

    fn say(&mut self) -> Result<(), U::Error> {
        while !self.sender.unsent().is_empty() && self.line.write_ready()? {
            let len = self.line.write(self.sender.unsent())?;
            if len == 0 {
                break;
            }
            self.sender.sent(len);
        }
        Ok(())
    }
}
