//! Who goes through a gap, and who waits where.
//!
//! ORCA alone jams in a door: everybody pushes, nobody can leave. This is the rule of robots whose way leads through
//! the same gap (a door or a passage of any length), found by each for itself from the walls that it sees
//! and the places, velocities and modes of others. Lengths are in own radii.
//!
//! - Of the robots on one side the nearest to the gap is first, equal ones by number; only the first goes. The others
//!   stand at a distance that grows with their rank, beside the lane that leads out of the gap, so that who comes out
//!   gets away and nobody pushes. Who is parked is no part of it.
//! - Nobody can count a long queue, since a robot knows its nearest neighbours only. So it is told on from each to the
//!   next by where he stands: who has somebody before him that waits, waits behind him, [`QUEUE`] off, and makes room
//!   for him. Such a queue is loose enough for those who come out, however many it has.
//! - Where two robots fit side by side, each direction keeps to its right half of the gap, and both flow: nobody waits
//!   in a queue there, and only short passages count.
//! - Where only one fits, directions take turns, one robot each (in a long passage as many as come in the time in which
//!   one goes through twice); after one has come out of the gap, it is the
//!   turn of the first on that side. At the beginning the nearer one goes, of equal ones the smaller number. With
//!   nobody waiting opposite, robots follow each other.
//! - Who is in the gap goes on. If two meet in it, the one nearer to its way out goes on, and the other goes back
//!   beside the lane, with those who follow it.
//! - What robots see may differ, and some wait for another gap: when nobody has been in the gap, or has moved before
//!   this robot, for a while (drawn by each robot for itself, longer for later ranks), whose turn it is no longer
//!   counts.
//! - A robot that a wall bars from its goal goes to the gap from as far as it sees it.
//!
//! So nobody waits for ever: a turn that is not taken passes on, and two that are taken at once are told apart in
//! the gap by distance.

use super::gap::{Gap, Wanted, gap_on_way};
use crate::geom::Vec2;
use crate::orca::dimension::Situation;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Longest passage whose walls are not looked at between its ends, thousandths of the own radius.
const DEEPEST: i32 = 8_000;
/// Widest gap in which the rule holds; wider ones are open land.
const WIDEST: i32 = 9_000;
/// Gaps farther off do not matter yet, unless a wall bars the straight way. Walls must be seen at least as far, since
/// where sight ends, two walls of a corridor look like a gap.
const WITHIN: i32 = 14_000;
/// How far behind a gap one still goes straight on.
const PAST: i32 = 2_000;
/// Play that two robots need to pass each other in a gap, beyond their diameters.
const PLAY: i32 = 150;
/// How far from the gap one waits or comes out.
const YARD: i32 = 5_000;
/// Who stands so near behind another one that waits goes no farther.
const QUEUE: i32 = 3_500;
/// Nearer than this to one that waits before him, he makes room.
const APART: i32 = 3_000;
/// For how long a direction keeps a passage while others wait opposite: while one could go so many times half its length.
const TURN: i32 = 4;
/// Distances that differ by less are equal: the rounding of what robots know is the same for both but for this,
/// millionths of the own radius.
const TIE: i32 = 600;
/// For how long more each rank leaves an empty gap alone, thousandths of the time in which one goes the own radius.
const PATIENCE_OF_RANK: i32 = 1_667;

/// What a robot remembers of the gap before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RightOfWay<S> {
    /// Which way the last robot seen in the gap went: whether as this one wants to.
    last_went_ahead: Option<bool>,
    /// For how long robots have gone that way since the direction changed: how far one could have gone, metres.
    turn_m: S,
    /// For how long nobody has been seen in it, and for how long this is not remarkable: how many own radii one could
    /// have gone.
    idle: Option<(S, S)>,
    /// Whether it was allowed to go in the last step.
    goes: bool,
    /// Whether it is at a gap for one.
    is_narrow: bool,
}

/// The gap, the robot and the others, seen from the gap.
struct Approach<'a, S: Scalar> {
    gap: Gap<S>,
    situation: &'a Situation<'a, Vec2<S>>,
    /// The own place: see [`Gap::place`].
    own: Vec2<S>,
    /// Two robots of the own size do not fit side by side.
    is_narrow: bool,
}

/// What others do at the gap.
struct Traffic<S> {
    /// How many on this side are nearer to the gap.
    rank: i32,
    /// Somebody in the gap goes ahead.
    ahead: bool,
    /// Somebody in the gap comes against, or stands there with more right to it.
    against: bool,
    /// The next one ahead in the gap does not go ahead, and is nearer to its way out.
    bars: bool,
    /// Somebody is in the gap, or nearer to it on this side and moves.
    flows: bool,
    /// Somebody who waits is nearer to the gap, and right ahead.
    is_behind: bool,
    /// Where the nearest is of those who wait before this one and are too near.
    crowds: Option<Vec2<S>>,
    /// Somebody is on the way out of the gap, on this side.
    comes_out: bool,
    /// Somebody may be waiting opposite.
    opposite: bool,
    /// One of those comes first by distance or number.
    opposite_is_nearer: bool,
    /// Radius of the largest robot.
    largest: S,
}

impl<S: Scalar> RightOfWay<S> {
    /// Of a robot that is at no gap.
    pub(in crate::orca) const NEW: Self =
        Self { last_went_ahead: None, turn_m: S::ZERO, idle: None, goes: false, is_narrow: false };

    /// Whether it waits at a gap.
    pub(in crate::orca) const fn waits(&self) -> bool {
        self.idle.is_some() && !self.goes
    }

    /// The wish of a robot whose way leads through a gap, with others near by; `None` when it does not. An empty
    /// gap is left to others for `patience` to twice as long: see [`DeadlockParams`](crate::orca::DeadlockParams).
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
        self.is_narrow = approach.is_narrow;
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
        let way = aim.map_or(Vec2::ZERO, |place| approach.gap.way(place));
        let most = way.norm().checked_div(situation.body.step_s);
        let speed = situation.wish.norm();
        let pace = most.map_or(speed, |most| most.min(speed));
        Some(way.normalized().map_or(Vec2::ZERO, |unit| unit * pace))
    }

    /// Whether it was at a gap for one in the last step.
    pub(in crate::orca) const fn takes_turns(&self) -> bool {
        self.is_narrow
    }

    fn may_go(&self, approach: &Approach<'_, S>, traffic: &Traffic<S>, has_lanes: bool, is_impatient: bool) -> bool {
        let is_inside = approach.own.x > -approach.radii(1_200) && approach.own.y.abs() < approach.gap.half;
        if has_lanes {
            return traffic.rank == 0 || is_inside || is_impatient && !traffic.ahead;
        }
        if is_inside {
            return !traffic.bars;
        }
        if traffic.against || traffic.comes_out {
            return false;
        }
        if traffic.rank > 0 {
            return is_impatient && !traffic.ahead;
        }
        if is_impatient || !traffic.opposite {
            return true;
        }
        match self.last_went_ahead {
            // The turn is theirs, unless it was given to this robot before it saw that, or the passage is worth more.
            Some(true) if traffic.ahead => self.turn_m < approach.gap.depth * S::from_i32(TURN),
            Some(true) => self.goes,
            Some(false) => !traffic.ahead,
            None => !traffic.opposite_is_nearer,
        }
    }
}

impl<'a, S: Scalar> Approach<'a, S> {
    fn new(situation: &'a Situation<'a, Vec2<S>>, target: Vec2<S>) -> Option<Self> {
        let radius = situation.body.radius_m;
        let radii = |thousandths: i32| radius * S::from_milli(thousandths);
        if situation.wish == Vec2::ZERO {
            return None;
        }
        let wanted = Wanted {
            least_m: radii(2_020),
            most_m: radii(WIDEST),
            deepest_m: radii(DEEPEST),
            narrow_m: radii(4_000 + PLAY),
            past_m: radii(PAST),
        };
        let gap = gap_on_way(situation.obstacles, target, &wanted)?;
        let own = gap.place(Vec2::ZERO);
        let is_near = own.norm() <= radii(WITHIN) && !situation.nearby.is_empty();
        let is_narrow = gap.half + gap.half < wanted.narrow_m;
        (is_near || is_narrow && gap.is_only_way).then_some(Self { gap, situation, own, is_narrow })
    }

    /// A length in thousandths of the own radius.
    fn radii(&self, thousandths: i32) -> S {
        self.situation.body.radius_m * S::from_milli(thousandths)
    }

    /// Whether robots can pass each other in the gap.
    fn has_lanes(&self, largest: S) -> bool {
        let two = self.situation.body.radius_m + largest;
        self.gap.half + self.gap.half >= two + two + self.radii(PLAY)
    }

    /// How far to the right of the gap's axis to go through it.
    fn lane(&self, has_lanes: bool) -> S {
        if has_lanes { self.gap.half * S::HALF } else { S::ZERO }
    }

    fn traffic(&self) -> Traffic<S> {
        let mut traffic = Traffic {
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
            largest: self.situation.body.radius_m,
        };
        // Slower than this is standing.
        let slow = self.situation.body.max_speed_mps * S::from_milli(100);
        let tie = self.situation.body.radius_m * S::from_micro(TIE);
        let own_distance = self.own.norm();
        let own_along = self.gap.turn(-self.gap.middle).x;
        // The nearest one ahead in the gap.
        let mut next = None;
        for other in self.situation.nearby {
            let is_parked = other.mode.is_parked();
            let place = self.gap.place(other.offset_m.xy());
            let speed_ahead = self.gap.turn(other.velocity_mps.xy()).x;
            let distance = place.norm();
            let is_nearer =
                distance < own_distance - tie || distance <= own_distance + tie && other.id < self.situation.body.id;
            let is_beside_axis = place.y.abs();
            let reach = self.situation.body.radius_m + other.radius_m;
            traffic.largest = traffic.largest.max(other.radius_m);
            if place.x.abs() < other.radius_m + self.radii(500) && is_beside_axis < self.gap.half {
                traffic.ahead |= speed_ahead > slow;
                traffic.flows |= self.is_narrow && !is_parked;
                let stands_there = speed_ahead <= slow && place.x > S::ZERO && is_nearer;
                traffic.against |= speed_ahead < -slow || stands_there;
                let along = self.gap.turn(other.offset_m.xy() - self.gap.middle).x;
                // How far each of them has to the middle, or less.
                let (own_rest, rest) = (-own_along, along);
                let is_first = rest < own_rest - tie || rest <= own_rest + tie && other.id < self.situation.body.id;
                let has_right = speed_ahead <= slow && is_first;
                if along > own_along && next.is_none() {
                    next = Some(has_right);
                }
            }
            if place.x < S::ZERO {
                let is_before = is_nearer && !is_parked;
                let waits = is_before && speed_ahead > -slow;
                traffic.rank += i32::from(waits);
                traffic.flows |= self.is_narrow && is_before && speed_ahead.abs() > slow;
                if waits && self.is_narrow {
                    self.keep_queue(other.offset_m.xy(), &mut traffic);
                }
                traffic.comes_out |=
                    speed_ahead < -slow && place.x > -self.radii(YARD) && is_beside_axis < self.gap.half.max(reach);
            } else if place.x > S::ZERO && distance < self.radii(YARD) && speed_ahead < slow && !is_parked {
                traffic.opposite = true;
                traffic.opposite_is_nearer |= is_nearer;
            }
        }
        traffic.bars = next.unwrap_or_default();
        traffic
    }

    /// Takes note of one that waits before this robot.
    fn keep_queue(&self, offset: Vec2<S>, traffic: &mut Traffic<S>) {
        let distance = offset.norm();
        if distance >= self.radii(QUEUE) {
            return;
        }
        traffic.is_behind |= offset.dot(self.gap.middle) > S::ZERO;
        // The nearest comes first.
        if distance < self.radii(APART) && traffic.crowds.is_none() {
            traffic.crowds = Some(offset);
        }
    }

    /// Where to go next on the way through.
    fn way_through(&self, has_lanes: bool) -> Vec2<S> {
        let lane = self.lane(has_lanes);
        let play = self.gap.half - self.situation.body.radius_m;
        if self.own.x > S::ZERO {
            // Out, and to the right.
            Vec2::new(self.radii(4_000), lane + self.radii(300))
        } else if self.own.x < S::ZERO && (self.own.y - lane).abs() > play.max(self.radii(300)) {
            // Into the lane first.
            Vec2::new(-self.radii(800), lane)
        } else {
            Vec2::new(self.radii(2_000), lane)
        }
    }

    /// Where to wait; `None`: here.
    fn place_to_wait(&self, traffic: &Traffic<S>, has_lanes: bool) -> Option<Vec2<S>> {
        let radius = self.situation.body.radius_m;
        let own = self.own;
        let side = if has_lanes || own.y >= S::ZERO { S::ONE } else { -S::ONE };
        let edge = self.gap.half.max(radius);
        let spot = Vec2::new(-self.radii(1_500), (edge + self.radii(1_200)) * side);
        let is_in_lane = own.y.abs() < edge + radius && own.x > -self.radii(YARD);
        if is_in_lane && !has_lanes {
            return Some(if own.x > -self.radii(1_300) {
                // Back out of the gap.
                Vec2::new(-self.radii(2_500), spot.y)
            } else {
                Vec2::new(own.x, spot.y + radius * S::HALF * side)
            });
        }
        if let Some(offset) = traffic.crowds {
            let unit = offset.normalized().unwrap_or_default();
            return Some(self.gap.place(offset - unit * self.radii(APART)));
        }
        // As many robots as the rank says find room in a quarter of this disc.
        let room = radius * (S::from_milli(6_500) * S::from_i32(traffic.rank)).sqrt();
        let goes_on = !traffic.is_behind && (spot - own).norm() >= room;
        goes_on.then_some(spot)
    }
}
