//! An arrived robot makes way for a robot that it blocks in a narrow place.

use super::GuidanceInput;
use super::goal_occupancy::SLOW;
use crate::geom::{Vec2, Vec3};
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
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

/// The robot moves away from a robot that comes near and cannot pass beside it, until that robot
/// leaves, arrives or can pass. Then it returns.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct MakeWay {
    for_id: RobotId,
    times: u8,
    is_on: bool,
}

impl MakeWay {
    pub(super) const NEW: Self = Self { for_id: RobotId::NONE, times: 0, is_on: false };

    /// The direction to move to; `None` if no robot needs the place. O(nearby x obstacles).
    pub(super) fn way<S: Scalar, P>(
        &mut self,
        input: &GuidanceInput<'_, S, P>,
        obstacles: &[Obstacle<S>],
        is_at_goal: bool,
    ) -> Option<Vec3<S>> {
        let GuidanceInput { body, nearby, .. } = input;
        let radii = |thousandths: i32| body.radius_m * S::from_milli(thousandths);
        let is_met = |other: &Nearby<S>| other.id == self.for_id && other.offset_m.norm() < radii(FAR);
        if !nearby.iter().any(is_met) {
            *self = Self::NEW;
        }
        let slow = body.max_speed_mps * S::from_milli(SLOW);
        let needs_place = |other: &&Nearby<S>| {
            let offset = other.offset_m.xy();
            let within = radii(if self.is_on && other.id == self.for_id { FAR } else { NEAR });
            let leaves = other.velocity_mps.xy().dot(offset.normalized().unwrap_or_default()) > slow;
            let is_near = offset.norm() < body.radius_m + other.radius_m + within;
            let is_spent = other.id == self.for_id && self.times >= TIMES && !self.is_on;
            is_near && !leaves && !is_spent && other.gives_way && !other.mode.is_parked()
        };
        let room = |other: &Nearby<S>| beside(obstacles, other.offset_m.xy());
        let space = if self.is_on { radii(SPACE) } else { S::ZERO };
        let is_narrow = |other: &&Nearby<S>| {
            let [left, right] = room(other);
            left + right < (body.radius_m + other.radius_m) * S::TWO + space
        };
        let first = nearby.iter().filter(needs_place).find(is_narrow);
        let Some(other) = first.filter(|_| is_at_goal || self.is_on) else {
            self.is_on = false;
            return None;
        };
        if !self.is_on || other.id != self.for_id {
            self.times = if other.id == self.for_id { self.times.saturating_add(1) } else { 1 };
        }
        (self.is_on, self.for_id) = (true, other.id);
        let away = -other.offset_m.xy().normalized()?;
        let is_ahead = |(point, distance): (Vec3<S>, S)| {
            distance < radii(AHEAD) && point.xy().normalized().is_some_and(|unit| unit.dot(away) > S::from_milli(700))
        };
        let is_shut = obstacles.iter().filter_map(Obstacle::nearest_point).any(is_ahead);
        let [left, right] = room(other);
        let aside = if left > right { -away.perp() } else { away.perp() };
        Some(if is_shut { aside } else { away }.extend(S::ZERO))
    }
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
