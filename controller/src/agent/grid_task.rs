//! The goal of a law on the grid.

use super::{GridOrder, Report, View};
use crate::grid::Cell;
use serde::{Deserialize, Serialize};

/// The goal of a law on the grid, and what the law shows.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GridTask {
    goal: Option<Goal>,
    /// What the law shows.
    pub shown: Report,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Goal {
    Own(Cell),
    /// For the top leader; this robot heads for its own place beside it.
    Formation(Cell),
}

impl GridTask {
    /// Without a goal.
    pub const NEW: Self = Self { goal: None, shown: Report::NONE };

    /// Takes in a goal; `offset` is the own place beside the top leader. False for other orders.
    pub fn order(&mut self, order: &GridOrder, offset: Cell) -> bool {
        let (goal, target) = match order {
            GridOrder::Goal(goal) => (Goal::Own(*goal), *goal),
            GridOrder::FormationGoal(top) => (Goal::Formation(*top), *top + offset),
            GridOrder::Template { .. } => return false,
        };
        self.goal = Some(goal);
        (self.shown.goal, self.shown.target) = (Some(target), Some(target));
        true
    }

    /// The cell to go to; `None` without a goal.
    #[must_use]
    pub fn goal<S, P>(&self, view: &View<'_, S, P>, offset: Cell) -> Option<Cell> {
        let own = self.goal.map(|goal| match goal {
            Goal::Own(goal) => goal,
            Goal::Formation(top) => top + offset,
        });
        view.sent_to.or(own)
    }

    /// Shows the goal and the cell that the robot heads for.
    pub fn show(&mut self, goal: Cell, target: Cell) {
        (self.shown.goal, self.shown.target) = (Some(goal), Some(target));
    }
}
