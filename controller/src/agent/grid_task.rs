//! The goal of a law on the grid.

use super::{GridOrder, Report, View};
use crate::grid::Cell;
use serde::{Deserialize, Serialize};

/// The goal, and what the law shows.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct GridTask {
    goal: Option<Goal>,
    pub(super) shown: Report,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Goal {
    Own(Cell),
    /// For the top leader; this robot heads for its own place beside it.
    Formation(Cell),
}

impl GridTask {
    pub(super) const NEW: Self = Self { goal: None, shown: Report::NONE };

    /// Takes in a goal; `offset` is the own place beside the top leader. False for other orders.
    pub(super) fn order(&mut self, order: &GridOrder, offset: Cell) -> bool {
        let (goal, target) = match order {
            GridOrder::Goal(goal) => (Goal::Own(*goal), *goal),
            GridOrder::FormationGoal(top) => (Goal::Formation(*top), *top + offset),
            GridOrder::Template { .. } => return false,
        };
        self.goal = Some(goal);
        (self.shown.goal, self.shown.target) = (Some(target), Some(target));
        true
    }

    /// The cell to go to.
    pub(super) fn goal<S, P>(&self, view: &View<'_, S, P>, offset: Cell) -> Option<Cell> {
        let own = self.goal.map(|goal| match goal {
            Goal::Own(goal) => goal,
            Goal::Formation(top) => top + offset,
        });
        view.sent_to.or(own)
    }

    pub(super) fn show(&mut self, goal: Cell, target: Cell) {
        (self.shown.goal, self.shown.target) = (Some(goal), Some(target));
    }
}
