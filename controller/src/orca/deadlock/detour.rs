//! The way around walls: from corner to corner, as far as they are seen.

use crate::geom::Vec2;
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;

/// Distance of a robot's centre from the corner that it passes, thousandths of its radius.
const ROOM: i32 = 1_100;
/// Corners of a way that are considered behind the first one.
const CORNERS: u8 = 3;

/// The first place of the shortest way to `target` if a wall blocks the straight one: outside a
/// corner that is seen. O(walls x obstacles).
pub(crate) fn detour<S: Scalar>(obstacles: &[Obstacle<S>], target: Vec2<S>, radius_m: S) -> Option<Vec2<S>> {
    first_wall(obstacles, Vec2::ZERO, target)?;
    let is_free = |place: &Vec2<S>| {
        !is_hidden(obstacles, *place)
            && obstacles.iter().filter_map(|obstacle| distance(obstacle, *place)).all(|distance| distance >= radius_m)
    };
    let outside = |end| outside(obstacles, end, radius_m);
    let places = walls(obstacles).flatten().filter_map(outside).filter(is_free);
    let costs = places.map(|place| (place.norm() + rest(obstacles, place, target, radius_m), place));
    costs.min_by(|(one, _), (other, _)| one.order(*other)).map(|(_, place)| place)
}

/// About the length of the way to `target`, around the first [`CORNERS`]. O(walls).
pub(super) fn rest<S: Scalar>(obstacles: &[Obstacle<S>], from: Vec2<S>, target: Vec2<S>, radius_m: S) -> S {
    let (mut from, mut length) = (from, S::ZERO);
    for _ in 0..CORNERS {
        let ends = first_wall(obstacles, from, target).into_iter().flatten();
        let next = ends.filter_map(|end| outside(obstacles, end, radius_m));
        let next = next.map(|next| ((next - from).norm(), next)).filter(|(way, _)| *way > radius_m);
        let cost = |(way, next): &(S, Vec2<S>)| *way + (target - *next).norm();
        let Some((way, next)) = next.min_by(|one, other| cost(one).order(cost(other))) else {
            break;
        };
        (from, length) = (next, length + way);
    }
    length + (target - from).norm()
}

/// A place beyond the end of a wall, or of several that end there; `None` if they are in line.
fn outside<S: Scalar>(obstacles: &[Obstacle<S>], end: Vec2<S>, radius_m: S) -> Option<Vec2<S>> {
    let is_here = |other: Vec2<S>| (other - end).norm() < radius_m * S::from_milli(50);
    let ways = walls(obstacles).filter_map(|[a, b]| match () {
        () if is_here(a) => (a - b).normalized(),
        () if is_here(b) => (b - a).normalized(),
        () => None,
    });
    let out = ways.fold(Vec2::ZERO, |sum, way| sum + way);
    (out.norm() > S::from_milli(20)).then(|| out.normalized())?.map(|out| end + out * (radius_m * S::from_milli(ROOM)))
}

fn first_wall<S: Scalar>(obstacles: &[Obstacle<S>], from: Vec2<S>, target: Vec2<S>) -> Option<[Vec2<S>; 2]> {
    let way = target - from;
    let met = walls(obstacles).filter(|ends| crosses(way, ends.map(|end| end - from)));
    let share = |[a, b]: [Vec2<S>; 2]| (a - from).det(b - a).checked_div(way.det(b - a)).unwrap_or(S::ZERO);
    met.min_by(|one, other| share(*one).order(share(*other)))
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
