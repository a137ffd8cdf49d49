//! What somebody can put into the plane.

use super::super::Refusal;
use serde::{Deserialize, Serialize};

/// Farthest coordinate, metres.
pub const FAR_M: f64 = 1e6;
/// Points of a polygon at most.
const POINTS: usize = 1000;

/// What stands in the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A disc, as high as there is anything.
    Circle {
        /// Its centre.
        center_m: [f64; 2],
        /// Its radius.
        radius_m: f64,
    },
    /// A wall without thickness.
    Segment {
        /// One end.
        from_m: [f64; 2],
        /// The other.
        to_m: [f64; 2],
    },
    /// Walls around a polygon.
    Polygon {
        /// Its corners.
        points_m: Vec<[f64; 2]>,
    },
    /// A ball.
    Ball {
        /// Its centre.
        center_m: [f64; 3],
        /// Its radius.
        radius_m: f64,
    },
}

impl Shape {
    fn numbers(&self) -> (Vec<f64>, Option<f64>) {
        match self {
            Self::Circle { center_m, radius_m } => (center_m.to_vec(), Some(*radius_m)),
            Self::Segment { from_m, to_m } => ([*from_m, *to_m].concat(), None),
            Self::Polygon { points_m } => (points_m.concat(), None),
            Self::Ball { center_m, radius_m } => (center_m.to_vec(), Some(*radius_m)),
        }
    }

    /// Whether it is something, somewhere.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn check(&self) -> Result<(), Refusal> {
        let (coordinates, radius_m) = self.numbers();
        if coordinates.iter().any(|x| x.abs().partial_cmp(&FAR_M).is_none_or(std::cmp::Ordering::is_gt)) {
            return Err(Refusal::new("solid", "it is nowhere", format!("give metres within {FAR_M}")));
        }
        if radius_m.is_some_and(|radius_m| !(0.001..=FAR_M).contains(&radius_m)) {
            return Err(Refusal::new("solid", "its radius is no size", format!("give 0.001 to {FAR_M} metres")));
        }
        match self {
            Self::Polygon { points_m } if !(3..=POINTS).contains(&points_m.len()) => {
                let what = format!("{} points are no polygon", points_m.len());
                Err(Refusal::new("solid", what, format!("give 3 to {POINTS}")))
            }
            _ => Ok(()),
        }
    }
}
