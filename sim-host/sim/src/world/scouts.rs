//! What robots know of land that they do not see: their common map, and what each has seen otherwise.

use super::window::known_window;
use crate::terrain::Terrain;
use rayon::prelude::*;
use staya_controller::grid::{Cell, Window};
use staya_controller::route::LandMemory;
use std::sync::Arc;

/// Cells that a robot remembers otherwise than its map has them.
pub const REMEMBERED: usize = 1024;

/// What one robot remembers of the land.
pub type Memory = LandMemory<REMEMBERED>;

/// Robots that a thread takes at least at a time.
const BATCH: usize = 64;

/// What robots know of the land before they see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Scouting {
    /// Their map; of the land's size.
    pub map: Arc<Terrain>,
    /// How far they see, cells in each direction.
    pub sight: u8,
}

/// What robots know of the land, by their bodies here.
#[derive(Clone, Debug)]
pub struct Scouts {
    known: Scouting,
    radius: u8,
    memories: Vec<Memory>,
}

impl Scouts {
    /// Of so many bodies that plan on windows of `radius`.
    #[must_use]
    pub fn new(known: &Scouting, radius: u8, bodies: usize) -> Self {
        Self { known: known.clone(), radius, memories: vec![Memory::new(); bodies] }
    }

    /// How far robots see, cells.
    #[must_use]
    pub const fn sight(&self) -> u8 {
        self.known.sight
    }

    /// What the robot of body `index` takes the land around `cell` to be: what it sees of it, else what it has seen, else its map.
    pub fn window<'a>(&self, land: &Terrain, index: usize, cell: Cell, buffer: &'a mut Vec<u8>) -> Option<Window<'a>> {
        let Scouting { map, sight } = &self.known;
        known_window(land, (map, &self.memories[index]), cell, [*sight, self.radius], buffer)
    }

    /// Takes note of what robots see where they are; `cells` by body, none off the map. O(bodies x cells in sight).
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

    /// What a robot remembers.
    #[must_use]
    pub fn memory(&self, index: usize) -> &Memory {
        &self.memories[index]
    }

    /// Replaces it.
    pub(crate) fn put(&mut self, index: usize, memory: Memory) {
        self.memories[index] = memory;
    }

    /// Keeps so many bodies, before the first tick.
    pub fn keep(&mut self, bodies: usize) {
        self.memories.truncate(bodies);
    }

    /// A body comes, behind those that are here.
    pub fn admit(&mut self) {
        self.memories.push(Memory::new());
    }

    /// A body goes; the last one takes its place.
    pub fn dismiss(&mut self, index: usize) {
        self.memories.swap_remove(index);
    }
}
