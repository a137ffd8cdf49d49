//! The rule against symmetry and jams, which ORCA lacks. It changes the wish and never a
//! constraint, so that ORCA's guarantee holds.
//!
//! - In the open, robots pass each other on the right ([`lean`]). Without this, equal robots on a
//!   circle stop in the middle forever; with it, they circle as in a roundabout.
//! - In narrow places robots take turns ([`right_of_way`]).
//! - A robot whose straight path is blocked goes around the obstacles ([`around`]).
//! - Elsewhere a robot that makes no progress for long backs off ([`patience`]).
//! - In space robots lean to the right and somewhat up or down ([`spread`](mod@spread)).
//!
//! A robot without a goal, such as a member of a flock, follows its wish.

mod course;
mod detour;
mod gap;
mod patience;
mod right_of_way;
mod spread;
#[cfg(test)]
mod tests;

pub(super) use course::Course;
pub(crate) use detour::detour;
pub(super) use patience::Patience;
pub(super) use right_of_way::RightOfWay;
pub(super) use spread::spread;

use super::AvoidParams;
use super::dimension::Situation;
use crate::geom::Vec2;
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;

/// A robot nearer than this is in the way, thousandths of the own radius.
const LEAN_WITHIN: i32 = 5_333;
/// The same for fast robots, thousandths of the path within the horizon.
const LEAN_AHEAD: i32 = 800;

/// The wish, along the way around the obstacles in between.
///
/// Beside other robots, ends of walls alone count ([`detour`]) unless an obstacle is round: the
/// rule for gaps takes the same corners.
pub(super) fn around<S: Scalar>(course: &mut Course<S>, situation: &Situation<'_, Vec2<S>>, goal: Vec2<S>) -> Vec2<S> {
    let Situation { wish, body, nearby, obstacles, .. } = *situation;
    if wish == Vec2::ZERO {
        return wish;
    }
    let has_balls = obstacles.iter().any(|obstacle| matches!(obstacle, Obstacle::Ball { .. }));
    let ahead = if nearby.is_empty() || has_balls {
        course.ahead(obstacles, goal, body.radius_m)
    } else {
        detour(obstacles, goal, body.radius_m).and_then(Vec2::normalized)
    };
    ahead.map_or(wish, |ahead| ahead * wish.norm())
}

/// The wish, turned to the right while a robot is ahead, near, and coming nearer. Not applied near
/// the `goal`, where the robot would circle.
pub(super) fn lean<S: Scalar>(params: &AvoidParams<S>, situation: &Situation<'_, Vec2<S>>, goal: Vec2<S>) -> Vec2<S> {
    let Situation { wish, body, .. } = *situation;
    let ahead = body.max_speed_mps * params.horizon_s * S::from_milli(LEAN_AHEAD);
    let near = body.radius_m * S::from_milli(LEAN_WITHIN);
    let within = near.max(ahead);
    let is_in_the_way = |other: &Nearby<S>| {
        let offset = other.offset_m.xy();
        let gap = offset.norm() - body.radius_m - other.radius_m;
        let closing = wish - other.velocity_mps.xy();
        gap < within && offset.dot(wish) > S::ZERO && closing.dot(offset) > S::ZERO
    };
    if goal.norm() < near || !situation.nearby.iter().any(is_in_the_way) {
        return wish;
    }
    let (sin, cos) = params.deadlock.lean_rad.sin_cos();
    wish.rotate(cos, -sin)
}
