//! Walls and balls from one scan, for collision avoidance.
//!
//! Source: sleeve fitting, Z. Zhao, A. Saalfeld 1997, "Linear-time sleeve-fitting polyline simplification algorithms":
//! from the first point of a wall the directions that pass all later points within the tolerance are an angle that only
//! shrinks, so that each point costs the same.

use super::{Ray, Scan};
use heapless::Vec;
use staya_controller::geom::Vec2;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;

/// How hits become walls.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutlineParams<S> {
    /// A wall may miss the hits that it stands for by so much, metres: some times the sensor's noise. Less: more walls
    /// for the same land.
    pub tolerance_m: S,
    /// Hits of neighbouring beams that are farther apart are two things, metres. No more than what the robot fits
    /// through.
    pub gap_m: S,
    /// Radius of the ball for a hit that stands alone, metres: half the distance of beams at the range that matters.
    /// More than 0.
    pub point_m: S,
}

/// What the scan shows as obstacles relative to the robot, the nearest first, at most `K`: the farthest are left out.
/// Hits that `is_robot` (place relative to the robot, metres along the world's axes) names are left out too.
///
/// The first and the last beam of a full turn are not joined. Bounded work: O(1) and one call of `is_robot` for each
/// range, O(K) for each wall.
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
            // A beam that says nothing, or goes through, parts what is left and right of it.
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
                    // What goes on round a corner begins at the corner.
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
        // There is room: both hold `K`. (`collect` would have a panic for the case that not.)
        let _ = obstacles.push(*obstacle);
    }
    obstacles
}

/// A wall that may grow.
struct Sleeve<S> {
    first: Vec2<S>,
    last: Vec2<S>,
    /// The rightmost and the leftmost direction that pass all points; `None` while all are at the first one.
    bounds: Option<[Vec2<S>; 2]>,
    /// How far from the first one the farthest is.
    reach: S,
}

impl<S: Scalar> Sleeve<S> {
    const fn at(first: Vec2<S>) -> Self {
        Self { first, last: first, bounds: None, reach: S::ZERO }
    }

    /// Goes on to `point` if the wall to it passes all points between within `tolerance`; whether it did.
    fn extend(&mut self, point: Vec2<S>, tolerance: S) -> bool {
        let way = point - self.first;
        let length = way.norm();
        let aside = way.normalized().unwrap_or_default().perp() * tolerance;
        let mut own = [way - aside, way + aside];
        if let Some([right, left]) = self.bounds {
            let is_within = right.det(way) >= S::ZERO && way.det(left) >= S::ZERO;
            // One that came back would leave the farthest point out.
            if !is_within || right.dot(way) < S::ZERO || length < self.reach {
                return false;
            }
            let [own_right, own_left] = own;
            own = [
                if right.det(own_right) > S::ZERO { own_right } else { right },
                if own_left.det(left) > S::ZERO { own_left } else { left },
            ];
        }
        // A point nearer than the tolerance bounds nothing.
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

/// Puts an obstacle where it belongs by its distance; in a full list the farthest has no place.
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
