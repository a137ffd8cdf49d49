//! Formation keeping in the plane: a place is a point that moves with the top leader, and robots
//! follow it.
//!
//! The law is proportional control with feed-forward of the leader's velocity, as in standard
//! leader-follower control (J. P. Desai, J. Ostrowski and V. Kumar 1998). The top leader is no
//! faster than the slowest robot follows. All gains follow from one time, in which the body reaches
//! its highest speed ([`Drive`]). No gain exceeds the reciprocal of that time, so that a body that
//! lags behind its commands by up to that time reaches its place without oscillating. States of
//! other robots are delayed by the radio, but these loops close over the own body.

use crate::body::Body;
use crate::geom::Vec2;
use crate::grid::{Cell, Window};
use crate::scalar::Scalar;

/// Steps that a body without inertia is assumed to need to reach its speed, since states of other
/// robots are a step or more old.
const STEPS: i32 = 10;
/// Speed that the top leader leaves to the others for corrections, thousandths of the highest
/// speed. A larger value returns them to their places sooner and makes every journey longer by as
/// much.
const RESERVE: i32 = 100;
/// Distance from the goal within which a robot comes to rest, thousandths of its radius; beyond
/// twice this distance it sets off again.
const AT_REST: i32 = 250;

/// The capabilities of a body, as the law needs them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Drive<S> {
    max_speed_mps: S,
    radius_m: S,
    /// Half of the highest speed, used by the gentle half of the law.
    half_mps: S,
    step_s: S,
    /// 1/T, where T is the time to reach the highest speed, or some steps if that is longer, 1/s.
    rate: S,
    halt_m: S,
}

impl<S: Scalar> Drive<S> {
    /// For a body at the highest speed that it can have in its present place.
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

    /// The lag at which a leader stops, metres: the own radius plus half of the distance in which a
    /// body reaches its speed. A robot within half of this value counts as being in its place.
    #[must_use]
    pub const fn halt_m(&self) -> S {
        self.halt_m
    }

    /// The distance that counts as being at the goal, metres, depending on whether the robot was
    /// there before.
    #[must_use]
    pub fn tolerance_m(&self, was_there: bool) -> S {
        self.radius_m * S::from_milli(if was_there { 2 * AT_REST } else { AT_REST })
    }

    /// The velocity towards a place `way_m` away that moves at `place_mps`. At most the highest
    /// speed.
    #[must_use]
    pub fn follow(&self, way_m: Vec2<S>, place_mps: Vec2<S>) -> Vec2<S> {
        let correction_mps = scaled(way_m, self.rate).clamp_norm(self.max_speed_mps);
        (place_mps + correction_mps).clamp_norm(self.max_speed_mps)
    }

    /// Whether a robot is so far behind a place `way_m` away that moves at `place_mps` that its
    /// leader should stop.
    #[must_use]
    pub fn is_far_behind(&self, way_m: Vec2<S>, place_mps: Vec2<S>) -> bool {
        dot(way_m, place_mps) > self.max_speed_mps * self.halt_m
    }

    /// The top leader's speed, m/s. It leaves a reserve for the others, decreases in proportion to
    /// the lag of the last robot, and lets the leader come to rest `left_m` ahead with half of its
    /// braking.
    #[must_use]
    pub fn leads_at(&self, lag_m: S, left_m: S) -> S {
        let reserved = self.max_speed_mps * S::from_milli(1000 - RESERVE);
        let room_m = (self.halt_m - lag_m).max(S::ZERO);
        let speed = (reserved * room_m).checked_div(self.halt_m).unwrap_or(S::ZERO);
        let half = self.half_mps;
        let near = left_m * self.rate;
        // v^2 = (V/2)^2 + 2 (V/2T) (d - VT/2), as a slope that ends where the proportional law
        // begins. An invalid distance counts as 0.
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
    /// and turns half as fast as it could, and brakes as fast, since the others learn of it late.
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

/// How far `off_m` (actual minus desired) is behind for a formation that moves in direction
/// `ahead`, metres. A robot ahead or aside loses nothing if the formation continues.
#[must_use]
pub fn behind<S: Scalar>(off_m: Vec2<S>, ahead: Vec2<S>) -> S {
    (-dot(off_m, ahead)).max(S::ZERO)
}

/// Whether all cells under the straight path `way_m` satisfy `is_good`, as far as the window shows
/// them; for a robot `offset_m` off the middle of its `cell`. Checks one point per half cell,
/// O(width + height) points.
#[must_use]
#[inline(never)]
pub fn is_straight<S: Scalar>(
    window: &Window<'_>,
    (cell, offset_m, cell_m): (Cell, Vec2<S>, S),
    way_m: Vec2<S>,
    is_good: &dyn Fn(Cell) -> bool,
) -> bool {
    /// A cell has 2^6 parts, half of it 2^5.
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
