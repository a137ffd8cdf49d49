//! A robot's knowledge of the land around it: cells that are closed.

use crate::array;
use crate::grid::{Cell, Dir};
use serde::{Deserialize, Serialize};

/// Columns and rows of an [`Area`]; the outermost column and row on one side are its border.
pub const SIDE: usize = 64;
const HALF: i16 = 32;
/// Most cells at a time that robots block.
const BLOCKS: usize = 8;
/// Steps for which a cell is closed that this robot found blocked, at first; doubled so often.
const FIRST: u8 = 16;
const MOST_TIMES: u8 = 3;
/// Steps for which a cell is closed that another robot found blocked.
const TOLD: u8 = 6;
/// Radius of a [`Sight`].
pub const SIGHT: i16 = 5;

/// One bit for each cell of a square of 64 x 64 cells.
pub(super) type Plane = [u64; SIDE];

/// The closed cells within 5 cells of a robot: 121 bits, row by row from the south, each from the
/// west; the lowest bit of the first byte is the south-western cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sight(#[serde(with = "array")] pub [u8; 16]);

/// The cells of a [`Sight`] relative to its robot, in the order of the bits.
fn cells() -> impl Iterator<Item = Cell> {
    (-SIGHT..=SIGHT).flat_map(|y| (-SIGHT..=SIGHT).map(move |x| Cell::new(x, y)))
}

impl Sight {
    /// Sees each cell around `center` for which `is_closed` is true.
    #[must_use]
    pub fn new(center: Cell, is_closed: impl Fn(Cell) -> bool) -> Self {
        let mut sight = Self::default();
        for (index, cell) in cells().enumerate() {
            if let Some(byte) = sight.0.get_mut(index >> 3) {
                *byte |= u8::from(is_closed(center + cell)) << (index & 7);
            }
        }
        sight
    }

    /// The closed cells relative to its robot. O(11 + 11 for each row with such cells).
    pub fn closed(&self) -> impl Iterator<Item = Cell> + use<> {
        let bits = u128::from_le_bytes(self.0);
        let rows = (0..=10_i16).zip(-SIGHT..=SIGHT).map(move |(row, y)| (bits >> (11 * row) & 0x7FF, y));
        rows.filter(|&(row, _)| row != 0).flat_map(|(row, y)| {
            let columns = (0..=10_u32).zip(-SIGHT..=SIGHT).filter(move |&(column, _)| row >> column & 1 == 1);
            columns.map(move |(_, x)| Cell::new(x, y))
        })
    }
}

/// The closed cells that a robot has seen or was told, within 31 cells of it; 568 bytes. Unknown
/// cells are open.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Area {
    #[serde(with = "array")]
    closed: Plane,
    center: Cell,
    blocked: [Block; BLOCKS],
    /// Counts the changes.
    version: u16,
}

/// A cell in which a robot stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Block {
    cell: Cell,
    /// Steps for which it still counts as closed.
    left: u8,
    /// How often this robot found it blocked.
    times: u8,
}

/// The place of a coordinate in a [`Plane`].
pub(super) const fn place(coordinate: i16) -> usize {
    (coordinate as u16 & 63) as usize
}

pub(super) fn bit(plane: &Plane, cell: Cell) -> bool {
    plane.get(place(cell.y)).is_some_and(|row| row >> place(cell.x) & 1 == 1)
}

pub(super) fn set(plane: &mut Plane, cell: Cell) {
    if let Some(row) = plane.get_mut(place(cell.y)) {
        *row |= 1 << place(cell.x);
    }
}

impl Area {
    /// Nothing is known around `center`.
    #[must_use]
    pub const fn new(center: Cell) -> Self {
        Self {
            closed: [0; SIDE],
            center,
            blocked: [Block { cell: Cell::new(0, 0), left: 0, times: 0 }; BLOCKS],
            version: 0,
        }
    }

    /// Whether a cell is inside, and not its border.
    #[must_use]
    pub fn has(&self, cell: Cell) -> bool {
        cell.chebyshev(self.center) < HALF as u32
    }

    /// Whether a cell may be entered, as far as is known. Cells outside may not.
    #[must_use]
    pub fn is_open(&self, cell: Cell) -> bool {
        self.has(cell) && !bit(&self.closed, cell) && !self.is_blocked(cell)
    }

    /// Whether a cell is closed because a robot stays there.
    #[must_use]
    pub fn is_blocked(&self, cell: Cell) -> bool {
        self.blocked.iter().any(|block| block.cell == cell && block.left > 0)
    }

    /// The cells in which this robot found that another one stays.
    pub fn blocked(&self) -> impl Iterator<Item = Cell> {
        self.blocked.iter().filter(|block| block.left > 0 && block.times > 0).map(|block| block.cell)
    }

    /// Closes a cell in which a robot stays: each time that this robot found it so, for twice as
    /// long; if another one `told` it, for some steps. One more than there is room for replaces the
    /// one that ends first.
    pub fn block(&mut self, cell: Cell, told: bool) {
        let known = self.blocked.iter().position(|block| block.cell == cell);
        let first = || (0..BLOCKS).min_by_key(|&index| self.blocked.get(index).map(|block| block.left));
        let Some(block) = known.or_else(first).and_then(|index| self.blocked.get_mut(index)) else { return };
        if block.cell != cell {
            *block = Block { cell, left: 0, times: 0 };
        }
        let was_open = block.left == 0;
        if told {
            block.left = block.left.max(TOLD);
        } else if was_open {
            block.left = FIRST << block.times.min(MOST_TIMES);
            block.times = block.times.saturating_add(1);
        }
        self.version = self.version.wrapping_add(was_open.into());
    }

    /// Opens a cell again, because a robot that moves is there.
    pub fn unblock(&mut self, cell: Cell) {
        for block in self.blocked.iter_mut().filter(|block| block.cell == cell) {
            self.version = self.version.wrapping_add((block.left > 0).into());
            (block.left, block.times) = (0, 0);
        }
    }

    /// A step passes.
    pub fn pass(&mut self) {
        for block in &mut self.blocked {
            self.version = self.version.wrapping_add((block.left == 1).into());
            block.left = block.left.saturating_sub(1);
        }
    }

    /// Closes a cell inside.
    pub fn close(&mut self, cell: Cell) {
        if self.is_open(cell) {
            set(&mut self.closed, cell);
            self.version = self.version.wrapping_add(1);
        }
    }

    /// Adds what a robot at `center` sees. O(121).
    pub fn learn(&mut self, center: Cell, sight: &Sight) {
        for cell in sight.closed() {
            self.close(center + cell);
        }
    }

    /// Moves its centre, and forgets what is outside then. O(64) for each cell of the way.
    pub fn follow(&mut self, center: Cell) {
        if center.chebyshev(self.center) >= HALF as u32 {
            *self = Self { version: self.version.wrapping_add(1), ..Self::new(center) };
            return;
        }
        while self.center != center {
            let step = Cell::new((center.x - self.center.x).signum(), (center.y - self.center.y).signum());
            self.center = self.center + step;
            self.version = self.version.wrapping_add(1);
            // The column and the row that are added, and the border behind them.
            let edge = |at: i16, step: i16| [at + step * (HALF - 1), at + step * HALF].map(place);
            if step.x != 0 {
                let columns = edge(self.center.x, step.x).into_iter().fold(0, |bits, column| bits | 1 << column);
                self.closed.iter_mut().for_each(|row| *row &= !columns);
            }
            if step.y != 0 {
                for row in edge(self.center.y, step.y) {
                    if let Some(row) = self.closed.get_mut(row) {
                        *row = 0;
                    }
                }
            }
        }
    }

    /// The open cells, without the border.
    pub(super) fn open(&self) -> Plane {
        let border = |at: i16| place(at.wrapping_sub(HALF));
        let mut open = self.closed.map(|row| !row & !(1 << border(self.center.x)));
        for &Block { cell, .. } in self.blocked.iter().filter(|block| block.left > 0) {
            if let Some(row) = open.get_mut(place(cell.y)).filter(|_| self.has(cell)) {
                *row &= !(1 << place(cell.x));
            }
        }
        if let Some(row) = open.get_mut(border(self.center.y)) {
            *row = 0;
        }
        open
    }

    /// Counts changes of the known cells.
    #[must_use]
    pub const fn version(&self) -> u16 {
        self.version
    }

    /// The cell inside that is nearest to `cell`.
    #[must_use]
    pub fn inside(&self, cell: Cell) -> Cell {
        let Cell { x, y } = self.center;
        let most = HALF - 1;
        // Not `clamp`, whose assertion would stay in the firmware.
        let clamp = |at: i16, middle: i16| at.max(middle.saturating_sub(most)).min(middle.saturating_add(most));
        Cell::new(clamp(cell.x, x), clamp(cell.y, y))
    }

    /// Whether a move is open: its cell, and both cells beside a diagonal.
    #[must_use]
    pub fn opens(&self, cell: Cell, dir: Dir) -> bool {
        let Cell { x, y } = dir.offset();
        let corners = [Cell::new(x, 0), Cell::new(0, y)];
        self.is_open(cell + dir.offset())
            && (!dir.is_diagonal() || corners.iter().all(|&corner| self.is_open(cell + corner)))
    }

    /// The open cells that one move reaches, in the order of `moves`.
    pub fn around<'a>(&'a self, cell: Cell, moves: &'a [Dir]) -> impl Iterator<Item = Cell> + 'a {
        moves.iter().copied().filter(move |&dir| self.opens(cell, dir)).map(move |dir| cell + dir.offset())
    }
}
