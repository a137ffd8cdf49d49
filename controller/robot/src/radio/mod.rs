//! Packets over a serial line: a UART, and behind it a radio modem or another robot's UART.
//!
//! The controller's packets are frames that a zero byte ends ([`staya_controller::wire`]). A [`Receiver`] makes
//! frames of bytes, a [`Sender`] holds frames until the line takes them; neither knows any hardware, so that a
//! radio with packets of its own (ESB, LoRa) feeds them too. `MavlinkReceiver` and `MavlinkSender` (feature `mavlink`) do the same for robots that speak
//! MAVLink. [`PacketLink`] and `MavlinkLink` move their bytes over `embedded-io`
//! without ever waiting, `AsyncPacketLink` and `AsyncMavlinkLink` (feature `async`) over `embedded-io-async`.
//!
//! When there is no room, the oldest frames go, whole ones only: of two beacons of a robot the later one is worth
//! more, and who asked something asks again.

#[cfg(feature = "async")]
mod asynchronous;
mod link;
#[cfg(feature = "mavlink")]
mod mavlink;
mod queue;
mod receiver;
mod sender;

#[cfg(all(feature = "async", feature = "mavlink"))]
pub use asynchronous::AsyncMavlinkLink;
#[cfg(feature = "async")]
pub use asynchronous::{AsyncLink, AsyncPacketLink};
#[cfg(feature = "mavlink")]
pub use link::MavlinkLink;
pub use link::{Link, PacketLink};
#[cfg(feature = "mavlink")]
pub use mavlink::{MavlinkReceiver, MavlinkSender};
pub use receiver::Receiver;
pub use sender::Sender;

/// What happened on a line since the start; each count stays at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Frames that went through.
    pub frames: u32,
    /// Pieces between zero bytes that were no sound frame: noise, damage, another version of the format.
    pub refused: u32,
    /// Sound frames that had to go because there was no room.
    pub dropped: u32,
    /// Errors that the line reported.
    pub line_errors: u32,
}

/// Makes frames of the bytes of a line.
pub trait Inbound {
    /// Takes bytes in as they come, cut anywhere.
    fn push(&mut self, bytes: &[u8]);

    /// The line lost bytes (an overrun, a framing error): what was begun is of no use.
    fn line_error(&mut self);

    /// The frames since the last call, for [`Inputs::inbox`](staya_controller::agent::Inputs::inbox).
    fn take(&mut self) -> &[u8];

    /// Bytes that it has room for between two steps: more at once would only push each other out.
    fn capacity(&self) -> usize;

    /// What came so far.
    fn counts(&self) -> Counts;
}

/// Holds frames until a line takes them.
pub trait Outbound {
    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox).
    fn send(&mut self, outbox: &[u8]);

    /// What the line should take next.
    fn unsent(&self) -> &[u8];

    /// The line took the first `bytes` of [`Self::unsent`].
    fn sent(&mut self, bytes: usize);

    /// The line failed: what is left of a begun frame is of no use.
    fn line_error(&mut self);

    /// What was sent so far.
    fn counts(&self) -> Counts;
}

/// One more, up to the largest number.
fn count(counter: &mut u32, more: usize) {
    *counter = counter.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
}

#[cfg(test)]
mod tests;
