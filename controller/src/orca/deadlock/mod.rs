//! The way out of symmetry and jams, which ORCA does not have: which wish to give to it so that nobody waits for ever.
//!
//! - In the open robots pass each other on the right: while somebody is ahead, near, and coming nearer, the wish turns
//!   to the right by a fixed angle ([`lean`]). Without it equal robots on a circle stop for ever in the middle; with it
//!   they go round each other as in a roundabout. Who merely goes the same way is no reason to turn.
//! - In narrow places they take turns: see [`right_of_way`].
//! - Elsewhere who gets nowhere for long backs off a little: see [`patience`].
//! - In space they lean to the right too, each somewhat up or down: see [`spread`](mod@spread).
//!
//! Who has no goal, such as a flock, follows its wish: that others come nearer is no jam there.
//!
//! All of it changes the wish and never a constraint, so that ORCA's guarantee stands. It costs nothing where nobody is
//! near.

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

/// Who is nearer than this is in the way, thousandths of the own radius.
const LEAN_WITHIN: i32 = 5_333;
/// The same for fast robots: thousandths of the way within the horizon.
const LEAN_AHEAD: i32 = 800;

/// The wish, turned to the right while a robot is ahead, near, and comes nearer; not as near to the `goal`, where it
/// would circle. O(nearby).
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
