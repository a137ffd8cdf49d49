use crate::grid::Cell;
use crate::list::SparseVec;
use serde::{Deserialize, Serialize};

/// How often the robot entered each of the last `M` different cells (eq. 9); a full memory forgets
/// the cell that was entered longest ago. 6 bytes per cell.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct VisitMemory<const M: usize> {
    visits: SparseVec<(Cell, u8), M>,
}

impl<const M: usize> VisitMemory<M> {
    /// Creates an empty memory.
    #[must_use]
    pub const fn new() -> Self {
        Self { visits: SparseVec::new() }
    }

    /// Counts one entry into `cell`. O(M).
    pub fn enter(&mut self, cell: Cell) {
        let known = self.visits.iter().position(|&(at, _)| at == cell);
        let goes = known.or_else(|| self.visits.is_full().then_some(0));
        let gone = goes.and_then(|at| {
            to_end(&mut self.visits, at);
            self.visits.pop()
        });
        let count = gone.filter(|&(at, _)| at == cell).map_or(0, |(_, count)| count);
        // Fails only for M = 0.
        let _ = self.visits.push((cell, count.saturating_add(1)));
    }

    /// Remembered entries into `cell`. O(M).
    #[must_use]
    pub fn count(&self, cell: Cell) -> u8 {
        self.iter().find(|&(at, _)| at == cell).map_or(0, |(_, count)| count)
    }

    /// The remembered cells with their counts, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, u8)> + '_ {
        self.visits.iter().copied()
    }

    /// Forgets everything, as for a new target.
    pub fn clear(&mut self) {
        self.visits.clear();
    }
}

fn to_end<T>(items: &mut [T], at: usize) {
    let mut rest = items.get_mut(at..).unwrap_or_default();
    while let [item, next, ..] = rest {
        core::mem::swap(item, next);
        rest = rest.get_mut(1..).unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_item_moves_to_the_end_and_the_others_keep_their_order() {
        let mut items = [1, 3, 4, 5, 7];
        to_end(&mut items, 1);
        assert_eq!(items, [1, 4, 5, 7, 3]);
        to_end(&mut items, 4);
        to_end(&mut items, 9);
        assert_eq!(items, [1, 4, 5, 7, 3]);
        to_end::<u8>(&mut [], 0);
    }

    #[test]
    fn full_memory_forgets_the_cell_entered_longest_ago() {
        let mut memory = VisitMemory::<2>::new();
        let [a, b, c] = [Cell::new(0, 0), Cell::new(1, 0), Cell::new(2, 0)];
        memory.enter(a);
        memory.enter(b);
        memory.enter(a);
        memory.enter(c);
        assert_eq!([a, b, c].map(|cell| memory.count(cell)), [2, 0, 1]);
    }

    #[test]
    fn counts_saturate_and_a_memory_of_capacity_zero_works() {
        let mut memory = VisitMemory::<1>::new();
        for _ in 0..300 {
            memory.enter(Cell::new(5, 5));
        }
        assert_eq!(memory.count(Cell::new(5, 5)), 255);
        let mut nothing = VisitMemory::<0>::new();
        nothing.enter(Cell::new(5, 5));
        assert_eq!(nothing.count(Cell::new(5, 5)), 0);
    }
}
