//! A robot makes way for a robot that it blocks in a narrow place.

use super::goal_occupancy::SLOW;
use crate::body::Body;
use crate::geom::{Vec2, Vec3};
use crate::law::Scene;
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::orca::detour;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// A robot with a smaller gap to this one is blocked, thousandths of the own radius.
const NEAR: i32 = 1_500;
/// A robot farther away no longer follows, thousandths of the own radius.
const FAR: i32 = 8_000;
/// Additional space between walls where it stops to make way, thousandths of the own radius.
const SPACE: i32 = 3_000;
/// A wall nearer than this ahead turns the way aside, thousandths of the own radius.
const AHEAD: i32 = 1_600;
/// How often it makes way for one robot, so that two arrived robots do not push each other forever.
const TIMES: u8 = 3;
/// Shortest time that a blocked robot stands before it goes back, as a distance, own radii; the
/// longest is twice that.
const STUCK: i32 = 10;
/// The same if the robot before it comes back, thousandths.
const PUSHED: i32 = 1_000;
/// How far it goes back at least, own radii.
const BACK: i32 = 4;

/// The robot moves away from a robot that comes near and cannot pass beside it, until that robot
/// leaves, arrives or can pass. Then it returns.
///
/// A robot at its goal does so at once. One on its way does so after it stood for a random time
/// behind a robot ahead, or if that one comes back: of two robots that meet, one goes back, and
/// those behind it do the same.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct MakeWay<S> {
    for_id: RobotId,
    times: u8,
    is_on: bool,
    /// How long it has stood, and the limit of that; as distances, own radii.
    stood: (S, S),
    /// How far it still goes back, own radii.
    left: S,
}

impl<S: Scalar> MakeWay<S> {
    pub(super) const NEW: Self =
        Self { for_id: RobotId::NONE, times: 0, is_on: false, stood: (S::ZERO, S::ZERO), left: S::ZERO };

    /// Whether a robot is near and cannot be passed. O(nearby x obstacles).
    pub(super) fn is_blocked(input: &Scene<'_, S>, obstacles: &[Obstacle<S>]) -> bool {
        let Scene { body, nearby, .. } = input;
        let is_near = |other: &&Nearby<S>| gap(body, other) < body.radius_m * S::from_milli(NEAR);
        nearby.iter().filter(is_near).any(|other| is_narrow(body, other, obstacles, S::ZERO))
    }

    /// The direction to move to; `None` if no robot needs the place. `to_goal`: the offset of the
    /// next waypoint, metres. O(nearby x obstacles + obstacles^2).
    pub(super) fn way(
        &mut self,
        input: &Scene<'_, S>,
        obstacles: &[Obstacle<S>],
        is_at_goal: bool,
        to_goal: Vec2<S>,
        rng: &mut Rng,
    ) -> Option<Vec3<S>> {
        let Scene { body, nearby, .. } = input;
        let radii = |thousandths: i32| body.radius_m * S::from_milli(thousandths);
        let slow = body.max_speed_mps * S::from_milli(SLOW);
        let step = (body.max_speed_mps * body.step_s).checked_div(body.radius_m).unwrap_or(S::ZERO);
        self.stand(is_at_goal || body.velocity_mps.norm() > slow, step, rng);
        let for_id = self.for_id;
        let is_met = |other: &Nearby<S>| other.id == for_id && other.offset_m.norm() < radii(FAR);
        if !nearby.iter().any(is_met) {
            *self = Self { stood: self.stood, ..Self::NEW };
        }
        let (stood, limit) = self.stood;
        let may_begin = !is_at_goal && !self.is_on && stood >= S::from_milli(PUSHED);
        let heading = match may_begin {
            true => detour(obstacles, to_goal, body.radius_m).unwrap_or(to_goal).normalized().unwrap_or_default(),
            false => Vec2::ZERO,
        };
        let ahead = |other: &Nearby<S>| other.offset_m.xy().normalized().unwrap_or_default().dot(heading);
        let needs_place = |other: &&Nearby<S>| {
            let goes_on = self.is_on && other.id == for_id;
            let unit = other.offset_m.xy().normalized().unwrap_or_default();
            let leaving_mps = other.velocity_mps.xy().dot(unit);
            let blocks = may_begin && ahead(other) > S::ZERO && (stood >= limit || leaving_mps < -slow);
            let is_spent = is_at_goal && other.id == for_id && self.times >= TIMES && !self.is_on;
            (is_at_goal || self.is_on || blocks)
                && gap(body, other) < radii(if goes_on { FAR } else { NEAR })
                && !(leaving_mps > slow || is_spent || other.mode.is_parked())
                && other.gives_way
        };
        let space = if self.is_on { radii(SPACE) } else { S::ZERO };
        let is_narrow = |other: &&Nearby<S>| is_narrow(body, other, obstacles, space);
        let mut needs = nearby.iter().filter(needs_place).filter(is_narrow);
        let other = match (is_at_goal, self.is_on) {
            (true, _) => needs.next(),
            (false, false) => needs.max_by(|one, other| ahead(one).order(ahead(other))),
            (false, true) => {
                let same = needs.find(|other| other.id == for_id);
                self.left = if same.is_some() { S::from_i32(BACK) } else { self.left - step };
                let goes_on = |other: &&Nearby<S>| self.left > S::ZERO && is_met(other) && is_narrow(other);
                nearby.iter().find(goes_on)
            }
        };
        let Some(other) = other else {
            self.is_on = false;
            return None;
        };
        if !self.is_on || other.id != for_id {
            self.times = if other.id == for_id { self.times.saturating_add(1) } else { 1 };
            self.left = S::from_i32(BACK);
        }
        (self.is_on, self.for_id) = (true, other.id);
        let away = -other.offset_m.xy().normalized()?;
        let is_open = |way: &Vec2<S>| {
            !obstacles.iter().filter_map(Obstacle::nearest_point).any(|(point, distance)| {
                let is_ahead = |unit: Vec2<S>| unit.dot(*way) > S::from_milli(700);
                distance < radii(AHEAD) && point.xy().normalized().is_some_and(is_ahead)
            })
        };
        let [left, right] = beside(obstacles, other.offset_m.xy());
        let aside = if left > right { -away.perp() } else { away.perp() };
        Some([away, aside, -aside].into_iter().find(is_open).unwrap_or(aside).extend(S::ZERO))
    }

    /// Counts how long the robot stands on its way.
    fn stand(&mut self, moves: bool, step: S, rng: &mut Rng) {
        let (stood, limit) = &mut self.stood;
        if moves || self.is_on {
            *stood = S::ZERO;
            return;
        }
        if *stood == S::ZERO {
            *limit = S::from_i32(STUCK) + S::from_ratio(rng.below(1000).cast_signed() * STUCK, 1000);
        }
        *stood += step;
    }
}

fn gap<S: Scalar>(body: &Body<S>, other: &Nearby<S>) -> S {
    other.offset_m.xy().norm() - body.radius_m - other.radius_m
}

/// Whether walls leave less than `space_m` beside the robot and the other one, metres.
#[inline(never)] // Firmware contains this once.
fn is_narrow<S: Scalar>(body: &Body<S>, other: &Nearby<S>, obstacles: &[Obstacle<S>], space_m: S) -> bool {
    let [left, right] = beside(obstacles, other.offset_m.xy());
    left + right < (body.radius_m + other.radius_m) * S::TWO + space_m
}

/// Distances to the obstacles on the left and on the right of the way to `offset`.
fn beside<S: Scalar>(obstacles: &[Obstacle<S>], offset: Vec2<S>) -> [S; 2] {
    let mut room = [S::MAX * S::HALF; 2];
    for (point, distance) in obstacles.iter().filter_map(Obstacle::nearest_point) {
        let [left, right] = &mut room;
        let side = if offset.det(point.xy()) > S::ZERO { left } else { right };
        *side = side.min(distance);
    }
    room
}
