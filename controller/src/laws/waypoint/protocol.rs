//! Goals of robots in the plane or in space, and the orders that set them.

use crate::geom::{Position, Vec3};
use crate::law::Protocol;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Content, Never, ProtocolId};
use serde::{Deserialize, Serialize};

/// Waypoints that a robot can store.
pub const WAYPOINTS: usize = 4;

const LONG: Duration = Duration::from_millis(600_000);

/// A position to go to, which may move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Waypoint<S> {
    /// Position at the time `at`.
    pub position: Position,
    /// Velocity since then, m/s.
    pub velocity_mps: Vec3<S>,
    /// Time of the position, own clock.
    pub at: Instant,
}

impl<S: Scalar> Waypoint<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Waypoint<T> {
        Waypoint { position: self.position, velocity_mps: self.velocity_mps.cast(), at: self.at }
    }

    /// Creates a waypoint that does not move.
    #[must_use]
    pub const fn fixed(position: Position) -> Self {
        Self { position, velocity_mps: Vec3::ZERO, at: Instant::from_micros(0) }
    }

    /// Returns its offset from `from` at `now`, metres. Call it at least every half hour, so that
    /// the 32-bit clock cannot wrap: it moves the stored position along, rounded to a millimetre.
    #[must_use]
    pub fn way(&mut self, from: Position, now: Instant) -> Vec3<S> {
        let span = now.since(self.at);
        let moved = self.velocity_mps * S::from_micro(span.as_micros());
        if span < Duration::ZERO || span > LONG {
            self.position = self.position.moved(moved).unwrap_or(self.position);
            self.at = now;
            return self.position.since(from);
        }
        self.position.since(from) + moved
    }
}

/// The protocol of the laws with waypoints.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Waypoints {}

impl Protocol for Waypoints {
    const ID: ProtocolId = ProtocolId(2);
    type Payload = ();
    type Message = Never;
    type Order = WaypointOrder;

    fn order_subject(order: &WaypointOrder) -> Option<u32> {
        Some(order.index.into())
    }

    fn received(order: &mut WaypointOrder, sent: Instant, _: bool) {
        order.waypoint.at = sent;
    }
}

/// Sets a waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WaypointOrder {
    /// Its number, below [`WAYPOINTS`](WAYPOINTS).
    pub index: u8,
    /// The waypoint.
    #[serde(with = "on_air")]
    pub waypoint: Waypoint<f32>,
}

impl Content for WaypointOrder {}

impl WaypointOrder {
    /// Waypoint 0: the start of a new course.
    #[must_use]
    pub const fn first(waypoint: Waypoint<f32>) -> Self {
        Self { index: 0, waypoint }
    }
}

/// A waypoint in 18 bytes: millimetres and millimetres per second, when the frame was sent.
mod on_air {
    use super::{Instant, Position, Vec3, Waypoint};
    use crate::fixint::Fixed;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<Z: Serializer>(waypoint: &Waypoint<f32>, to: Z) -> Result<Z::Ok, Z::Error> {
        let Vec3 { x, y, z } = waypoint.velocity_mps;
        let milli = |mps: f32| crate::scalar::Scalar::to_milli(mps).unwrap_or(0);
        let velocity_mmps = [x, y, z].map(|mps| milli(mps).clamp(i16::MIN.into(), i16::MAX.into()) as i16);
        (waypoint.position.mm.to_bytes(), velocity_mmps.to_bytes()).serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Waypoint<f32>, D::Error> {
        let (mm, mmps) = Deserialize::deserialize(from)?;
        let mmps = <[i16; 3]>::from_bytes(mmps);
        Ok(Waypoint {
            position: Position::from_mm(Fixed::from_bytes(mm)),
            velocity_mps: Vec3::from_milli(mmps.map(i32::from)),
            at: Instant::from_micros(0),
        })
    }
}
