use crate::cost::Cost;
use crate::grid::Cell;
use crate::list::SparseVec;
use serde::{Deserialize, Serialize};

/// Least costs to the target of up to `L` cells that cost more than the straight path; a full
/// memory forgets the cell farthest from the robot. 8 bytes per cell.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LearnedCosts<const L: usize> {
    costs: SparseVec<(Cell, Cost), L>,
}

impl<const L: usize> LearnedCosts<L> {
    /// Creates an empty memory.
    #[must_use]
    pub const fn new() -> Self {
        Self { costs: SparseVec::new() }
    }

    /// The cells with their least costs, in no order.
    #[must_use]
    pub fn as_slice(&self) -> &[(Cell, Cost)] {
        &self.costs
    }

    /// The cells with their least costs.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, Cost)> + '_ {
        self.costs.iter().copied()
    }

    /// Stores that the route from `cell` costs at least `cost`. A full memory forgets the cell
    /// farthest from `here`, which may be `cell` itself. O(L).
    pub fn raise(&mut self, cell: Cell, cost: Cost, here: Cell) {
        if let Some((_, known)) = self.costs.iter_mut().find(|(at, _)| *at == cell) {
            *known = cost.max(*known);
        } else if self.costs.push((cell, cost)).is_err() {
            let farthest = self.costs.iter_mut().max_by_key(|(at, _)| at.chebyshev(here));
            if let Some(slot) = farthest.filter(|(at, _)| at.chebyshev(here) > cell.chebyshev(here)) {
                *slot = (cell, cost);
            }
        }
    }

    /// Forgets everything, as for a new target.
    pub fn clear(&mut self) {
        self.costs.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: i16) -> Cell {
        Cell::new(x, 0)
    }

    #[test]
    fn costs_only_rise_and_a_full_memory_forgets_the_farthest_cell() {
        let mut learned = LearnedCosts::<2>::new();
        learned.raise(at(9), 5, at(0));
        learned.raise(at(1), 7, at(0));
        learned.raise(at(1), 6, at(0));
        assert!(learned.iter().eq([(at(9), 5), (at(1), 7)]));
        learned.raise(at(3), 8, at(0));
        assert!(learned.iter().eq([(at(3), 8), (at(1), 7)]));
        learned.raise(at(4), 9, at(0));
        assert!(learned.iter().eq([(at(3), 8), (at(1), 7)]), "the new one is the farthest");
    }

    #[test]
    fn a_memory_of_capacity_zero_works() {
        let mut learned = LearnedCosts::<0>::new();
        learned.raise(at(1), 7, at(0));
        assert_eq!(learned.iter().count(), 0);
    }
}
