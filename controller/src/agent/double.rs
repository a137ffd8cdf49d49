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

use crate::geom::Position;
use crate::neighbor::Neighbor;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Header, Message};
use serde::Serialize;

/// Frames of one's own that are known again. What comes back later is refused for its number; a double whose news are so late is
/// not heard.
const SAID: usize = 16;
const _: () = assert!(SAID.is_power_of_two());

/// The last beacons of one's own, by sequence number: a few bits of what they said.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Said([u16; SAID]);

impl Said {
    pub(super) const fn new() -> Self {
        Self([0; SAID])
    }

    /// Takes note of what is said under a sequence number.
    pub(super) fn note(&mut self, sequence: u16, message: &Message) {
        if let (Some(said), Some(place)) = (self.0.get_mut(usize::from(sequence) & (SAID - 1)), Place::of(message)) {
            *said = place.print;
        }
    }

    /// Whether somebody else must have said this, `next` being the header of the own next frame; under a number that is still to
    /// come, or under one of the last.
    pub(super) fn is_other(&self, next: Header, header: Header, place: &Place) -> bool {
        let behind = usize::from(next.sequence.wrapping_sub(header.sequence));
        let said = self.0.get(usize::from(header.sequence) & (SAID - 1));
        is_ahead(next, header) || header.boot == next.boot && behind <= SAID && said != Some(&place.print)
    }
}

/// Whether the own numbers have not come to this one yet.
pub(super) const fn is_ahead(next: Header, header: Header) -> bool {
    let boots = header.boot.wrapping_sub(next.boot).cast_signed();
    let ahead = header.sequence.wrapping_sub(next.sequence).cast_signed();
    boots > 0 || boots == 0 && ahead >= 0
}

/// Where a beacon says that its sender is.
pub(super) struct Place {
    position: Position,
    velocity_mmps: [i16; 3],
    radius_mm: u16,
    /// A few bits of when and where.
    print: u16,
}

impl Place {
    /// What a beacon says; `None` for other messages.
    pub(super) fn of(message: &Message) -> Option<Self> {
        let (mm, velocity_mmps, radius_mm, more) = match message {
            Message::Beacon(beacon) => {
                let more = [beacon.time.as_micros(), beacon.cell.x as u32, beacon.cell.y as u32];
                (beacon.position_mm, beacon.velocity_mmps, beacon.radius_mm, more)
            }
            Message::Compact(beacon) => {
                let ([x, y], [vx, vy]) = (beacon.position_mm, beacon.velocity_mmps);
                ([x, y, 0], [vx, vy, 0], u16::from(beacon.radius_cm) * 10, [beacon.time_ms.into(), 0, 0])
            }
            _ => return None,
        };
        let words = mm.iter().map(|mm| mm.cast_unsigned()).chain(more);
        // FNV-1a by words.
        let print = words.fold(0x811C_9DC5_u32, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193));
        let print = (print >> 16) as u16;
        Some(Self { position: Position::from_mm(mm), velocity_mmps, radius_mm, print })
    }

    /// Whether a robot that was heard as `known` can be here after `time` at its own speed, or one that is told or
    /// `fastest_mps`, give or take two bodies.
    pub(super) fn is_within<S: Scalar>(&self, known: &Neighbor<S>, time: Duration, fastest_mps: S) -> bool {
        let speed = self.velocity_mmps.iter().map(|v| S::from_milli(i32::from(*v).abs()));
        let speed = speed.fold(fastest_mps.max(known.velocity_mps.norm()), |sum, v| sum.max(v));
        let slack_m = known.radius_m + S::from_milli(self.radius_mm.into());
        let way_m = self.position.since::<S>(known.position).norm();
        // False for NaN: nothing is known of such a robot.
        let is_beyond = way_m > speed * S::from_micro(time.as_micros()) + slack_m;
        !is_beyond
    }

    /// How far it is from where `known` should be at `now`, metres.
    pub(super) fn distance<S: Scalar>(&self, known: &Neighbor<S>, now: Instant, longest: Duration) -> S {
        known.offset_at(self.position, now, longest).norm()
    }
}
