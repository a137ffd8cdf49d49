//! Decides which robot may pass a gap (a door or a passage) and where the others wait.
//!
//! ORCA alone jams in a door: all robots push, and none can leave. Each robot finds the gap from
//! the walls that it sees, and uses the positions, velocities and modes of the others.
//!
//! - **Order.** On each side robots pass by their distance to the gap (ties: the smaller number).
//!   They follow each other at [`SPACING`], measured to the gap: robots whose distances to a point
//!   differ by more than two radii cannot touch, so that their paths merge without a jam. Silent
//!   robots are obstacles: they have no place in the order.
//! - **Waiting.** The others wait at a distance that grows with their rank, beside the lane out of
//!   the gap.
//! - **Queue.** A robot that knows only its nearest neighbours cannot count a long queue. So it
//!   waits [`QUEUE`] behind a waiting robot ahead, which leaves room for robots coming out.
//! - **Wide gaps.** If two robots fit side by side, each direction keeps to its right half, without
//!   a queue; only short passages count.
//! - **Narrow gaps.** Directions take turns. The nearer robot begins, and robots of its direction
//!   follow until none is left or the turn is over ([`BATCH`], and the time of two passages). Then
//!   those in the lane still pass. If no robot waits on the opposite side, a turn does not end.
//! - **Inside the gap.** If two robots meet, the one nearer to its exit continues; the other moves
//!   back beside the lane, with the robots that follow it.
//! - **Behind the gap** robots move straight ahead, unless one that does not give way is there.
//! - **Timeout.** Robots may see different things. If the gap was empty for a random time and no
//!   robot before this one moved, turns no longer count; later ranks wait longer.
//! - **Distant gaps.** A robot that a wall separates from its goal heads for the gap that it sees.
//!
//! Thus no robot waits forever: an unused turn passes to the next robot, and if two robots take a
//! turn at once, their distances in the gap decide.

use super::gap::{Gap, Wanted, gap_on_way};
use crate::body::Body;
use crate::geom::{Vec2, Vec3};
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::orca::dimension::Situation;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Longest passage whose walls are not checked between its ends, thousandths of the own radius.
const DEEPEST: i32 = 8_000;
/// Widest gap in which the rule applies, thousandths of the own radius.
const WIDEST: i32 = 9_000;
/// Gaps farther away are ignored unless a wall blocks the straight path; thousandths of the own
/// radius. Walls must be visible this far: where visibility ends, a corridor looks like a gap.
const WITHIN: i32 = 14_000;
/// How far behind a gap the robot moves straight ahead, thousandths of the own radius.
const PAST: i32 = 2_000;
/// Clearance of two robots that pass in a gap, thousandths of the own radius.
const PLAY: i32 = 150;
/// Where robots wait or come out, thousandths of the own radius from the gap.
const YARD: i32 = 5_000;
/// A robot this near behind a waiting robot stops, thousandths of the own radius.
const QUEUE: i32 = 3_500;
/// A robot nearer than this to the waiting robot ahead moves back, thousandths of the own radius.
const APART: i32 = 3_000;
/// A direction keeps a passage while others wait for the time to travel half its length this often.
const TURN: i32 = 4;
/// The turn in a gap without depth, as a distance to travel, thousandths of the own radius: about
/// twenty robots. Less is fairer; each change costs the time in which one or two robots pass.
const BATCH: i32 = 50_000;
/// How much farther from the gap a robot is than the one that it follows, thousandths of their mean
/// radius. Above 2000; with less than 2200 a lost packet slows the queue.
const SPACING: i32 = 2_200;
/// Where the way of a robot bends into the axis of the gap, thousandths of the own radius. Nearer
/// to the gap its walls slow a robot that comes from the side.
const BEND: [i32; 2] = [1_500, 800];
/// Distances that differ by less are equal, millionths of the own radius: rounding of positions.
const TIE: i32 = 600;
/// Waiting time at an empty gap per rank, thousandths of the time to travel the own radius.
const PATIENCE_OF_RANK: i32 = 1_667;

/// The state of a robot at a gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RightOfWay<S> {
    /// Direction of the last robot seen in the gap.
    last_went_ahead: Option<bool>,
    /// How long robots have moved that way, as the distance that one could have travelled, metres.
    turn_m: S,
    /// How long the gap was empty, and the limit of that; as distances to travel, own radii.
    idle: Option<(S, S)>,
    goes: bool,
    /// It waits in a narrow gap, or follows a robot.
    takes_turns: bool,
}

struct Approach<'a, S: Scalar> {
    gap: Gap<S>,
    situation: &'a Situation<'a, Vec2<S>>,
    own: Vec2<S>,
    is_narrow: bool,
}

struct Traffic<S> {
    rank: i32,
    /// A robot in the gap moves in this robot's direction.
    ahead: bool,
    /// A robot in the gap comes towards this one, or stands there with priority.
    against: bool,
    /// The next robot ahead in the gap does not move on, and is nearer to its exit.
    bars: bool,
    /// A robot is in the gap, or nearer to it on this side and moving.
    flows: bool,
    /// A waiting robot is nearer to the gap, and directly ahead.
    is_behind: bool,
    /// The nearest waiting robot that is before this one and too close.
    crowds: Option<Vec2<S>>,
    comes_out: bool,
    opposite: bool,
    opposite_is_nearer: bool,
    /// A robot ahead moves to the gap, or on from it.
    leads: bool,
    /// A robot on the opposite side moves to the gap in its lane.
    oncoming: bool,
    oncoming_is_nearer: bool,
    /// The speed that keeps [`SPACING`] to the moving robots ahead, m/s.
    pace_mps: S,
    largest: S,
}

impl<S: Scalar> Traffic<S> {
    const fn none(largest: S) -> Self {
        Self {
            rank: 0,
            ahead: false,
            against: false,
            bars: false,
            flows: false,
            is_behind: false,
            crowds: None,
            comes_out: false,
            opposite: false,
            opposite_is_nearer: false,
            leads: false,
            oncoming: false,
            oncoming_is_nearer: false,
            pace_mps: S::MAX,
            largest,
        }
    }
}

impl<S: Scalar> RightOfWay<S> {
    pub(in crate::orca) const NEW: Self =
        Self { last_went_ahead: None, turn_m: S::ZERO, idle: None, goes: false, takes_turns: false };

    pub(in crate::orca) const fn waits(&self) -> bool {
        self.idle.is_some() && !self.goes
    }

    /// The wish of a robot whose path leads through a gap; `None` otherwise. It leaves an empty gap
    /// to others for `patience` to twice as long ([`DeadlockParams`](crate::orca::DeadlockParams)).
    pub(in crate::orca) fn wish(
        &mut self,
        situation: &Situation<'_, Vec2<S>>,
        goal: Vec2<S>,
        patience: S,
        rng: &mut Rng,
    ) -> Option<Vec2<S>> {
        let Some(approach) = Approach::new(situation, goal) else {
            *self = Self::NEW;
            return None;
        };
        self.takes_turns = approach.is_narrow;
        let traffic = approach.traffic();
        let body = situation.body;
        let step_m = body.max_speed_mps * body.step_s;
        let step = step_m.checked_div(body.radius_m).unwrap_or(S::ZERO);
        self.turn_m += step_m;
        if traffic.ahead || traffic.against {
            if self.last_went_ahead != Some(traffic.ahead) {
                self.turn_m = S::ZERO;
            }
            self.last_went_ahead = Some(traffic.ahead);
        }
        if traffic.ahead || traffic.against || traffic.flows {
            self.idle = None;
        }
        let (idle, enough) = self.idle.unwrap_or_else(|| {
            let more = S::from_ratio(rng.below(1000).cast_signed(), 1000);
            (S::ZERO, patience + patience * more)
        });
        self.idle = Some((idle + step, enough));
        let is_impatient = idle > enough + S::from_milli(PATIENCE_OF_RANK) * S::from_i32(traffic.rank);
        let has_lanes = approach.has_lanes(traffic.largest);
        self.goes = self.may_go(&approach, &traffic, has_lanes, is_impatient);
        let aim =
            if self.goes { Some(approach.way_through(has_lanes)) } else { approach.place_to_wait(&traffic, has_lanes) };
        let mut way = aim.map_or(Vec2::ZERO, |place| approach.gap.way(place));
        if self.goes && !approach.gap.is_only_way && goal.norm() < way.norm() {
            way = goal;
        }
        let most = way.norm().checked_div(situation.body.step_s);
        let mut speed = situation.wish.norm();
        if self.goes && !has_lanes && approach.own.x < S::ZERO {
            self.takes_turns &= traffic.pace_mps < speed;
            speed = speed.min(traffic.pace_mps);
        }
        let pace = most.map_or(speed, |most| most.min(speed));
        Some(way.normalized().map_or(Vec2::ZERO, |unit| unit * pace))
    }

    pub(in crate::orca) const fn takes_turns(&self) -> bool {
        self.takes_turns
    }

    fn may_go(&self, approach: &Approach<'_, S>, traffic: &Traffic<S>, has_lanes: bool, is_impatient: bool) -> bool {
        let is_inside = approach.own.x > -approach.radii(1_200) && approach.own.y.abs() < approach.gap.half
            || !has_lanes && approach.is_between_walls();
        if has_lanes {
            return traffic.rank == 0 || is_inside || is_impatient && !traffic.ahead;
        }
        if is_inside {
            return !traffic.bars;
        }
        if traffic.against || traffic.comes_out {
            return false;
        }
        if traffic.oncoming && (self.last_went_ahead == Some(false) || traffic.oncoming_is_nearer) {
            return false;
        }
        if traffic.is_behind && !traffic.leads {
            return is_impatient && !traffic.ahead;
        }
        if is_impatient || !traffic.opposite {
            return true;
        }
        let is_over = self.turn_m >= approach.gap.depth * S::from_i32(TURN) + approach.radii(BATCH);
        match self.last_went_ahead {
            Some(true) => !is_over || self.goes && approach.is_in_lane(approach.own),
            Some(false) => is_over && !traffic.ahead,
            None => !traffic.opposite_is_nearer,
        }
    }
}

impl<'a, S: Scalar> Approach<'a, S> {
    fn new(situation: &'a Situation<'a, Vec2<S>>, target: Vec2<S>) -> Option<Self> {
        let radius = situation.body.radius_m;
        let radii = |thousandths: i32| radius * S::from_milli(thousandths);
        if situation.wish == Vec2::ZERO || situation.nearby.is_empty() {
            return None;
        }
        let wanted = Wanted {
            radius_m: radius,
            least_m: radii(2_020),
            most_m: radii(WIDEST),
            deepest_m: radii(DEEPEST),
            narrow_m: radii(4_000 + PLAY),
            past_m: radii(PAST),
        };
        let gap = gap_on_way(situation.obstacles, target, &wanted)?;
        let own = gap.place(Vec2::ZERO);
        let is_near = own.norm() <= radii(WITHIN);
        let is_narrow = gap.half + gap.half < wanted.narrow_m;
        let approach = Self { gap, situation, own, is_narrow };
        (is_near || is_narrow && gap.is_only_way).then_some(approach).filter(|approach| !approach.is_barred_behind())
    }

    /// Whether the robot is behind the gap, and one that does not give way is in its lane. On its
    /// straight way out it could stop before that one forever.
    fn is_barred_behind(&self) -> bool {
        let bars = |other: &Nearby<S>| {
            let place = self.gap.place(other.offset_m.xy());
            !other.gives_way && place.x > S::ZERO && self.is_in_lane(place)
        };
        self.own.x > S::ZERO && self.situation.nearby.iter().any(bars)
    }

    fn radii(&self, thousandths: i32) -> S {
        self.situation.body.radius_m * S::from_milli(thousandths)
    }

    fn has_lanes(&self, largest: S) -> bool {
        let two = self.situation.body.radius_m + largest;
        self.gap.half + self.gap.half >= two + two + self.radii(PLAY)
    }

    /// Whether the robot is in a passage for one, such as one that leads to the gap.
    fn is_between_walls(&self) -> bool {
        let points = || self.situation.obstacles.iter().filter_map(Obstacle::nearest_point);
        let Some((wall, near)) = points().min_by(|(_, one), (_, other)| one.order(*other)) else {
            return false;
        };
        let is_opposite = |point: Vec3<S>, distance: S| point.dot(wall) < -near * distance * S::HALF;
        points().any(|(point, distance)| near + distance < self.radii(4_000) && is_opposite(point, distance))
    }

    /// Lateral position in the gap, to the right of its axis.
    fn lane(&self, has_lanes: bool) -> S {
        if has_lanes { self.gap.half * S::HALF } else { S::ZERO }
    }

    fn traffic(&self) -> Traffic<S> {
        let mut traffic = Traffic::none(self.situation.body.radius_m);
        let slow = self.situation.body.max_speed_mps * S::from_milli(100);
        let tie = self.situation.body.radius_m * S::from_micro(TIE);
        let own_distance = self.own.norm();
        let own_along = self.gap.turn(-self.gap.middle).x;
        let mut next = None;
        for other in self.situation.nearby {
            // A silent or failed robot is an obstacle, for which no robot waits.
            let is_parked = other.mode.is_parked() || !other.gives_way;
            let place = self.gap.place(other.offset_m.xy());
            let speed_ahead = self.gap.turn(other.velocity_mps.xy()).x;
            let distance = place.norm();
            let is_nearer =
                distance < own_distance - tie || distance <= own_distance + tie && other.id < self.situation.body.id;
            let is_beside_axis = place.y.abs();
            let reach = self.situation.body.radius_m + other.radius_m;
            let is_ahead = self.own.x < S::ZERO && is_nearer || place.x > S::ZERO && is_beside_axis < reach;
            if is_ahead && !is_parked && speed_ahead > -slow {
                self.follow(other, place, slow, &mut traffic);
            }
            traffic.largest = traffic.largest.max(other.radius_m);
            if place.x.abs() < other.radius_m + self.radii(500) && is_beside_axis < self.gap.half {
                traffic.ahead |= speed_ahead > slow;
                traffic.flows |= self.is_narrow && !is_parked;
                let stands_there = !is_parked && speed_ahead <= slow && place.x > S::ZERO && is_nearer;
                traffic.against |= speed_ahead < -slow || stands_there;
                let along = self.gap.turn(other.offset_m.xy() - self.gap.middle).x;
                // Lower bounds of the distances to the middle.
                let (own_rest, rest) = (-own_along, along);
                let is_first = rest < own_rest - tie || rest <= own_rest + tie && other.id < self.situation.body.id;
                // A parked robot makes way.
                let has_right = !is_parked && speed_ahead <= slow && is_first;
                if along > own_along && next.is_none() {
                    next = Some(has_right);
                }
            }
            if place.x < S::ZERO {
                // Where robots could pass it, a silent robot keeps its place in the order.
                let counts = other.gives_way || !self.is_narrow;
                let is_before = is_nearer && !other.mode.is_parked() && counts;
                let waits = is_before && speed_ahead > -slow;
                traffic.rank += i32::from(waits);
                traffic.flows |= self.is_narrow && is_before && speed_ahead.abs() > slow;
                if waits && self.is_narrow {
                    self.keep_queue(other.offset_m.xy(), &mut traffic);
                }
                // Behind a robot that has come past, the next one starts.
                traffic.comes_out |= speed_ahead < -slow
                    && distance < own_distance - self.situation.body.radius_m
                    && place.x > -self.radii(YARD)
                    && is_beside_axis < self.gap.half.max(reach);
            } else if place.x > S::ZERO && distance < self.radii(YARD) && speed_ahead < slow && !is_parked {
                traffic.opposite = true;
                traffic.opposite_is_nearer |= is_nearer;
                if speed_ahead < -slow && self.is_in_lane(place) {
                    traffic.oncoming = true;
                    traffic.oncoming_is_nearer |= is_nearer;
                }
            }
        }
        traffic.bars = next.unwrap_or_default();
        traffic
    }

    /// Follows a moving robot that is ahead at this place.
    fn follow(&self, other: &Nearby<S>, place: Vec2<S>, slow: S, traffic: &mut Traffic<S>) {
        let Body { radius_m, max_speed_mps, .. } = *self.situation.body;
        let velocity = self.gap.turn(other.velocity_mps.xy());
        let past_entry = self.gap.turn(other.offset_m.xy() - self.gap.middle).x + self.gap.depth;
        let (rest, speed) = match place.normalized() {
            Some(unit) if place.x < S::ZERO => (place.norm(), -velocity.dot(unit)),
            _ => (-past_entry, velocity.x),
        };
        // A follower of a stationary robot would wait as long as it: the queue's rules apply.
        if speed > slow {
            traffic.leads = true;
            let room = self.own.norm() - rest - (radius_m + other.radius_m) * S::from_milli(SPACING) * S::HALF;
            // Makes up for a difference in the time to travel one radius.
            let more = (room * max_speed_mps).checked_div(radius_m).unwrap_or(S::ZERO);
            traffic.pace_mps = traffic.pace_mps.min((speed + more).max(S::ZERO));
        }
    }

    fn keep_queue(&self, offset: Vec2<S>, traffic: &mut Traffic<S>) {
        let distance = offset.norm();
        if distance >= self.radii(QUEUE) {
            return;
        }
        traffic.is_behind |= offset.dot(self.gap.middle) > S::ZERO;
        if distance < self.radii(APART) && traffic.crowds.is_none() {
            traffic.crowds = Some(offset);
        }
    }

    fn way_through(&self, has_lanes: bool) -> Vec2<S> {
        let lane = self.lane(has_lanes);
        let play = self.gap.half - self.situation.body.radius_m;
        if self.own.x > S::ZERO {
            Vec2::new(self.radii(4_000), lane + self.radii(300))
        } else if self.own.x < S::ZERO && (self.own.y - lane).abs() > play.max(self.radii(300)) {
            let [far, near] = BEND.map(|bend| -self.radii(bend));
            Vec2::new(if has_lanes { near } else { self.own.x.max(far).min(near) }, lane)
        } else {
            Vec2::new(self.radii(2_000), lane)
        }
    }

    /// Whether a place is where robots go in and come out.
    fn is_in_lane(&self, place: Vec2<S>) -> bool {
        let radius = self.situation.body.radius_m;
        place.y.abs() < self.gap.half.max(radius) + radius && place.x.abs() < self.radii(YARD)
    }

    fn place_to_wait(&self, traffic: &Traffic<S>, has_lanes: bool) -> Option<Vec2<S>> {
        let radius = self.situation.body.radius_m;
        let own = self.own;
        let side = if has_lanes || own.y >= S::ZERO { S::ONE } else { -S::ONE };
        let edge = self.gap.half.max(radius);
        let spot = Vec2::new(-self.radii(1_500), (edge + self.radii(1_200)) * side);
        if self.is_in_lane(own) && !has_lanes {
            return Some(if own.x > -self.radii(1_300) {
                Vec2::new(-self.radii(2_500), spot.y)
            } else {
                Vec2::new(own.x, spot.y + radius * S::HALF * side)
            });
        }
        if let Some(offset) = traffic.crowds {
            let unit = offset.normalized().unwrap_or_default();
            return Some(self.gap.place(offset - unit * self.radii(APART)));
        }
        // A quarter of this disc has space for as many robots as the rank.
        let room = radius * (S::from_milli(6_500) * S::from_i32(traffic.rank)).sqrt();
        let moves_there = !traffic.is_behind && (spot - own).norm() >= room;
        moves_there.then_some(spot)
    }
}

#[cfg(test)]
mod tests;
