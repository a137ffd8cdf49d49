//! The route of one robot: what it remembers between steps.

use super::{CostField, RouteParams, Unreachable, VisitMemory};
use crate::cost::Weights;
use crate::grid::{Cell, Dir, Window};
use crate::names::named;
use heapless::Vec;
use serde::Serialize;

/// Moves that a plan holds; a longer route is planned again after so many.
pub const PLAN: usize = 32;

named! {
    /// When a route is searched anew.
    #[derive(Default)]
    pub enum Replan {
        /// Whenever the robot is free to leave its cell (alg. 1): O((2r + 1)^2) a cell.
        #[default]
        EachCell = "each_cell",
        /// At the end of the planned chain or when something changed on it (KUZ section 3): fewer
        /// searches, later reactions to what happens beside the chain.
        UntilChanged = "until_changed",
    }
}

/// What one robot's routing keeps between steps: visits (`M` cells) and the planned chain.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Router<const M: usize> {
    visits: VisitMemory<M>,
    here: Option<Cell>,
    target: Option<Cell>,
    /// The moves to come, last one first, each with the impassability that it was planned for.
    plan: Vec<(Dir, u8), PLAN>,
}

impl<const M: usize> Router<M> {
    /// Knows nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { visits: VisitMemory::new(), here: None, target: None, plan: Vec::new() }
    }

    /// What the robot remembers of its way.
    #[must_use]
    pub const fn visits(&self) -> &VisitMemory<M> {
        &self.visits
    }

    /// Tells where the robot is and where it is heading; to be called each step. A changed cell
    /// counts as a visit and as a move of the planned chain, a target that moves by more than the window forgets the visits.
    pub fn observe(&mut self, params: &RouteParams, cell: Cell, target: Cell) {
        if self.here != Some(cell) {
            let made = self.here.and_then(|before| Dir::between(before, cell));
            self.advance(made.unwrap_or_default());
            self.here = Some(cell);
            self.visits.enter(cell);
        }
        if self.target.is_some_and(|old| old.chebyshev(target) > u32::from(params.radius)) {
            self.visits.clear();
        }
        if self.target != Some(target) {
            self.target = Some(target);
            self.plan.clear();
        }
    }

    /// Weights of the eight moves by a new search; see [`CostField::weights`].
    ///
    /// # Errors
    /// [`Unreachable`] when no exit of the window can be reached.
    pub fn weights<const CELLS: usize>(
        &self,
        params: &RouteParams,
        field: &mut CostField<CELLS>,
        window: &Window<'_>,
        from: Cell,
        target: Cell,
        others: impl IntoIterator<Item = Cell>,
    ) -> Result<Weights, Unreachable> {
        field.weights(params, window, from, target, others, Some(&self.visits))
    }

    /// The next move of the planned chain, planned anew when there is none or something on it
    /// changed. [`Router::observe`] sees whether the robot makes it.
    ///
    /// # Errors
    /// [`Unreachable`] when no exit of the window can be reached.
    pub fn follow<const CELLS: usize>(
        &mut self,
        params: &RouteParams,
        field: &mut CostField<CELLS>,
        window: &Window<'_>,
        from: Cell,
        target: Cell,
        others: impl IntoIterator<Item = Cell> + Clone,
    ) -> Result<Dir, Unreachable> {
        if !self.plan_holds(window, from, others.clone()) {
            let weights = self.weights(params, field, window, from, target, others)?;
            self.draw_plan(params, field, window, from, &weights);
        }
        self.plan.last().map(|&(dir, _)| dir).ok_or(Unreachable)
    }

    /// Takes the first move off the plan, once the robot has made it; drops a plan that the robot left.
    fn advance(&mut self, made: Dir) {
        if self.plan.pop().is_some_and(|(dir, _)| dir != made) {
            self.plan.clear();
        }
    }

    /// Whether the land on the chain is as planned, as far as the window shows it, and nobody is in the way.
    fn plan_holds(&self, window: &Window<'_>, from: Cell, others: impl IntoIterator<Item = Cell> + Clone) -> bool {
        let mut cell = from;
        !self.plan.is_empty()
            && self.plan.iter().rev().all(|&(dir, u)| {
                cell = cell + dir.offset();
                window.get(cell) == Some(u) && others.clone().into_iter().all(|other| other != cell)
            })
    }

    fn draw_plan<const CELLS: usize>(
        &mut self,
        params: &RouteParams,
        field: &CostField<CELLS>,
        window: &Window<'_>,
        from: Cell,
        weights: &Weights,
    ) {
        self.plan.clear();
        let mut cell = from;
        let mut next = weights.best();
        while let Some(dir) = next {
            cell = cell + dir.offset();
            let Some(u) = window.get(cell) else { break };
            if self.plan.push((dir, u)).is_err() {
                break;
            }
            next = field.descend(params, cell);
        }
        self.plan.reverse();
    }
}
