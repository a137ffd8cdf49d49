//! The way around walls: from corner to corner, as far as they are seen.

use crate::geom::Vec2;
use crate::list;
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use heapless::Vec;

/// Distance of a robot's centre from the corner that it passes, thousandths of its radius.
const ROOM: i32 = 1_100;
/// Corners of a way that are considered behind the first one.
const CORNERS: u8 = 3;

/// Walls whose corners are remembered for the time of one question; others are computed each time.
const REMEMBERED: usize = 8;

/// The places beyond the ends of walls.
pub(super) struct Corners<'a, S> {
    obstacles: &'a [Obstacle<S>],
    radius_m: S,
    first: Vec<[Option<Vec2<S>>; 2], REMEMBERED>,
}

impl<'a, S: Scalar> Corners<'a, S> {
    /// O(walls).
    #[inline(never)]
    pub(super) fn new(obstacles: &'a [Obstacle<S>], radius_m: S) -> Self {
        let first = walls(obstacles).map(|ends| ends.map(|end| outside(obstacles, end, radius_m)));
        Self { obstacles, radius_m, first: list::collect(first.take(REMEMBERED)) }
    }

    fn of(&self, wall: usize, ends: [Vec2<S>; 2]) -> [Option<Vec2<S>>; 2] {
        let compute = || ends.map(|end| outside(self.obstacles, end, self.radius_m));
        self.first.get(wall).copied().unwrap_or_else(compute)
    }

    /// About the length of the way to `target`, around the first [`CORNERS`]. O(walls).
    pub(super) fn rest(&self, from: Vec2<S>, target: Vec2<S>) -> S {
        self.way(from, target).0
    }

    /// [`Corners::rest`], and the first corner of that way.
    pub(super) fn way(&self, from: Vec2<S>, target: Vec2<S>) -> (S, Option<Vec2<S>>) {
        let (mut from, mut length, mut first) = (from, S::ZERO, None);
        for _ in 0..CORNERS {
            let Some((wall, ends)) = first_wall(self.obstacles, from, target) else {
                break;
            };
            let mut best = None::<(S, S, Vec2<S>)>;
            for next in self.of(wall, ends).into_iter().flatten() {
                let way = (next - from).norm();
                if way > self.radius_m {
                    let cost = way + (target - next).norm();
                    if best.is_none_or(|(least, ..)| is_less(cost, least)) {
                        best = Some((cost, way, next));
                    }
                }
            }
            let Some((_, way, next)) = best else {
                break;
            };
            (from, length) = (next, length + way);
            first = first.or(Some(next));
        }
        (length + (target - from).norm(), first)
    }
}

/// In the order of [`Scalar::order`].
fn is_less<S: Scalar>(one: S, other: S) -> bool {
    one.order(other).is_lt()
}

/// The first place of the shortest way to `target` if a wall blocks the straight one: outside a
/// corner that is seen. O(walls x obstacles).
pub(crate) fn detour<S: Scalar>(obstacles: &[Obstacle<S>], target: Vec2<S>, radius_m: S) -> Option<Vec2<S>> {
    first_wall(obstacles, Vec2::ZERO, target)?;
    let corners = Corners::new(obstacles, radius_m);
    let is_free = |place: Vec2<S>| {
        !is_hidden(obstacles, place)
            && obstacles.iter().filter_map(|obstacle| distance(obstacle, place)).all(|distance| distance >= radius_m)
    };
    let mut best = None::<(S, Vec2<S>)>;
    for (wall, ends) in walls(obstacles).enumerate() {
        for place in corners.of(wall, ends).into_iter().flatten() {
            if is_free(place) {
                let cost = place.norm() + corners.rest(place, target);
                if best.is_none_or(|(least, _)| is_less(cost, least)) {
                    best = Some((cost, place));
                }
            }
        }
    }
    best.map(|(_, place)| place)
}

/// A place beyond the end of a wall, or of several that end there; `None` if they are in line.
fn outside<S: Scalar>(obstacles: &[Obstacle<S>], end: Vec2<S>, radius_m: S) -> Option<Vec2<S>> {
    let near = radius_m * S::from_milli(50);
    let is_here = |other: Vec2<S>| {
        let way = other - end;
        // The first two save most roots: no component is longer than the vector.
        way.x.abs() < near && way.y.abs() < near && way.norm() < near
    };
    let ways = walls(obstacles).filter_map(|[a, b]| match () {
        () if is_here(a) => (a - b).normalized(),
        () if is_here(b) => (b - a).normalized(),
        () => None,
    });
    let out = ways.fold(Vec2::ZERO, |sum, way| sum + way);
    let (unit, length) = out.unit_and_norm();
    unit.filter(|_| length > S::from_milli(20)).map(|out| end + out * (radius_m * S::from_milli(ROOM)))
}

/// The wall that the straight way meets first, and its index.
fn first_wall<S: Scalar>(obstacles: &[Obstacle<S>], from: Vec2<S>, target: Vec2<S>) -> Option<(usize, [Vec2<S>; 2])> {
    let way = target - from;
    let mut first = None::<(S, usize, [Vec2<S>; 2])>;
    for (wall, ends) in walls(obstacles).enumerate() {
        let [a, b] = ends;
        if crosses(way, [a - from, b - from]) {
            let share = (a - from).det(b - a).checked_div(way.det(b - a)).unwrap_or(S::ZERO);
            if first.is_none_or(|(least, ..)| is_less(share, least)) {
                first = Some((share, wall, ends));
            }
        }
    }
    first.map(|(_, wall, ends)| (wall, ends))
}

/// Whether a wall lies before `place`; the wall that ends there does not count.
pub(super) fn is_hidden<S: Scalar>(obstacles: &[Obstacle<S>], place: Vec2<S>) -> bool {
    let before = place - place * S::from_milli(1);
    walls(obstacles).any(|ends| crosses(before, ends))
}

pub(super) fn walls<S: Scalar>(obstacles: &[Obstacle<S>]) -> impl Iterator<Item = [Vec2<S>; 2]> {
    obstacles.iter().filter_map(|obstacle| match obstacle {
        Obstacle::Wall(ends) => Some(*ends),
        _ => None,
    })
}

pub(super) fn crosses<S: Scalar>(target: Vec2<S>, [a, b]: [Vec2<S>; 2]) -> bool {
    let along = b - a;
    let sides = (along.det(-a) > S::ZERO) != (along.det(target - a) > S::ZERO);
    let ends = (target.det(a) > S::ZERO) != (target.det(b) > S::ZERO);
    sides && ends
}

pub(super) fn distance<S: Scalar>(obstacle: &Obstacle<S>, from: Vec2<S>) -> Option<S> {
    nearest(obstacle, from).map(|(_, distance)| distance)
}

/// The nearest point, relative to `from`, and its distance.
pub(super) fn nearest<S: Scalar>(obstacle: &Obstacle<S>, from: Vec2<S>) -> Option<(Vec2<S>, S)> {
    let moved = match *obstacle {
        Obstacle::Wall([a, b]) => Obstacle::Wall([a - from, b - from]),
        Obstacle::Ball { center_m, radius_m } => {
            Obstacle::Ball { center_m: (center_m.xy() - from).extend(S::ZERO), radius_m }
        }
        Obstacle::Plane { .. } => return None,
    };
    moved.nearest_point().map(|(point, distance)| (point.xy(), distance))
}

#[cfg(test)]
pub(super) mod tests;
