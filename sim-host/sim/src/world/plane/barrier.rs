//! Whether any motion leads a body to its goal, if all robots but it were gone.

use super::Solid;
use crate::terrain::Terrain;
use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;

/// Why no motion leads to a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Barrier {
    /// The goal is in an obstacle, in a blocked cell or off the map.
    GoalTaken,
    /// Obstacles and blocked cells enclose the robot or its goal.
    Enclosed,
}

/// Largest number of obstacles and rows of blocked cells for which a way is looked for.
const MOST: usize = 50_000;

/// Obstacles that a body of some radius cannot pass between, grouped.
///
/// Two places are apart if and only if a ring of obstacles lies around one of them, each so near to
/// the next that the body does not fit between. Such a ring crosses the line from one place to the
/// other an odd number of times.
#[derive(Debug)]
pub struct Barriers {
    shapes: Vec<Shape>,
    /// Pairs of shapes with their nearest points.
    gaps: Vec<([usize; 2], [[f64; 2]; 2])>,
    radius_m: f64,
}

/// A convex obstacle.
#[derive(Clone, Debug)]
enum Shape {
    /// The points within a distance of a polygon of one, two or four corners.
    Around(Vec<[f64; 2]>, f64),
    /// A half-plane: a point on its border, and the unit vector out of it.
    Half([f64; 2], [f64; 2]),
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: [f64; 2]) -> f64 {
    libm::hypot(a[0], a[1])
}

/// The point of the side from `a` to `b` that is nearest to `to`.
fn nearest([a, b]: [[f64; 2]; 2], to: [f64; 2]) -> [f64; 2] {
    let way = minus(b, a);
    let squared = dot(way, way);
    let along = if squared > 0.0 { (dot(minus(to, a), way) / squared).clamp(0.0, 1.0) } else { 0.0 };
    [a[0] + way[0] * along, a[1] + way[1] * along]
}

fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

/// Where two sides cross.
fn crossing([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (one, other) = (minus(b, a), minus(d, c));
    let turn = cross(one, other);
    if turn == 0.0 {
        return None;
    }
    let [along, across] = [cross(minus(c, a), other) / turn, cross(minus(c, a), one) / turn];
    let is_on = (0.0..=1.0).contains(&along) && (0.0..=1.0).contains(&across);
    is_on.then(|| [a[0] + one[0] * along, a[1] + one[1] * along])
}

impl Shape {
    /// A point of the shape.
    fn middle(&self) -> [f64; 2] {
        match self {
            Self::Around(corners, _) => {
                let count = corners.len() as f64;
                [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / count)
            }
            Self::Half(point, _) => *point,
        }
    }

    /// The least and greatest coordinates along an axis.
    fn bounds(&self, axis: usize) -> [f64; 2] {
        match self {
            Self::Around(corners, around) => {
                let all = corners.iter().map(|corner| corner[axis]);
                [all.clone().fold(f64::INFINITY, f64::min) - around, all.fold(f64::NEG_INFINITY, f64::max) + around]
            }
            Self::Half(..) => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Distance of a place from the shape; negative inside a disc or a half-plane, 0 in a
    /// rectangle.
    fn distance(&self, place: [f64; 2]) -> f64 {
        match self {
            Self::Around(corners, around) => {
                let turns = || sides(corners).map(|[a, b]| cross(minus(b, a), minus(place, a)));
                let is_inside = corners.len() > 2 && turns().all(|turn| turn >= 0.0);
                let off = sides(corners).map(|side| length(minus(nearest(side, place), place)));
                (if is_inside { 0.0 } else { off.fold(f64::INFINITY, f64::min) }) - around
            }
            Self::Half(point, normal) => dot(minus(place, *point), *normal),
        }
    }

    /// The distance to another shape, not more than 0 if they touch, with points of both between
    /// which it lies.
    fn gap(&self, other: &Self) -> (f64, [[f64; 2]; 2]) {
        match (self, other) {
            (Self::Around(one, r), Self::Around(two, s)) => {
                let both = || sides(one).flat_map(|side| sides(two).map(move |other| (side, other)));
                if let Some(point) = both().find_map(|(side, other)| crossing(side, other)) {
                    return (-r - s, [point; 2]);
                }
                let pairs = both().flat_map(|(a, b)| {
                    let from_a = a.map(|corner| [corner, nearest(b, corner)]);
                    let from_b = b.map(|corner| [nearest(a, corner), corner]);
                    from_a.into_iter().chain(from_b)
                });
                let pairs = pairs.map(|[a, b]| (length(minus(a, b)) - r - s, [a, b]));
                pairs.min_by(|one, other| one.0.total_cmp(&other.0)).unwrap_or((f64::INFINITY, [[0.0; 2]; 2]))
            }
            (Self::Around(corners, around), Self::Half(point, normal)) => {
                let off = |corner: [f64; 2]| dot(minus(corner, *point), *normal);
                let pairs = corners.iter().map(|&corner| {
                    let foot = [0, 1].map(|axis| corner[axis] - normal[axis] * off(corner).max(0.0));
                    (off(corner) - around, [corner, foot])
                });
                pairs.min_by(|one, other| one.0.total_cmp(&other.0)).unwrap_or((f64::INFINITY, [[0.0; 2]; 2]))
            }
            (Self::Half(..), Self::Around(..)) => {
                let (gap, [a, b]) = other.gap(self);
                (gap, [b, a])
            }
            // They meet at infinity, if not before; no ring through there crosses a way outside.
            (Self::Half(point, _), Self::Half(other, _)) => (f64::NEG_INFINITY, [*point, *other]),
        }
    }
}

/// A rectangle in counter-clockwise order.
fn rectangle([west, south]: [f64; 2], [east, north]: [f64; 2]) -> Shape {
    Shape::Around(vec![[west, south], [east, south], [east, north], [west, north]], 0.0)
}

/// Rows of blocked cells as rectangles, and the land beyond the sides of the map as half-planes.
fn blocked(land: &Terrain) -> impl Iterator<Item = Shape> {
    let [[west, east], [south, north]] = [land.sides_m(0), land.sides_m(1)];
    let beyond = [([west, south], [1.0, 0.0]), ([west, south], [0.0, 1.0])];
    let beyond = beyond.into_iter().chain([([east, north], [-1.0, 0.0]), ([east, north], [0.0, -1.0])]);
    let width = i32::from(land.width());
    let rows = (0..i32::from(land.height())).flat_map(move |row| {
        let is_blocked =
            move |column: i32| (0..width).contains(&column) && !land.is_passable(Cell::new(column as i16, row as i16));
        let begins = (0..width).filter(move |&column| is_blocked(column) && !is_blocked(column - 1));
        begins.map(move |begin| {
            let end = (begin..width).take_while(|&column| is_blocked(column)).last().unwrap_or(begin);
            let at = |cells: i32, axis: usize| land.origin_m[axis] + f64::from(cells) * land.cell_m;
            rectangle([at(begin, 0), at(row, 1)], [at(end + 1, 0), at(row + 1, 1)])
        })
    });
    beyond.map(|(point, normal)| Shape::Half(point, normal)).chain(rows)
}

impl Barriers {
    /// Finds the obstacles at the height of a body that it cannot pass between. `None`: there are
    /// too many. O(obstacles x obstacles at the same y).
    #[must_use]
    pub fn new(solids: &[Solid], land: Option<&Terrain>, radius_m: f64, height_m: f64) -> Option<Self> {
        let of = |solid: &Solid| match *solid {
            Solid::Wall(ends) => Some(Shape::Around(ends.to_vec(), 0.0)),
            Solid::Ball { center_m: [x, y, z], radius_m } => {
                let off = z - height_m;
                (off.abs() < radius_m).then(|| Shape::Around(vec![[x, y]], libm::sqrt(radius_m * radius_m - off * off)))
            }
            Solid::Plane { point_m: [x, y, _], normal: [n_x, n_y, n_z] } => {
                (n_z == 0.0).then_some(Shape::Half([x, y], [n_x, n_y]))
            }
        };
        let mut shapes: Vec<Shape> = solids.iter().filter_map(of).take(MOST + 1).collect();
        shapes.extend(land.into_iter().flat_map(blocked).take(MOST + 1));
        if shapes.len() > MOST {
            return None;
        }
        shapes.sort_by(|one, other| one.bounds(1)[0].total_cmp(&other.bounds(1)[0]));
        Some(Self { gaps: gaps(&shapes, 2.0 * radius_m), shapes, radius_m })
    }

    /// Number of obstacles.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.shapes.len()
    }

    /// Why no motion leads from `from` to within `tolerance_m` of `to`; `None`: one does.
    #[must_use]
    pub fn between(&self, from: [f64; 2], to: [f64; 2], tolerance_m: f64) -> Option<Barrier> {
        let clear = |place| self.shapes.iter().map(|shape| shape.distance(place)).fold(f64::INFINITY, f64::min);
        if clear(to) < self.radius_m - tolerance_m {
            return Some(Barrier::GoalTaken);
        }
        // A body that touches an obstacle counts as one that just fits there.
        let least = 2.0 * self.radius_m.min(clear(from)).min(clear(to)) - 1e-6;
        (least > 0.0 && self.is_ringed(from, to, least)).then_some(Barrier::Enclosed)
    }

    fn is_ringed(&self, from: [f64; 2], to: [f64; 2], least: f64) -> bool {
        let way = minus(to, from);
        // Whether a line crosses the way an odd number of times.
        let crosses = |a: [f64; 2], b: [f64; 2]| {
            let [off_a, off_b] = [cross(way, minus(a, from)), cross(way, minus(b, from))];
            if (off_a >= 0.0) == (off_b >= 0.0) {
                return false;
            }
            let share = off_a / (off_a - off_b);
            let point = [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * share);
            (0.0..dot(way, way)).contains(&dot(way, minus(point, from)))
        };
        let mut groups: Vec<(usize, bool)> = (0..self.shapes.len()).map(|index| (index, false)).collect();
        self.gaps.iter().any(|&([one, other], [a, b])| {
            let (shape, second) = (&self.shapes[one], &self.shapes[other]);
            let meet_far_away = matches!((shape, second), (Shape::Half(..), Shape::Half(..)));
            if !meet_far_away && length(minus(a, b)) - around(shape) - around(second) >= least {
                return false;
            }
            let odd = !meet_far_away && (crosses(shape.middle(), a) ^ crosses(a, b) ^ crosses(b, second.middle()));
            let ((root, before), (other_root, after)) = (root(&mut groups, one), root(&mut groups, other));
            if root == other_root {
                return before ^ after ^ odd;
            }
            groups[root] = (other_root, before ^ after ^ odd);
            false
        })
    }
}

const fn around(shape: &Shape) -> f64 {
    match shape {
        Shape::Around(_, around) => *around,
        Shape::Half(..) => 0.0,
    }
}

/// The first member of a group, and whether the way to it crosses the line an odd number of times.
fn root(groups: &mut [(usize, bool)], index: usize) -> (usize, bool) {
    let (mut at, mut is_odd) = (index, false);
    while groups[at].0 != at {
        is_odd ^= groups[at].1;
        at = groups[at].0;
    }
    groups[index] = (at, at != index && is_odd);
    (at, is_odd)
}

/// Pairs of shapes that are nearer to each other than `within`; shapes are sorted by their least y.
fn gaps(shapes: &[Shape], within: f64) -> Vec<([usize; 2], [[f64; 2]; 2])> {
    let mut gaps = Vec::new();
    for (one, shape) in shapes.iter().enumerate() {
        let ([west, east], [_, north]) = (shape.bounds(0), shape.bounds(1));
        for (other, second) in shapes.iter().enumerate().skip(one + 1) {
            if second.bounds(1)[0] > north + within {
                break;
            }
            let [low, high] = second.bounds(0);
            if low > east + within || high < west - within {
                continue;
            }
            let (gap, points) = shape.gap(second);
            if gap < within {
                gaps.push(([one, other], points));
            }
        }
    }
    gaps
}

#[cfg(test)]
mod tests;
