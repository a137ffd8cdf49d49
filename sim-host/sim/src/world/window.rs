//! What a robot sees of the terrain.

use super::World;
use crate::terrain::Terrain;
use staya_controller::grid::{BLOCKED, Cell, Window};

impl World {
    /// The square of `2 * radius + 1` cells a side around `cell`, written into `buffer`. Cells
    /// outside the map are walls, so that every window has the same size. `None` when `cell` itself
    /// is not on the map. O(radius^2).
    #[must_use]
    pub fn window<'a>(&self, cell: Cell, radius: u8, buffer: &'a mut Vec<u8>) -> Option<Window<'a>> {
        window(&self.terrain, cell, radius, buffer)
    }
}

/// As [`World::window`], of any land.
#[must_use]
pub fn window<'a>(terrain: &Terrain, cell: Cell, radius: u8, buffer: &'a mut Vec<u8>) -> Option<Window<'a>> {
    terrain.index(cell)?;
    let reach = i16::from(radius);
    let side = 2 * u16::from(radius) + 1;
    let origin = cell - Cell::new(reach, reach);
    let row_length = usize::from(terrain.width());
    let (before, columns, after) = span(cell.x, reach, terrain.width());
    buffer.clear();
    for y in i32::from(origin.y)..i32::from(origin.y) + i32::from(side) {
        let row = usize::try_from(y).ok().filter(|&row| row < usize::from(terrain.height()));
        let Some(row) = row else {
            buffer.resize(buffer.len() + usize::from(side), BLOCKED);
            continue;
        };
        let row = &terrain.cells()[row * row_length..][..row_length];
        buffer.resize(buffer.len() + before, BLOCKED);
        buffer.extend_from_slice(&row[columns.clone()]);
        buffer.resize(buffer.len() + after, BLOCKED);
    }
    Window::new(buffer, origin, side, side)
}

/// The part of `at - reach ..= at + reach` inside `0..length`, and how much of it lies before and after.
fn span(at: i16, reach: i16, length: u16) -> (usize, std::ops::Range<usize>, usize) {
    let (first, end) = (i32::from(at) - i32::from(reach), i32::from(at) + i32::from(reach) + 1);
    let (low, high) = (first.max(0), end.min(i32::from(length)));
    ((low - first) as usize, low as usize..high as usize, (end - high) as usize)
}
