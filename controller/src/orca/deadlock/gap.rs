//! Finds narrow places between walls, which robots must share.

use super::detour::{Corners, crosses, distance, is_hidden, nearest, walls};
use crate::geom::Vec2;
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;

/// A door, or a passage as wide as a door, on the path to the goal; relative to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap<S> {
    pub(super) middle: Vec2<S>,
    pub(super) ahead: Vec2<S>,
    pub(super) half: S,
    /// Half its depth, metres; 0 between walls without thickness.
    pub(super) depth: S,
    /// A wall blocks the straight path.
    pub(super) is_only_way: bool,
}

pub(super) struct Wanted<S> {
    pub(super) radius_m: S,
    pub(super) least_m: S,
    pub(super) most_m: S,
    /// Longest passage among gaps that are not narrow, metres.
    pub(super) deepest_m: S,
    pub(super) narrow_m: S,
    /// How far behind a gap it still counts.
    pub(super) past_m: S,
}

impl<S: Scalar> Gap<S> {
    /// Coordinates: x behind the gap (negative: before it; 0: in it), y to the right of its axis.
    pub(super) fn place(&self, offset: Vec2<S>) -> Vec2<S> {
        let Vec2 { x, y } = self.turn(offset - self.middle);
        let beyond = (x.abs() - self.depth).max(S::ZERO);
        Vec2::new(if x < S::ZERO { -beyond } else { beyond }, y)
    }

    pub(super) fn turn(&self, vector: Vec2<S>) -> Vec2<S> {
        Vec2::new(vector.dot(self.ahead), -self.ahead.det(vector))
    }

    /// Inverse of [`Gap::place`]; a position in the gap counts as before it.
    pub(super) fn way(&self, place: Vec2<S>) -> Vec2<S> {
        let depth = if place.x > S::ZERO { self.depth } else { -self.depth };
        self.middle + self.ahead * (place.x + depth) - self.ahead.perp() * place.y
    }

    fn between(a: Vec2<S>, b: Vec2<S>, target: Vec2<S>) -> Option<Self> {
        let across = (b - a).perp().normalized()?;
        let middle = (a + b) * S::HALF;
        let distance = (target - middle).dot(across);
        let gap = Self {
            middle,
            ahead: if distance < S::ZERO { -across } else { across },
            half: (b - a).norm() * S::HALF,
            depth: S::ZERO,
            is_only_way: false,
        };
        (distance != S::ZERO).then_some(gap)
    }

    fn is_passed(&self, wanted: &Wanted<S>) -> bool {
        let own = self.place(Vec2::ZERO);
        own.x > wanted.past_m || own.x > S::ZERO && own.y.abs() > self.half
    }

    /// Whether walls lead on both sides to a gap in line, `way` away; checks halfway.
    fn is_walled(&self, way: Vec2<S>, obstacles: &[Obstacle<S>]) -> bool {
        let side = self.ahead.perp() * self.half;
        let halfway = self.middle + way * S::HALF;
        [halfway + side, halfway - side]
            .into_iter()
            .all(|place| obstacles.iter().filter_map(|obstacle| distance(obstacle, place)).any(|near| near < self.half))
    }

    /// Whether nothing is as near to the middle as the posts, such as other corners of a crossing.
    fn is_clear(&self, obstacles: &[Obstacle<S>]) -> bool {
        let side = self.ahead.perp() * self.half;
        let room = self.half - self.half * S::from_milli(1);
        let is_post = |point: Vec2<S>| (point - side).norm().min((point + side).norm()) < self.half * S::HALF;
        let mut nearest = obstacles.iter().filter_map(|obstacle| nearest(obstacle, self.middle));
        nearest.all(|(point, distance)| {
            distance >= room && (distance > self.half + self.half * S::from_milli(50) || is_post(point))
        })
    }

    /// Joined with the other end of the same passage. An end farther away than
    /// [`Wanted::deepest_m`] belongs to it if the passage is narrow and has walls all along.
    fn joined(self, other: &Self, wanted: &Wanted<S>, obstacles: &[Obstacle<S>]) -> Self {
        let way = other.middle - self.middle;
        let Vec2 { x, y } = self.turn(way);
        // From a target inside, the other end looks the opposite way.
        let is_same_way = self.ahead.dot(other.ahead).abs() > S::from_milli(990);
        if !is_same_way || y.abs() > self.half * S::HALF {
            return self;
        }
        let is_narrow = self.half + self.half < wanted.narrow_m;
        if x.abs() > wanted.deepest_m && !(is_narrow && self.is_walled(way, obstacles)) {
            return self;
        }
        let (low, high) = ((-self.depth).min(x), self.depth.max(x));
        let middle = self.middle + self.ahead * ((low + high) * S::HALF);
        let joined = Self { middle, depth: (high - low) * S::HALF, ..self };
        // The ends of a corridor that this one crosses.
        let own = joined.place(Vec2::ZERO);
        let is_crossing = own.x == S::ZERO && own.y.abs() > self.half;
        if is_crossing || !other.is_clear(obstacles) { self } else { joined }
    }
}

/// The gap on the shortest path to `target`, if a wall blocks the straight path or that leads
/// through a gap; also for a robot in the gap or just behind it. O(walls^2), and O(obstacles) for
/// each pair of ends with the right distance.
pub(super) fn gap_on_way<S: Scalar>(obstacles: &[Obstacle<S>], target: Vec2<S>, wanted: &Wanted<S>) -> Option<Gap<S>> {
    let is_blocked = is_hidden(obstacles, target);
    let mut best: Option<(S, Gap<S>)> = None;
    let mut corners = None;
    for_each_gap(obstacles, target, wanted, &mut |gap| {
        // Two ends of walls are a gap only if both are seen: a solid may lie between them.
        let side = gap.ahead.perp() * gap.half;
        // Behind a gap but before a wall, the robot need not have come through the gap.
        let is_behind = gap.is_passed(wanted) || is_blocked && gap.place(Vec2::ZERO).x > S::ZERO;
        if is_behind || !gap.is_clear(obstacles) {
            return;
        }
        if [side, -side].into_iter().any(|side| is_hidden(obstacles, gap.middle + side)) {
            return;
        }
        let corners = corners.get_or_insert_with(|| Corners::new(obstacles, wanted.radius_m));
        let (rest, next) = corners.way(gap.middle, target);
        // From the gap the way leads back, past its outside.
        if next.is_some_and(|corner| gap.place(corner).x < -wanted.radius_m * S::HALF) {
            return;
        }
        let detour = gap.middle.norm() + rest;
        if best.is_none_or(|(least, _)| detour < least) {
            best = Some((detour, gap));
        }
    });
    let (_, mut gap) = best?;
    for_each_gap(obstacles, target, wanted, &mut |other| {
        gap = gap.joined(&other, wanted, obstacles);
    });
    if gap.is_passed(wanted) {
        return None;
    }
    let own = gap.place(Vec2::ZERO);
    let side = gap.ahead.perp() * gap.half;
    let is_free = own.x >= S::ZERO || crosses(target, [gap.middle - side, gap.middle + side]);
    gap.is_only_way = !is_free;
    (is_free || is_blocked).then_some(gap)
}

fn for_each_gap<S: Scalar>(
    obstacles: &[Obstacle<S>],
    target: Vec2<S>,
    wanted: &Wanted<S>,
    // Not generic, so that firmware contains this once.
    visit: &mut dyn FnMut(Gap<S>),
) {
    for (index, one) in walls(obstacles).enumerate() {
        for other in walls(obstacles).skip(index + 1) {
            for (a, b) in one.into_iter().flat_map(|a| other.map(|b| (a, b))) {
                let width = (b - a).norm();
                if !(width >= wanted.least_m && width <= wanted.most_m) {
                    continue;
                }
                if let Some(gap) = Gap::between(a, b, target) {
                    visit(gap);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
