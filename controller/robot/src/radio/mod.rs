//! Packets over a serial line: a UART, and behind it a radio modem or another robot's UART.
//!
//! The agent's packets are frames of its wire format: postcard's, which a zero byte ends ([`staya_controller::wire`]),
//! or MAVLink's (feature `mavlink`). A [`Receiver`] makes frames of bytes, a [`Sender`] holds frames until the line
//! takes them; neither knows any hardware, so that a radio with packets of its own (ESB, LoRa) feeds them too.
//! [`PacketLink`] moves their bytes over `embedded-io` without ever waiting, or over `embedded-io-async` (feature
//! `async`).
//!
//! When there is no room, the oldest frames go, whole ones only: of two beacons of a robot the later one is worth
//! more, and who asked something asks again.

#[cfg(feature = "async")]
mod asynchronous;
mod framing;
mod link;
mod receiver;
mod sender;
#[cfg(test)]
mod tests;

pub use framing::{Framing, Piece};
pub use link::PacketLink;
pub use receiver::Receiver;
pub use sender::Sender;

use core::cell::Cell;
use heapless::Vec;

/// What happened on a line since the start; each count stays at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Frames that went through.
    pub frames: u32,
    /// Pieces that were no sound frame: noise, damage, another version of the format.
    pub refused: u32,
    /// Sound frames that had to go because there was no room.
    pub dropped: u32,
    /// Errors that the line reported.
    pub line_errors: u32,
}

impl Counts {
    const NONE: Self = Self { frames: 0, refused: 0, dropped: 0, line_errors: 0 };
}

/// So many more, up to the largest number.
fn count(counter: &mut u32, more: usize) {
    *counter = counter.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
}

/// Takes `count` bytes out from `start` on. O(N).
fn remove<const N: usize>(bytes: &mut Vec<u8, N>, start: usize, count: usize) {
    let cells = Cell::from_mut(bytes.as_mut_slice()).as_slice_of_cells();
    let count = count.min(cells.len().saturating_sub(start));
    let later = cells.iter().skip(start.saturating_add(count));
    for (to, from) in cells.iter().skip(start).zip(later) {
        to.set(from.get());
    }
    let left = cells.len().saturating_sub(count);
    bytes.truncate(left);
}
