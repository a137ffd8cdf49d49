//! Land beyond the window: coarse tiles of what robots have seen, small enough for messages, and
//! the cost of a path across them.
//!
//! A [`Tile`] stores the average cost of [`TILE`] x [`TILE`] cells and its age in one byte.
//! [`LandMap`] keeps a square of tiles around the robot: its own observations ([`LandMap::see`])
//! and those received ([`LandMap::hear`]) as a [`LandPatch`] of 32 tiles per message
//! ([`LandMap::say`]). [`Outlook`] is the cheapest path onwards from each tile; [`crate::route`]
//! uses it to price the exits of its window.
//!
//! Merging is by age: the newer tile wins, and of equally new ones the dearer, so that neither the
//! order nor the repetition of messages changes the result. The robot's own observations override
//! messages for a quarter of the lifetime of tiles. A message never adds a wall but only a high
//! price, and it expires: a false report causes detours, but cannot wall a robot in.

mod map;
mod outlook;
mod tile;

#[cfg(test)]
mod tests;

pub use map::{LandMap, MapParams};
pub use outlook::{FarLand, Gains, Outlook};
pub use tile::{AGES, LandPatch, PATCH_HEIGHT, PATCH_TILES, PATCH_WIDTH, TILE, Tile};

use crate::grid::Cell;

/// The tile that contains a cell, in tiles.
#[must_use]
pub const fn tile_of(cell: Cell) -> Cell {
    Cell::new(cell.x >> tile::TILE_BITS, cell.y >> tile::TILE_BITS)
}
