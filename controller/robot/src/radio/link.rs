//! Frames over a line, with and without waiting.

use super::{Counts, Framing, Receiver, Sender};
use embedded_io::{Read, ReadReady, Write, WriteReady};
use staya_controller::wire::Postcard;

/// Bytes that one call moves at a time.
pub(super) const PIECE: usize = 32;

/// Frames of the wire format `F` over a line `U`. `IN` and `OUT`: bytes between two steps, and bytes that wait to be
/// sent, `OUT` at least [`OUTBOX`](staya_controller::agent::OUTBOX).
///
/// Call [`Self::take`] once for each step and [`Self::send`] after it. In between something has to move the bytes:
///
/// - over a line that can say whether it is ready (`embedded-io`), [`Self::pump`], which never waits. Call it at least
///   as often as the HAL's own buffer fills up (at 115,200 baud a byte comes every 87 µs);
/// - over the two halves of an asynchronous line (`embedded-io-async`, feature `async`), `serve`, beside the wait for
///   the next step.
///
/// HALs whose UART has neither use a [`Receiver`] and a [`Sender`] with what they have.
#[derive(Clone, Debug)]
pub struct PacketLink<U, F = Postcard, const IN: usize = 1024, const OUT: usize = 512> {
    pub(super) line: U,
    pub(super) receiver: Receiver<F, IN>,
    pub(super) sender: Sender<F, OUT>,
}

impl<U, F: Framing, const IN: usize, const OUT: usize> PacketLink<U, F, IN, OUT> {
    /// Over `line`, with nothing received and nothing to send.
    #[must_use]
    pub const fn new(line: U) -> Self {
        Self { line, receiver: Receiver::new(), sender: Sender::new() }
    }

    /// The frames since the last call, for [`Inputs::inbox`](staya_controller::agent::Inputs::inbox).
    #[must_use]
    pub fn take(&mut self) -> &[u8] {
        self.receiver.take()
    }

    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox).
    pub fn send(&mut self, outbox: &[u8]) {
        self.sender.send(outbox);
    }

    /// What came in, and what went out.
    #[must_use]
    pub const fn counts(&self) -> (Counts, Counts) {
        (self.receiver.counts(), self.sender.counts())
    }

    /// The line itself, to set it up anew; what is read or written here the link does not see.
    #[must_use]
    pub const fn line_mut(&mut self) -> &mut U {
        &mut self.line
    }

    /// The line back.
    #[must_use]
    pub fn release(self) -> U {
        self.line
    }
}

impl<U, F: Framing, const IN: usize, const OUT: usize> PacketLink<U, F, IN, OUT>
where
    U: Read + ReadReady + Write + WriteReady,
{
    /// Moves what can be moved without waiting: in at most `IN` bytes (more would only push each other out), out what
    /// is there.
    ///
    /// # Errors
    /// The line's first one. It is counted, what it spoiled is forgotten, and the link goes on at the next call: a
    /// caller may ignore it.
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
