//! Shares a map of the terrain with other robots and plans with it.

use crate::grid::{Cell, Window};
use crate::land::{FarLand, LandMap, LandPatch, MapParams};
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// Terrain beyond the window of a law on the grid: `()` for none, or a [`SharedMap`].
pub trait FarMap {
    /// Takes in the window of a robot in `cell` that goes to `goal`.
    fn see(&mut self, _window: &Window<'_>, _cell: Cell, _goal: Cell) {}

    /// The terrain to plan with, if it helps.
    fn land(&self) -> Option<&dyn FarLand> {
        None
    }

    /// Merges a patch of another robot's map.
    fn hear(&mut self, _patch: &LandPatch) {}

    /// Returns the patch to send after a beacon.
    fn say(&mut self, _now: Instant) -> Option<LandPatch> {
        None
    }
}

impl FarMap for () {}

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

/// Moves with the map without a new least distance to the goal.
const PATIENCE: u8 = 32;

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Progress {
    way: Option<(Cell, Cell)>,
    /// Squared distance.
    least: u64,
    idle: u8,
    patience: u8,
}

impl Progress {
    fn note(&mut self, cell: Cell, goal: Cell) {
        let before = self.way.replace((cell, goal));
        if before.is_none_or(|(_, old)| old != goal) {
            *self = Self { way: self.way, least: u64::MAX, idle: 0, patience: PATIENCE };
        }
        let distance = cell.distance_squared(goal);
        if distance < self.least {
            if self.idle > self.patience {
                self.patience >>= 2;
            }
            (self.least, self.idle) = (distance, 0);
        } else if before.is_some_and(|(here, _)| here != cell) {
            self.idle = self.idle.saturating_add(1);
        }
    }
}

impl<const T: usize> SharedMap<T> {
    /// Creates an empty map.
    #[must_use]
    pub fn new(params: MapParams) -> Self {
        Self { land: LandMap::new(), params, progress: Progress::default() }
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
        self.progress.note(cell, goal);
    }

    fn land(&self) -> Option<&dyn FarLand> {
        (self.progress.idle <= self.progress.patience).then_some(&self.land as &dyn FarLand)
    }

    fn hear(&mut self, patch: &LandPatch) {
        self.land.hear(patch);
    }

    fn say(&mut self, now: Instant) -> Option<LandPatch> {
        self.land.age(&self.params, now);
        self.land.say()
    }
}

/// For hosts, where only some robots share maps.
#[cfg(feature = "host")]
impl<H: FarMap> FarMap for Option<alloc::boxed::Box<H>> {
    fn see(&mut self, window: &Window<'_>, cell: Cell, goal: Cell) {
        if let Some(map) = self {
            map.see(window, cell, goal);
        }
    }

    fn land(&self) -> Option<&dyn FarLand> {
        self.as_ref()?.land()
    }

    fn hear(&mut self, patch: &LandPatch) {
        if let Some(map) = self {
            map.hear(patch);
        }
    }

    fn say(&mut self, now: Instant) -> Option<LandPatch> {
        self.as_mut()?.say(now)
    }
}
