//! Handles a goal that another robot occupies.

use crate::geom::Vec3;
use crate::law::Scene;
use crate::neighbor::Nearby;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Idle distance (that the robot could have covered since it last came nearer), in own radii, after
/// which other robots at the goal may go first.
const FIRST: i32 = 1;
/// Idle distance after which the robot may have arrived beside its goal.
const PATIENCE: i32 = 4;
/// The same if the robots ahead leave space between them.
const LONG_PATIENCE: i32 = 40;
/// Idle distance up to which the nearest robot has precedence.
const BY_DISTANCE: i32 = 12;
/// Idle distance up to which the smallest id has precedence.
const BY_NUMBER: i32 = 24;
/// Precedence is not decided beyond this distance to the goal, own radii.
const ABOUT: i32 = 8;
/// Robots nearer to the goal are next to it, thousandths of the own radius.
const OUTSIDE: i32 = 3_000;
/// Approach that counts as progress, thousandths of the own radius.
const NEARER: i32 = 250;
/// A robot this much farther away was sent elsewhere or pushed away; thousandths of the own radius.
const FARTHER: i32 = 8_000;
/// Differences of distances below this are rounding; thousandths of the own radius.
const TIE: i32 = 100;
/// Speed below which a robot stands, thousandths of the top speed.
pub(crate) const SLOW: i32 = 100;

/// Decides whether the place that a robot heads for is free.
///
/// - After [`FIRST`] without progress, it looks for robots that overlap its body at the goal.
/// - If one is parked or in fault there, this robot has arrived beside it until the place is free,
///   after [`PATIENCE`]. So have robots around them, if the space up to the goal is full or after
///   [`LONG_PATIENCE`].
/// - If one moves there, robots around a full space wait. Of those next to the goal, the nearest
///   has precedence until [`BY_DISTANCE`], the smallest id until [`BY_NUMBER`] (each can be nearest
///   to its own place). The others leave it space, then all try again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct GoalOccupancy<S> {
    nearest_m: S,
    idle_m: S,
    is_beside: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Claim<S> {
    Goes,
    /// Another robot has precedence; keep this distance, metres.
    Yields(S),
    IsBeside,
}

impl<S: Scalar> GoalOccupancy<S> {
    pub(crate) const NEW: Self = Self { nearest_m: S::ZERO, idle_m: S::ZERO, is_beside: false };

    /// O(nearby). Call it in each step.
    pub(crate) fn claim(&mut self, input: &Scene<'_, S>, way_m: Vec3<S>, tolerance_m: S) -> Claim<S> {
        let Scene { body, nearby, .. } = input;
        let distance = way_m.norm();
        let radii = |thousandths: i32| body.radius_m * S::from_milli(thousandths);
        let is_as_before = (self.nearest_m - radii(NEARER)..=self.nearest_m + radii(FARTHER)).contains(&distance);
        if !is_as_before || distance <= tolerance_m {
            *self = Self { nearest_m: distance, ..Self::NEW };
        }
        self.idle_m = (self.idle_m + body.max_speed_mps * body.step_s).min(radii(1000 * LONG_PATIENCE));
        let has_waited = |radii: i32| self.idle_m >= body.radius_m * S::from_i32(radii);
        if !has_waited(FIRST) {
            return Claim::Goes;
        }
        let covers =
            |other: &&Nearby<S>| (way_m - other.offset_m).norm() + tolerance_m < body.radius_m + other.radius_m;
        let touches = |other: &Nearby<S>| other.offset_m.norm() < body.radius_m + body.radius_m + other.radius_m;
        let is_slow = |other: &Nearby<S>| other.velocity_mps.norm() < body.max_speed_mps * S::from_milli(SLOW);
        let stands = |other: &Nearby<S>| other.mode.is_parked() || !other.mode.gives_way() && is_slow(other);
        let is_nearer = |other: &&Nearby<S>| (way_m - other.offset_m).norm() < distance;
        // Half of the disc around the goal, up to the own body, is occupied.
        let is_full = |count: usize| {
            let count = i32::try_from(count).unwrap_or(i32::MAX >> 8);
            distance <= body.radius_m * (S::ONE + S::from_i32(count + count).sqrt())
        };
        if nearby.iter().filter(covers).any(stands) {
            let is_blocked =
                has_waited(LONG_PATIENCE) || is_full(nearby.iter().filter(is_nearer).filter(|o| stands(o)).count());
            let is_ahead = |other: &Nearby<S>| other.offset_m.dot(way_m) > S::ZERO && is_blocked;
            let is_next = |other: &Nearby<S>| stands(other) && touches(other) && (covers(&other) || is_ahead(other));
            self.is_beside = self.is_beside || has_waited(PATIENCE) && nearby.iter().any(is_next);
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
            self.idle_m = radii(1000 * (FIRST - PATIENCE));
        }
        if let Some(other) = first {
            return Claim::Yields(body.radius_m + other.radius_m + radii(NEARER));
        }
        let is_taken = distance > radii(OUTSIDE) && nearby.iter().any(|other| covers(&other));
        match is_taken && is_full(nearby.iter().filter(is_nearer).count()) {
            true => Claim::Yields(S::ZERO),
            false => Claim::Goes,
        }
    }
}
