//! Handles a goal that another robot occupies.

use super::GuidanceInput;
use crate::geom::Vec3;
use crate::neighbor::Nearby;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Idle distance (that the robot could have covered since it last came nearer), in own radii.
const PATIENCE: i32 = 4;
/// Idle distance after which stationary robots ahead also count as arrived.
const LONG_PATIENCE: i32 = 40;
/// Idle distance up to which the nearest robot has precedence.
const BY_DISTANCE: i32 = 12;
/// Idle distance up to which the smallest id has precedence.
const BY_NUMBER: i32 = 24;
/// Precedence is not decided beyond this distance to the goal, own radii.
const ABOUT: i32 = 8;
/// Approach that counts as progress, thousandths of the own radius.
const NEARER: i32 = 250;
/// A robot this much farther away was sent elsewhere or pushed away; thousandths of the own radius.
const FARTHER: i32 = 8_000;
/// Differences of distances below this are rounding; thousandths of the own radius.
const TIE: i32 = 100;
/// Speed below which a robot stands, thousandths of the top speed.
const SLOW: i32 = 100;

/// Decides whether the place that a robot heads for is free.
///
/// - After [`PATIENCE`] without progress, it looks for robots that overlap its body at the goal.
/// - If one is parked or in fault there, this robot has arrived beside it until the place is free.
///   After [`LONG_PATIENCE`] so have robots that stand around them.
/// - If one moves there, the nearest has precedence until [`BY_DISTANCE`], the smallest id until
///   [`BY_NUMBER`] (each can be nearest to its own place). The others leave it space, then all try
///   again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct GoalOccupancy<S> {
    nearest_m: S,
    idle_m: S,
    is_beside: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Claim<S> {
    Goes,
    /// Another robot has precedence; keep this distance, metres.
    Yields(S),
    IsBeside,
}

impl<S: Scalar> GoalOccupancy<S> {
    pub(super) const NEW: Self = Self { nearest_m: S::ZERO, idle_m: S::ZERO, is_beside: false };

    /// O(nearby). Call it in each step.
    pub(super) fn claim<P>(&mut self, input: &GuidanceInput<'_, S, P>, way_m: Vec3<S>, tolerance_m: S) -> Claim<S> {
        let GuidanceInput { body, nearby, .. } = input;
        let distance = way_m.norm();
        let radii = |thousandths: i32| body.radius_m * S::from_milli(thousandths);
        let is_as_before = (self.nearest_m - radii(NEARER)..=self.nearest_m + radii(FARTHER)).contains(&distance);
        if !is_as_before || distance <= tolerance_m {
            *self = Self { nearest_m: distance, ..Self::NEW };
        }
        self.idle_m = (self.idle_m + body.max_speed_mps * body.step_s).min(radii(1000 * LONG_PATIENCE));
        let has_waited = |radii: i32| self.idle_m >= body.radius_m * S::from_i32(radii);
        if !has_waited(PATIENCE) {
            return Claim::Goes;
        }
        let covers =
            |other: &&Nearby<S>| (way_m - other.offset_m).norm() + tolerance_m < body.radius_m + other.radius_m;
        let touches = |other: &Nearby<S>| other.offset_m.norm() < body.radius_m + body.radius_m + other.radius_m;
        let is_slow = |other: &Nearby<S>| other.velocity_mps.norm() < body.max_speed_mps * S::from_milli(SLOW);
        let stands = |other: &Nearby<S>| other.mode.is_parked() || !other.mode.gives_way() && is_slow(other);
        if nearby.iter().filter(covers).any(stands) {
            let is_ahead = |other: &Nearby<S>| other.offset_m.dot(way_m) > S::ZERO && has_waited(LONG_PATIENCE);
            let is_next = |other: &Nearby<S>| stands(other) && touches(other) && (covers(&other) || is_ahead(other));
            self.is_beside = self.is_beside || nearby.iter().any(is_next);
            return if self.is_beside { Claim::IsBeside } else { Claim::Goes };
        }
        self.is_beside = false;
        if distance > radii(1000 * ABOUT) {
            return Claim::Goes;
        }
        let tie = if has_waited(BY_DISTANCE) { S::MAX } else { radii(TIE) };
        let goes_first = |other: &&Nearby<S>| {
            let behind = (way_m - other.offset_m).norm() - distance;
            behind < -tie || behind <= tie && other.id < body.id
        };
        let first = nearby.iter().filter(covers).find(goes_first);
        if has_waited(BY_NUMBER) {
            self.idle_m = S::ZERO;
        }
        first.map_or(Claim::Goes, |other| Claim::Yields(body.radius_m + other.radius_m + radii(NEARER)))
    }
}
