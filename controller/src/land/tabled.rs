//! A table of costs to go of the tiles that robots have merged, made on board.

#[cfg(test)]
mod tests;

use super::cost_to_go::{Header, MOST};
use super::{Gains, LandMap, TILE, tile_of};
use crate::cost::{Cost, Gain};
use crate::grid::{Cell, DIAGONAL, Norm, UNIT};

/// Half cells from the centre of a tile to its border.
const HALF_TILE_HALVES: u32 = TILE.unsigned_abs() as u32;

impl<const T: usize> LandMap<T> {
    /// Writes a [`CostToGo`](super::CostToGo) of the tiles into `bytes` and returns its length:
    /// travel times to the goal of `table` on the land that `table` describes, by `nodes` nodes
    /// from its first to its last cell. The unit of `table` is ignored; the written one is the
    /// finest that fits.
    ///
    /// An unknown tile takes `unknown` ticks per cell; beside known ones, a mean of these and of
    /// `unknown`. No path leaves the land. A node lies on a cell, the centre of a tile between two.
    /// So the time of a node is the least over nine tiles: that of the centre, and the way to it.
    /// Two nodes per tile along each side are enough.
    ///
    /// `None` if no tile was ever known, the bytes are too few, or a field of `table` is out of
    /// range; the goal must be on the land. O(T + nodes), with 6 bytes per tile on the stack: call
    /// it when the goal or the map has changed, not at each step.
    #[must_use]
    #[inline(never)]
    pub fn write_costs(&self, table: &Header, unknown: Gain, norm: Norm, bytes: &mut [u8]) -> Option<usize> {
        if self.is_empty() {
            return None;
        }
        let ([columns, rows], [width, height]) = (table.nodes, table.cells);
        let last = |from: i16, cells: u16| from.saturating_add_unsigned(cells.saturating_sub(1));
        let (from, to) = (table.origin, Cell::new(last(table.origin.x, width), last(table.origin.y, height)));
        let (first, end) = (tile_of(from), tile_of(to));
        let is_land = |at: Cell| (first.x..=end.x).contains(&at.x) && (first.y..=end.y).contains(&at.y);
        let target = tile_of(table.goal);
        let search = self.search(&Gains { a0: Gain::ONE, a3: unknown, norm }, target, is_land);
        let time = |column: u8, row: u8| {
            let cell =
                Cell::new(place(column, columns, table.origin.x, width), place(row, rows, table.origin.y, height));
            let own = self.nearest(tile_of(cell));
            let price = |at: usize| search.price.get(at).copied().map_or(0, u32::from);
            let own_price = self.place_of(own).map_or(0, price);
            let beside = (-1..=1).flat_map(|y| (-1..=1).map(move |x| own + Cell::new(x, y)));
            let ways = beside.filter(|&at| is_land(at)).filter_map(|at| {
                let index = self.place_of(at)?;
                let halves = |cell: i16, goal: i16, tile: i16| {
                    let middle = if at == target { 2 * i32::from(goal) } else { 8 * i32::from(tile) + 3 };
                    (2 * i32::from(cell) - middle).unsigned_abs()
                };
                let (dx, dy) = (halves(cell.x, table.goal.x, at.x), halves(cell.y, table.goal.y, at.y));
                let (longer, shorter) = (dx.max(dy), dx.min(dy));
                let length = match norm {
                    Norm::Chebyshev => longer * UNIT,
                    Norm::Euclidean => (longer - shorter) * UNIT + shorter * DIAGONAL,
                };
                // The way through the other tile, then that through the own one.
                let there = if at == own { 0 } else { HALF_TILE_HALVES.min(longer) };
                let sum = u64::from(price(index) * there + own_price * (longer - there)) * u64::from(length);
                let way = sum.checked_div(u64::from(longer) << 1).unwrap_or(0);
                Some(search.cost.get(index)?.saturating_add(way.min(Cost::MAX.into()) as Cost))
            });
            ways.min().unwrap_or(Cost::MAX)
        };
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let most = nodes.map(|(column, row)| time(column, row)).max().unwrap_or(0);
        // A cost is in sixteenths of a unit, a count in 256ths.
        let unit = (u64::from(most) << 4).div_ceil(MOST.into()).max(1);
        let count = |column, row| (u64::from(time(column, row)) << 4).checked_div(unit).unwrap_or(0) as u16;
        Header { unit: unit as u32, ..*table }.write(bytes, count)
    }

    /// The tile of the square that is nearest to `at`.
    fn nearest(&self, at: Cell) -> Cell {
        let (origin, last) = (self.origin(), (1_i16 << Self::BITS) - 1);
        let along = |at: i16, from: i16| at.max(from).min(from.saturating_add(last));
        Cell::new(along(at.x, origin.x), along(at.y, origin.y))
    }

    /// Its number in a search.
    fn place_of(&self, at: Cell) -> Option<usize> {
        let side = 1_i32 << Self::BITS;
        let along = |at: i16, origin: i16| i32::from(at) - i32::from(origin);
        let (x, y) = (along(at.x, self.origin().x), along(at.y, self.origin().y));
        let is_inside = (0..side).contains(&x) && (0..side).contains(&y);
        is_inside.then_some((y << Self::BITS | x) as usize)
    }
}

/// The cell nearest to a node.
fn place(node: u8, nodes: u8, origin: i16, cells: u16) -> i16 {
    let steps = u32::from(nodes).saturating_sub(1);
    let way = u32::from(node) * u32::from(cells).saturating_sub(1);
    let offset = (2 * way + steps).checked_div(2 * steps).unwrap_or(0);
    origin.saturating_add_unsigned(offset as u16)
}
