//! Leaves any dead end: follows the wall until the target is nearer than where the wall was met.
//!
//! Source: V. Lumelsky and A. Stepanov, "Path-Planning Strategies for a Point Mobile Automaton
//! Moving Amidst Unknown Obstacles of Arbitrary Shape", Algorithmica 2, 1987, section 4; on the
//! grid the boundary is a closed chain of cells. The straight line through a wall leaves it nearer
//! to a reachable target, at a cell of the same boundary, and the number of distances is finite.

use super::RouteParams;
use crate::grid::{Cell, Dir, Window};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Escape {
    /// Squared distance to the target where the wall was met; `None` without a wall.
    met: Option<u64>,
    first: u8,
    next: Dir,
}

impl Escape {
    pub(super) const fn new() -> Self {
        Self { met: None, first: 0, next: Dir::Stay }
    }

    /// Returns whether the robot made the chosen move; otherwise it has left the boundary.
    pub(super) fn has_made(&mut self, params: &RouteParams, made: Dir) -> bool {
        let back = if params.corner_cutting && !made.is_diagonal() { 7 } else { 6 };
        self.first = (made.index() as u8).wrapping_add(back) & 7;
        made == self.next
    }

    /// `None` if the robot is walled in. Constant until the robot has moved.
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
            // If corners are not cut, an open diagonal lies between two open moves.
            (params.corner_cutting || !dir.is_diagonal()) && is_open(dir)
        });
        self.next = hand.unwrap_or_default();
        hand
    }
}

/// A move along the axis with the farther target always approaches it.
fn ahead(cell: Cell, target: Cell) -> Dir {
    let (dx, dy) = (i32::from(target.x) - i32::from(cell.x), i32::from(target.y) - i32::from(cell.y));
    match (dx.abs() >= dy.abs(), dx > 0, dy > 0) {
        (true, true, _) => Dir::East,
        (true, false, _) => Dir::West,
        (false, _, true) => Dir::North,
        (false, _, false) => Dir::South,
    }
}
