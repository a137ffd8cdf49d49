//! Which frames of one sender are new, late, repeated or replayed.
//!
//! The sliding window of IPsec (RFC 4303, section 3.4.3) over a sequence of 16 bits that wraps, and
//! a boot number that says that the sequence started anew.

use super::Header;
use serde::{Deserialize, Serialize};

/// How many sequence numbers a [`SequenceWindow`] remembers, the newest included.
pub const SEQUENCE_SPAN: u16 = u32::BITS as u16;

/// What a frame is, seen from what came before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Arrival {
    /// The first frame of the sender, or newer than everything before.
    New,
    /// Not seen yet, but a newer one came first.
    OutOfOrder,
    /// Seen already.
    Duplicate,
    /// [`SEQUENCE_SPAN`] or more behind the newest: whether it was seen is forgotten; a replay.
    TooOld,
    /// The sender started anew, and this is the first frame since.
    Rebooted,
    /// From before the sender's last start; a replay.
    PreviousBoot,
}

impl Arrival {
    /// Whether the frame was never accepted before: new, late or the first of a new boot.
    #[must_use]
    pub const fn is_accepted(self) -> bool {
        matches!(self, Self::New | Self::OutOfOrder | Self::Rebooted)
    }

    /// Whether the frame is the latest word of its sender: what it says of its state replaces
    /// what was known.
    #[must_use]
    pub const fn is_latest(self) -> bool {
        matches!(self, Self::New | Self::Rebooted)
    }
}

/// The recent sequence numbers of one sender; 8 bytes.
///
/// "Newer" means less than 2^15 ahead. The owner therefore drops the window when it forgets a
/// silent sender, at the latest after 2^15 frame periods (54 minutes at 10 Hz). That also heals the
/// window when a damaged frame passed every check and moved it far ahead, or to a boot that
/// never was: refused frames do not count as a sign of life.
///
/// A new boot number is believed at once. One earlier boot is remembered: its frames are
/// [`Arrival::PreviousBoot`]; frames of still earlier boots look like another start. Boot numbers
/// are best counted in lasting memory; one drawn at random equals the previous one (and makes
/// the robot wait until it is forgotten) once in 256 starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SequenceWindow {
    /// Bit k: the frame `newest - k` was seen. 0: none was, ever.
    seen: u32,
    newest: u16,
    boot: u8,
    /// The boot before; equal to `boot` when there was none.
    previous: u8,
}

const _: () = assert!(size_of::<SequenceWindow>() == 8);

impl SequenceWindow {
    /// A window that has seen nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { seen: 0, newest: 0, boot: 0, previous: 0 }
    }

    /// Judges a frame of this window's sender and remembers it. Constant work.
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

    /// How many frames between the newest and this newer one have not come.
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "it is more than 0 there")]
    pub const fn skipped(&self, header: Header) -> u16 {
        let ahead = header.sequence.wrapping_sub(self.newest);
        if self.seen == 0 || header.boot != self.boot || ahead.cast_signed() <= 0 { 0 } else { ahead - 1 }
    }

    /// How many frames this one is before or behind the newest, if it is of the same boot; 0 otherwise.
    #[must_use]
    pub const fn distance(&self, header: Header) -> u16 {
        let ahead = header.sequence.wrapping_sub(self.newest);
        if self.seen == 0 || header.boot != self.boot { 0 } else { ahead.cast_signed().unsigned_abs() }
    }

    fn restart(&mut self, header: Header, previous: u8) {
        *self = Self { seen: 1, newest: header.sequence, boot: header.boot, previous };
    }
}

#[cfg(test)]
mod tests;
