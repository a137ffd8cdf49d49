//! Terrain from a formula: it takes no flash and is identical on host and device.

use heapless::Vec;
use staya_controller::grid::{BLOCKED, Cell, Window};

const SIGHT: i16 = 5;
pub(crate) const WINDOW: usize = 121;

/// A square map with one corner at (0, 0), surrounded by walls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Land {
    pub(crate) size: i16,
    /// Binary logarithm of the largest impassability.
    pub(crate) roughness_log2: u8,
    /// North-south walls: column, first and last row.
    pub(crate) walls: &'static [(i16, i16, i16)],
}

impl Land {
    pub(crate) fn at(&self, cell: Cell) -> u8 {
        let Cell { x, y } = cell;
        let is_inside = x >= 0 && y >= 0 && x < self.size && y < self.size;
        let is_wall = |&(column, first, last): &(i16, i16, i16)| x == column && (first..=last).contains(&y);
        if !is_inside || self.walls.iter().any(is_wall) {
            return BLOCKED;
        }
        let mut bits = (u32::from(x.cast_unsigned()) << 16) | u32::from(y.cast_unsigned());
        for _ in 0..2 {
            bits = (bits ^ (bits >> 15)).wrapping_mul(0x9E37_79B1);
        }
        let high = bits.checked_shr(32 - u32::from(self.roughness_log2));
        high.unwrap_or(0).saturating_add(1).min(255) as u8
    }

    pub(crate) fn window<'a>(&self, cell: Cell, cells: &'a mut Vec<u8, WINDOW>) -> Option<Window<'a>> {
        cells.clear();
        let origin = cell - Cell::new(SIGHT, SIGHT);
        let side = 2 * SIGHT + 1;
        for y in 0..side {
            for x in 0..side {
                let _ = cells.push(self.at(origin + Cell::new(x, y)));
            }
        }
        Window::new(cells, origin, side.unsigned_abs(), side.unsigned_abs())
    }
}
