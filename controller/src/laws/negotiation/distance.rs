//! How far each cell of an [`Area`] is from a goal, modulo 3.

use super::area::{Area, Plane, SIDE, bit, place, set};
use crate::grid::{Cell, Dir};
use core::cmp::Ordering;

/// Moves from each cell of an [`Area`] to a goal, modulo 3: enough to compare neighbouring cells,
/// whose distances differ by at most 1. 1 KiB.
#[derive(Clone, Debug)]
pub struct Distances {
    goal: Cell,
    version: u16,
    /// The two bits of each remainder; 3 for cells that were not reached.
    low: Plane,
    high: Plane,
}

impl Distances {
    /// Reaches nothing.
    pub const EMPTY: Self = Self { goal: Cell::new(0, 0), version: 0, low: [!0; SIDE], high: [!0; SIDE] };

    /// Whether it holds for this goal and what is known.
    #[must_use]
    pub fn is_for(&self, goal: Cell, area: &Area) -> bool {
        (self.goal, self.version) == (goal, area.version())
    }

    /// Searches from the goal outwards, 64 cells at once: at most 64 rows for each move of the
    /// longest way. `diagonals`: with the moves to eight neighbours.
    pub fn search(&mut self, goal: Cell, area: &Area, diagonals: bool) {
        *self = Self { goal, version: area.version(), ..Self::EMPTY };
        let open = area.open();
        let mut front: Plane = [0; SIDE];
        set(&mut front, area.inside(goal));
        let mut fresh = open;
        let mut remainder = 0u8;
        while front.iter().any(|&row| row != 0) {
            let rows = front.iter().zip(&mut fresh).zip(self.low.iter_mut().zip(&mut self.high));
            for ((front, fresh), (low, high)) in rows {
                *fresh &= !front;
                if remainder != 1 {
                    *low &= !front;
                }
                if remainder != 2 {
                    *high &= !front;
                }
            }
            remainder = if remainder == 2 { 0 } else { remainder.wrapping_add(1) };
            front = spread(&front, &open, &fresh, diagonals);
        }
    }

    /// Compares the distances of two cells with one move between them; `None` if one of them was
    /// not reached.
    #[must_use]
    pub fn compare(&self, a: Cell, b: Cell) -> Option<Ordering> {
        let remainder = |cell: Cell| u8::from(bit(&self.low, cell)) | u8::from(bit(&self.high, cell)) << 1;
        match (remainder(a), remainder(b)) {
            (3, _) | (_, 3) => None,
            (a, b) if a == b => Some(Ordering::Equal),
            (0, 2) | (1, 0) | (2, 1) => Some(Ordering::Greater),
            _ => Some(Ordering::Less),
        }
    }

    /// Whether `a` is nearer to the goal than its neighbour `b`.
    #[must_use]
    pub fn is_nearer(&self, a: Cell, b: Cell) -> bool {
        self.compare(a, b) == Some(Ordering::Less)
    }

    /// How the distance changes with a move.
    #[must_use]
    pub fn along(&self, cell: Cell, dir: Dir) -> Option<Ordering> {
        self.compare(cell + dir.offset(), cell)
    }
}

/// The cells of `fresh` that one move from `front` reaches.
fn spread(front: &Plane, open: &Plane, fresh: &Plane, diagonals: bool) -> Plane {
    let row = |plane: &Plane, y: usize| plane.get(y & (SIDE - 1)).copied().unwrap_or(0);
    let mut next: Plane = [0; SIDE];
    for (y, next) in next.iter_mut().enumerate() {
        let (below, above) = (y.wrapping_add(SIDE - 1), y.wrapping_add(1));
        let from = row(front, y);
        let mut reached = from.rotate_left(1) | from.rotate_right(1) | row(front, below) | row(front, above);
        if diagonals {
            for other in [below, above] {
                // Both cells beside a diagonal are open: one in the row of the start, one in the
                // row of the end.
                let (start, beside) = (row(front, other), row(open, other));
                let end = row(open, y);
                reached |= (start & end).rotate_left(1) & beside | (start & end).rotate_right(1) & beside;
            }
        }
        *next = reached & row(fresh, y);
    }
    next
}

const _: () = assert!(place(-1) == SIDE - 1);
