//! Two robots with one number: how they are told apart.
//!
//! **Who hears its own number** hears itself, if its radio or a router sends frames back; a recording of itself; or somebody else. What a
//! robot has not said cannot be its own: a boot or a sequence number that it has not come to yet, or, under one of its last
//! [`SAID`] sequence numbers, something else than it said then. All other frames of its number are refused, as
//! repeated ones of others are. Of two robots with one number, which may have started hours apart, one is always ahead. The
//! other one hears that, and goes on counting from there: so both say different things under the same numbers from then on, and
//! each hears the other. Two that stand in one place with one clock say the same, and do not know of each other.
//!
//! **Who hears two robots of another number** tells them apart by their places. When a beacon comes from where the one that is
//! known cannot be, neither in the time since it was heard nor in that for which its sequence numbers allow (news that were
//! held back), it is the second one's; after that, a beacon is of the one that is nearer. When the first one is not heard any more, it was one
//! robot that was moved. How fast robots can be is known only to those that
//! keep clear of them by velocities; on the grid the one whose numbers are ahead is heard, and the other one comes and
//! goes as frames are lost. Two that have not heard each other count apart: then it may be that only one of them is heard.
//!
//! With a key: whoever is behind in the counters of a [`Sealed`](crate::wire::Sealed) wire is a replay to third parties, who then hear the other
//! one alone. The two hear each other all the same, since nobody takes note of its own counters.
//!
//! The second one is known as [`RobotId::double`](crate::robot::RobotId::double); only its beacons count, its requests and orders do not.

use crate::geom::{Position, Vec3};
use crate::neighbor::Neighbor;
use crate::scalar::Scalar;
use crate::time::Duration;
use crate::wire::{Header, Message};
use serde::{Deserialize, Serialize};

/// Frames of one's own that are known again. What comes back later is refused for its number; a double whose news are so late is
/// not heard.
const SAID: usize = 16;
const _: () = assert!(SAID.is_power_of_two());

/// The last beacons of one's own, by sequence number: a few bits of what they said.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Said([u16; SAID]);

impl Said {
    pub(super) const fn new() -> Self {
        Self([0; SAID])
    }

    /// Takes note of what is said under a sequence number.
    pub(super) fn note(&mut self, sequence: u16, message: &Message) {
        if let (Some(said), Some(print)) = (self.0.get_mut(usize::from(sequence) & (SAID - 1)), print(message)) {
            *said = print;
        }
    }

    /// Whether somebody else must have said this, `next` being the header of the own next frame; under a number that is still to
    /// come, or under one of the last.
    pub(super) fn is_other(&self, next: Header, header: Header, message: &Message) -> bool {
        let Some(print) = print(message) else {
            return false;
        };
        let behind = usize::from(next.sequence.wrapping_sub(header.sequence));
        let said = self.0.get(usize::from(header.sequence) & (SAID - 1));
        is_ahead(next, header) || header.boot == next.boot && behind <= SAID && said != Some(&print)
    }
}

/// Whether the own numbers have not come to this one yet.
pub(super) const fn is_ahead(next: Header, header: Header) -> bool {
    let boots = header.boot.wrapping_sub(next.boot).cast_signed();
    let ahead = header.sequence.wrapping_sub(next.sequence).cast_signed();
    boots > 0 || boots == 0 && ahead >= 0
}

/// A few bits of when and where a beacon says that its sender is; `None` for other messages.
fn print(message: &Message) -> Option<u16> {
    let Message::Beacon(beacon) = message else {
        return None;
    };
    let more = [beacon.time.as_micros(), beacon.cell.x as u32, beacon.cell.y as u32];
    // FNV-1a by words.
    let words = beacon.position_mm.iter().map(|mm| mm.cast_unsigned()).chain(more);
    let print = words.fold(0x811C_9DC5_u32, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193));
    Some((print >> 16) as u16)
}

/// Where a beacon says that its sender is; `None` for other messages.
pub(super) fn place(message: &Message) -> Option<Position> {
    match message {
        Message::Beacon(beacon) => Some(Position::from_mm(beacon.position_mm)),
        _ => None,
    }
}

/// Whether a robot that was heard as `known` can be at `place` after `time` at `fastest_mps`, or as it went if that is faster (by
/// its components, without a root: this is asked of each beacon), give or take its body's width.
pub(super) fn is_within<S: Scalar, P>(place: Position, known: &Neighbor<S, P>, time: Duration, fastest_mps: S) -> bool {
    let Vec3 { x, y, z } = known.velocity_mps;
    let went_mps = x.abs().max(y.abs()).max(z.abs()) * S::TWO;
    let slack_m = known.radius_m + known.radius_m;
    let most_m = fastest_mps.max(went_mps) * S::from_micro(time.as_micros()) + slack_m;
    place.since::<S>(known.position).length_key() <= Vec3::new(most_m, S::ZERO, S::ZERO).length_key()
}
