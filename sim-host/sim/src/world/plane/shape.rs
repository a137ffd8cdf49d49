//! Shapes of obstacles that interventions add.

use super::super::Refusal;
use serde::{Deserialize, Serialize};

/// Largest coordinate, metres.
pub const FAR_M: f64 = 1e6;
const POINTS: usize = 1000;

/// Shape of an added obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// An upright cylinder of unlimited height.
    Circle {
        /// Centre, metres.
        center_m: [f64; 2],
        /// Radius, metres.
        radius_m: f64,
    },
    /// A wall without thickness.
    Segment {
        /// One end, metres.
        from_m: [f64; 2],
        /// The other end, metres.
        to_m: [f64; 2],
    },
    /// Walls around a polygon.
    Polygon {
        /// Corners, metres.
        points_m: Vec<[f64; 2]>,
    },
    /// A ball.
    Ball {
        /// Centre, metres.
        center_m: [f64; 3],
        /// Radius, metres.
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

    /// Checks coordinates, radius and number of corners.
    ///
    /// # Errors
    /// Names the error and the remedy.
    pub fn check(&self) -> Result<(), Refusal> {
        let (coordinates, radius_m) = self.numbers();
        if coordinates.iter().any(|x| x.abs().partial_cmp(&FAR_M).is_none_or(std::cmp::Ordering::is_gt)) {
            return Err(Refusal::new("solid", "a coordinate is out of range", format!("give metres within {FAR_M}")));
        }
        if radius_m.is_some_and(|radius_m| !(0.001..=FAR_M).contains(&radius_m)) {
            return Err(Refusal::new("solid", "its radius is out of range", format!("give 0.001 to {FAR_M} metres")));
        }
        match self {
            Self::Polygon { points_m } if !(3..=POINTS).contains(&points_m.len()) => {
                let what = format!("{} points do not make a polygon", points_m.len());
                Err(Refusal::new("solid", what, format!("give 3 to {POINTS}")))
            }
            _ => Ok(()),
        }
    }
}

/// Even-odd test: a ray to the east crosses an odd number of the polygon's sides.
pub(crate) fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let before = corners.iter().cycle().skip(corners.len() - 1);
    let sides = before.zip(corners).filter(|([_, from], [_, to])| (*from > y) != (*to > y));
    let crossed = sides.filter(|([x0, y0], [x1, y1])| x < x0 + (x1 - x0) * (y - y0) / (y1 - y0));
    crossed.count() % 2 == 1
}
