//! A tile in one byte, and 32 of them as a message.

use crate::fixint;
use crate::grid::{BLOCKED, Cell, Window};
use serde::{Deserialize, Serialize};

pub(super) const TILE_BITS: u32 = 2;
/// Cells along each side of a tile.
pub const TILE: i16 = 1 << TILE_BITS;
const CELLS: u32 = 1 << (2 * TILE_BITS);
/// Visible cells from which a tile is known.
const ENOUGH: u32 = CELLS >> 1;
/// Ages of a tile; beyond the last one it is forgotten.
pub const AGES: u8 = 16;

/// Sixteenths of a tick per cell; number 0 is an unknown tile.
const PRICES: [u16; 16] = [0, 16, 24, 32, 40, 48, 56, 64, 72, 80, 96, 112, 128, 176, 256, 512];
/// A wall cell in the mean, ticks: a tile of walls has the highest price.
const WALL_TICKS: u32 = 32;

/// Price and age of a tile: the number of the price in the low four bits, the age above them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(transparent)]
pub struct Tile(u8);

impl Tile {
    /// An unknown tile.
    pub const UNKNOWN: Self = Self(0);

    /// A tile just seen, with the price nearest to `ticks_16` sixteenths of a tick per cell.
    #[must_use]
    pub fn new(ticks_16: u16) -> Self {
        let known = PRICES.iter().zip(0_u8..).skip(1);
        let nearest = known.min_by_key(|&(price, _)| price.abs_diff(ticks_16));
        Self(nearest.map_or(0, |(_, number)| number))
    }

    /// The tile `at` as seen in the window; `None` if too little is visible. O(cells of a tile).
    #[must_use]
    pub fn seen(window: &Window<'_>, at: Cell) -> Option<Self> {
        let south_west = Cell::new(at.x << TILE_BITS, at.y << TILE_BITS);
        let cells = (0..TILE).flat_map(|y| (0..TILE).map(move |x| Cell::new(x, y)));
        let (mut seen, mut ticks) = (0_u32, 0_u32);
        for u in cells.filter_map(|cell| window.get(south_west + cell)) {
            seen += 1;
            ticks += if u == BLOCKED { WALL_TICKS } else { u32::from(u).min(WALL_TICKS) };
        }
        let mean = (ticks << 4).checked_div(seen).filter(|_| seen >= ENOUGH)?;
        Some(Self::new(mean as u16))
    }

    /// Its price, sixteenths of a tick per cell; `None` if it is unknown.
    #[must_use]
    pub fn ticks_16(self) -> Option<u16> {
        PRICES.get(usize::from(self.level())).copied().filter(|_| self.is_known())
    }

    /// Whether the tile is known.
    #[must_use]
    pub const fn is_known(self) -> bool {
        self.level() != 0
    }

    /// Its age, 0..[`AGES`].
    #[must_use]
    pub const fn age(self) -> u8 {
        self.0 >> 4
    }

    pub(super) const fn level(self) -> u8 {
        self.0 & 0xF
    }

    /// The tile one age older; unknown if it had the last age.
    #[must_use]
    pub const fn older(self) -> Self {
        match self.0.checked_add(1 << 4) {
            Some(byte) if self.is_known() => Self(byte),
            _ => Self::UNKNOWN,
        }
    }

    /// The better of two tiles: known before unknown, then newer, then dearer. Commutative.
    #[must_use]
    pub fn merged(self, other: Self) -> Self {
        let worth = |tile: Self| (tile.is_known(), AGES.saturating_sub(tile.age()), tile.level());
        if worth(self) >= worth(other) { self } else { other }
    }
}

/// Tiles of a patch from west to east.
pub const PATCH_WIDTH: i16 = 8;
/// Tiles of a patch from south to north.
pub const PATCH_HEIGHT: i16 = 4;
/// Tiles of a patch.
pub const PATCH_TILES: usize = PATCH_WIDTH as usize * PATCH_HEIGHT as usize;

/// A piece of a robot's map, 32 x 16 cells, for [`LandMap::hear`](super::LandMap::hear).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LandPatch {
    /// The south-west tile, in tiles.
    #[serde(with = "fixint")]
    pub corner: Cell,
    /// The tiles, row by row from there.
    pub tiles: [Tile; PATCH_TILES],
}

impl LandPatch {
    /// The tiles with their positions, in tiles. A position beyond the range of coordinates wraps.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, Tile)> + '_ {
        let places = (0..PATCH_HEIGHT).flat_map(|y| (0..PATCH_WIDTH).map(move |x| Cell::new(x, y)));
        places.zip(self.tiles).map(|(place, tile)| (self.corner + place, tile))
    }

    /// The tiles as bytes.
    #[must_use]
    pub fn bytes(&self) -> [u8; PATCH_TILES] {
        self.tiles.map(|Tile(byte)| byte)
    }

    /// The inverse of [`LandPatch::bytes`]; any bytes are valid tiles.
    #[must_use]
    pub fn from_bytes(corner: Cell, bytes: [u8; PATCH_TILES]) -> Self {
        Self { corner, tiles: bytes.map(Tile) }
    }
}
