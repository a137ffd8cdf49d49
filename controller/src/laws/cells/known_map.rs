//! Plans with the cost-to-go of a map that is known before the mission.

use super::FarMap;
use super::far_map::Progress;
use crate::grid::{Cell, Window};
use crate::land::{CostToGo, FarLand};
use core::fmt::Debug;
use serde::Serialize;

/// A [`CostToGo`] in flash (`B` is `&'static [u8]`), by which laws on the grid price the exits of
/// their windows on the way to its goal; with other goals they plan without it.
///
/// A map that is wrong costs only time: the robot stops using it after 32 moves that bring no new
/// least cost to go, then after a quarter of that.
#[derive(Clone, Debug, Serialize)]
#[serde(bound(serialize = "B: AsRef<[u8]>"))]
#[cfg_attr(feature = "host", derive(serde::Deserialize))]
#[cfg_attr(feature = "host", serde(bound(deserialize = "B: AsRef<[u8]> + From<alloc::vec::Vec<u8>>")))]
pub struct KnownMap<B> {
    table: CostToGo<B>,
    progress: Progress,
    is_for_goal: bool,
}

impl<B> KnownMap<B> {
    /// Creates the map.
    #[must_use]
    pub const fn new(table: CostToGo<B>) -> Self {
        Self { table, progress: Progress::NONE, is_for_goal: false }
    }
}

impl<B: AsRef<[u8]> + Debug> FarMap for KnownMap<B> {
    fn see(&mut self, _window: &Window<'_>, cell: Cell, goal: Cell) {
        self.is_for_goal = goal == self.table.header().goal;
        if self.is_for_goal {
            self.progress.note(cell, goal, self.table.at(cell));
        }
    }

    fn land(&self) -> Option<&dyn FarLand> {
        (self.is_for_goal && self.progress.is_made()).then_some(&self.table as &dyn FarLand)
    }
}
