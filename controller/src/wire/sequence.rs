//! Classifies the frames of one sender: the sliding window of IPsec (RFC 4303, section 3.4.3) on a
//! wrapping 16-bit sequence, with a boot number that marks a restart.

use super::Header;
use serde::{Deserialize, Serialize};

/// How many sequence numbers a [`SequenceWindow`] remembers, including the newest.
pub const SEQUENCE_SPAN: u16 = u32::BITS as u16;

/// The class of a frame, given the frames received before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Arrival {
    /// The first frame of the sender, or newer than all frames before.
    New,
    /// Not received yet, but a newer frame arrived first.
    OutOfOrder,
    /// Received before.
    Duplicate,
    /// [`SEQUENCE_SPAN`] or more behind the newest, so possibly a replay.
    TooOld,
    /// The first frame after a restart of the sender.
    Rebooted,
    /// A frame from before the sender's last restart; a replay.
    PreviousBoot,
}

impl Arrival {
    /// Whether the frame was not accepted before: new, late, or the first after a restart.
    #[must_use]
    pub const fn is_accepted(self) -> bool {
        matches!(self, Self::New | Self::OutOfOrder | Self::Rebooted)
    }

    /// Whether the frame is the latest of its sender, so that its state replaces the known one.
    #[must_use]
    pub const fn is_latest(self) -> bool {
        matches!(self, Self::New | Self::Rebooted)
    }
}

/// The recent sequence numbers of one sender; 8 bytes.
///
/// "Newer" means less than 2^15 ahead, so drop the window of a silent sender after at most 2^15
/// frame periods (54 minutes at 10 Hz). Rejected frames must not count as a sign of life: dropping
/// also repairs a window that an undetected error moved.
///
/// A new boot number is accepted at once. The window remembers one earlier boot, whose frames give
/// [`Arrival::PreviousBoot`]; still earlier boots look like another restart. Count boots in
/// persistent memory: a random number equals the previous one once in 256 starts, and then the
/// robot is rejected until the window is dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SequenceWindow {
    /// Bit k: the frame `newest - k` was received. 0: no frame was ever received.
    seen: u32,
    newest: u16,
    boot: u8,
    /// Equal to `boot` if there was none.
    previous: u8,
}

const _: () = assert!(size_of::<SequenceWindow>() == 8);

impl SequenceWindow {
    /// Creates a window that has not received any frame.
    #[must_use]
    pub const fn new() -> Self {
        Self { seen: 0, newest: 0, boot: 0, previous: 0 }
    }

    /// Classifies a frame of this window's sender and records it. Constant work.
    pub fn check(&mut self, header: Header) -> Arrival {
        let Header { boot, sequence, .. } = header;
        if self.seen == 0 {
            self.restart(header, boot);
            return Arrival::New;
        }
        if boot != self.boot {
            if boot == self.previous {
                return Arrival::PreviousBoot;
            }
            self.restart(header, self.boot);
            return Arrival::Rebooted;
        }
        let ahead = sequence.wrapping_sub(self.newest);
        if ahead.cast_signed() > 0 {
            self.seen = self.seen.checked_shl(ahead.into()).unwrap_or(0) | 1;
            self.newest = sequence;
            return Arrival::New;
        }
        let Some(bit) = 1_u32.checked_shl(ahead.wrapping_neg().into()) else {
            return Arrival::TooOld;
        };
        if self.seen & bit != 0 {
            return Arrival::Duplicate;
        }
        self.seen |= bit;
        Arrival::OutOfOrder
    }

    /// How many frames are missing between the newest frame and this newer one.
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "it is more than 0 there")]
    pub const fn skipped(&self, header: Header) -> u16 {
        let ahead = header.sequence.wrapping_sub(self.newest);
        if self.seen == 0 || header.boot != self.boot || ahead.cast_signed() <= 0 { 0 } else { ahead - 1 }
    }

    /// At most how many beacon periods after the newest frame an authenticated sender sent this
    /// newer one; 0 for other frames. Such a sender takes two numbers in each period of its clock,
    /// the even one for its beacon, and more only if it has more to send ([`next_beacon`]).
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "at most 2^15")]
    pub const fn periods(&self, header: Header) -> u16 {
        let ahead = header.sequence.wrapping_sub(self.newest);
        if self.seen == 0 || header.boot != self.boot || ahead.cast_signed() <= 0 {
            return 0;
        }
        ((self.newest & 1) + ahead) >> 1
    }

    /// The distance of this frame from the newest one, before or behind; 0 after a reboot.
    #[must_use]
    pub const fn distance(&self, header: Header) -> u16 {
        let ahead = header.sequence.wrapping_sub(self.newest);
        if self.seen == 0 || header.boot != self.boot { 0 } else { ahead.cast_signed().unsigned_abs() }
    }

    fn restart(&mut self, header: Header, previous: u8) {
        *self = Self { seen: 1, newest: header.sequence, boot: header.boot, previous };
    }
}

/// The number of an authenticated sender's beacon that is sent `periods` after the last one, for a
/// sender whose next frame would have the number `next`. At most [`MOST_PERIODS`] are counted.
#[must_use]
pub fn next_beacon(next: u16, periods: u16) -> u16 {
    let even = next.wrapping_add(next & 1);
    even.wrapping_add(periods.clamp(1, MOST_PERIODS).wrapping_sub(1).wrapping_mul(2))
}

/// The longest pause that [`next_beacon`] counts, in beacon periods. Its numbers cannot look older
/// than the last ones.
pub const MOST_PERIODS: u16 = 1 << 13;

#[cfg(test)]
mod tests;
