//! Land beyond the window: coarse tiles of what robots have seen, small enough for messages.
//!
//! A [`Tile`] stores the average cost of [`TILE`] x [`TILE`] cells and its age in one byte.
//! [`LandMap`] keeps a square of tiles: own observations ([`LandMap::see`]) and received ones
//! ([`LandMap::hear`]), sent as a [`LandPatch`] of 32 tiles ([`LandMap::say`]). Its
//! [`Outlook`] has the cheapest path onwards from each tile; [`crate::route`] prices the exits of
//! its window by it, or by [`CostToGo`], a table in flash, made from a map before the mission.
//! [`LandMap::write_costs`] makes such a table of the tiles, for the next mission on this land.
//!
//! The newer tile wins, of equally new ones the dearer, so that order and repetition of messages do
//! not matter. Own observations override messages for a quarter of the lifetime of tiles. A message
//! never adds a wall but only a high price that expires: a false report cannot wall a robot in.

pub mod cost_to_go;
mod map;
mod outlook;
mod tabled;
mod tile;

#[cfg(test)]
mod tests;

pub use cost_to_go::CostToGo;
pub use map::{LandMap, MapParams};
pub use outlook::{FarLand, Gains, Outlook};
pub use tile::{AGES, LandPatch, PATCH_HEIGHT, PATCH_TILES, PATCH_WIDTH, TILE, Tile};

use crate::grid::Cell;

/// The tile that contains a cell, in tiles.
#[must_use]
pub const fn tile_of(cell: Cell) -> Cell {
    Cell::new(cell.x >> tile::TILE_BITS, cell.y >> tile::TILE_BITS)
}
