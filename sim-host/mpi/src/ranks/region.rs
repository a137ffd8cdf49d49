//! The region of a rank's robots, by which others know which data it needs.

use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;
use staya_sim::world::border::CellBounds;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Bounds {
    low_m: [f64; 2],
    high_m: [f64; 2],
}

/// The actual positions of all radios and bodies on a rank, also of robots outside its block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Region {
    /// A rectangle around the robots, then a point for each other radio or body.
    parts: Vec<Bounds>,
    pub(super) cells: Option<CellBounds>,
}

const MARGIN: f64 = 1.0 + 1e-9;

impl Bounds {
    fn at(place_m: [f64; 2]) -> Self {
        Self { low_m: place_m, high_m: place_m }
    }

    fn squared_distance(&self, other: &Self) -> f64 {
        let off =
            |axis: usize| (self.low_m[axis] - other.high_m[axis]).max(other.low_m[axis] - self.high_m[axis]).max(0.0);
        off(0) * off(0) + off(1) * off(1)
    }
}

impl Region {
    pub(super) fn new(
        robots: impl Iterator<Item = ([f64; 2], Cell)> + Clone,
        others_m: impl Iterator<Item = [f64; 2]>,
    ) -> Self {
        let around = robots.clone().map(|(place_m, _)| place_m).fold(None, |bounds: Option<Bounds>, place_m| {
            let Bounds { low_m, high_m } = bounds.unwrap_or(Bounds::at(place_m));
            Some(Bounds {
                low_m: [0, 1].map(|axis| low_m[axis].min(place_m[axis])),
                high_m: [0, 1].map(|axis| high_m[axis].max(place_m[axis])),
            })
        });
        Self {
            parts: around.into_iter().chain(others_m.map(Bounds::at)).collect(),
            cells: CellBounds::around(robots.map(|(_, cell)| cell)),
        }
    }

    pub(super) fn is_near(&self, place_m: [f64; 2], reach_m: f64) -> bool {
        let place = Bounds::at(place_m);
        self.parts.iter().any(|part| part.squared_distance(&place) <= reach_m * reach_m * MARGIN)
    }

    /// Whether members of both regions may be within `reach_m` of each other; symmetric.
    pub(super) fn is_beside(&self, other: &Self, reach_m: f64) -> bool {
        let pairs = self.parts.iter().flat_map(|one| other.parts.iter().map(move |two| one.squared_distance(two)));
        pairs.into_iter().any(|squared| squared <= reach_m * reach_m * MARGIN)
    }

    pub(super) fn is_beside_in_cells(&self, other: &Self, reach: i16) -> bool {
        self.cells.zip(other.cells).is_some_and(|(one, two)| one.distance_to(&two) <= i32::from(reach))
    }
}
