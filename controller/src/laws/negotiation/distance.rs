//! How far each cell of an [`Area`] is from a goal, modulo 3.

use super::area::{Area, Plane, SIDE, bit, place, set};
use crate::grid::{Cell, Dir};
use core::cmp::Ordering;
use serde::{Deserialize, Serialize};

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

impl Default for Distances {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Distances {
    /// Reaches nothing.
    pub const EMPTY: Self = Self { goal: Cell::new(0, 0), version: 0, low: [!0; SIDE], high: [!0; SIDE] };

    /// Whether it holds for this goal and the known cells.
    #[must_use]
    pub fn is_for(&self, goal: Cell, area: &Area) -> bool {
        (self.goal, self.version) == (goal, area.version())
    }

    /// The goal.
    #[must_use]
    pub const fn goal(&self) -> Cell {
        self.goal
    }

    /// Searches from the goal outwards, 64 cells at once: at most 64 rows for each move of the
    /// longest way, and only those near cells that were just reached. `diagonals`: with the moves
    /// to eight neighbours.
    pub fn search(&mut self, goal: Cell, area: &Area, diagonals: bool) {
        *self = Self { goal, version: area.version(), ..Self::EMPTY };
        let open = area.open();
        let (mut front, mut next): (&mut Plane, &mut Plane) = (&mut [0; SIDE], &mut [0; SIDE]);
        let mut fresh = open;
        let mut remainder = 0u8;
        let goal = area.inside(goal);
        set(front, goal);
        // A bit for each row of `front` with cells.
        let mut rows = 1_u64 << place(goal.y);
        while rows != 0 {
            for y in ones(rows) {
                let reached = row(front, y);
                let keep = |plane: &mut Plane, keeps: bool| {
                    if let Some(row) = plane.get_mut(y).filter(|_| !keeps) {
                        *row &= !reached;
                    }
                };
                keep(&mut fresh, false);
                keep(&mut self.low, remainder == 1);
                keep(&mut self.high, remainder == 2);
            }
            remainder = if remainder == 2 { 0 } else { remainder.wrapping_add(1) };
            let mut reached = 0;
            for y in ones(rows | rows.rotate_left(1) | rows.rotate_right(1)) {
                let cells = spread(front, &open, y, diagonals) & row(&fresh, y);
                if let Some(row) = next.get_mut(y) {
                    *row = cells;
                }
                reached |= u64::from(cells != 0) << y;
            }
            for y in ones(rows) {
                if let Some(row) = front.get_mut(y) {
                    *row = 0;
                }
            }
            core::mem::swap(&mut front, &mut next);
            rows = reached;
        }
    }

    /// Compares the distances of two cells with one move between them; `None` if one of them was
    /// not reached.
    #[must_use]
    pub fn compare(&self, a: Cell, b: Cell) -> Option<Ordering> {
        order(self.remainder(a), self.remainder(b))
    }

    fn remainder(&self, cell: Cell) -> u8 {
        u8::from(bit(&self.low, cell)) | u8::from(bit(&self.high, cell)) << 1
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

/// The cells of row `y` that one move from `front` reaches, if they are open.
fn spread(front: &Plane, open: &Plane, y: usize, diagonals: bool) -> u64 {
    let (below, above) = (y.wrapping_add(SIDE - 1), y.wrapping_add(1));
    let from = row(front, y);
    let mut reached = from.rotate_left(1) | from.rotate_right(1) | row(front, below) | row(front, above);
    if diagonals {
        for other in [below, above] {
            // Both cells beside a diagonal are open: one in the row of the start, one in the row
            // of the end.
            let (start, beside) = (row(front, other), row(open, other));
            let end = row(open, y);
            reached |= (start & end).rotate_left(1) & beside | (start & end).rotate_right(1) & beside;
        }
    }
    reached
}

fn row(plane: &Plane, y: usize) -> u64 {
    plane.get(y & (SIDE - 1)).copied().unwrap_or(0)
}

/// The places of the bits that are set.
fn ones(bits: u64) -> impl Iterator<Item = usize> {
    core::iter::successors(Some(bits), |bits| Some(bits & bits.wrapping_sub(1)))
        .take_while(|&bits| bits != 0)
        .map(|bits| bits.trailing_zeros() as usize)
}

const _: () = assert!(place(-1) == SIDE - 1);

/// The distances of a robot's goal from the cells within 2 of it, modulo 3: what others need to
/// foresee its wishes while they do not hear it. Two bits a cell, row by row from the south; 3 for
/// cells that were not reached. 7 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Nearby([u8; 7]);

impl Default for Nearby {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

impl Nearby {
    /// No cell was reached.
    pub const UNKNOWN: Self = Self([!0; 7]);

    /// Those around `center`.
    #[must_use]
    pub fn new(center: Cell, distances: &Distances) -> Self {
        let mut nearby = Self::UNKNOWN;
        let cells = (-2..=2).flat_map(|y| (-2..=2).map(move |x| Cell::new(x, y)));
        for (index, offset) in (0_usize..25).zip(cells) {
            let remainder = distances.remainder(center + offset);
            if let Some(byte) = nearby.0.get_mut(index >> 2) {
                *byte &= !((3 ^ remainder) << ((index & 3) << 1));
            }
        }
        nearby
    }

    /// Compares the distances of two cells with one move between them, at offsets from the centre;
    /// `None` if one of them is not known.
    #[must_use]
    pub fn compare(&self, a: Cell, b: Cell) -> Option<Ordering> {
        let remainder = |Cell { x, y }: Cell| {
            if x.abs() > 2 || y.abs() > 2 {
                return 3;
            }
            let index = ((y + 2) * 5 + x + 2) as usize;
            self.0.get(index >> 2).map_or(3, |byte| byte >> ((index & 3) << 1) & 3)
        };
        order(remainder(a), remainder(b))
    }
}

/// Compares distances that differ by at most 1 by their remainders; 3: not reached.
fn order(a: u8, b: u8) -> Option<Ordering> {
    match (a, b) {
        (3, _) | (_, 3) => None,
        (a, b) if a == b => Some(Ordering::Equal),
        (0, 2) | (1, 0) | (2, 1) => Some(Ordering::Greater),
        _ => Some(Ordering::Less),
    }
}
