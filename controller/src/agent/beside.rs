//! What becomes of a robot whose goal is taken by another one.

use super::GuidanceInput;
use crate::geom::Vec3;
use crate::neighbor::Nearby;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// After coming no nearer for so long that one could have gone so many own radii, a robot asks whether its place is taken.
const PATIENCE: i32 = 4;
/// From then on it takes others than the one on its goal for those who have arrived beside it.
const LONG_PATIENCE: i32 = 40;
/// Until then the nearest goes first.
const BY_DISTANCE: i32 = 12;
/// Until then the smallest number goes first.
const BY_NUMBER: i32 = 24;
/// Farther off than this it does not matter yet who goes first.
const ABOUT: i32 = 8;
/// How much nearer counts as nearer, thousandths of the own radius.
const NEARER: i32 = 250;
/// So much farther off than it was, it begins anew: it was sent elsewhere, or pushed away.
const FARTHER: i32 = 8_000;
/// Places as near to the goal as that are equally near, thousandths of the own radius: what both know is rounded.
const TIE: i32 = 100;
/// Slower is standing, thousandths of the top speed.
const SLOW: i32 = 100;

/// Whether the place that a robot goes to is free. Lengths are in own radii.
///
/// - A robot that comes no nearer for [`PATIENCE`] looks at who is where its own body should be.
/// - If somebody stands there for good (parked, or out of order), it has arrived beside him, until the place is free. So
///   have those who stand around them, after [`LONG_PATIENCE`]: others may be in the way for another reason.
/// - If it is somebody on the move, perhaps to the same place or to one close by, one of them goes on: until
///   [`BY_DISTANCE`] the nearest, until [`BY_NUMBER`] the smallest number (each can be nearest to its own place). The other
///   ones leave him the room that he needs. Then all try again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Beside<S> {
    /// The least distance to the goal so far, metres; 0: it has not looked yet.
    nearest_m: S,
    /// How far it could have gone since it last came nearer, metres.
    idle_m: S,
    is_beside: bool,
}

/// What a robot does about its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Claim<S> {
    /// It goes there.
    Goes,
    /// It lets another one go there first, and keeps so far off, metres.
    Yields(S),
    /// It has arrived beside it.
    IsBeside,
}

impl<S: Scalar> Beside<S> {
    /// Of a robot on its way.
    pub(super) const NEW: Self = Self { nearest_m: S::ZERO, idle_m: S::ZERO, is_beside: false };

    /// What to do about a goal `way_m` off that does not move; to be asked in each step. O(nearby).
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
        // Whether there is no room for the own body at the goal.
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
