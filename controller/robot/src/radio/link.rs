//! The link over a line that can say whether it is ready.

use super::{Counts, Inbound, Outbound, Receiver, Sender};
#[cfg(feature = "mavlink")]
use super::{MavlinkReceiver, MavlinkSender};
use embedded_io::{Read, ReadReady, Write, WriteReady};

/// Bytes that one call moves at a time.
const PIECE: usize = 32;

/// Frames over a line `U`, which it asks before each call whether it is ready: nothing here ever waits.
///
/// Call [`Self::pump`] at least as often as the HAL's own buffer fills up (at 115,200 baud a byte comes every 87 µs), [`Self::take`]
/// once for each step, and [`Self::send`] after it.
///
/// HALs whose UART lacks [`WriteReady`] use the receiver and the sender with what they have, or `AsyncLink`.
#[derive(Clone, Debug)]
pub struct Link<U, R, S> {
    line: U,
    receiver: R,
    sender: S,
}

/// [`Link`] for robots that speak postcard. `IN` and `OUT`: bytes between two steps and bytes that wait to be sent;
/// `OUT` at least [`OUTBOX`](staya_controller::agent::OUTBOX).
pub type PacketLink<U, const IN: usize = 1024, const OUT: usize = 512> =
    Link<U, Receiver<IN>, Sender<OUT>>;

/// [`Link`] for robots that speak MAVLink; `IN` and `OUT` as for [`PacketLink`].
#[cfg(feature = "mavlink")]
pub type MavlinkLink<U, const IN: usize = 1536, const OUT: usize = 512> =
    Link<U, MavlinkReceiver<IN>, MavlinkSender<OUT>>;

impl<U, const IN: usize, const OUT: usize> PacketLink<U, IN, OUT> {
    /// Over `line`, with nothing received and nothing to send.
    #[must_use]
    pub const fn new(line: U) -> Self {
        Self {
            line,
            receiver: Receiver::new(),
            sender: Sender::new(),
        }
    }
}

#[cfg(feature = "mavlink")]
impl<U, const IN: usize, const OUT: usize> MavlinkLink<U, IN, OUT> {
    /// Over `line`, with nothing received and nothing to send.
    #[must_use]
    pub const fn new(line: U) -> Self {
        Self {
            line,
            receiver: MavlinkReceiver::new(),
            sender: MavlinkSender::new(),
        }
    }
}

impl<U, R: Inbound, S: Outbound> Link<U, R, S> {
    /// The frames since the last call, for [`Inputs::inbox`](staya_controller::agent::Inputs::inbox).
    #[must_use]
    pub fn take(&mut self) -> &[u8] {
        self.receiver.take()
    }

    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox); [`Self::pump`] sends them.
    pub fn send(&mut self, outbox: &[u8]) {
        self.sender.send(outbox);
    }

    /// What came in, and what went out.
    #[must_use]
    pub fn counts(&self) -> (Counts, Counts) {
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

impl<U, R: Inbound, S: Outbound> Link<U, R, S>
where
    U: Read + ReadReady + Write + WriteReady,
{
    /// Moves what can be moved without waiting: in at most [`Inbound::capacity`] bytes, out what is there.
    ///
    /// # Errors
    /// The line's first one. It is counted, what it spoiled is forgotten, and the link goes on at the next call: a caller may
    /// ignore it.
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
        let mut left = self.receiver.capacity();
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
