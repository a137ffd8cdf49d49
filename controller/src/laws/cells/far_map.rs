//! Terrain beyond the window of laws on the grid.

use crate::grid::{Cell, Window};
use crate::land::{FarLand, LandPatch};
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// Terrain beyond the window of a law on the grid: `()` for none, a
/// [`SharedMap`](super::SharedMap), a [`KnownMap`](super::KnownMap), or both as a pair.
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

/// The first one that helps.
impl<A: FarMap, B: FarMap> FarMap for (A, B) {
    fn see(&mut self, window: &Window<'_>, cell: Cell, goal: Cell) {
        self.0.see(window, cell, goal);
        self.1.see(window, cell, goal);
    }

    fn land(&self) -> Option<&dyn FarLand> {
        self.0.land().or_else(|| self.1.land())
    }

    fn hear(&mut self, patch: &LandPatch) {
        self.0.hear(patch);
        self.1.hear(patch);
    }

    fn say(&mut self, now: Instant) -> Option<LandPatch> {
        self.0.say(now).or_else(|| self.1.say(now))
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

/// Moves with the map without a new least distance to the goal.
const PATIENCE: u8 = 32;

/// Whether a map brings the robot nearer to its goal.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Progress {
    way: Option<(Cell, Cell)>,
    least: u64,
    idle: u8,
    patience: u8,
}

impl Progress {
    pub(super) const NONE: Self = Self { way: None, least: 0, idle: 0, patience: 0 };

    /// Notes the robot's `cell` and how much is left to the `goal`, in any unit.
    pub(super) fn note(&mut self, cell: Cell, goal: Cell, left: u64) {
        let before = self.way.replace((cell, goal));
        if before.is_none_or(|(_, old)| old != goal) {
            *self = Self { way: self.way, least: u64::MAX, idle: 0, patience: PATIENCE };
        }
        if left < self.least {
            if self.idle > self.patience {
                self.patience >>= 2;
            }
            (self.least, self.idle) = (left, 0);
        } else if before.is_some_and(|(here, _)| here != cell) {
            self.idle = self.idle.saturating_add(1);
        }
    }

    /// Whether to use the map.
    pub(super) const fn is_made(&self) -> bool {
        self.idle <= self.patience
    }
}
