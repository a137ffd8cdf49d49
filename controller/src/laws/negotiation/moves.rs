//! The moves of robots that negotiate.

use crate::grid::Dir;
use serde::{Deserialize, Serialize};

/// The moves between cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Moves {
    /// To all eight neighbours, not only to the east, north, west and south.
    pub diagonals: bool,
    /// Three or more robots may move in a circle, each into the cell of the next one.
    pub circles: bool,
}

impl Moves {
    /// Four neighbours, all robots at once.
    pub const FOUR: Self = Self { diagonals: false, circles: true };
    /// Eight neighbours, and only into cells that are free.
    pub const EIGHT: Self = Self { diagonals: true, circles: false };

    /// The moves, without staying.
    #[must_use]
    pub const fn dirs(self) -> &'static [Dir] {
        if self.diagonals { &Dir::MOVES } else { &[Dir::East, Dir::North, Dir::West, Dir::South] }
    }
}
