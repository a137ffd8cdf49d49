//! How followers derive the place to head for from the top leader's position.

use super::{Anchor, FormationParams, aim, lag};
use crate::grid::{Cell, Dir};
use crate::robot::RobotId;
use serde::{Deserialize, Serialize};

/// The course that followers assume for their leader.
pub trait Steering {
    /// Records the last known position of the top leader, or the own one.
    fn note(&mut self, leader: (RobotId, Cell));

    /// The cell to plan the route to, and the place that prices moves; `goal` is the final place.
    #[must_use]
    fn aims(&self, params: &FormationParams, anchor: &Anchor, goal: Cell) -> [Cell; 2];

    /// How far `off` (actual minus desired, cells) is behind, in
    /// [`UNIT`](crate::grid::UNIT)s; `heading` is the leader's.
    #[must_use]
    fn lag(&self, off: Cell, heading: Dir) -> u32;
}

/// Uses the move that the leader announced: [`aim`], [`lag`]. O(1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NextMove;

impl Steering for NextMove {
    fn note(&mut self, _: (RobotId, Cell)) {}

    fn aims(&self, params: &FormationParams, anchor: &Anchor, _: Cell) -> [Cell; 2] {
        [aim(anchor, params.lead); 2]
    }

    fn lag(&self, off: Cell, heading: Dir) -> u32 {
        lag(off, heading)
    }
}
