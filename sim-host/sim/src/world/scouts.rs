//! Robots' knowledge of unseen terrain: a common map, and each robot's own observations.

use super::window::known_window;
use crate::terrain::Terrain;
use rayon::prelude::*;
use staya_controller::grid::{Cell, Window};
use staya_controller::route::LandMemory;
use std::sync::Arc;

/// Number of cells in which a robot's memory may differ from its map.
pub const REMEMBERED: usize = 1024;

/// Terrain memory of one robot.
pub type Memory = LandMemory<REMEMBERED>;

const BATCH: usize = 64;

/// Terrain that robots know before they see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Scouting {
    /// Common map; of the terrain's size.
    pub map: Arc<Terrain>,
    /// Range of sight, cells in each direction.
    pub sight: u8,
}

/// Terrain knowledge of all robots, by body index.
#[derive(Clone, Debug)]
pub struct Scouts {
    known: Scouting,
    radius: u8,
    memories: Vec<Memory>,
}

impl Scouts {
    /// Creates empty memories for `bodies` robots that plan on windows of `radius`.
    #[must_use]
    pub fn new(known: &Scouting, radius: u8, bodies: usize) -> Self {
        Self { known: known.clone(), radius, memories: vec![Memory::new(); bodies] }
    }

    /// Range of sight, cells.
    #[must_use]
    pub const fn sight(&self) -> u8 {
        self.known.sight
    }

    /// Terrain around `cell` as known by a robot: from sight, else memory, else the map.
    pub fn window<'a>(&self, land: &Terrain, index: usize, cell: Cell, buffer: &'a mut Vec<u8>) -> Option<Window<'a>> {
        let Scouting { map, sight } = &self.known;
        known_window(land, (map, &self.memories[index]), cell, [*sight, self.radius], buffer)
    }

    /// Adds the terrain in sight to the memories; `cell` maps a body to its cell, `None` off the
    /// map. O(bodies x cells in sight).
    pub fn observe(&mut self, land: &Terrain, cell: impl Fn(usize) -> Option<Cell> + Sync) {
        let Scouting { map, sight } = &self.known;
        let memories = self.memories.par_iter_mut().enumerate().with_min_len(BATCH);
        memories.for_each_init(Vec::new, |buffer, (index, memory)| {
            let Some(cell) = cell(index) else { return };
            if let Some(seen) = super::window(land, cell, *sight, buffer) {
                memory.observe(cell, &seen, |cell| map.get(cell));
            }
        });
    }

    /// Memory of a robot.
    #[must_use]
    pub fn memory(&self, index: usize) -> &Memory {
        &self.memories[index]
    }

    pub(crate) fn put(&mut self, index: usize, memory: Memory) {
        self.memories[index] = memory;
    }

    /// Reduces the number of bodies to `bodies`, before the first tick.
    pub fn keep(&mut self, bodies: usize) {
        self.memories.truncate(bodies);
    }

    /// Appends a body.
    pub fn admit(&mut self) {
        self.memories.push(Memory::new());
    }

    /// Removes a body; the last body takes its index.
    pub fn dismiss(&mut self, index: usize) {
        self.memories.swap_remove(index);
    }
}
