//! Formation keeping in the plane: a place is a point that moves with the top leader.
//!
//! Proportional control with feed-forward of the leader's velocity (J. P. Desai, J. Ostrowski and
//! V. Kumar 1998). No gain exceeds the reciprocal of the time in which the body reaches its highest
//! speed ([`Drive`]), so that a body that lags by up to that time does not oscillate. Beacons are
//! delayed, but these loops close over the own body.

use crate::body::Body;
use crate::geom::Vec2;
use crate::grid::{Cell, Window};
use crate::scalar::Scalar;

/// Steps in which a body without inertia reaches its speed, since beacons are a step or older.
const STEPS: i32 = 10;
/// Speed that the top leader leaves for corrections, thousandths of the highest. More returns
/// robots to their places sooner and makes every journey longer.
const RESERVE: i32 = 100;
/// A robot rests this near the goal, thousandths of its radius, and sets off at twice that
/// distance.
const AT_REST: i32 = 250;

/// The capabilities of a body, as the law needs them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Drive<S> {
    max_speed_mps: S,
    radius_m: S,
    half_mps: S,
    step_s: S,
    /// 1/T, where T is the time to reach the highest speed, or some steps if longer, 1/s.
    rate: S,
    halt_m: S,
}

impl<S: Scalar> Drive<S> {
    /// The law for a body at the highest speed that it can have in its current place.
    #[must_use]
    pub fn new(body: &Body<S>) -> Self {
        let Body { max_speed_mps, max_acceleration_mps2, radius_m, step_s, .. } = *body;
        let by_inertia = max_speed_mps.checked_div(max_acceleration_mps2).unwrap_or(S::ZERO);
        let response_s = by_inertia.max(step_s * S::from_i32(STEPS));
        let rate = S::ONE.checked_div(response_s).unwrap_or(S::ZERO);
        let half_mps = max_speed_mps * S::HALF;
        let halt_m = radius_m + half_mps * response_s;
        Self { max_speed_mps, radius_m, half_mps, step_s, rate, halt_m }
    }

    /// The lag at which a leader stops, metres: the own radius plus half of the distance to reach
    /// full speed. A robot within half of this is in its place.
    #[must_use]
    pub const fn halt_m(&self) -> S {
        self.halt_m
    }

    /// The distance that counts as being at the goal, metres.
    #[must_use]
    pub fn tolerance_m(&self, was_there: bool) -> S {
        self.radius_m * S::from_milli(if was_there { 2 * AT_REST } else { AT_REST })
    }

    /// The velocity towards a place `way_m` away that moves at `place_mps`.
    #[must_use]
    pub fn follow(&self, way_m: Vec2<S>, place_mps: Vec2<S>) -> Vec2<S> {
        let correction_mps = scaled(way_m, self.rate).clamp_norm(self.max_speed_mps);
        (place_mps + correction_mps).clamp_norm(self.max_speed_mps)
    }

    /// Whether the leader should stop for a robot `way_m` from its place, which moves at
    /// `place_mps`.
    #[must_use]
    pub fn is_far_behind(&self, way_m: Vec2<S>, place_mps: Vec2<S>) -> bool {
        dot(way_m, place_mps) > self.max_speed_mps * self.halt_m
    }

    /// The top leader's speed, m/s. It leaves a reserve, decreases in proportion to the lag of the
    /// last robot, and lets the leader rest `left_m` ahead with half of its braking.
    #[must_use]
    pub fn leads_at(&self, lag_m: S, left_m: S) -> S {
        let reserved = self.max_speed_mps * S::from_milli(1000 - RESERVE);
        let room_m = (self.halt_m - lag_m).max(S::ZERO);
        let speed = (reserved * room_m).checked_div(self.halt_m).unwrap_or(S::ZERO);
        let half = self.half_mps;
        let near = left_m * self.rate;
        // v^2 = (V/2)^2 + 2 (V/2T) (d - VT/2), which ends where the proportional law begins.
        let before_goal = if near > half {
            ((near + near - half) * half).sqrt()
        } else if near > S::ZERO {
            near
        } else {
            S::ZERO
        };
        speed.min(before_goal)
    }

    /// The velocity nearest to `wish_mps` that a leader takes after `before_mps`. It accelerates
    /// and turns half as fast as it could, since the others learn of it late.
    #[must_use]
    pub fn gently(&self, before_mps: Vec2<S>, wish_mps: Vec2<S>) -> Vec2<S> {
        let change = wish_mps - before_mps;
        let half = self.half_mps * self.step_s * self.rate;
        let most = if dot(change, before_mps) < S::ZERO { half + half } else { half };
        before_mps + change.clamp_norm(most)
    }
}

// Not inlined: products of fixed-point numbers are long.

#[inline(never)]
fn dot<S: Scalar>(a: Vec2<S>, b: Vec2<S>) -> S {
    a.dot(b)
}

#[inline(never)]
pub(crate) fn scaled<S: Scalar>(v: Vec2<S>, s: S) -> Vec2<S> {
    v * s
}

/// How far `off_m` (actual minus desired) is behind in direction `ahead`, metres; at least 0.
#[must_use]
pub fn behind<S: Scalar>(off_m: Vec2<S>, ahead: Vec2<S>) -> S {
    (-dot(off_m, ahead)).max(S::ZERO)
}

/// Whether all visible cells under the straight path `way_m` satisfy `is_good`; for a robot
/// `offset_m` off the middle of its `cell`. Checks a point per half cell, O(width + height).
#[must_use]
#[inline(never)]
pub fn is_straight<S: Scalar>(
    window: &Window<'_>,
    (cell, offset_m, cell_m): (Cell, Vec2<S>, S),
    way_m: Vec2<S>,
    is_good: &dyn Fn(Cell) -> bool,
) -> bool {
    const PARTS: u32 = 6;
    let Some(per_m) = S::from_i32(1 << PARTS).checked_div(cell_m) else { return false };
    let parts = |length_m: Vec2<S>| {
        let parts = scaled(length_m, per_m);
        Some((parts.x.floor_to_i32()?, parts.y.floor_to_i32()?))
    };
    let (Some((x, y)), Some((dx, dy))) = (parts(offset_m), parts(way_m)) else { return false };
    let points = (dx.saturating_abs().max(dy.saturating_abs()) >> (PARTS - 1)).saturating_add(1);
    let index = |from: i32, way: i32, point: i32| {
        let moved = way.saturating_mul(point).checked_div(points).unwrap_or(0);
        (from.saturating_add(moved).saturating_add(1 << (PARTS - 1)) >> PARTS) as i16
    };
    let on_way = (1..=points).map(|point| cell + Cell::new(index(x, dx, point), index(y, dy, point)));
    on_way.take_while(|&cell| window.get(cell).is_some()).all(is_good)
}
