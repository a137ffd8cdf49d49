//! Conversion of a beacon into an entry of the neighbour table.

use super::Beacon;
use crate::geom::{Position, Vec3};
use crate::neighbor::{Neighbor, Trace};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};

impl<S: Scalar, P: Default> Neighbor<S, P> {
    /// The robot `id` as described by its beacon, received at `now`.
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn from_beacon(id: RobotId, beacon: &Beacon, now: Instant) -> Self {
        Self {
            id,
            heard: now,
            busy_until: now + Duration::from_millis(i32::from(beacon.busy_ms)),
            position: Position::from_mm(beacon.position_mm),
            velocity_mps: Vec3::from_milli(beacon.velocity_mmps.map(i32::from)),
            radius_m: S::from_milli(i32::from(beacon.radius_mm)),
            cell: beacon.cell,
            target: beacon.target,
            leader: beacon.leader,
            heading: beacon.heading,
            slot: beacon.slot,
            mode: beacon.mode,
            trace: Trace::Heard,
            gap_m: S::ZERO,
            payload: P::default(),
        }
    }
}
