//! Leaves any dead end: follows the wall until the target is nearer than ever before.
//!
//! Source: V. Lumelsky and A. Stepanov, "Path-Planning Strategies for a Point Mobile Automaton
//! Moving Amidst Unknown Obstacles of Arbitrary Shape", Algorithmica 2, 1987, section 4, with the
//! leave condition "nearer than where the wall was met", which needs no line. Difference: on a grid
//! the boundary is a closed chain of cells that is followed with one hand on the wall.
//!
//! Why the robot arrives: in the open each move approaches the target. If no move does, the cell
//! ahead is a wall. If the target can be reached at all, the straight line through that wall leaves
//! it nearer to the target, at a cell of the same boundary. So each wall is left nearer to the
//! target than it was met, and the number of distances is finite.

use super::RouteParams;
use crate::grid::{Cell, Dir, Window};
use serde::{Deserialize, Serialize};

/// The state of wall following, which brings the robot nearer to its target than ever before, for
/// any walls.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Escape {
    /// Squared distance to the target where the wall was met; `None` while there is no wall in the
    /// way.
    met: Option<u64>,
    /// The number of the direction that is tried first, along a wall.
    first: u8,
    next: Dir,
}

impl Escape {
    pub(super) const fn new() -> Self {
        Self { met: None, first: 0, next: Dir::Stay }
    }

    /// Records that the robot has moved; returns whether it made the chosen move. Otherwise it has
    /// left the boundary, and starts over.
    pub(super) fn has_made(&mut self, params: &RouteParams, made: Dir) -> bool {
        // The first direction that may be open again, with the wall on the right.
        let back = if params.corner_cutting && !made.is_diagonal() { 7 } else { 6 };
        self.first = (made.index() as u8).wrapping_add(back) & 7;
        made == self.next
    }

    /// The next move from `cell`; `None` if it is walled in. Constant until the robot has moved.
    /// O(1).
    pub(super) fn choose(
        &mut self,
        params: &RouteParams,
        window: &Window<'_>,
        cell: Cell,
        target: Cell,
    ) -> Option<Dir> {
        let here = cell.distance_squared(target);
        let is_open = |dir: Dir| params.opens(window, cell, dir);
        if self.met.is_none_or(|met| here < met) {
            self.met = None;
            let distance = |dir: &Dir| (cell + dir.offset()).distance_squared(target);
            let nearest = Dir::MOVES.into_iter().filter(|&dir| is_open(dir)).min_by_key(distance);
            let nearer = nearest.filter(|dir| distance(dir) < here);
            if let Some(dir) = nearer {
                self.next = dir;
                return nearer;
            }
            self.met = Some(here);
            self.first = ahead(cell, target).index() as u8;
        }
        let turns = 0..8_u8;
        let hand = turns.map(|turn| Dir::from_index(self.first.wrapping_add(turn) & 7)).find(|&dir| {
            // If corners are not cut, an open diagonal lies between two open moves, and the wall is
            // beside those.
            (params.corner_cutting || !dir.is_diagonal()) && is_open(dir)
        });
        self.next = hand.unwrap_or_default();
        hand
    }
}

/// The axis along which the target is farther; a move along it always approaches the target.
fn ahead(cell: Cell, target: Cell) -> Dir {
    let (dx, dy) = (i32::from(target.x) - i32::from(cell.x), i32::from(target.y) - i32::from(cell.y));
    match (dx.abs() >= dy.abs(), dx > 0, dy > 0) {
        (true, true, _) => Dir::East,
        (true, false, _) => Dir::West,
        (false, _, true) => Dir::North,
        (false, _, false) => Dir::South,
    }
}
