//! The way out of any dead end: along the wall until the target is nearer than it ever was.
//!
//! Source: V. Lumelsky and A. Stepanov, "Path-Planning Strategies for a Point Mobile Automaton Moving Amidst Unknown
//! Obstacles of Arbitrary Shape", Algorithmica 2, 1987, section 4, with the leave condition of "nearer than where
//! the wall was met", which needs no line. What differs: on a grid the boundary is a closed chain of cells that is
//! walked with one hand on the wall.
//!
//! Why it arrives: straight on, each move comes nearer to the target. Where none does, the cell ahead is a wall, and
//! the straight line through that wall comes out of it nearer to the target, at a cell of the same boundary if the
//! target can be reached at all. So each wall is left nearer than it was met, and of distances there are finitely many.

use super::RouteParams;
use crate::grid::{Cell, Dir, Window};
use serde::{Deserialize, Serialize};

/// How the robot comes nearer to its target than it ever was, whatever the walls.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Escape {
    /// Squared distance to the target where the wall was met; `None` while no wall is in the way.
    met: Option<u64>,
    /// The number of the direction that is tried first, along a wall.
    first: u8,
    /// The move that was chosen last.
    next: Dir,
}

impl Escape {
    pub(super) const fn new() -> Self {
        Self { met: None, first: 0, next: Dir::Stay }
    }

    /// Tells that the robot has moved; whether by the move that was chosen. Otherwise it is off the boundary, and
    /// begins again.
    pub(super) fn has_made(&mut self, params: &RouteParams, made: Dir) -> bool {
        // The first direction that may be open again, seen from the wall at the right hand.
        let back = if params.corner_cutting && !made.is_diagonal() { 7 } else { 6 };
        self.first = (made.index() as u8).wrapping_add(back) & 7;
        made == self.next
    }

    /// The next move from `cell`; `None` when it is walled in. The same again until the robot has moved. O(1).
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
            // Where corners are not cut, an open diagonal lies between two open moves, and the wall is beside those.
            (params.corner_cutting || !dir.is_diagonal()) && is_open(dir)
        });
        self.next = hand.unwrap_or_default();
        hand
    }
}

/// The axis along which the target is farther; a move along it always comes nearer.
fn ahead(cell: Cell, target: Cell) -> Dir {
    let (dx, dy) = (i32::from(target.x) - i32::from(cell.x), i32::from(target.y) - i32::from(cell.y));
    match (dx.abs() >= dy.abs(), dx > 0, dy > 0) {
        (true, true, _) => Dir::East,
        (true, false, _) => Dir::West,
        (false, _, true) => Dir::North,
        (false, _, false) => Dir::South,
    }
}
