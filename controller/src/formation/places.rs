//! Keeping a formation in the plane: a place is a point that moves with the top leader, and robots follow it.
//!
//! The law is proportional control with feed-forward of the leader's velocity, as in any text on leader and follower
//! formations (J. P. Desai, J. Ostrowski and V. Kumar 1998); the top leader goes no faster than the slowest follows.
//! All gains come from one time, in which the body can get going ([`Drive`]): no gain is larger than
//! its reciprocal, so that a body that lags behind its commands by up to as long comes to its place without
//! swinging about it. News of others are old by the radio's delay, but these loops close over the own body.

use crate::body::Body;
use crate::geom::Vec2;
use crate::grid::{Cell, Window};
use crate::scalar::Scalar;

/// Steps in which a body without inertia gets going all the same: news of it take a step or more.
const STEPS: i32 = 10;
/// What the top leader leaves to the others for corrections, thousandths of the highest speed. More brings them back to
/// their places sooner and makes every journey longer by as much.
const RESERVE: i32 = 100;
/// How near to its goal a robot has come to rest, thousandths of its radius; twice as far off it goes there again.
const AT_REST: i32 = 250;

/// What a body can do, as the law needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Drive<S> {
    max_speed_mps: S,
    radius_m: S,
    step_s: S,
    /// 1/T, where T is the time to get to the highest speed, or some steps if that is longer, 1/s.
    rate: S,
    halt_m: S,
}

impl<S: Scalar> Drive<S> {
    /// Of a body at the highest speed that it can have where it is.
    #[must_use]
    pub fn new(body: &Body<S>) -> Self {
        let Body { max_speed_mps, max_acceleration_mps2, radius_m, step_s, .. } = *body;
        let by_inertia = max_speed_mps.checked_div(max_acceleration_mps2).unwrap_or(S::ZERO);
        let response_s = by_inertia.max(step_s * S::from_i32(STEPS));
        let rate = S::ONE.checked_div(response_s).unwrap_or(S::ZERO);
        let halt_m = radius_m + max_speed_mps * response_s * S::HALF;
        Self { max_speed_mps, radius_m, step_s, rate, halt_m }
    }

    /// The lag at which a leader stands, metres: the own radius, and half of the way in which a body gets going. Half of it is
    /// too far from a place to count as being there.
    #[must_use]
    pub const fn halt_m(&self) -> S {
        self.halt_m
    }

    /// How near counts as being at the goal, metres, if the robot was there before or not.
    #[must_use]
    pub fn tolerance_m(&self, was_there: bool) -> S {
        self.radius_m * S::from_milli(if was_there { 2 * AT_REST } else { AT_REST })
    }

    /// The velocity towards a place `way_m` off that moves at `place_mps`. At most the highest speed.
    #[must_use]
    pub fn follow(&self, way_m: Vec2<S>, place_mps: Vec2<S>) -> Vec2<S> {
        let correction_mps = (way_m * self.rate).clamp_norm(self.max_speed_mps);
        (place_mps + correction_mps).clamp_norm(self.max_speed_mps)
    }

    /// The top leader's speed, m/s: with a reserve for the others, slower in proportion to how far the last of them is
    /// behind, and so that it comes to rest `left_m` ahead with half of the braking that a body has.
    #[must_use]
    pub fn leads_at(&self, lag_m: S, left_m: S) -> S {
        let reserved = self.max_speed_mps * S::from_milli(1000 - RESERVE);
        let room_m = (self.halt_m - lag_m).max(S::ZERO);
        let speed = (reserved * room_m).checked_div(self.halt_m).unwrap_or(S::ZERO);
        let half = self.max_speed_mps * S::HALF;
        let near = left_m * self.rate;
        // v^2 = (V/2)^2 + 2 (V/2T) (d - VT/2), as a slope that ends where the proportional law begins.
        let before_goal = if near <= half { near } else { ((near + near - half) * half).sqrt() };
        speed.min(before_goal)
    }

    /// The velocity nearest to `wish_mps` that a leader takes after `before_mps`: it gets going and turns half as
    /// quickly as it could, and brakes as quickly, since others learn of it late.
    #[must_use]
    pub fn gently(&self, before_mps: Vec2<S>, wish_mps: Vec2<S>) -> Vec2<S> {
        let change = wish_mps - before_mps;
        let brakes = change.dot(before_mps) < S::ZERO;
        let most = self.max_speed_mps * self.step_s * self.rate * if brakes { S::ONE } else { S::HALF };
        before_mps + change.clamp_norm(most)
    }
}

/// How far `off_m` (actual minus desired) is behind for a formation that goes in direction `ahead`, metres: who is ahead
/// or aside loses nothing when the others go on.
#[must_use]
pub fn behind<S: Scalar>(off_m: Vec2<S>, ahead: Vec2<S>) -> S {
    (-off_m.dot(ahead)).max(S::ZERO)
}

/// Whether all cells under the straight way `way_m` are as `is_good` wants them, as far as the window shows them: of a robot
/// `offset_m` off the middle of its `cell`. Looks at a point each half cell, O(width + height) of them.
#[must_use]
pub fn is_straight<S: Scalar>(
    window: &Window<'_>,
    (cell, offset_m, cell_m): (Cell, Vec2<S>, S),
    way_m: Vec2<S>,
    is_good: &dyn Fn(Cell) -> bool,
) -> bool {
    let Some(ahead) = way_m.normalized() else { return true };
    let step_m = cell_m * S::HALF;
    let steps = way_m.norm().checked_div(step_m).and_then(S::floor_to_i32).unwrap_or(i32::MAX);
    let most = 2 * (i32::from(window.width()) + i32::from(window.height()));
    let index = |at: S| {
        let cells = at.checked_div(cell_m)? + S::HALF;
        i16::try_from(cells.floor_to_i32()?).ok()
    };
    let under = |way: Vec2<S>| {
        let at = offset_m + way;
        Some(cell + Cell::new(index(at.x)?, index(at.y)?)).filter(|&at| window.get(at).is_some())
    };
    let on_way = (1..=steps.min(most)).map(|step| ahead * (step_m * S::from_i32(step)));
    // The end is not on a half cell; what is out of sight ends the look.
    on_way.map_while(under).all(is_good) && under(way_m).is_none_or(is_good)
}
