//! From a range sensor to the controller's inputs: a window of terrain, and obstacles.
//!
//! A [`Scan`] holds the measurements of a rotating lidar or a ring of sonar or infrared sensors.
//! [`LocalMap`] stores them as cells for guidance on the grid; [`outline`] converts them directly
//! to walls and balls, for collision avoidance in the plane. Both exclude known robots, whose
//! packets are more precise.
//!
//! ```rust
//! use staya_controller::agent::{GridPayload, KinematicState};
//! use staya_controller::geom::{Position, Vec2};
//! use staya_controller::grid::GridFrame;
//! use staya_controller::neighbor::Neighbor;
//! use staya_controller::obstacle::Obstacle;
//! use staya_controller::time::{Duration, Instant};
//! use staya_robot::scan::*;
//!
//! fn look(
//!     map: &mut LocalMap, // LocalMap::new(MapParams::default(), own cell)
//!     ranges_m: &[f32],   // one turn, counter-clockwise, the first one straight ahead
//!     state: &KinematicState<f32>,
//!     heading_rad: f32,
//!     others: &[Neighbor<f32, GridPayload>], // agent.neighbors()
//!     now: Instant,
//! ) -> heapless::Vec<Obstacle<f32>, 16> {
//!     let frame = GridFrame { origin_m: Vec2::new(0.0, 0.0), cell_m: 0.4 };
//!     let scan = Scan {
//!         first_rad: 0.0,
//!         step_rad: core::f32::consts::TAU / ranges_m.len().max(1) as f32,
//!         ranges_m,
//!         min_m: 0.1,
//!         max_m: 4.0,
//!         mount_m: Vec2::new(-0.06, 0.0), // over the axle, seen from the point ahead
//!     };
//!     // Other robots report their own positions.
//!     let longest = Duration::from_millis(200);
//!     let is_robot = |place| is_neighbor(others, state.position, now, longest, place, 0.05);
//!     let place_m = state.position.since::<f32>(Position::ORIGIN).xy();
//!     map.observe(&frame, place_m, heading_rad, &scan, now, is_robot);
//!     // For InCells: map.window(), and these.
//!     let params = OutlineParams { tolerance_m: 0.03, gap_m: 0.3, point_m: 0.03 };
//!     outline(&scan, heading_rad, &params, is_robot)
//! }
//! ```

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
