//! Shares a map of the terrain with other robots and plans with it.

use super::FarMap;
use super::far_map::Progress;
use crate::grid::{Cell, Window};
use crate::land::{FarLand, LandMap, LandPatch, MapParams};
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// A [`LandMap`] of `T` tiles beyond the window, shared by one patch per beacon. Laws on the grid
/// price window exits by it while they lead.
///
/// False reports cost only time, at most 42 moves per goal plus the ways back: the robot stops
/// using the map after 32 moves without a new least distance to its goal, then after a quarter of
/// that.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SharedMap<const T: usize> {
    land: LandMap<T>,
    params: MapParams,
    progress: Progress,
}

impl<const T: usize> SharedMap<T> {
    /// Creates an empty map.
    #[must_use]
    pub fn new(params: MapParams) -> Self {
        Self { land: LandMap::new(), params, progress: Progress::NONE }
    }

    /// The map itself.
    #[must_use]
    pub const fn inside(&self) -> &LandMap<T> {
        &self.land
    }
}

impl<const T: usize> FarMap for SharedMap<T> {
    fn see(&mut self, window: &Window<'_>, cell: Cell, goal: Cell) {
        self.land.see(window, cell);
        self.progress.note(cell, goal, cell.distance_squared(goal));
    }

    fn land(&self) -> Option<&dyn FarLand> {
        self.progress.is_made().then_some(&self.land as &dyn FarLand)
    }

    fn hear(&mut self, patch: &LandPatch) {
        self.land.hear(patch);
    }

    fn say(&mut self, now: Instant) -> Option<LandPatch> {
        self.land.age(&self.params, now);
        self.land.say()
    }
}
