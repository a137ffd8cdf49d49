//! Shared by the laws on the grid: the last choice, requests to robots in the way, reachable goals.

use super::protocol::{Grid, GridNeighbor};
use crate::cost::Weights;
use crate::grid::{BLOCKED, Cell, Dir, Norm, UNIT, Window};
use crate::law::View;
use crate::rand::Rng;
use crate::robot::{Mode, RobotId};
use crate::shuffle::{Sharpness, weighted_shuffle};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Decisions after which a robot in the way is asked to choose another direction.
pub(crate) const PATIENCE: u8 = 4;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct MoveHistory {
    cell: Option<Cell>,
    choice: Dir,
    attempts: u8,
    redirected: bool,
}

impl MoveHistory {
    pub(crate) const fn new() -> Self {
        Self { cell: None, choice: Dir::Stay, attempts: 0, redirected: false }
    }

    pub(crate) const fn choice(&self) -> Dir {
        self.choice
    }

    pub(crate) const fn redirect(&mut self) {
        self.redirected = true;
    }

    pub(crate) fn take_redirection(&mut self) -> bool {
        core::mem::take(&mut self.redirected)
    }

    /// Whether a robot without contact must be in the way.
    pub(crate) const fn is_jammed(&self) -> bool {
        self.attempts > PATIENCE
    }

    pub(crate) fn without_last(&self, weights: Weights) -> Weights {
        weights.without(self.choice)
    }

    pub(crate) fn order(weights: &Weights, sharpness: Sharpness, alternatives: usize, rng: &mut Rng) -> Vec<Dir, 8> {
        let mut moves = weighted_shuffle(weights, sharpness, rng);
        moves.truncate(alternatives);
        moves
    }

    /// Stores the choice. Returns a robot to redirect, which has been in the way for too long.
    /// `idle`: moves since the robot was nearest to its target.
    pub(crate) fn note<S: Copy>(
        &mut self,
        input: &View<'_, S, Grid>,
        cell: Cell,
        choice: Dir,
        idle: u8,
    ) -> Option<RobotId> {
        let is_waiting = self.cell == Some(cell) && choice != Dir::Stay;
        self.attempts = if is_waiting { self.attempts.saturating_add(1) } else { 0 };
        self.cell = Some(cell);
        self.choice = choice;
        // The least patience below: most decisions need no look at the robots nearby.
        if choice == Dir::Stay || (self.attempts < PATIENCE && idle <= PATIENCE) {
            return None;
        }
        let patience = |other: &GridNeighbor| {
            if other.cell != cell {
                return if other.mode == Mode::Arrived && idle > PATIENCE { 0 } else { PATIENCE };
            }
            // In the plane two robots can share a cell and usually pass each other. Otherwise the
            // smaller id asks first: if both made way at once, they would meet again.
            if input.id < other.id { 2 * PATIENCE } else { 3 * PATIENCE }
        };
        let wanted = cell + choice.offset();
        let to = occupant(input, wanted).or_else(|| occupant(input, cell))?;
        if self.attempts < patience(&to) {
            return None;
        }
        self.attempts = 0;
        to.is_peer.then_some(to.id)
    }
}

/// Removes diagonal moves out of `cell` that cross one of another robot: under way, or announced so
/// recently that it may be under way. An announced move into an occupied cell has not begun.
pub(crate) fn avoid_crossing<S: Copy>(
    moves: &mut Vec<Dir, 8>,
    input: &View<'_, S, Grid>,
    (window, norm): (&Window<'_>, Norm),
    cell: Cell,
) {
    // Beacons are a tick old.
    let now = input.now + input.tick;
    for other in input.on_grid().filter(|other| other.cell.chebyshev(cell) == 1) {
        let announced = other.cell + other.heading.offset();
        let class = window.get(announced).unwrap_or(BLOCKED);
        let length = i64::from(other.heading.length(norm)) * i64::from(class) * i64::from(input.tick.as_micros());
        let age = i64::from(now.since(other.heard).as_micros()) * i64::from(UNIT);
        let has_begun = other.heard == other.busy_until && age < length && occupant(input, announced).is_none();
        let end = if has_begun { announced } else { other.cell };
        if has_begun || now.is_before(other.busy_until) {
            moves.retain(|dir| !dir.crosses(cell, other.heading, end));
        }
    }
}

fn occupant<S: Copy>(input: &View<'_, S, Grid>, cell: Cell) -> Option<GridNeighbor> {
    input.on_grid().find(|neighbor| neighbor.cell == cell)
}
