//! Packets over a serial line: a UART, and behind it a radio modem or another robot's UART.
//!
//! The controller's packets are frames that a zero byte ends ([`staya_controller::wire`]). A [`Receiver`] makes
//! frames of bytes, a [`Sender`] holds frames until the line takes them; neither knows any hardware, so that a
//! radio with packets of its own (ESB, LoRa) feeds them too. [`PacketLink`] moves their bytes over `embedded-io`
//! without ever waiting, and `AsyncPacketLink` (feature `async`) over `embedded-io-async`.
//!
//! When there is no room, the oldest frames go, whole ones only: of two beacons of a robot the later one is worth
//! more, and who asked something asks again.

#[cfg(feature = "async")]
mod asynchronous;
mod link;
mod queue;
mod receiver;
mod sender;

#[cfg(feature = "async")]
pub use asynchronous::AsyncPacketLink;
pub use link::PacketLink;
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

/// One more, up to the largest number.
fn count(counter: &mut u32, more: usize) {
    *counter = counter.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
}

#[cfg(test)]
mod tests;
