//! Walls and balls from one scan, for collision avoidance.
//!
//! Source: sleeve fitting, Z. Zhao, A. Saalfeld 1997, "Linear-time sleeve-fitting polyline
//! simplification algorithms". From the first point of a wall, the directions that pass all later
//! points within the tolerance form an angle that only shrinks, so each point takes constant work.

use super::{Ray, Scan};
use heapless::Vec;
use staya_controller::geom::Vec2;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;

/// How hits become walls.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutlineParams<S> {
    /// Maximum distance between a wall and its hits, metres: a few times the sensor's noise. A
    /// smaller value gives more walls for the same land.
    pub tolerance_m: S,
    /// Hits of neighbouring beams that are farther apart belong to different objects, metres. At
    /// most the width that the robot fits through.
    pub gap_m: S,
    /// Radius of the ball for a single hit, metres: half the distance of beams at the relevant
    /// range. More than 0.
    pub point_m: S,
}

/// Converts a scan to obstacles relative to the robot, nearest first, at most `K`; the farthest are
/// omitted. Hits for which `is_robot` (position relative to the robot, metres along the world's
/// axes) returns true are omitted, too.
///
/// The first and the last beam of a full turn are not joined. Bounded work: O(1) and one call of
/// `is_robot` for each range, O(K) for each wall.
#[must_use]
pub fn outline<S: Scalar, const K: usize>(
    scan: &Scan<'_, S>,
    heading_rad: S,
    params: &OutlineParams<S>,
    is_robot: impl Fn(Vec2<S>) -> bool,
) -> Vec<Obstacle<S>, K> {
    let mut nearest = Vec::<(S, Obstacle<S>), K>::new();
    let mut wall: Option<Sleeve<S>> = None;
    for ray in scan.rays(heading_rad) {
        let end = ray.filter(|ray| ray.is_hit).map(|ray: Ray<S>| ray.end_m());
        let Some(end) = end.filter(|end| !is_robot(*end)) else {
            // An invalid or free beam separates the hits on its left and right.
            if let Some(wall) = wall.take() {
                add(&mut nearest, wall.obstacle(params));
            }
            continue;
        };
        wall = Some(match wall.take() {
            None => Sleeve::at(end),
            Some(mut sleeve) => {
                let is_near = (end - sleeve.last).norm() <= params.gap_m;
                if is_near && sleeve.extend(end, params.tolerance_m) {
                    sleeve
                } else {
                    add(&mut nearest, sleeve.obstacle(params));
                    // A wall that continues around a corner begins at the corner.
                    if is_near {
                        let mut next = Sleeve::at(sleeve.last);
                        let _ = next.extend(end, params.tolerance_m);
                        next
                    } else {
                        Sleeve::at(end)
                    }
                }
            }
        });
    }
    if let Some(wall) = wall {
        add(&mut nearest, wall.obstacle(params));
    }
    let mut obstacles = Vec::new();
    for (_, obstacle) in &nearest {
        // It fits: both hold `K`. (`collect` would contain a panic for the other case.)
        let _ = obstacles.push(*obstacle);
    }
    obstacles
}

struct Sleeve<S> {
    first: Vec2<S>,
    last: Vec2<S>,
    /// The rightmost and the leftmost direction that pass all points; `None` while all are at the
    /// first one.
    bounds: Option<[Vec2<S>; 2]>,
    /// Distance of the farthest point from the first.
    reach: S,
}

impl<S: Scalar> Sleeve<S> {
    const fn at(first: Vec2<S>) -> Self {
        Self { first, last: first, bounds: None, reach: S::ZERO }
    }

    /// Extends the wall to `point` if the result passes all points between within `tolerance`;
    /// returns whether it did.
    fn extend(&mut self, point: Vec2<S>, tolerance: S) -> bool {
        let way = point - self.first;
        let length = way.norm();
        let aside = way.normalized().unwrap_or_default().perp() * tolerance;
        let mut own = [way - aside, way + aside];
        if let Some([right, left]) = self.bounds {
            let is_within = right.det(way) >= S::ZERO && way.det(left) >= S::ZERO;
            // A wall that came back would omit the farthest point.
            if !is_within || right.dot(way) < S::ZERO || length < self.reach {
                return false;
            }
            let [own_right, own_left] = own;
            own = [
                if right.det(own_right) > S::ZERO { own_right } else { right },
                if own_left.det(left) > S::ZERO { own_left } else { left },
            ];
        }
        // A point nearer than the tolerance gives no bound.
        if length > tolerance || self.bounds.is_some() {
            self.bounds = Some(own);
            self.reach = length;
        }
        self.last = point;
        true
    }

    fn obstacle(&self, params: &OutlineParams<S>) -> Obstacle<S> {
        if self.first == self.last {
            return Obstacle::Ball { center_m: self.first.extend(S::ZERO), radius_m: params.point_m };
        }
        Obstacle::Wall([self.first, self.last])
    }
}

/// Inserts an obstacle by its distance; a full list drops the farthest.
fn add<S: Scalar, const K: usize>(nearest: &mut Vec<(S, Obstacle<S>), K>, obstacle: Obstacle<S>) {
    let Some((_, distance)) = obstacle.nearest_point() else {
        return;
    };
    let place = nearest.partition_point(|(other, _)| *other <= distance);
    let mut entry = (distance, obstacle);
    for farther in nearest.iter_mut().skip(place) {
        core::mem::swap(farther, &mut entry);
    }
    let _ = nearest.push(entry);
}
