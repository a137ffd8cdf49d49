//! The grid: cells (x east, y north), the eight unit moves, norms, the window of terrain, and the
//! conversion to metres (A. V. Kuznetsov 2017, KUZ, sections 2 and 3).

use crate::geom::Vec2;
use crate::names::named;
use crate::scalar::Scalar;
use core::ops::{Add, Sub};
use serde::{Deserialize, Serialize};

/// Cost units per cell of an axis move; sqrt 2 is 99/70, with a relative error of 5.1e-5. Integer
/// costs make results on host and device identical.
pub const UNIT: u32 = 70;
/// Cost units of a diagonal move under the Euclidean norm.
pub const DIAGONAL: u32 = 99;

/// Impassability of a cell that no robot can enter.
pub const BLOCKED: u8 = 0;

/// A cell of the grid, or the difference of two cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Cell {
    /// Column, growing east.
    pub x: i16,
    /// Row, growing north.
    pub y: i16,
}

impl Cell {
    /// The cell in column `x` and row `y`.
    #[must_use]
    pub const fn new(x: i16, y: i16) -> Self {
        Self { x, y }
    }

    /// Chebyshev distance to `other` in cells.
    #[must_use]
    pub fn chebyshev(self, other: Self) -> u32 {
        let dx = i32::from(self.x).abs_diff(i32::from(other.x));
        let dy = i32::from(self.y).abs_diff(i32::from(other.y));
        dx.max(dy)
    }

    /// Squared Euclidean distance to `other` in cells squared.
    #[must_use]
    pub fn distance_squared(self, other: Self) -> u64 {
        let dx = u64::from(i32::from(self.x).abs_diff(i32::from(other.x)));
        let dy = u64::from(i32::from(self.y).abs_diff(i32::from(other.y)));
        dx * dx + dy * dy
    }

    /// Distance to `other` in [`UNIT`]s per cell under `norm`, rounded down.
    #[must_use]
    pub fn distance(self, other: Self, norm: Norm) -> u32 {
        match norm {
            Norm::Chebyshev => self.chebyshev(other) * UNIT,
            // At most 65535 * sqrt 2 cells * 70 < 2^23.
            Norm::Euclidean => (self.distance_squared(other) * u64::from(UNIT * UNIT)).isqrt() as u32,
        }
    }
}

impl Add for Cell {
    type Output = Self;
    /// Saturates at the edges of the coordinate range.
    fn add(self, other: Self) -> Self {
        Self::new(self.x.saturating_add(other.x), self.y.saturating_add(other.y))
    }
}

impl Sub for Cell {
    type Output = Self;
    /// Saturates at the edges of the coordinate range.
    fn sub(self, other: Self) -> Self {
        Self::new(self.x.saturating_sub(other.x), self.y.saturating_sub(other.y))
    }
}

named! {
    /// The norm of a unit move (KUZ section 2: a parameter).
    #[derive(Default)]
    pub enum Norm {
        /// A diagonal move has length sqrt 2.
        #[default]
        Euclidean = "euclidean",
        /// A diagonal move has length 1.
        Chebyshev = "chebyshev",
    }
}

/// One of the eight unit moves, counter-clockwise from east, or `Stay`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
#[expect(missing_docs, reason = "compass points")]
pub enum Dir {
    East = 0,
    NorthEast = 1,
    North = 2,
    NorthWest = 3,
    West = 4,
    SouthWest = 5,
    South = 6,
    SouthEast = 7,
    #[default]
    Stay = 8,
}

impl Dir {
    /// The eight moves in the order of their indices.
    pub const MOVES: [Self; 8] = [
        Self::East,
        Self::NorthEast,
        Self::North,
        Self::NorthWest,
        Self::West,
        Self::SouthWest,
        Self::South,
        Self::SouthEast,
    ];

    /// The index of the move, 0..=7, or 8 for `Stay`.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The move with that index; `Stay` for an index above 7.
    #[must_use]
    pub fn from_index(index: u8) -> Self {
        Self::MOVES.get(usize::from(index)).copied().unwrap_or(Self::Stay)
    }

    /// The cell difference of the move.
    #[must_use]
    pub const fn offset(self) -> Cell {
        match self {
            Self::East => Cell::new(1, 0),
            Self::NorthEast => Cell::new(1, 1),
            Self::North => Cell::new(0, 1),
            Self::NorthWest => Cell::new(-1, 1),
            Self::West => Cell::new(-1, 0),
            Self::SouthWest => Cell::new(-1, -1),
            Self::South => Cell::new(0, -1),
            Self::SouthEast => Cell::new(1, -1),
            Self::Stay => Cell::new(0, 0),
        }
    }

    /// The move from one cell to an adjacent or identical one; `None` if they are farther apart.
    #[must_use]
    pub fn between(from: Cell, to: Cell) -> Option<Self> {
        let step = to - from;
        Self::MOVES.into_iter().chain([Self::Stay]).find(|dir| dir.offset() == step)
    }

    /// Whether the move changes both coordinates.
    #[must_use]
    pub const fn is_diagonal(self) -> bool {
        matches!(self, Self::NorthEast | Self::NorthWest | Self::SouthWest | Self::SouthEast)
    }

    /// Whether this diagonal move out of `from` passes the same point as the diagonal move `other`
    /// that ends in `end`, in another direction. Two robots that do so at once collide.
    #[must_use]
    pub fn crosses(self, from: Cell, other: Self, end: Cell) -> bool {
        let (to, start) = (from + self.offset(), end - other.offset());
        let sides = [Cell::new(from.x, to.y), Cell::new(to.x, from.y)];
        self.is_diagonal() && (sides == [start, end] || sides == [end, start])
    }

    /// Length of the move in [`UNIT`]s. `Stay` counts as one cell, the cost of waiting.
    #[must_use]
    pub const fn length(self, norm: Norm) -> u32 {
        match norm {
            Norm::Euclidean if self.is_diagonal() => DIAGONAL,
            _ => UNIT,
        }
    }
}

/// A rectangle of terrain around the robot, borrowed from the caller for one step.
///
/// `cells` holds the impassability of each cell, row by row from the south-west corner: 1..=255
/// ticks to cross, or [`BLOCKED`]. Cells outside the rectangle are unknown.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Window<'a> {
    cells: &'a [u8],
    origin: Cell,
    width: u16,
    height: u16,
}

impl<'a> Window<'a> {
    /// Creates a window whose south-west cell is `origin`, if `cells` has `width * height` entries.
    #[must_use]
    pub fn new(cells: &'a [u8], origin: Cell, width: u16, height: u16) -> Option<Self> {
        let fits = cells.len() == usize::from(width) * usize::from(height);
        fits.then_some(Self { cells, origin, width, height })
    }

    /// The south-west cell.
    #[must_use]
    pub const fn origin(&self) -> Cell {
        self.origin
    }

    /// Cells from west to east.
    #[must_use]
    pub const fn width(&self) -> u16 {
        self.width
    }

    /// Cells from south to north.
    #[must_use]
    pub const fn height(&self) -> u16 {
        self.height
    }

    /// The impassabilities, row by row from the south-west corner.
    #[must_use]
    pub const fn cells(&self) -> &'a [u8] {
        self.cells
    }

    /// Index of `cell` in [`Window::cells`]; `None` outside of the window.
    #[must_use]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let dx = u16::try_from(i32::from(cell.x) - i32::from(self.origin.x)).ok()?;
        let dy = u16::try_from(i32::from(cell.y) - i32::from(self.origin.y)).ok()?;
        let inside = dx < self.width && dy < self.height;
        inside.then(|| usize::from(dy) * usize::from(self.width) + usize::from(dx))
    }

    /// Returns the part of the window within `radius` cells (Chebyshev) of `center`: its south-west
    /// cell, width and height, one of which is 0 if they do not intersect.
    #[must_use]
    pub fn cut(&self, center: Cell, radius: u8) -> (Cell, u16, u16) {
        let radius = i32::from(radius);
        let span = |center: i16, origin: i16, size: u16| {
            let low = (i32::from(center) - radius).max(i32::from(origin));
            let high = (i32::from(center) + radius).min(i32::from(origin) + i32::from(size) - 1);
            // Between two i16 values, those of the origin and the centre, or not farther west.
            (low as i16, u16::try_from(high - low + 1).unwrap_or(0))
        };
        let (west, width) = span(center.x, self.origin.x, self.width);
        let (south, height) = span(center.y, self.origin.y, self.height);
        (Cell::new(west, south), width, height)
    }

    /// Impassability of `cell`: `None` outside of the window, `Some(BLOCKED)` for a wall.
    #[must_use]
    pub fn get(&self, cell: Cell) -> Option<u8> {
        self.cells.get(self.index(cell)?).copied()
    }

    /// Iterates over all cells and their impassability, row by row from the south-west corner.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, u8)> + '_ {
        let rows = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        let cell = |(x, y): (u16, u16)| self.origin + Cell::new(x.cast_signed(), y.cast_signed());
        rows.map(cell).zip(self.cells.iter().copied())
    }

    /// Whether `cell` is visible and passable.
    #[must_use]
    pub fn is_passable(&self, cell: Cell) -> bool {
        self.get(cell).is_some_and(|u| u != BLOCKED)
    }

    /// Returns `goal`, or the nearest passable visible cell (the smallest of equals) if it is
    /// impassable. O(cells).
    #[must_use]
    pub fn reachable(&self, goal: Cell) -> Cell {
        if self.get(goal) != Some(BLOCKED) {
            return goal;
        }
        let rows = (0..self.height()).flat_map(|y| (0..self.width()).map(move |x| (x, y)));
        rows.map(|(x, y)| self.origin() + Cell::new(x.cast_signed(), y.cast_signed()))
            .filter(|&cell| self.is_passable(cell))
            .min_by_key(|cell| (cell.distance_squared(goal), *cell))
            .unwrap_or(goal)
    }
}

/// The position of the grid in the world, for conversions between cells and metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridFrame<S> {
    /// World position of the south-west corner of cell (0, 0), metres.
    pub origin_m: Vec2<S>,
    /// Side length of a cell, metres; above 0.
    pub cell_m: S,
}

impl<S: Scalar> GridFrame<S> {
    /// World position of the centre of `cell`, metres.
    #[must_use]
    pub fn center(&self, cell: Cell) -> Vec2<S> {
        let half = S::HALF;
        Vec2::new(
            self.origin_m.x + (S::from_i32(i32::from(cell.x)) + half) * self.cell_m,
            self.origin_m.y + (S::from_i32(i32::from(cell.y)) + half) * self.cell_m,
        )
    }

    /// The cell that contains a world position; `None` outside of the coordinate range or for NaN.
    #[must_use]
    pub fn cell(&self, position_m: Vec2<S>) -> Option<Cell> {
        let index = |at: S, origin: S| -> Option<i16> {
            i16::try_from(((at - origin).checked_div(self.cell_m)?).floor_to_i32()?).ok()
        };
        Some(Cell::new(index(position_m.x, self.origin_m.x)?, index(position_m.y, self.origin_m.y)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn diagonal_is_sqrt_two_within_1e_4() {
        let ratio = f64::from(DIAGONAL) / f64::from(UNIT);
        assert!((ratio - core::f64::consts::SQRT_2).abs() < 1e-4);
    }

    #[test]
    fn every_move_is_recovered_from_its_cells_and_has_unit_chebyshev_length() {
        for dir in Dir::MOVES {
            let from = Cell::new(-3, 7);
            assert_eq!(Dir::between(from, from + dir.offset()), Some(dir));
            assert_eq!(Cell::default().chebyshev(dir.offset()), 1);
            assert_eq!(Dir::from_index(dir.index() as u8), dir);
        }
        assert_eq!(Dir::between(Cell::new(0, 0), Cell::new(2, 0)), None);
        assert_eq!(Dir::from_index(200), Dir::Stay);
    }

    #[test]
    fn only_the_two_diagonals_of_four_cells_cross() {
        let from = Cell::new(4, -1);
        let ends = || (1..8).flat_map(|x| (-4..3).map(move |y| Cell::new(x, y)));
        for dir in Dir::MOVES {
            let all = ends().flat_map(|end| Dir::MOVES.map(|other| (other, end)));
            let crossing: Vec<_> = all.filter(|&(other, end)| dir.crosses(from, other, end)).collect();
            assert_eq!(crossing.len(), if dir.is_diagonal() { 2 } else { 0 }, "{dir:?}");
            for (other, end) in crossing {
                let start = end - other.offset();
                assert_eq!(from + from + dir.offset(), start + end, "the middles are one point");
                assert!(other.is_diagonal() && start != from && end != from);
                assert!(other.crosses(start, dir, from + dir.offset()), "crossing is mutual");
            }
        }
        let edge = Cell::new(i16::MAX, i16::MAX);
        assert!(!Dir::NorthEast.crosses(edge, Dir::NorthWest, edge));
    }

    #[test]
    fn distance_covers_the_whole_coordinate_range() {
        let (a, b) = (Cell::new(i16::MIN, i16::MIN), Cell::new(i16::MAX, i16::MAX));
        assert_eq!(a.chebyshev(b), 65_535);
        assert_eq!(a.distance(b, Norm::Euclidean), 6_487_634);
        assert_eq!(Cell::new(0, 0).distance(Cell::new(3, 4), Norm::Euclidean), 5 * UNIT);
    }

    #[test]
    fn window_refuses_a_slice_of_the_wrong_length() {
        assert!(Window::new(&[1; 5], Cell::default(), 2, 3).is_none());
        assert!(Window::new(&[], Cell::default(), 0, 0).is_some());
    }

    #[test]
    fn window_cells_have_their_positions() {
        let window = Window::new(&[1, 2, 3, 4, 5, BLOCKED], Cell::new(-1, 10), 3, 2).unwrap();
        assert_eq!(window.iter().count(), 6);
        assert!(window.iter().all(|(cell, u)| window.get(cell) == Some(u)));
    }

    #[test]
    fn window_covers_only_its_rectangle() {
        let cells = [1, 2, 3, 4, 5, BLOCKED];
        let window = Window::new(&cells, Cell::new(-1, 10), 3, 2).unwrap();
        assert_eq!(window.get(Cell::new(-1, 10)), Some(1));
        assert_eq!(window.get(Cell::new(1, 11)), Some(BLOCKED));
        assert!(!window.is_passable(Cell::new(1, 11)));
        for outside in [(-2, 10), (2, 10), (0, 9), (0, 12), (i16::MIN, i16::MAX)] {
            assert_eq!(window.get(Cell::new(outside.0, outside.1)), None);
        }
    }
}
