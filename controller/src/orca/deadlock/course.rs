//! The way around obstacles: a string from the robot to its goal, pulled taut.
//!
//! The string bends around discs: the ends of walls, and balls, each grown by the robot. So a
//! polygon of many sides and a ball are the same kind of thing, and a gap that the robot does not
//! fit through is closed, because its discs overlap. The string starts as a straight line. Where
//! an obstacle is in its way, it gets a bend around that obstacle; a bend that it no longer needs
//! is removed. It passes all obstacles that leave no room between them on one side.

use super::detour::{crosses, distance};
use crate::geom::Vec2;
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Distance of the string from the obstacles that it bends around, thousandths of the radius.
const ROOM: i32 = 1_030;
/// An obstacle nearer than this is in its way, thousandths of [`ROOM`]. Both give one radius.
const FREE: i32 = 971;
/// How much nearer than the robot or its goal a bend is, thousandths of [`ROOM`].
const NEARER: i32 = 15;
/// Most bends of a string.
const BENDS: usize = 40;
/// A way shorter than this share of the present one changes the side, thousandths.
const SHORTER: i32 = 500;
/// How much less both limits for a change are after each change, thousandths.
const DOUBT: i32 = 25;
/// Two directions are nearly opposite below minus this cosine, thousandths.
const REVERSED: i32 = 900;
/// Obstacles whose connections are known.
const GROUPED: usize = 128;

/// The way that the robot takes around what is before it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Course<S> {
    /// Its direction in the last step; zero: the straight way was free.
    heading: Vec2<S>,
    changes: u8,
    /// The shortest way seen since the straight one was free, metres. The robot turns for a
    /// shorter one, so that one that does not see all of an obstacle does not go back and forth
    /// before it; also for one that is far shorter than the present way.
    least_m: S,
}

impl<S: Scalar> Course<S> {
    pub(in crate::orca) const NEW: Self = Self { heading: Vec2::ZERO, changes: 0, least_m: S::MAX };

    /// The direction of the way to `goal` if the straight one is not free. O(obstacles^2).
    pub(super) fn ahead(&mut self, obstacles: &[Obstacle<S>], goal: Vec2<S>, radius_m: S) -> Option<Vec2<S>> {
        let mut field = Field { obstacles, goal, room: radius_m * S::from_milli(ROOM), groups: Vec::new() };
        if field.is_free() {
            *self = Self::NEW;
            return None;
        }
        field.group();
        let [left, right] = [true, false].map(|on_left| field.best(on_left));
        let like = |way: &Option<(S, Vec2<S>)>| way.map_or(-S::TWO, |(_, ahead)| ahead.dot(self.heading));
        let (kept, other) = if like(&left) >= like(&right) { (left, right) } else { (right, left) };
        let (kept_m, heading) = kept.or(other)?;
        let (other_m, turned) = other.unwrap_or((S::MAX, heading));
        // The more often it changes, the less it believes a shorter way.
        let doubt = S::from_milli(i32::from(self.changes) * DOUBT);
        let is_new = self.heading == Vec2::ZERO;
        let is_shorter =
            other_m < self.least_m * (S::ONE - doubt) || other_m < kept_m * (S::from_milli(SHORTER) - doubt);
        if other_m < kept_m && (is_new || is_shorter) {
            let changes = self.changes.saturating_add(u8::from(!is_new));
            *self = Self { heading: turned, changes, least_m: other_m };
        } else {
            *self = Self { heading, least_m: self.least_m.min(kept_m), ..*self };
        }
        Some(self.heading)
    }
}

/// Something round that the string passes.
#[derive(Clone, Copy)]
struct Bend<S> {
    /// Its index; `None` for the robot and its goal.
    obstacle: Option<u16>,
    center: Vec2<S>,
    /// Its radius; negative if it is on the right of the string.
    radius: S,
}

/// A straight part of the string.
struct Leg<S> {
    from: Vec2<S>,
    unit: Vec2<S>,
    length: S,
}

impl<S: Scalar> Leg<S> {
    /// The common tangent; `None` if one disc leaves no room for it.
    fn between(one: &Bend<S>, other: &Bend<S>) -> Option<Self> {
        let (unit, distance) = (other.center - one.center).unit_and_norm();
        let unit = unit?;
        let sin = (other.radius - one.radius).checked_div(distance)?;
        let rest = S::ONE - sin * sin;
        if rest <= S::ZERO {
            return None;
        }
        let cos = rest.sqrt();
        let unit = unit * cos - unit.perp() * sin;
        Some(Self { from: one.center - unit.perp() * one.radius, unit, length: distance * cos })
    }

    fn to(&self) -> Vec2<S> {
        self.from + self.unit * self.length
    }

    /// Where the obstacle comes nearer than `room`, from the start of this leg.
    fn meets(&self, obstacle: &Obstacle<S>, room: S) -> Option<S> {
        let place = |at: Vec2<S>| Vec2::new((at - self.from).dot(self.unit), self.unit.det(at - self.from));
        let beyond = |at: Vec2<S>| Vec2::new((-at.x).max(at.x - self.length).max(S::ZERO), at.y).norm();
        match *obstacle {
            Obstacle::Wall(ends) => {
                let [a, b] = ends.map(place);
                let is_beside = a.y.min(b.y) >= room || a.y.max(b.y) <= -room;
                if is_beside || a.x.max(b.x) <= -room || a.x.min(b.x) >= self.length + room {
                    return None;
                }
                if (a.y > S::ZERO) != (b.y > S::ZERO) {
                    let share = a.y.checked_div(a.y - b.y).unwrap_or(S::ZERO);
                    let x = a.x + (b.x - a.x) * share;
                    if x >= S::ZERO && x <= self.length {
                        return Some(x);
                    }
                }
                let wall = Obstacle::Wall([a, b]);
                let is_near = |x: S| distance(&wall, Vec2::new(x, S::ZERO)).is_some_and(|distance| distance < room);
                let ends = [a, b].into_iter().filter(|end| beyond(*end) < room).map(|end| end.x);
                let own = [S::ZERO, self.length].into_iter().filter(|x| is_near(*x));
                ends.chain(own).min_by(|one, other| one.order(*other))
            }
            Obstacle::Ball { center_m, radius_m } => {
                let at = place(center_m.xy());
                (beyond(at) < radius_m + room).then_some(at.x - radius_m)
            }
            Obstacle::Plane { .. } => None,
        }
    }
}

struct Field<'a, S> {
    obstacles: &'a [Obstacle<S>],
    goal: Vec2<S>,
    room: S,
    /// The first obstacle that an obstacle is connected to, through gaps that are closed.
    groups: Vec<u8, GROUPED>,
}

impl<S: Scalar> Field<'_, S> {
    /// O(obstacles^2).
    fn group(&mut self) {
        for index in 0..self.obstacles.len().min(GROUPED) {
            let Ok(mut own) = u8::try_from(index) else {
                break;
            };
            if self.groups.push(own).is_err() {
                break;
            }
            for other in 0..index {
                let Some(known) = self.groups.get(other).copied() else {
                    break;
                };
                if known != own && self.is_closed(index, other) {
                    let (low, high) = (known.min(own), known.max(own));
                    self.groups.iter_mut().filter(|group| **group == high).for_each(|group| *group = low);
                    own = low;
                }
            }
        }
    }

    fn is_grouped(&self, one: usize, other: usize) -> bool {
        one == other || self.groups.get(one).is_some_and(|group| self.groups.get(other) == Some(group))
    }

    fn ends(&self) -> [Bend<S>; 2] {
        [Vec2::ZERO, self.goal].map(|center| Bend { obstacle: None, center, radius: S::ZERO })
    }

    fn is_free(&self) -> bool {
        let [start, goal] = self.ends();
        Leg::between(&start, &goal).is_none_or(|leg| self.first_on(&leg).is_none())
    }

    /// Where the leg comes too near to an obstacle.
    fn meets(&self, leg: &Leg<S>, obstacle: &Obstacle<S>) -> Option<S> {
        let free = S::from_milli(FREE);
        let at = leg.meets(obstacle, self.room * free)?;
        // Near its start and its end the string may be as near as they are.
        let near = |place| distance(obstacle, place).unwrap_or(-S::ONE);
        let room = near(Vec2::ZERO).min(near(self.goal));
        if room >= self.room {
            return Some(at);
        }
        if room <= S::ZERO { None } else { leg.meets(obstacle, room * free) }
    }

    /// The obstacle that the leg meets first.
    fn first_on(&self, leg: &Leg<S>) -> Option<usize> {
        let all = self.obstacles.iter().enumerate();
        let met = all.filter_map(|(index, obstacle)| Some((self.meets(leg, obstacle)?, index)));
        met.min_by(|(one, _), (other, _)| one.order(*other)).map(|(_, index)| index)
    }

    /// The outermost bend on this side around an obstacle and those on the leg that are connected
    /// to it.
    fn outermost(&self, index: usize, on_left: bool, near: &[Bend<S>; 2], leg: &Leg<S>) -> Option<Bend<S>> {
        let [before, _] = near;
        let mut best = self.bend(index, on_left, near);
        for (other, obstacle) in self.obstacles.iter().enumerate() {
            if other != index && self.is_grouped(index, other) && self.meets(leg, obstacle).is_some() {
                let bend = self.bend(other, on_left, near);
                best = match best.zip(bend) {
                    Some((one, other)) => Some(outer(before, on_left, one, other)),
                    None => best.or(bend),
                };
            }
        }
        best
    }

    /// The bend around an obstacle on this side, behind the first of two bends that differ from it.
    fn bend(&self, index: usize, on_left: bool, near: &[Bend<S>; 2]) -> Option<Bend<S>> {
        let make = |center: Vec2<S>, radius: S| {
            // Around a robot or a goal that is nearer.
            let most = center.norm().min((center - self.goal).norm()) - self.room * S::from_milli(NEARER);
            let radius = radius.min(most).max(S::ZERO);
            Bend { obstacle: u16::try_from(index).ok(), center, radius: if on_left { radius } else { -radius } }
        };
        let is_new = |bend: &Bend<S>| {
            near.iter().all(|other| {
                let is_same = (other.center - bend.center).norm() < self.room * S::from_milli(50);
                !(is_same && (other.radius > S::ZERO) == on_left)
            })
        };
        match *self.obstacles.get(index)? {
            Obstacle::Wall([a, b]) => {
                let [before, _] = near;
                let [one, other] = [a, b].map(|end| make(end, self.room));
                let best = outer(before, on_left, one, other);
                let ends = if best.center == one.center { [one, other] } else { [other, one] };
                ends.into_iter().find(is_new)
            }
            Obstacle::Ball { center_m, radius_m } => {
                Some(make(center_m.xy(), radius_m + self.room)).filter(|bend| is_new(bend))
            }
            Obstacle::Plane { .. } => None,
        }
    }

    /// Whether the robot does not fit between two obstacles.
    fn is_closed(&self, one: usize, other: usize) -> bool {
        let pair = self.obstacles.get(one).zip(self.obstacles.get(other));
        let gap = pair.and_then(|(one, other)| match (one, other) {
            (Obstacle::Ball { center_m, radius_m }, other) | (other, Obstacle::Ball { center_m, radius_m }) => {
                Some(distance(other, center_m.xy())? - *radius_m)
            }
            (Obstacle::Wall([a, b]), Obstacle::Wall([c, d])) => {
                if crosses(*b - *a, [*c - *a, *d - *a]) {
                    return Some(S::ZERO);
                }
                let ends = [(one, c), (one, d), (other, a), (other, b)];
                ends.into_iter().filter_map(|(wall, end)| distance(wall, *end)).min_by(|one, other| one.order(*other))
            }
            _ => None,
        });
        gap.is_some_and(|gap| gap < self.room * S::TWO * S::from_milli(FREE))
    }

    /// The shortest string that passes the first obstacle on this side. Connected obstacles are
    /// passed on one side, or only those that the robot does not fit between; around the first
    /// obstacle apart from these the string takes the side that seems shorter, or the other one.
    fn best(&self, on_left: bool) -> Option<(S, Vec2<S>)> {
        let kinds = [(true, false), (true, true), (false, false), (false, true)];
        let ways = kinds.into_iter().filter_map(|(is_whole, is_other)| self.way(on_left, is_whole, is_other));
        ways.min_by(|(one, _), (other, _)| one.order(*other))
    }

    /// The length of the string that passes the first obstacle on this side, and its direction.
    fn way(&self, on_left: bool, is_whole: bool, mut is_other: bool) -> Option<(S, Vec2<S>)> {
        let mut path = Vec::<Bend<S>, BENDS>::new();
        for end in self.ends() {
            path.push(end).ok()?;
        }
        let mut at = 0_usize;
        for _ in 0..self.obstacles.len().saturating_mul(4).saturating_add(16) {
            let Some([one, other]) = path.get(at..at.saturating_add(2)) else {
                return Self::measure(&path);
            };
            let leg = Leg::between(one, other)?;
            let Some(index) = self.first_on(&leg) else {
                at = at.saturating_add(1);
                continue;
            };
            let near = [*one, *other];
            let side = if is_whole {
                path.iter().find(|bend| bend.obstacle.is_some_and(|known| self.is_grouped(known.into(), index)))
            } else {
                near.iter().find(|bend| bend.obstacle.is_some_and(|known| self.is_closed(known.into(), index)))
            };
            let bend = match side {
                Some(bend) if is_whole => self.outermost(index, bend.radius > S::ZERO, &near, &leg),
                Some(bend) => self.bend(index, bend.radius > S::ZERO, &near),
                None if path.len() == 2 && is_whole => self.outermost(index, on_left, &near, &leg),
                None if path.len() == 2 => self.bend(index, on_left, &near),
                None => {
                    // The centre of a ball is as far from the leg on both sides.
                    let cost = |bend: &Bend<S>| {
                        let place = bend.center - leg.unit.perp() * bend.radius;
                        (place - leg.from).norm() + (place - leg.to()).norm()
                    };
                    let both = [true, false].map(|on_left| self.bend(index, on_left, &near));
                    let both = both.into_iter().flatten();
                    if core::mem::take(&mut is_other) {
                        both.max_by(|one, other| cost(one).order(cost(other)))
                    } else {
                        both.min_by(|one, other| cost(one).order(cost(other)))
                    }
                }
            };
            if path.push(bend?).is_err() {
                // The rest of a string with too many bends is not known.
                return Self::measure(&path).map(|(length, ahead)| (length * S::TWO, ahead));
            }
            let place = at.saturating_add(1);
            swap_on(&mut path, place, true);
            at = pull(&mut path, place);
        }
        None
    }

    /// The length of a string, and its first direction.
    fn measure(path: &[Bend<S>]) -> Option<(S, Vec2<S>)> {
        let mut length = S::ZERO;
        let mut last = None::<Vec2<S>>;
        let mut first = None;
        for pair in path.windows(2) {
            let [one, other] = pair else {
                continue;
            };
            let leg = Leg::between(one, other)?;
            if let Some(last) = last {
                let (det, dot) = (last.det(leg.unit), last.dot(leg.unit));
                let det = if one.radius < S::ZERO { -det } else { det };
                // A turn the wrong way is more than half a turn, or rounding.
                let angle = match () {
                    () if det >= S::ZERO => det.atan2(dot),
                    () if dot < S::ZERO => det.atan2(dot) + S::PI * S::TWO,
                    () => S::ZERO,
                };
                length += angle * one.radius.abs();
            }
            length += leg.length;
            last = Some(leg.unit);
            first = first.or(last);
        }
        first.map(|first| (length, first))
    }
}

/// The one of two bends behind `before` whose tangent lies farther on this side.
fn outer<S: Scalar>(before: &Bend<S>, on_left: bool, one: Bend<S>, other: Bend<S>) -> Bend<S> {
    let [a, b] = [one, other].map(|bend| Leg::between(before, &bend).map_or(Vec2::ZERO, |leg| leg.unit));
    let turn = a.det(b);
    if (if on_left { turn } else { -turn }) >= S::ZERO { one } else { other }
}

/// Moves the last bend to `place`, or the one there to the end. `insert` and `remove` of the list
/// would leave a panic in the firmware.
fn swap_on<S: Scalar>(path: &mut [Bend<S>], place: usize, is_back: bool) {
    for step in place.saturating_add(1)..path.len() {
        let at = if is_back { path.len().saturating_add(place).saturating_sub(step) } else { step };
        if let Some([one, other]) = path.get_mut(at.saturating_sub(1)..=at) {
            core::mem::swap(one, other);
        }
    }
}

/// Removes bends near `at` around which the string would turn the wrong way. Returns where to
/// continue.
fn pull<S: Scalar>(path: &mut Vec<Bend<S>, BENDS>, at: usize) -> usize {
    let mut from = at.saturating_sub(1);
    let mut middle = at.saturating_add(1);
    loop {
        let slice = middle.checked_sub(1).and_then(|before| path.get(before..before.saturating_add(3)));
        if let Some([before, bend, after]) = slice
            && bend.obstacle.is_some()
            && is_slack(before, bend, after)
        {
            swap_on(path, middle, false);
            path.pop();
            from = from.min(middle.saturating_sub(1));
            continue;
        }
        if middle == 0 || middle.saturating_add(1) < at {
            break;
        }
        middle -= 1;
    }
    from
}

fn is_slack<S: Scalar>(before: &Bend<S>, bend: &Bend<S>, after: &Bend<S>) -> bool {
    let Some((one, other)) = Leg::between(before, bend).zip(Leg::between(bend, after)) else {
        return false;
    };
    let turn = one.unit.det(other.unit);
    let turn = if bend.radius < S::ZERO { -turn } else { turn };
    // Around the end of a wall the string may turn by somewhat more than half a turn.
    turn < S::ZERO && one.unit.dot(other.unit) > -S::from_milli(REVERSED)
}

#[cfg(test)]
mod tests;
