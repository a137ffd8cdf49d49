//! The way out of symmetry and jams, which ORCA does not have: which wish to give to it so that nobody waits for ever.
//!
//! - In the open robots pass each other on the right: while somebody is ahead, near, and coming nearer, the wish turns
//!   to the right by a fixed angle ([`lean`]). Without it equal robots on a circle stop for ever in the middle; with it
//!   they go round each other as in a roundabout. Who merely goes the same way is no reason to turn.
//! - In narrow places they take turns: see [`right_of_way`].
//! - In space they lean to the right too, each somewhat up or down: see [`spread`](mod@spread).
//!
//! All of it changes the wish and never a constraint, so that ORCA's guarantee stands. It costs nothing where nobody is
//! near.

mod gap;
mod right_of_way;
mod spread;

pub(super) use right_of_way::RightOfWay;
pub(super) use spread::spread;

use super::DeadlockParams;
use super::dimension::Situation;
use crate::geom::Vec2;
use crate::neighbor::Nearby;
use crate::scalar::Scalar;

/// The wish, turned to the right while a robot is ahead, near, and comes nearer. O(nearby).
pub(super) fn lean<S: Scalar>(params: &DeadlockParams<S>, situation: &Situation<'_, Vec2<S>>) -> Vec2<S> {
    let wish = situation.wish;
    let near_goal = situation.goal.is_some_and(|goal| goal.norm() < params.straight_within_m);
    let is_in_the_way = |other: &Nearby<S>| {
        let offset = other.offset_m.xy();
        let gap = offset.norm() - situation.body.radius_m - other.radius_m;
        let closing = wish - other.velocity_mps.xy();
        gap < params.lean_within_m && offset.dot(wish) > S::ZERO && closing.dot(offset) > S::ZERO
    };
    if near_goal || !situation.nearby.iter().any(is_in_the_way) {
        return wish;
    }
    let (sin, cos) = params.lean_rad.sin_cos();
    wish.rotate(cos, -sin)
}
