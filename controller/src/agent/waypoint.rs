//! Where a robot of the plane or of space is to go.

use crate::geom::{Position, Vec3};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Waypoints that a robot has room for.
pub const WAYPOINTS: usize = 4;

/// Span after which a moving waypoint is taken note of.
const LONG: Duration = Duration::from_millis(600_000);

/// A place to go to, which may move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Waypoint<S> {
    /// Where it was.
    pub position: Position,
    /// Its velocity since, m/s.
    pub velocity_mps: Vec3<S>,
    /// When it was there, own clock.
    pub at: Instant,
}

impl<S: Scalar> Waypoint<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Waypoint<T> {
        Waypoint { position: self.position, velocity_mps: self.velocity_mps.cast(), at: self.at }
    }

    /// One that stays where it is.
    #[must_use]
    pub const fn fixed(position: Position) -> Self {
        Self { position, velocity_mps: Vec3::ZERO, at: Instant::from_micros(0) }
    }

    /// The way there from `from` at `now`, metres. Call it at least every half hour: what moves is taken note of
    /// on the way, lest the clock run round (each time rounds to a millimetre).
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
