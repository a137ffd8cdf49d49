//! Distinguishes two robots that use one id.
//!
//! **Own id:** a frame is from another robot if its boot or sequence number lies ahead of the own
//! one, or if it repeats one of the last [`SAID`] numbers with different content. Other frames are
//! echoes or recordings. The robot behind adopts the counters of the robot ahead, so both then send
//! different content under equal numbers and detect each other. Identical frames are not detected.
//!
//! **Id of a neighbour:** a beacon is from a second robot
//! ([`RobotId::duplicate`](crate::robot::RobotId::duplicate)) if the known one cannot have reached
//! its position. Later beacons belong to the nearer of the two. Only beacons of the second robot
//! are used. The test needs the speed limit of robots, so on the grid only the robot with the
//! higher numbers is received. With a [`Sealed`](crate::wire::Sealed) wire, third parties refuse
//! the lower counters as a replay.

use crate::geom::{Position, Vec3};
use crate::neighbor::Neighbor;
use crate::scalar::Scalar;
use crate::time::Duration;
use crate::wire::{Header, Message};
use serde::{Deserialize, Serialize};

/// Number of own frames that are recognised; older echoes are refused by their numbers.
const SAID: usize = 16;
const _: () = assert!(SAID.is_power_of_two());

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

    /// Returns whether another robot must have sent this message; `next` is the own next header.
    pub(super) fn is_other(&self, next: Header, header: Header, message: &Message) -> bool {
        let Some(print) = print(message) else {
            return false;
        };
        let behind = usize::from(next.sequence.wrapping_sub(header.sequence));
        let said = self.0.get(usize::from(header.sequence) & (SAID - 1));
        is_ahead(next, header) || header.boot == next.boot && behind <= SAID && said != Some(&print)
    }
}

pub(super) const fn is_ahead(next: Header, header: Header) -> bool {
    let boots = header.boot.wrapping_sub(next.boot).cast_signed();
    let ahead = header.sequence.wrapping_sub(next.sequence).cast_signed();
    boots > 0 || boots == 0 && ahead >= 0
}

/// Fingerprint of the place and the payload in a beacon; `None` for other messages.
fn print(message: &Message) -> Option<u16> {
    let Message::Beacon(beacon) = message else {
        return None;
    };
    let bytes = beacon.position_mm.iter().flat_map(|mm| mm.to_le_bytes());
    let bytes = bytes.chain(beacon.payload.iter().copied());
    let print = bytes.fold(0x811C_9DC5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    Some((print >> 16) as u16)
}

pub(super) fn place(message: &Message) -> Option<Position> {
    match message {
        Message::Beacon(beacon) => Some(Position::from_mm(beacon.position_mm)),
        _ => None,
    }
}

/// Whether `known` can be at `place` after `time`, at `fastest_mps` or its own speed if higher,
/// with a slack of its body's width. Bounds the speed by components, since it runs for each beacon.
pub(super) fn is_within<S: Scalar, P>(place: Position, known: &Neighbor<S, P>, time: Duration, fastest_mps: S) -> bool {
    let Vec3 { x, y, z } = known.velocity_mps;
    let went_mps = x.abs().max(y.abs()).max(z.abs()) * S::TWO;
    let slack_m = known.radius_m + known.radius_m;
    let most_m = fastest_mps.max(went_mps) * S::from_micro(time.as_micros()) + slack_m;
    place.since::<S>(known.position).length_key() <= Vec3::new(most_m, S::ZERO, S::ZERO).length_key()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Beacon;

    #[test]
    fn each_bit_of_place_and_payload_changes_the_fingerprint() {
        let payload = crate::wire::Bytes::from_slice(&[7, 0, 255]).unwrap();
        let beacon = Beacon { position_mm: [-123_456, 7_890, -3], payload, ..Beacon::default() };
        let same = print(&Message::Beacon(beacon.clone()));
        for bit in 0..32 {
            for axis in 0..3 {
                let mut other = beacon.clone();
                other.position_mm[axis] ^= 1 << bit;
                assert_ne!(print(&Message::Beacon(other)), same, "bit {bit} of axis {axis}");
            }
        }
        for bit in 0..8 {
            for byte in 0..3 {
                let mut other = beacon.clone();
                other.payload[byte] ^= 1 << bit;
                assert_ne!(print(&Message::Beacon(other)), same, "bit {bit} of byte {byte}");
            }
        }
    }
}
