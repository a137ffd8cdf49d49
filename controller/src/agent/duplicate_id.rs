//! Distinguishes two robots that use one id.
//!
//! **Frames with the own id** can be echoes from the own radio or a router, recordings, or frames
//! of another robot. A frame is certainly from another robot if it has a boot or sequence number
//! that this robot has not reached yet, or if it has one of the last [`SAID`] sequence numbers but
//! different content. All other frames with the own id are refused as duplicates.
//!
//! Of two robots with one id, which may have started hours apart, one is always ahead. The robot
//! behind receives frames of the other one and continues counting from there. From then on both
//! send different content under equal numbers, so each one detects the other. Two robots at one
//! position with one clock send identical frames and cannot detect each other.
//!
//! **Two other robots with one id** are distinguished by their positions. A beacon belongs to a
//! second robot if the known one cannot have reached its position, neither in the time since its
//! last beacon nor in the time that its sequence numbers indicate (for delayed packets). After
//! that, a beacon belongs to the nearer of the two. If the first robot falls silent, it was one
//! robot that was moved.
//!
//! The speed limit of robots is known only to those that avoid each other by velocities. On the
//! grid, the robot with the higher sequence numbers is received, and the other one appears and
//! disappears as frames are lost. Two robots that have not received each other count independently;
//! then possibly only one of them is received.
//!
//! **With a key:** third parties refuse the robot with the lower counters of a
//! [`Sealed`](crate::wire::Sealed) wire as a replay, and receive the other one alone. The two still
//! receive each other, because no robot tracks its own counters.
//!
//! The second robot is known as [`RobotId::duplicate`](crate::robot::RobotId::duplicate). Only its
//! beacons are used; its requests and orders are ignored.

use crate::geom::{Position, Vec3};
use crate::neighbor::Neighbor;
use crate::scalar::Scalar;
use crate::time::Duration;
use crate::wire::{Header, Message};
use serde::{Deserialize, Serialize};

/// Number of own frames that are recognised. An older echo is refused by its sequence number, and a
/// robot with the own id is not detected if its frames are that late.
const SAID: usize = 16;
const _: () = assert!(SAID.is_power_of_two());

/// Fingerprints of the last own beacons, by sequence number.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct EchoFilter([u16; SAID]);

impl EchoFilter {
    pub(super) const fn new() -> Self {
        Self([0; SAID])
    }

    pub(super) fn note(&mut self, sequence: u16, message: &Message) {
        if let (Some(said), Some(print)) = (self.0.get_mut(usize::from(sequence) & (SAID - 1)), print(message)) {
            *said = print;
        }
    }

    /// Returns whether another robot must have sent this message. `next` is the header of the own
    /// next frame.
    pub(super) fn is_other(&self, next: Header, header: Header, message: &Message) -> bool {
        let Some(print) = print(message) else {
            return false;
        };
        let behind = usize::from(next.sequence.wrapping_sub(header.sequence));
        let said = self.0.get(usize::from(header.sequence) & (SAID - 1));
        is_ahead(next, header) || header.boot == next.boot && behind <= SAID && said != Some(&print)
    }
}

/// Returns whether the own counters have not reached this header yet.
pub(super) const fn is_ahead(next: Header, header: Header) -> bool {
    let boots = header.boot.wrapping_sub(next.boot).cast_signed();
    let ahead = header.sequence.wrapping_sub(next.sequence).cast_signed();
    boots > 0 || boots == 0 && ahead >= 0
}

/// Fingerprint of the time and the place in a beacon; `None` for other messages.
fn print(message: &Message) -> Option<u16> {
    let Message::Beacon(beacon) = message else {
        return None;
    };
    let more = [beacon.time.as_micros(), beacon.cell.x as u32, beacon.cell.y as u32];
    // FNV-1a over words.
    let words = beacon.position_mm.iter().map(|mm| mm.cast_unsigned()).chain(more);
    let print = words.fold(0x811C_9DC5_u32, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193));
    Some((print >> 16) as u16)
}

pub(super) fn place(message: &Message) -> Option<Position> {
    match message {
        Message::Beacon(beacon) => Some(Position::from_mm(beacon.position_mm)),
        _ => None,
    }
}

/// Returns whether the robot `known` can be at `place` after `time`, at the higher of `fastest_mps`
/// and its own speed, with a slack of its body's width. The speed is bounded by its components
/// without a square root, because this runs for each beacon.
pub(super) fn is_within<S: Scalar, P>(place: Position, known: &Neighbor<S, P>, time: Duration, fastest_mps: S) -> bool {
    let Vec3 { x, y, z } = known.velocity_mps;
    let went_mps = x.abs().max(y.abs()).max(z.abs()) * S::TWO;
    let slack_m = known.radius_m + known.radius_m;
    let most_m = fastest_mps.max(went_mps) * S::from_micro(time.as_micros()) + slack_m;
    place.since::<S>(known.position).length_key() <= Vec3::new(most_m, S::ZERO, S::ZERO).length_key()
}
