//! What the guidance laws on the grid have in common: the last choice, who is in the way, walls at the
//! goal.

use super::OnGrid;
use super::guidance::{Ask, BadInput, GuidanceInput};
use crate::cost::Weights;
use crate::grid::{BLOCKED, Cell, Dir, Window};
use crate::neighbor::Neighbor;
use crate::rand::Rng;
use crate::robot::Mode;
use crate::shuffle::{Sharpness, weighted_shuffle};
use crate::wire::RequestKind;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Decisions after which whoever stands in the way is asked to choose another direction.
pub(super) const PATIENCE: u8 = 4;

/// What a robot remembers of its last decisions.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Travel {
    /// Where it decided last.
    cell: Option<Cell>,
    /// What it wanted most.
    choice: Dir,
    /// Decisions in this cell that wanted to leave it.
    attempts: u8,
    /// Somebody asked for another direction.
    redirected: bool,
}

impl Travel {
    pub(super) const fn new() -> Self {
        Self { cell: None, choice: Dir::Stay, attempts: 0, redirected: false }
    }

    /// What it wanted most at its last decision.
    pub(super) const fn choice(&self) -> Dir {
        self.choice
    }

    /// The next choice must differ from the last one.
    pub(super) fn redirect(&mut self) {
        self.redirected = true;
    }

    /// Whether the next choice answers a redirection; asks once.
    pub(super) fn take_redirection(&mut self) -> bool {
        core::mem::take(&mut self.redirected)
    }

    /// Whether it has wanted to leave this cell for so long that what stands there must be somebody whom nobody hears.
    pub(super) const fn is_jammed(&self) -> bool {
        self.attempts > PATIENCE
    }

    /// The weights without the last choice.
    pub(super) fn without_last(&self, weights: Weights) -> Weights {
        weights.without(self.choice)
    }

    /// The moves in the order in which to try them, at most `alternatives` of them.
    pub(super) fn order(weights: &Weights, sharpness: Sharpness, alternatives: usize, rng: &mut Rng) -> Vec<Dir, 8> {
        let mut moves = weighted_shuffle(weights, sharpness, rng);
        moves.truncate(alternatives);
        moves
    }

    /// Takes note of what was chosen in `cell`, and returns the request to whoever has stood in the way for too long.
    /// `idle`: moves since it was nearest to its target.
    pub(super) fn note<S>(&mut self, input: &GuidanceInput<'_, S>, cell: Cell, choice: Dir, idle: u8) -> Option<Ask> {
        let is_waiting = self.cell == Some(cell) && choice != Dir::Stay;
        self.attempts = if is_waiting { self.attempts.saturating_add(1) } else { 0 };
        self.cell = Some(cell);
        self.choice = choice;
        let patience = |other: &Neighbor<S>| {
            if other.cell != cell {
                // One that has arrived does not go by itself, and the robot may try other ways between its attempts.
                return if other.mode == Mode::Arrived && idle > PATIENCE { 0 } else { PATIENCE };
            }
            // In the plane two may have come into one cell, and mostly get past each other. If not, the one with the
            // smaller number asks first: if both made way at once, they would meet again.
            if input.id < other.id { 2 * PATIENCE } else { 3 * PATIENCE }
        };
        let wanted = cell + choice.offset();
        let to = occupant(input, wanted).or_else(|| occupant(input, cell))?;
        if choice == Dir::Stay || self.attempts < patience(to) {
            return None;
        }
        self.attempts = 0;
        Some(Ask { to: to.id, kind: RequestKind::Redirect })
    }
}

/// Who was last heard in a cell.
fn occupant<'a, S>(input: &GuidanceInput<'a, S>, cell: Cell) -> Option<&'a Neighbor<S>> {
    input.neighbors.iter().find(|neighbor| neighbor.cell == cell)
}

/// The cell of a robot on the grid, and the land that it sees.
///
/// # Errors
/// [`BadInput`] when it sees none, or the window does not show the cell.
pub(super) fn on_grid<'a>(here: &OnGrid<'a>) -> Result<(Cell, Window<'a>), BadInput> {
    let cell = here.cell.cell;
    let window = here.window.ok_or(BadInput)?;
    let is_in_sight = window.get(cell).is_some();
    is_in_sight.then_some((cell, window)).ok_or(BadInput)
}

/// `goal`, or when it is in sight and impassable the nearest passable cell in sight (then the
/// smallest); the goal itself when there is none. O(cells) for an impassable goal, else O(1).
pub(super) fn reachable_goal(window: &Window<'_>, goal: Cell) -> Cell {
    if window.get(goal) != Some(BLOCKED) {
        return goal;
    }
    let rows = (0..window.height()).flat_map(|y| (0..window.width()).map(move |x| (x, y)));
    rows.map(|(x, y)| window.origin() + Cell::new(x.cast_signed(), y.cast_signed()))
        .filter(|&cell| window.is_passable(cell))
        .min_by_key(|cell| (cell.distance_squared(goal), *cell))
        .unwrap_or(goal)
}
