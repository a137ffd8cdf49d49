//! Land beyond the window: what robots have seen of it, as coarse tiles that fit packets, and what a way across it costs.
//!
//! A [`Tile`] is what [`TILE`] x [`TILE`] cells cost on average, in a byte together with its age. [`LandMap`] keeps a square
//! of tiles around the robot: what it saw itself ([`LandMap::see`]) and what others told ([`LandMap::hear`]), a
//! [`LandPatch`] of 32 tiles per packet ([`LandMap::say`]). [`Outlook`] is the cheapest way on from each tile, by which
//! [`crate::route`] prices the exits of its window.
//!
//! Merging is by age: newer wins, and of equally new tiles the dearer one, so that neither the order nor the repetition of
//! packets changes what comes out. What the robot saw itself beats what it is told for a quarter of the time that tiles live. What is told
//! is never a wall but a high price, and it ages out: whoever lies makes detours, and cannot wall anybody in.

mod map;
mod outlook;
mod tile;

#[cfg(test)]
mod tests;

pub use map::{LandMap, MapParams};
pub use outlook::{FarLand, Gains, Outlook};
pub use tile::{AGES, LandPatch, PATCH_HEIGHT, PATCH_TILES, PATCH_WIDTH, TILE, Tile};

use crate::grid::Cell;

/// The tile that a cell lies in, in tiles.
#[must_use]
pub const fn tile_of(cell: Cell) -> Cell {
    Cell::new(cell.x >> tile::TILE_BITS, cell.y >> tile::TILE_BITS)
}
