//! From a range sensor to what the controller wants to see: a window of terrain, and obstacles.
//!
//! A [`Scan`] is what a turning lidar or a ring of sonar or infrared sensors measured. [`LocalMap`] remembers it as
//! cells for guidance on the grid; [`outline`] makes walls and balls of it at once, for collision avoidance in the
//! plane. Both leave out what is known to be another robot, whose packets say more about it.

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
    /// Where the first one looks, counter-clockwise from the robot's nose.
    pub first_rad: S,
    /// From one to the next; negative when the sensor turns clockwise.
    pub step_rad: S,
    /// Metres. Those below [`Self::min_m`] and what is not a number are no measurement; those of [`Self::max_m`] or
    /// more (also infinite ones) say that nothing is nearer than `max_m`.
    pub ranges_m: &'a [S],
    /// The least range that means something.
    pub min_m: S,
    /// The range that the sensor sees for sure.
    pub max_m: S,
    /// Where the sensor is, seen from the robot's reference point (for two wheels with
    /// [`LookAhead`](crate::drive::LookAhead): from the point ahead): x to the nose, y to the left, metres.
    pub mount_m: Vec2<S>,
}

/// One measurement, relative to the robot, along the world's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ray<S> {
    /// Where the sensor is, metres.
    pub from_m: Vec2<S>,
    /// Where it looks: length 1.
    pub ahead: Vec2<S>,
    /// How far it is free, metres.
    pub free_m: S,
    /// Whether something is there at the end.
    pub is_hit: bool,
}

impl<S: Scalar> Ray<S> {
    /// Where it ends, metres.
    #[must_use]
    pub fn end_m(&self) -> Vec2<S> {
        self.from_m + self.ahead * self.free_m
    }
}

impl<'a, S: Scalar> Scan<'a, S> {
    /// What each range says, `None` for those that say nothing, of a robot at `heading_rad`. O(1) for each: one sine
    /// and cosine.
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

/// Whether what is seen at `place_m`, relative to the robot at `own`, is one of the known neighbours: within `margin_m`
/// of its ball, where its last packet leads it by `now`, gone on for at most `longest`. The margin covers how wrong
/// that may be.
///
/// For [`LocalMap::observe`] and [`outline`]: `|place| is_neighbor(agent.neighbors(), own, now, longest, place,
/// margin)`. O(neighbours).
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
