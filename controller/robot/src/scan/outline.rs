//! Walls and balls from one scan by sleeve fitting (Z. Zhao, A. Saalfeld 1997, "Linear-time
//! sleeve-fitting polyline simplification algorithms"): the directions from the first point of a
//! wall that pass all later points within the tolerance form an angle that only shrinks.

use super::{Ray, Scan};
use heapless::Vec;
use staya_controller::geom::Vec2;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;

/// How hits become walls.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutlineParams<S> {
    /// Maximum distance between a wall and its hits, metres: a few times the sensor's noise.
    pub tolerance_m: S,
    /// Hits farther apart belong to different objects, metres; at most the robot's width.
    pub gap_m: S,
    /// Radius of the ball for a single hit, metres; above 0, half the distance of beams.
    pub point_m: S,
}

/// Converts a scan to obstacles relative to the robot, nearest first, at most `K`. Hits for which
/// `is_robot` (relative position, metres along the world's axes) returns true are omitted.
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
        // Both hold `K`; `collect` would contain a panic.
        let _ = obstacles.push(*obstacle);
    }
    obstacles
}

struct Sleeve<S> {
    first: Vec2<S>,
    last: Vec2<S>,
    /// Rightmost and leftmost direction; `None` while all points are at the first one.
    bounds: Option<[Vec2<S>; 2]>,
    reach: S,
}

impl<S: Scalar> Sleeve<S> {
    const fn at(first: Vec2<S>) -> Self {
        Self { first, last: first, bounds: None, reach: S::ZERO }
    }

    /// Succeeds if the wall passes all points between within `tolerance`.
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
