//! Tasks that Staya and comparable crates both solve, with equal results.

pub mod crowd;
pub mod drones;
pub mod flockers;
pub mod swarm;

use pathfinding::prelude::dijkstra_all;
use staya_controller::cost::{Cost, Gain};
use staya_controller::grid::{BLOCKED, Cell, Dir, Window};
use staya_controller::route::{CostField, RouteParams, VisitMemory};
use std::collections::HashMap;

/// A square window of terrain with a robot and its target.
pub struct Task {
    cells: Vec<u8>,
    side: u16,
    from: Cell,
    target: Cell,
}

impl Task {
    /// Creates natural terrain as in KUZ section 5: `peaks` cells of impassability 9, falling by
    /// one per cell of distance down to 1, with robot and target in opposite quadrants.
    #[must_use]
    pub fn natural(side: u16, peaks: usize, walls: usize, seed: u64) -> Self {
        let mut state = seed;
        let mut below = |limit: u16| {
            // Knuth's MMIX generator.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % u64::from(limit)) as i16
        };
        let quarter = (side / 4).max(1);
        let from = Cell::new(below(quarter), below(quarter));
        let far = (side - quarter).cast_signed();
        let target = Cell::new(far + below(quarter), far + below(quarter));
        let mut scatter = |n| -> Vec<Cell> { (0..n).map(|_| Cell::new(below(side), below(side))).collect() };
        let (peaks, walls) = (scatter(peaks), scatter(walls));
        let height = |cell: Cell| {
            let nearest = peaks.iter().map(|peak| cell.distance_squared(*peak)).min();
            let distance = nearest.map_or(u64::MAX, u64::isqrt);
            9_u64.saturating_sub(distance).max(1) as u8
        };
        let all = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        let cells = all
            .map(|(x, y)| Cell::new(x.cast_signed(), y.cast_signed()))
            .map(|cell| {
                let wall = walls.contains(&cell) && cell != from && cell != target;
                if wall { BLOCKED } else { height(cell) }
            })
            .collect();
        Self { cells, side, from, target }
    }

    /// The cells of the window.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let side = self.side.cast_signed();
        (0..side).flat_map(move |y| (0..side).map(move |x| Cell::new(x, y)))
    }

    /// Computes the cost of travel to the target from every cell with Staya.
    pub fn staya<const CELLS: usize>(&self, field: &mut CostField<CELLS>) {
        let window = Window::new(&self.cells, Cell::default(), self.side, self.side);
        let none: Option<&VisitMemory<0>> = None;
        let (from, target) = (self.from, self.target);
        if let Some(window) = window {
            let _ = field.weights(&self.params(), &window, from, target, [], none);
            field.complete(&self.params());
        }
    }

    /// Computes the same costs with the `pathfinding` crate, without unreachable cells.
    pub fn pathfinding(&self) -> impl Iterator<Item = (Cell, Cost)> + use<> {
        // No route uses the robot's own cell.
        let others = |(cell, _): &(Cell, Cost)| *cell != self.from;
        let field = dijkstra_all(&self.target, |&cell| self.moves_into(cell).filter(others));
        field.into_iter().map(|(cell, (_, cost))| (cell, cost))
    }

    fn params(&self) -> RouteParams {
        RouteParams {
            radius: u8::try_from(self.side).unwrap_or(u8::MAX),
            a1: Gain::ZERO,
            a2: Gain::ZERO,
            a3: Gain::ZERO,
            ..RouteParams::default()
        }
    }

    fn moves_into(&self, cell: Cell) -> impl Iterator<Item = (Cell, Cost)> {
        let params = self.params();
        let u = u32::from(self.get(cell));
        Dir::MOVES.into_iter().filter_map(move |dir| {
            let before = cell - dir.offset();
            let corner = !dir.is_diagonal()
                || self.get(Cell::new(before.x, cell.y)) != BLOCKED && self.get(Cell::new(cell.x, before.y)) != BLOCKED;
            let open = corner && self.get(before) != BLOCKED;
            open.then(|| (before, params.a0.of(dir.length(params.norm) * u)))
        })
    }

    fn get(&self, cell: Cell) -> u8 {
        let side = self.side.cast_signed();
        if cell.x < 0 || cell.y < 0 || cell.x >= side || cell.y >= side {
            return BLOCKED;
        }
        let at = usize::from(cell.y.cast_unsigned()) * usize::from(self.side);
        self.cells[at + usize::from(cell.x.cast_unsigned())]
    }

    /// Checks that both find the same costs and returns the number of cells with a route. `None` if
    /// the robot itself has none: Staya then answers another question, how to leave the window.
    ///
    /// # Panics
    /// If the costs differ.
    pub fn assert_equal<const CELLS: usize>(&self, field: &mut CostField<CELLS>) -> Option<usize> {
        let mut theirs: HashMap<Cell, Cost> = self.pathfinding().collect();
        theirs.insert(self.target, 0); // the peer omits its start
        let mut first_moves = theirs.keys().flat_map(|&cell| self.moves_into(cell));
        if !first_moves.any(|(cell, _)| cell == self.from) {
            return None;
        }
        self.staya(field);
        for cell in self.cells() {
            let wanted = theirs.get(&cell).copied();
            assert_eq!(field.cost(cell), wanted, "from {cell:?} to {:?}", self.target);
        }
        Some(theirs.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cost_fields_are_equal_on_open_land() {
        let mut field = CostField::<{ 34 * 34 }>::new();
        for seed in 0..20 {
            let reached = Task::natural(16, 4, 0, seed).assert_equal(&mut field);
            assert_eq!(reached, Some(16 * 16 - 1), "all but the robot's own cell");
            let reached = Task::natural(32, 12, 0, seed).assert_equal(&mut field);
            assert_eq!(reached, Some(32 * 32 - 1));
        }
    }

    #[test]
    fn cost_fields_are_equal_among_walls() {
        let mut field = CostField::<{ 34 * 34 }>::new();
        let mut compared = 0;
        for seed in 0..200 {
            let side = 3 + (seed % 30) as u16;
            let walls = usize::from(side * side) / 4;
            let task = Task::natural(side, 3, walls, seed);
            compared += u32::from(task.assert_equal(&mut field).is_some());
        }
        assert!(compared > 100, "only {compared} of 200 robots had a way");
    }
}
