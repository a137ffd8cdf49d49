//! Packets over a serial line: a UART, connected to a radio modem or to another robot's UART.
//!
//! The agent's packets are frames of its wire format: postcard's, which a zero byte ends
//! ([`staya_controller::wire`]), or MAVLink's (feature `mavlink`). A [`Receiver`] extracts frames
//! from bytes; a [`Sender`] holds frames until the line accepts them; both also work with a radio
//! that has its own packets. [`PacketLink`] moves their bytes over `embedded-io` without waiting,
//! or over `embedded-io-async` (feature `async`). A full buffer drops the oldest whole frames.

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

/// Counts of a line since the start; each saturates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Frames passed on.
    pub frames: u32,
    /// Pieces that were not an intact frame: noise, damage or another version of the format.
    pub refused: u32,
    /// Intact frames that were dropped because the buffer was full.
    pub dropped: u32,
    /// Errors that the line reported.
    pub line_errors: u32,
}

impl Counts {
    const NONE: Self = Self { frames: 0, refused: 0, dropped: 0, line_errors: 0 };
}

fn count(counter: &mut u32, more: usize) {
    *counter = counter.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
}

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
