//! Conversion of a beacon into an entry of the neighbour table.

use super::{Beacon, Content, ProtocolId};
use crate::geom::{Position, Vec3};
use crate::neighbor::{Neighbor, Trace};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;

impl<S: Scalar, P: Content> Neighbor<S, P> {
    /// The robot `id` as described by its beacon, received at `now`; `own` is the protocol of `P`.
    #[must_use]
    pub fn from_beacon(id: RobotId, beacon: &Beacon, own: ProtocolId, now: Instant) -> Self {
        Self {
            id,
            heard: now,
            position: Position::from_mm(beacon.position_mm),
            velocity_mps: Vec3::from_milli(beacon.velocity_mmps.map(i32::from)),
            radius_m: S::from_milli(i32::from(beacon.radius_mm)),
            flock: beacon.flock,
            mode: beacon.mode,
            trace: Trace::Heard,
            gap_m: S::ZERO,
            payload: P::decode(own, beacon.protocol, &beacon.payload),
        }
    }
}
