//! Gaps and overlaps between bodies and obstacles.

use super::{dot, length, minus, squared};
use crate::nearby::{Cells, Query, Search as _, Space};
use serde::Serialize;

/// An obstacle in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle<const D: usize> {
    /// A wall without thickness between two points, metres.
    Segment([[f64; D]; 2]),
    /// A disc; in space a ball.
    Disc {
        /// Centre, metres.
        centre_m: [f64; D],
        /// Radius, metres.
        radius_m: f64,
    },
}

impl<const D: usize> Obstacle<D> {
    /// Distance of a point from the surface, metres; negative inside a disc.
    #[must_use]
    pub fn distance_m(&self, at: [f64; D]) -> f64 {
        match *self {
            Self::Segment([a, b]) => {
                let (along, to) = (minus(b, a), minus(at, a));
                let whole = squared(along);
                let share = if whole > 0.0 { (dot(to, along) / whole).clamp(0.0, 1.0) } else { 0.0 };
                length(minus(to, along.map(|c| c * share)))
            }
            Self::Disc { centre_m, radius_m } => length(minus(at, centre_m)) - radius_m,
        }
    }
}

/// Smallest gaps at one moment, from surface to surface; negative for overlaps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gaps {
    /// Smallest gap between two robots, metres; `None` if all gaps exceed the horizon.
    pub between_robots_m: Option<f64>,
    /// Pairs of robots that overlap.
    pub overlapping_pairs: usize,
    /// Smallest gap between a robot and an obstacle, metres; `None` without robots or obstacles.
    pub to_obstacles_m: Option<f64>,
    /// Robots that overlap an obstacle.
    pub robots_in_obstacles: usize,
}

/// Computes the gaps between discs (in space, balls). Gaps between robots above `horizon_m` are
/// ignored. O(n + pairs within the horizon + n x obstacles).
///
/// # Panics
/// If there are not as many radii as positions.
#[must_use]
pub fn gaps<const D: usize>(
    places_m: &[[f64; D]],
    radii_m: &[f64],
    obstacles: &[Obstacle<D>],
    horizon_m: f64,
    space: Space<f64, D>,
) -> Gaps {
    assert_eq!(places_m.len(), radii_m.len(), "one radius a robot");
    let largest = radii_m.iter().copied().fold(0.0, f64::max);
    let reach = 2.0 * largest + horizon_m.max(0.0);
    let mut cells = Cells::new(space, reach);
    cells.rebuild(places_m);
    let mut all = Gaps { between_robots_m: None, overlapping_pairs: 0, to_obstacles_m: None, robots_in_obstacles: 0 };
    let least = |known: Option<f64>, gap: f64| Some(known.map_or(gap, |known| known.min(gap)));
    let mut found = Vec::new();
    for ((robot, &at), &radius) in (0..).zip(places_m).zip(radii_m) {
        let query = Query { at, radius: reach, most: usize::MAX, except: Some(robot) };
        cells.within(&query, &mut found);
        for other in found.iter().filter(|other| other.index > robot) {
            let gap = other.distance_squared.sqrt() - radius - radii_m[other.index as usize];
            if gap <= horizon_m.max(0.0) {
                all.between_robots_m = least(all.between_robots_m, gap);
                all.overlapping_pairs += usize::from(gap < 0.0);
            }
        }
        let nearest = obstacles.iter().map(|obstacle| obstacle.distance_m(at) - radius).fold(None, least);
        if let Some(gap) = nearest {
            all.to_obstacles_m = least(all.to_obstacles_m, gap);
            all.robots_in_obstacles += usize::from(gap < 0.0);
        }
    }
    all
}
