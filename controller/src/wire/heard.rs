//! What beacons tell of their senders, as the neighbour table keeps it.

use super::{Beacon, CompactBeacon};
use crate::geom::{Position, Vec3};
use crate::grid::{Cell, Dir};
use crate::neighbor::Neighbor;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};

impl<S: Scalar, P: Default> Neighbor<S, P> {
    /// The robot `id` as its beacon, received at `now`, describes it.
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
            is_lost: false,
            gap_m: S::ZERO,
            payload: P::default(),
        }
    }

    /// The robot `id` as its compact beacon, received at `now`, describes it: at height 0, without
    /// a leader, standing in `cell`, which the caller finds from the position if it uses cells.
    #[must_use]
    #[expect(clippy::arithmetic_side_effects, reason = "16 bits times 10 within 32")]
    pub fn from_compact(id: RobotId, beacon: &CompactBeacon, cell: Cell, now: Instant) -> Self {
        let [x, y] = beacon.position_mm;
        let [vx, vy] = beacon.velocity_mmps.map(i32::from);
        Self {
            id,
            heard: now,
            busy_until: now,
            position: Position::from_mm([x, y, 0]),
            velocity_mps: Vec3::from_milli([vx, vy, 0]),
            radius_m: S::from_milli(i32::from(beacon.radius_cm) * 10),
            cell,
            target: cell,
            leader: RobotId::NOBODY,
            heading: Dir::Stay,
            slot: 0,
            mode: beacon.mode,
            is_lost: false,
            gap_m: S::ZERO,
            payload: P::default(),
        }
    }
}
