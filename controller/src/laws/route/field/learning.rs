//! The search that learns from its result; see [`Router`](crate::route::Router).

use super::{CostField, Query, Unreachable};
use crate::cost::{Cost, Weights};
use crate::grid::Cell;
use crate::route::{LearnedCosts, RouteParams};

impl<const CELLS: usize> CostField<CELLS> {
    /// Weights of the eight moves on the loaded window, for land without robots and visits. Learns
    /// a lower bound of the cost from each visible cell; the straight path costs `easiest` times
    /// its length. O(L w h) with a memory of L cells.
    ///
    /// # Errors
    /// As for [`CostField::weights`].
    pub(in crate::laws::route) fn learn<const L: usize>(
        &mut self,
        params: &RouteParams,
        (from, target): (Cell, Cell),
        easiest: u8,
        learned: &mut LearnedCosts<L>,
    ) -> Result<Weights, Unreachable> {
        for (cell, least) in learned.iter() {
            if let Some(extra) = self.index(cell).and_then(|at| self.extra.get_mut(at)) {
                *extra = least;
            }
        }
        self.learns = true;
        let straight = |cell: Cell| params.a0.of(u32::from(easiest).saturating_mul(cell.distance(target, params.norm)));
        let weights = self.solve_learning(params, (from, target), &straight)?;
        let own = weights.best().map(|dir| weights.get(dir));
        for row in 1..self.height.saturating_sub(1) {
            for column in 1..self.width.saturating_sub(1) {
                let cell = self.origin + Cell::new(column.cast_signed(), row.cast_signed());
                let cost = if cell == from { own } else { self.cost(cell) };
                let known = self.index(cell).and_then(|at| self.extra.get(at)).copied().unwrap_or(0);
                if let Some(cost) = cost.filter(|&cost| cost > known.max(straight(cell))) {
                    learned.raise(cell, cost, from);
                }
            }
        }
        Ok(weights)
    }

    #[inline(never)]
    fn solve_learning(
        &mut self,
        params: &RouteParams,
        (from, target): (Cell, Cell),
        straight: &dyn Fn(Cell) -> Cost,
    ) -> Result<Weights, Unreachable> {
        let from_index = self.index(from).ok_or(Unreachable)?;
        let query = Query { params, from: from_index, from_cell: from, target };
        if let Some(inside) = self.index(target) {
            self.search_from(&query, Some(inside));
            self.complete(params);
            let weights = self.outgoing(&query);
            if weights.best().is_some() {
                return Ok(weights);
            }
        }
        self.begin(&query);
        for cell in self.border() {
            if let Some(at) = self.index(cell) {
                let least = self.extra.get(at).copied().unwrap_or(0);
                self.offer(at, straight(cell).max(least));
            }
        }
        self.search(&query);
        self.complete(params);
        let weights = self.outgoing(&query);
        weights.best().map(|_| weights).ok_or(Unreachable)
    }
}
