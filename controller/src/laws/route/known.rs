//! Observed differences from the map, for land out of sight (KUZ section 3).
//!
//! A robot with a map plans on a window wider than its view. The caller fills it with the map
//! ([`supposed`]), then with remembered differences ([`LandMemory::overlay`]), then with the view.
//! Maps can lie in flash; only differences take memory.

use crate::grid::{BLOCKED, Cell, Window};
use crate::list::{SparseVec, sink_last};
use serde::{Deserialize, Serialize};

/// Ticks of a cell that is only assumed to be closed: any other route is preferred.
pub const SUPPOSED_CLOSED: u8 = u8::MAX;

/// The class to plan with for a cell out of sight that was last seen, or is mapped, as `class`.
#[must_use]
pub const fn supposed(class: u8) -> u8 {
    if class == BLOCKED { SUPPOSED_CLOSED } else { class }
}

/// The classes of up to `N` cells that differ from the map; a full memory forgets the cell farthest
/// from the robot. 6 bytes per cell.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LandMemory<const N: usize> {
    cells: SparseVec<(Cell, u8), N>,
}

impl<const N: usize> LandMemory<N> {
    /// Creates an empty memory.
    #[must_use]
    pub const fn new() -> Self {
        Self { cells: SparseVec::new() }
    }

    /// The cells that differ, each as last seen, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, u8)> + '_ {
        self.cells.iter().copied()
    }

    /// The last seen class of a cell, if the map differs. O(log N).
    #[must_use]
    pub fn get(&self, cell: Cell) -> Option<u8> {
        let at = self.cells.binary_search_by_key(&cell, |&(at, _)| at).ok()?;
        self.cells.get(at).map(|&(_, class)| class)
    }

    /// Stores all cells that the robot `here` sees; `map` returns their class on the map. O(cells
    /// of `seen` x log N), and O(N) for each changed cell.
    pub fn observe(&mut self, here: Cell, seen: &Window<'_>, map: impl Fn(Cell) -> u8) {
        for (cell, class) in seen.iter() {
            if class == map(cell) {
                if self.get(cell).is_some() {
                    self.cells.retain(|&(at, _)| at != cell);
                }
            } else if self.get(cell) != Some(class) {
                self.note(cell, class, here);
            }
        }
    }

    fn note(&mut self, cell: Cell, class: u8, here: Cell) {
        if let Some((_, known)) = self.cells.iter_mut().find(|(at, _)| *at == cell) {
            *known = class;
            return;
        }
        if self.cells.is_full() {
            let farthest = self.cells.iter().map(|&(at, _)| at).max_by_key(|at| at.chebyshev(here));
            let Some(farthest) = farthest.filter(|at| at.chebyshev(here) > cell.chebyshev(here)) else {
                return;
            };
            self.cells.retain(|&(at, _)| at != farthest);
        }
        if self.cells.push((cell, class)).is_ok() {
            sink_last(&mut self.cells, |(before, _), (after, _)| before > after);
        }
    }

    /// Writes the remembered cells into a window of this south-west cell and `width`. O(N).
    pub fn overlay(&self, origin: Cell, width: u16, cells: &mut [u8]) {
        for &(cell, class) in &self.cells {
            let [dx, dy] = [(cell.x, origin.x), (cell.y, origin.y)].map(|(at, from)| i32::from(at) - i32::from(from));
            let column = u16::try_from(dx).ok().filter(|&dx| dx < width);
            if let (Some(column), Ok(row)) = (column, u16::try_from(dy))
                && let Some(known) = cells.get_mut(usize::from(row) * usize::from(width) + usize::from(column))
            {
                *known = supposed(class);
            }
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.cells.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(x: i16) -> Cell {
        Cell::new(x, 0)
    }

    fn see<const N: usize>(memory: &mut LandMemory<N>, here: i16, from: i16, cells: &[u8]) {
        let seen = Window::new(cells, at(from), cells.len() as u16, 1).expect("fits");
        memory.observe(at(here), &seen, |_| 1);
    }

    #[test]
    fn only_differences_from_the_map_take_memory() {
        let mut memory = LandMemory::<8>::new();
        see(&mut memory, 0, -1, &[1, 5, 1, BLOCKED]);
        assert!(memory.iter().eq([(at(0), 5), (at(2), BLOCKED)]));
        see(&mut memory, 0, -1, &[1, 6, 1, 1]);
        assert!(memory.iter().eq([(at(0), 6)]));
        assert_eq!((memory.get(at(0)), memory.get(at(2))), (Some(6), None));
        memory.clear();
        assert_eq!(memory.iter().count(), 0);
    }

    #[test]
    fn a_full_memory_forgets_the_farthest_cell_even_the_new_one() {
        let mut memory = LandMemory::<2>::new();
        see(&mut memory, 0, 5, &[2]);
        see(&mut memory, 0, 1, &[3]);
        see(&mut memory, 0, 3, &[4]);
        assert!(memory.iter().eq([(at(1), 3), (at(3), 4)]));
        see(&mut memory, 0, 9, &[7]);
        assert!(memory.iter().eq([(at(1), 3), (at(3), 4)]));
        let mut nothing = LandMemory::<0>::new();
        see(&mut nothing, 0, 0, &[7]);
        assert_eq!(nothing.get(at(0)), None);
    }

    #[test]
    fn walls_out_of_sight_are_expensive_but_passable() {
        let mut memory = LandMemory::<8>::new();
        see(&mut memory, 0, 0, &[BLOCKED, 4, 1]);
        let mut known = [supposed(BLOCKED), 1, 1, 1, 1, 1];
        memory.overlay(Cell::new(-1, -1), 3, &mut known);
        assert_eq!(known, [SUPPOSED_CLOSED, 1, 1, 1, SUPPOSED_CLOSED, 4]);
    }

    proptest! {
        #[test]
        fn it_returns_the_last_seen_class_within_its_capacity(
            looks in proptest::collection::vec((-6_i16..6, proptest::collection::vec(0_u8..4, 1..6)), 0..20),
        ) {
            let mut memory = LandMemory::<16>::new();
            let mut truth = std::collections::BTreeMap::new();
            for (from, cells) in looks {
                see(&mut memory, from, from, &cells);
                truth.extend((from..).zip(cells));
                prop_assert!(memory.iter().is_sorted_by(|one, two| one.0 < two.0));
                for (x, class) in &truth {
                    prop_assert_eq!(memory.get(at(*x)).unwrap_or(1), *class);
                }
            }
        }

        #[test]
        fn windows_of_any_size_are_overlaid(width: u16, x: i16, y: i16, cells in proptest::collection::vec(0_u8..4, 0..30)) {
            let mut memory = LandMemory::<8>::new();
            for (cx, cy) in [(0, 0), (i16::MIN, i16::MAX), (x, y)] {
                let seen = Window::new(&[9], Cell::new(cx, cy), 1, 1).expect("fits");
                memory.observe(Cell::default(), &seen, |_| 1);
            }
            let mut known = cells.clone();
            memory.overlay(Cell::new(x, y), width, &mut known);
            prop_assert_eq!(known.len(), cells.len());
        }
    }
}
