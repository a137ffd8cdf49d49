//! A robot's view of the cells around it, and its part in ending a stalemate.

use super::area::Area;
use super::moves::Moves;
use crate::fixint;
use crate::grid::{Cell, Dir, Norm};
use core::cmp::Ordering;
use serde::{Deserialize, Serialize};

/// The time that a robot loses by each move around it against its best one, four bits a move, and
/// its move after the best one. Together with the goal this is all that others need to plan for it:
/// along a corridor a robot continues until its goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wish {
    /// Ticks that each move loses, in the order of [`Dir::MOVES`], the first in the lowest bits:
    /// at most [`MOST_LOST`](Self::MOST_LOST), or 15 if the cell is closed.
    #[serde(with = "fixint")]
    lost: u32,
    /// The move after the best one; `Stay` if that leads to the goal, or is unknown.
    pub then: Dir,
}

impl Default for Wish {
    fn default() -> Self {
        Self::CLOSED
    }
}

impl Wish {
    /// No cell around is open.
    pub const CLOSED: Self = Self { lost: u32::MAX, then: Dir::Stay };
    /// The greatest loss that a wish can tell, ticks.
    pub const MOST_LOST: u8 = 14;
    /// Ticks that a robot loses by staying where it is.
    pub const STAYING: u8 = 1;
    const SHUT: u8 = 15;

    /// The wish of a robot in `cell` with this goal, over land whose cells cost the same. `compare`
    /// compares the distances of two cells from the goal, with one move between them.
    #[must_use]
    pub fn new(
        (cell, goal): (Cell, Cell),
        area: &Area,
        compare: impl Fn(Cell, Cell) -> Option<Ordering>,
        moves: Moves,
    ) -> Self {
        let along = |at: Cell, dir: Dir| compare(at + dir.offset(), at);
        let mut wish = Self::by(cell, area, moves, |dir| match along(cell, dir) {
            // Distances count diagonals as moves like others, but they are longer.
            Some(Ordering::Less) => u8::from(dir.is_diagonal() && !approaches(cell, dir, goal)),
            Some(Ordering::Equal) => 1,
            Some(Ordering::Greater) | None => 2,
        });
        if wish.best().is_none() {
            // Only diagonals lead on.
            let nearer = |&&dir: &&Dir| area.opens(cell, dir) && along(cell, dir) == Some(Ordering::Less);
            moves.dirs().iter().filter(nearer).for_each(|&dir| wish.set(dir, 0));
        }
        if let Some(best) = wish.best() {
            let at = cell + best.offset();
            let goes_on =
                |&dir: &Dir| at + dir.offset() != cell && area.opens(at, dir) && along(at, dir) == Some(Ordering::Less);
            wish.then = moves.dirs().iter().copied().find(goes_on).unwrap_or_default();
        }
        wish
    }

    /// The wish of a robot in `cell` as far as others can tell from its goal alone.
    #[must_use]
    pub fn towards(cell: Cell, goal: Cell, area: &Area, moves: Moves) -> Self {
        let far = |cell: Cell| cell.distance(goal, Norm::Euclidean);
        Self::by(cell, area, moves, |dir| match far(cell + dir.offset()).cmp(&far(cell)) {
            Ordering::Less => 0,
            Ordering::Equal => 1,
            Ordering::Greater => 2,
        })
    }

    /// The wish of a robot in `cell` that makes one move.
    #[must_use]
    pub fn only(dir: Dir, cell: Cell, area: &Area, moves: Moves) -> Self {
        Self::by(cell, area, moves, |other| if other == dir { 0 } else { 2 })
    }

    fn by(cell: Cell, area: &Area, moves: Moves, lost: impl Fn(Dir) -> u8) -> Self {
        let mut wish = Self::CLOSED;
        moves.dirs().iter().filter(|&&dir| area.opens(cell, dir)).for_each(|&dir| wish.set(dir, lost(dir)));
        wish
    }

    /// The losses in four bytes, and the move after the best one.
    #[must_use]
    pub const fn from_bits(lost: u32, then: Dir) -> Self {
        Self { lost, then }
    }

    /// The losses, four bits a move.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.lost
    }

    /// Sets the ticks that a move loses; ignored for `Stay`.
    pub const fn set(&mut self, dir: Dir, lost: u8) {
        if !matches!(dir, Dir::Stay) {
            let shift = 4 * dir.index() as u32;
            let lost = if lost > Self::MOST_LOST { Self::MOST_LOST } else { lost };
            self.lost = self.lost & !(15_u32.wrapping_shl(shift)) | (lost as u32).wrapping_shl(shift);
        }
    }

    /// The ticks that a move loses; `None` if the cell is closed.
    #[must_use]
    pub const fn lost(self, dir: Dir) -> Option<u8> {
        if matches!(dir, Dir::Stay) {
            return Some(Self::STAYING);
        }
        match self.lost.wrapping_shr(4 * dir.index() as u32) as u8 & Self::SHUT {
            Self::SHUT => None,
            lost => Some(lost),
        }
    }

    /// The best move, the first of equals; `None` if no move loses nothing.
    #[must_use]
    pub fn best(self) -> Option<Dir> {
        Dir::MOVES.into_iter().find(|&dir| self.lost(dir) == Some(0))
    }
}

/// Whether a move brings a robot nearer to its goal along both axes.
fn approaches(cell: Cell, dir: Dir, goal: Cell) -> bool {
    let (way, step) = (goal - cell, dir.offset());
    way.x.signum() == step.x && way.y.signum() == step.y
}

/// A robot's part in ending a stalemate, in one step. The default is its usual behaviour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "u8", into = "u8")]
pub struct Manners {
    /// It chooses after all others.
    pub is_last: bool,
    /// It does not begin to exchange its place with another robot.
    pub keeps_on: bool,
}

impl From<u8> for Manners {
    fn from(bits: u8) -> Self {
        Self { is_last: bits & 1 == 1, keeps_on: bits & 2 == 2 }
    }
}

impl From<Manners> for u8 {
    fn from(manners: Manners) -> Self {
        Self::from(manners.is_last) | Self::from(manners.keeps_on) << 1
    }
}
