//! Conversion of heights to impassability: steeper cells are slower, too steep cells are blocked.

use super::Terrain;
use super::error::{TerrainError, parameter_error};
use super::esri::Heights;
use crate::{defaults, table};
use serde::Serialize;
use staya_controller::grid::BLOCKED;

table! {
    /// Rule that converts slopes to impassability.
    ///
    /// The slope g of a cell is the length of the gradient of the heights, rise over run (1 is 45
    /// degrees). It uses central differences over the four neighbours, one-sided at the border and
    /// next to unknown heights. With l classes and the maximum slope m, a cell has impassability 1
    /// + floor(l g / m) for g < m, l for g = m, and is blocked for g > m. Unknown heights are
    /// blocked.
    #[derive(Copy, PartialEq, Serialize)]
    pub struct SlopeRule {
        /// Number of classes l, 1 to 255: the steepest passable land takes l times as long as flat
        /// land.
        pub classes: u8 = 9;
        /// Steepest passable slope m, rise over run, more than 0: up to 0.6 for wheels, 1 for
        /// tracks. Too high a value sends robots up cliffs; too low a value splits the terrain.
        pub max_slope: f64 = 0.5;
    }
}

// Nine classes as in KUZ section 5, and 0.5 (27 degrees).
defaults!(SlopeRule);

impl SlopeRule {
    /// Impassability of a slope, rise over run; NaN is blocked.
    #[must_use]
    pub fn impassability(&self, slope: f64) -> u8 {
        if slope <= self.max_slope {
            let class = 1.0 + (f64::from(self.classes) * slope / self.max_slope).floor();
            class.min(f64::from(self.classes)) as u8
        } else {
            BLOCKED
        }
    }

    /// Converts heights to terrain. O(size).
    ///
    /// # Errors
    /// A [`TerrainError::Parameter`] if the rule is invalid.
    pub fn apply(&self, heights: &Heights) -> Result<Terrain, TerrainError> {
        if self.classes == 0 {
            return Err(parameter_error("slope.classes is 0", "give the number of classes, 1..=255"));
        }
        if !(self.max_slope > 0.0 && self.max_slope.is_finite()) {
            return Err(parameter_error(
                format!("slope.max_slope is {}", self.max_slope),
                "give the steepest passable rise over run, more than 0, for example 0.5",
            ));
        }
        let (width, height) = (usize::from(heights.width), usize::from(heights.height));
        let at = |x: usize, y: usize| f64::from(heights.metres[y * width + x]);
        let mut cells = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let here = at(x, y);
                let west = (x > 0).then(|| at(x - 1, y));
                let east = (x + 1 < width).then(|| at(x + 1, y));
                let south = (y > 0).then(|| at(x, y - 1));
                let north = (y + 1 < height).then(|| at(x, y + 1));
                let along_x = gradient(west, here, east) / heights.cell_m;
                let along_y = gradient(south, here, north) / heights.cell_m;
                cells.push(self.impassability((along_x * along_x + along_y * along_y).sqrt()));
            }
        }
        let mut terrain = Terrain::from_cells(heights.width, heights.height, cells)?;
        terrain.cell_m = heights.cell_m;
        terrain.origin_m = heights.origin_m;
        terrain.mark_unknown(heights.metres.iter().map(|metre| metre.is_nan()));
        Ok(terrain)
    }
}

/// Rise per cell between the known neighbours; NaN if `here` is unknown.
fn gradient(before: Option<f64>, here: f64, after: Option<f64>) -> f64 {
    if here.is_nan() {
        return f64::NAN;
    }
    let known = |side: Option<f64>| side.filter(|metre| !metre.is_nan());
    match (known(before), known(after)) {
        (Some(before), Some(after)) => (after - before) / 2.0,
        (Some(before), None) => here - before,
        (None, Some(after)) => after - here,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heights(width: u16, metres: &[f32]) -> Heights {
        Heights {
            width,
            height: metres.len() as u16 / width,
            metres: metres.to_vec(),
            cell_m: 10.0,
            origin_m: [3.0, 4.0],
        }
    }

    const RULE: SlopeRule = SlopeRule { classes: 4, max_slope: 1.0 };

    #[test]
    fn classes_are_linear_up_to_the_maximum_slope() {
        let cases = [
            (0.0, 1),
            (0.249, 1),
            (0.25, 2),
            (0.75, 4),
            (1.0, 4),
            (1.001, BLOCKED),
            (f64::INFINITY, BLOCKED),
            (f64::NAN, BLOCKED),
        ];
        for (slope, expected) in cases {
            assert_eq!(RULE.impassability(slope), expected, "slope {slope}");
        }
        let finest = SlopeRule { classes: 255, ..RULE };
        assert_eq!(finest.impassability(1.0), 255);
    }

    #[test]
    fn a_plane_has_its_slope_everywhere() {
        // 3 m east and 4 m north per cell of 10 m: slope 0.5, class 1 + floor(4 * 0.5) = 3.
        let plane: Vec<f32> = (0..12).map(|at| (3 * (at % 4) + 4 * (at / 4)) as f32).collect();
        let terrain = RULE.apply(&heights(4, &plane)).unwrap();
        assert_eq!(terrain.cells(), [3; 12]);
        assert_eq!((terrain.cell_m, terrain.origin_m), (10.0, [3.0, 4.0]));
    }

    #[test]
    fn unknown_heights_are_blocked_and_neighbours_keep_their_slope() {
        let terrain = RULE.apply(&heights(3, &[0.0, 3.0, f32::NAN])).unwrap();
        assert_eq!(terrain.cells(), [2, 2, BLOCKED]);
        let is_unknown = [0, 1, 2].map(|x| terrain.is_unknown(staya_controller::grid::Cell::new(x, 0)));
        assert_eq!(is_unknown, [false, false, true]);
        let alone = RULE.apply(&heights(1, &[5.0])).unwrap();
        assert_eq!(alone.cells(), [1]);
    }

    #[test]
    fn an_invalid_rule_is_refused() {
        let land = heights(1, &[0.0]);
        for max_slope in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(SlopeRule { max_slope, ..RULE }.apply(&land).is_err());
        }
        assert!(SlopeRule { classes: 0, ..RULE }.apply(&land).is_err());
    }
}
