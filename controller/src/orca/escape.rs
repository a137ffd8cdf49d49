//! The way out of symmetry and jams: which wish to give to ORCA so that nobody waits for ever.
//!
//! - In the open robots pass each other on the right: while somebody is ahead, near, and coming nearer, the wish turns to the
//!   right by a fixed angle. Without it equal robots on a circle stop for ever in the middle; with it they go round each other as in a
//!   roundabout. Who merely goes the same way is no reason to turn.
//! - In narrow places they take turns: see [`turn`](super::turn).
//!
//! Neither costs anything where nobody is near.

use super::turn::Turn;
use crate::body::Body;
use crate::geom::Vec2;
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// Parameters of the rule of escape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EscapeParams<S> {
    /// How far to the right of the wish to lean while a robot is in the way, radians; 0: never. More makes every way longer; less
    /// leaves robots on a circle in each other's way for longer (below 0.25 for ever). 0.4 to 0.6. No danger: the half-planes stay.
    pub lean_rad: S,
    /// A robot is in the way when its border is nearer than this, metres: about as far as the robot goes within its horizon.
    pub lean_within_m: S,
    /// Nobody leans nearer to its goal than this, metres: there it would circle.
    pub straight_within_m: S,
    /// For how long (to twice as long) a robot leaves an empty gap to those whose turn it is, seconds. Less than others
    /// need to come from where they wait (two or three radii) lets turns be skipped; more costs time when somebody
    /// merely stands near a gap. 2 to 10.
    pub patience_s: S,
}

impl<S: Scalar> Default for EscapeParams<S> {
    fn default() -> Self {
        Self {
            lean_rad: S::from_milli(460),
            lean_within_m: S::from_milli(800),
            straight_within_m: S::from_milli(800),
            patience_s: S::from_i32(3),
        }
    }
}

impl<S: Scalar> EscapeParams<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> EscapeParams<T> {
        EscapeParams {
            lean_rad: cast(self.lean_rad),
            lean_within_m: cast(self.lean_within_m),
            straight_within_m: cast(self.straight_within_m),
            patience_s: cast(self.patience_s),
        }
    }
}

/// What the rule sees.
pub(super) struct Scene<'a, S> {
    pub(super) body: &'a Body<S>,
    /// Finite, within the speed limit.
    pub(super) wish: Vec2<S>,
    pub(super) goal: Option<Vec2<S>>,
    pub(super) nearby: &'a [Nearby<S>],
    pub(super) obstacles: &'a [Obstacle<S>],
}

/// State of the rule.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Escape<S> {
    turn: Turn<S>,
}

impl<S: Scalar> Escape<S> {
    pub(super) const fn new() -> Self {
        Self { turn: Turn::new() }
    }

    /// The wish for the solver. Not inlined, so that its stack is free again for it.
    #[inline(never)]
    pub(super) fn wish(
        &mut self,
        params: &EscapeParams<S>,
        scene: &Scene<'_, S>,
        rng: &mut Rng,
    ) -> Vec2<S> {
        match self.turn.wish(scene, params.patience_s, rng) {
            Some(wish) => wish,
            None => lean(params, scene),
        }
    }
}

/// To the right of a robot ahead.
fn lean<S: Scalar>(params: &EscapeParams<S>, scene: &Scene<'_, S>) -> Vec2<S> {
    let wish = scene.wish;
    let near_goal = scene
        .goal
        .is_some_and(|goal| goal.norm() < params.straight_within_m);
    let is_in_the_way = |other: &Nearby<S>| {
        let offset = other.offset_m.xy();
        let gap = offset.norm() - scene.body.radius_m - other.radius_m;
        let closing = wish - other.velocity_mps.xy();
        gap < params.lean_within_m && offset.dot(wish) > S::ZERO && closing.dot(offset) > S::ZERO
    };
    if near_goal || !scene.nearby.iter().any(is_in_the_way) {
        return wish;
    }
    let (sin, cos) = params.lean_rad.sin_cos();
    wish.rotate(cos, -sin)
}
