//! The rule against symmetry and jams, which ORCA lacks: it chooses the preferred velocity for ORCA
//! so that no robot waits forever.
//!
//! - In the open, robots pass each other on the right: while a robot is ahead, near, and coming
//!   nearer, the wish turns to the right by a fixed angle ([`lean`]). Without it, equal robots on a
//!   circle stop in the middle forever; with it, they circle as in a roundabout. A robot that moves
//!   the same way does not trigger it.
//! - In narrow places robots take turns: see [`right_of_way`].
//! - Elsewhere a robot that makes no progress for long backs off a little: see [`patience`].
//! - In space robots also lean to the right, each somewhat up or down: see [`spread`](mod@spread).
//!
//! A robot without a goal, such as a member of a flock, follows its wish, since approaching robots
//! are not a jam there.
//!
//! The rule changes the wish and never a constraint, so that ORCA's guarantee holds. It costs
//! nothing if no robot is near.

mod gap;
mod patience;
mod right_of_way;
mod spread;

pub(super) use patience::Patience;
pub(super) use right_of_way::RightOfWay;
pub(super) use spread::spread;

use super::AvoidParams;
use super::dimension::Situation;
use crate::geom::Vec2;
use crate::neighbor::Nearby;
use crate::scalar::Scalar;

/// A robot nearer than this is in the way, thousandths of the own radius.
const LEAN_WITHIN: i32 = 5_333;
/// The same distance for fast robots, thousandths of the path within the horizon.
const LEAN_AHEAD: i32 = 800;

/// The wish, turned to the right while a robot is ahead, near, and coming nearer. Not applied near
/// the `goal`, where the robot would circle. O(nearby).
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
