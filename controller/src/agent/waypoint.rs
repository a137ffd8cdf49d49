//! Goals of robots in the plane or in space.

use crate::geom::{Position, Vec3};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
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
