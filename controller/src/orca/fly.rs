//! Collision avoidance in space as one step, for robots that fly: what robots and obstacles near by forbid, and a wish that
//! leans where everybody would meet in one point.

use super::Params;
use super::space::{HalfSpace, Neighbor, Solution, half_space, obstacle, solve};
use crate::body::Body;
use crate::geom::Vec3;
use crate::neighbor::{Nearby, tie};
use crate::obstacle::Obstacle;
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod tests;

/// Parameters of [`fly`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlyParams<S> {
    /// Time ahead for which no collision with a robot may happen, seconds; more than 0, and more than speed / acceleration.
    pub horizon_s: S,
    /// The same for what does not move, seconds.
    pub obstacle_horizon_s: S,
    /// Share of the correction towards robots that give way too; 1/2 when all use the same.
    pub share: S,
    /// Added to the sum of the radii of two robots, metres: the error of what is known of the other one; 0.002 or more, since
    /// places come rounded to a millimetre.
    pub margin_m: S,
}

impl<S: Scalar> Default for FlyParams<S> {
    fn default() -> Self {
        Self {
            horizon_s: S::TWO,
            obstacle_horizon_s: S::ONE,
            share: S::HALF,
            margin_m: S::from_milli(3),
        }
    }
}

impl<S: Scalar> FlyParams<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> FlyParams<T> {
        FlyParams {
            horizon_s: cast(self.horizon_s),
            obstacle_horizon_s: cast(self.obstacle_horizon_s),
            share: cast(self.share),
            margin_m: cast(self.margin_m),
        }
    }
}

/// The velocity to take until the next step: the nearest to `wish_mps`, leant to the right while somebody is in the way,
/// that robots and obstacles permit; where they permit none, the one that violates them least,
/// obstacles first. At most `K` half-spaces count, obstacles before robots, though robots have half of the places.
///
/// The lean: while somebody who is no farther than the horizon takes us together is within 45 degrees of the wish, and the goal
/// `way_m` is farther than he, the wish is turned by 25 degrees to the right, for each robot somewhat
/// up or down by its number. That takes the symmetry out
/// of ways that all cross in one point. It changes the wish and
/// never a half-space, so ORCA's guarantee stands.
///
/// What is not finite counts as absent (wish: as zero). Work: as [`solve`], and O(obstacles + `nearby`).
///
/// Not inlined: its half-spaces are no burden to firmware that does not fly.
#[inline(never)]
#[must_use]
pub fn fly<S: Scalar, const K: usize>(
    params: &FlyParams<S>,
    body: &Body<S>,
    wish_mps: Vec3<S>,
    way_m: Option<Vec3<S>>,
    nearby: &[Nearby<S>],
    obstacles: &[Obstacle<S>],
) -> Solution<S> {
    let own = body.velocity_mps;
    let own = if own.is_finite() { own } else { Vec3::ZERO };
    let mut planes = Vec::<HalfSpace<S>, K>::new();
    let room = K.saturating_sub(nearby.len().min(K >> 1));
    for solid in obstacles {
        let plane = obstacle(own, solid, body.radius_m, params.obstacle_horizon_s);
        if let Some(plane) = plane
            && planes.len() < room
        {
            // There is room.
            let _ = planes.push(plane);
        }
    }
    let hard = planes.len();
    for other in nearby {
        let neighbor = Neighbor {
            offset_m: other.offset_m,
            velocity_mps: other.velocity_mps,
            radii_m: body.radius_m + other.radius_m + params.margin_m,
            // It takes a sine, and only who is in the same place asks for it.
            tie: if other.offset_m.norm_squared() < S::from_milli(1) {
                tie(body.id, other.id).extend(S::ZERO)
            } else {
                Vec3::ZERO
            },
        };
        let rules = Params {
            horizon_s: params.horizon_s,
            separation_s: body.step_s,
            share: if other.gives_way {
                params.share
            } else {
                S::ONE
            },
        };
        if let Some(plane) = half_space(own, &neighbor, &rules)
            && planes.push(plane).is_err()
        {
            break;
        }
    }
    let wish = wish_mps.clamp_norm(body.max_speed_mps);
    let wish = if meets_somebody(params, body, wish, way_m, nearby) {
        lean(body.id, wish)
    } else {
        wish
    };
    solve::<S, K>(&planes, hard, wish, body.max_speed_mps)
}

/// Whether somebody is ahead, and nearer than the goal.
fn meets_somebody<S: Scalar>(
    params: &FlyParams<S>,
    body: &Body<S>,
    wish: Vec3<S>,
    way_m: Option<Vec3<S>>,
    nearby: &[Nearby<S>],
) -> bool {
    let Some(ahead) = wish.normalized() else {
        return false;
    };
    let goal = way_m.map_or(S::MAX, Vec3::norm);
    // cos 45 degrees.
    let narrow = S::from_ratio(70_711, 100_000);
    nearby.iter().any(|other| {
        let distance = other.offset_m.norm();
        let radii = body.radius_m + other.radius_m;
        let reach = radii + (body.max_speed_mps + other.velocity_mps.norm()) * params.horizon_s;
        let is_ahead = other.offset_m.dot(ahead) > narrow * distance;
        is_ahead && distance <= reach && distance < goal
    })
}

/// The wish turned by 25 degrees to the right as seen from above (straight up: to the east; straight down: to the west), and
/// for each robot somewhat up or down of that, by its number.
fn lean<S: Scalar>(own: RobotId, wish: Vec3<S>) -> Vec3<S> {
    let (cos, sin) = (
        S::from_ratio(90_631, 100_000),
        S::from_ratio(42_262, 100_000),
    );
    let east = if wish.z > S::ZERO { S::ONE } else { -S::ONE };
    let right = wish.cross(Vec3::new(S::ZERO, S::ZERO, S::ONE));
    let right = right
        .normalized()
        .unwrap_or(Vec3::new(east, S::ZERO, S::ZERO));
    let Some(above) = right.cross(wish).normalized() else {
        return wish;
    };
    // Multiples of the golden ratio spread evenly over a turn of 2^32; of that a quarter turn around the right.
    let spread = own.0.wrapping_mul(0x9E37_79B9) >> 16;
    let share = S::from_ratio(spread.cast_signed() - (1 << 15), 1 << 16);
    let (up, level) = (share * S::PI * S::HALF).sin_cos();
    wish * cos + (right * level + above * up) * (wish.norm() * sin)
}
