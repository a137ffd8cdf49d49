//! Terrain windows around a robot.

use super::World;
use crate::terrain::Terrain;
use staya_controller::grid::{BLOCKED, Cell, Window};
use staya_controller::route::{LandMemory, supposed};

impl World {
    /// The square of `2 * radius + 1` cells a side around `cell`, written to `buffer`; cells
    /// outside the map are walls. `None` if `cell` is not on the map. O(radius^2).
    #[must_use]
    pub fn window<'a>(&self, cell: Cell, radius: u8, buffer: &'a mut Vec<u8>) -> Option<Window<'a>> {
        window(&self.terrain, cell, radius, buffer)
    }
}

/// The window of [`World::window`] for any terrain.
#[must_use]
pub fn window<'a>(terrain: &Terrain, cell: Cell, radius: u8, buffer: &'a mut Vec<u8>) -> Option<Window<'a>> {
    window_but(terrain, cell, radius, &[], buffer)
}

/// The window of [`World::window`] with some cells replaced; later replacements win.
#[must_use]
pub fn window_but<'a>(
    terrain: &Terrain,
    cell: Cell,
    radius: u8,
    but: &[(Cell, u8)],
    buffer: &'a mut Vec<u8>,
) -> Option<Window<'a>> {
    let origin = copy(terrain, cell, radius, buffer)?;
    let side = 2 * u16::from(radius) + 1;
    put(buffer, origin, side, but.iter().copied());
    Window::new(buffer, origin, side, side)
}

/// Terrain window of a robot that sees `sight` cells far and plans on `radius` cells: `land` within
/// sight, then the memory, then the map, of the same size. `None` off the map. O(radius^2 + N).
#[must_use]
pub fn known_window<'a, const N: usize>(
    land: &Terrain,
    (map, memory): (&Terrain, &LandMemory<N>),
    cell: Cell,
    [sight, radius]: [u8; 2],
    buffer: &'a mut Vec<u8>,
) -> Option<Window<'a>> {
    let origin = copy(map, cell, radius, buffer)?;
    let side = 2 * u16::from(radius) + 1;
    let closed = |at: usize| origin + Cell::new((at % usize::from(side)) as i16, (at / usize::from(side)) as i16);
    for (at, class) in buffer.iter_mut().enumerate().filter(|(_, class)| **class == BLOCKED) {
        if map.index(closed(at)).is_some() {
            *class = supposed(*class);
        }
    }
    memory.overlay(origin, side, buffer);
    let reach = i16::from(sight.min(radius));
    let rows = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| Cell::new(x, y)));
    put(buffer, origin, side, rows.map(|off| cell + off).map(|cell| (cell, land.get(cell))));
    Window::new(buffer, origin, side, side)
}

fn copy(terrain: &Terrain, cell: Cell, radius: u8, buffer: &mut Vec<u8>) -> Option<Cell> {
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
    Some(origin)
}

fn put(buffer: &mut [u8], origin: Cell, side: u16, cells: impl Iterator<Item = (Cell, u8)>) {
    for (cell, class) in cells {
        let at = |at: i16, from: i16| u16::try_from(i32::from(at) - i32::from(from)).ok().filter(|&at| at < side);
        if let (Some(x), Some(y)) = (at(cell.x, origin.x), at(cell.y, origin.y)) {
            buffer[usize::from(y) * usize::from(side) + usize::from(x)] = class;
        }
    }
}

/// Part of `at - reach ..= at + reach` inside `0..length`, with the lengths before and after it.
fn span(at: i16, reach: i16, length: u16) -> (usize, std::ops::Range<usize>, usize) {
    let (first, end) = (i32::from(at) - i32::from(reach), i32::from(at) + i32::from(reach) + 1);
    let (low, high) = (first.max(0), end.min(i32::from(length)));
    ((low - first) as usize, low as usize..high as usize, (end - high) as usize)
}
