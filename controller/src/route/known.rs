//! What a robot knows of land that it does not see: what it has seen otherwise than its map says.
//!
//! KUZ section 3: land changes with time and is not fully scouted. A robot that has a map plans on a window that is wider
//! than its sight. Its caller fills that window: with the map ([`supposed`]), then with what the robot has seen otherwise
//! ([`LandMemory::overlay`]), then with what it sees now. The search takes such a window as any other one, and a plan that does not
//! hold any more is made anew when the robot sees so. Maps can lie in flash; memory is taken by differences only.

use crate::grid::{BLOCKED, Cell, Window};
use crate::list::{Seldom, sink_last};
use serde::{Deserialize, Serialize};

/// Ticks that a cell takes for who only supposes that it is closed: no way through it is taken while there is another one, and
/// none is given up that nobody has looked at.
pub const SUPPOSED_CLOSED: u8 = u8::MAX;

/// The class with which to plan for a cell out of sight whose class was, or is said to be, this one.
#[must_use]
pub const fn supposed(class: u8) -> u8 {
    if class == BLOCKED { SUPPOSED_CLOSED } else { class }
}

/// The classes of up to `N` cells that a robot has seen otherwise than its map says.
///
/// When full, the cell farthest from the robot is forgotten, and is again what the map says. Memory: 6 bytes a cell.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LandMemory<const N: usize> {
    /// By rising cell.
    cells: Seldom<(Cell, u8), N>,
}

impl<const N: usize> LandMemory<N> {
    /// Nothing seen otherwise yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { cells: Seldom::new() }
    }

    /// The cells that are otherwise, each as it was seen last, by rising cell.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, u8)> + '_ {
        self.cells.iter().copied()
    }

    /// What a cell was when it was seen last, if the map says otherwise. O(log N).
    #[must_use]
    pub fn get(&self, cell: Cell) -> Option<u8> {
        let at = self.cells.binary_search_by_key(&cell, |&(at, _)| at).ok()?;
        self.cells.get(at).map(|&(_, class)| class)
    }

    /// Takes note of all cells that the robot `here` sees; `map` says what it would have thought of them.
    /// O(cells of `seen` x log N), and O(N) for each that has changed since it was seen last.
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

    /// Writes what was seen into a window of known land whose south-west cell is `origin`, row by row from there, each
    /// `width` cells long. O(N).
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
    fn only_what_is_otherwise_takes_memory_and_goes_when_it_is_as_the_map_says() {
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
    fn a_full_memory_forgets_the_farthest_cell_be_it_the_new_one() {
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
    fn walls_out_of_sight_are_dear_and_no_walls() {
        let mut memory = LandMemory::<8>::new();
        see(&mut memory, 0, 0, &[BLOCKED, 4, 1]);
        let mut known = [supposed(BLOCKED), 1, 1, 1, 1, 1];
        memory.overlay(Cell::new(-1, -1), 3, &mut known);
        assert_eq!(known, [SUPPOSED_CLOSED, 1, 1, 1, SUPPOSED_CLOSED, 4]);
    }

    proptest! {
        #[test]
        fn it_knows_what_it_saw_last_as_long_as_there_is_room(
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
        fn no_window_is_too_small_for_it(width: u16, x: i16, y: i16, cells in proptest::collection::vec(0_u8..4, 0..30)) {
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
