//! From a range sensor to the controller's inputs: a window of terrain, and obstacles.
//!
//! A [`Scan`] holds the ranges of a lidar or a ring of sensors. [`LocalMap`] stores them as cells
//! for guidance on the grid; [`outline`] converts them to walls and balls, for collision avoidance
//! in the plane. Both exclude known robots, whose packets are more precise.

mod local_map;
mod outline;

pub use local_map::{LocalMap, MapParams};
pub use outline::{OutlineParams, outline};

use staya_controller::geom::{Position, Vec2};
use staya_controller::neighbor::Neighbor;
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};

/// Ranges at equal angles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Scan<'a, S> {
    /// Direction of the first range, counter-clockwise from the robot's nose.
    pub first_rad: S,
    /// Angle from one to the next; negative if the sensor turns clockwise.
    pub step_rad: S,
    /// Metres. Ranges below [`Self::min_m`] or not a number are invalid; [`Self::max_m`] or more
    /// shows that nothing is nearer than that.
    pub ranges_m: &'a [S],
    /// The least valid range.
    pub min_m: S,
    /// The range within which the sensor reliably detects objects.
    pub max_m: S,
    /// Sensor minus reference point ([`LookAhead`](crate::drive::LookAhead): the point ahead): x to
    /// the nose, y to the left, metres.
    pub mount_m: Vec2<S>,
}

/// One measurement, relative to the robot, along the world's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ray<S> {
    /// Position of the sensor, metres.
    pub from_m: Vec2<S>,
    /// Direction of the beam: length 1.
    pub ahead: Vec2<S>,
    /// Free distance, metres.
    pub free_m: S,
    /// Whether the beam ends at an object.
    pub is_hit: bool,
}

impl<S: Scalar> Ray<S> {
    /// The end of the beam, metres.
    #[must_use]
    pub fn end_m(&self) -> Vec2<S> {
        self.from_m + self.ahead * self.free_m
    }
}

impl<'a, S: Scalar> Scan<'a, S> {
    /// Converts each range for a robot at `heading_rad`; `None` for invalid ranges. O(1) each.
    pub fn rays(&self, heading_rad: S) -> impl Iterator<Item = Option<Ray<S>>> + 'a {
        let scan = *self;
        let (sin, cos) = heading_rad.sin_cos();
        let from_m = scan.mount_m.rotate(cos, sin);
        scan.ranges_m.iter().zip(0..).map(move |(range, number)| {
            let bearing = scan.first_rad + scan.step_rad * S::from_i32(number);
            let (sin, cos) = (heading_rad + bearing).sin_cos();
            let ray =
                Ray { from_m, ahead: Vec2::new(cos, sin), free_m: range.min(scan.max_m), is_hit: *range < scan.max_m };
            (*range >= scan.min_m && ray.end_m().is_finite()).then_some(ray)
        })
    }
}

/// Whether an object at `place_m`, relative to the robot at `own`, is a known neighbour: within
/// `margin_m` of its ball, extrapolated from its last packet to `now` by at most `longest`.
///
/// For [`LocalMap::observe`] and [`outline`]:
/// `|place| is_neighbor(agent.neighbors(), own, now, longest, place, margin)`. O(neighbours).
#[must_use]
pub fn is_neighbor<S: Scalar, P>(
    neighbors: &[Neighbor<S, P>],
    own: Position,
    now: Instant,
    longest: Duration,
    place_m: Vec2<S>,
    margin_m: S,
) -> bool {
    neighbors.iter().any(|neighbor| {
        let center = neighbor.offset_at(own, now, longest).xy();
        (place_m - center).norm() <= neighbor.radius_m + margin_m
    })
}

#[cfg(test)]
mod tests;
