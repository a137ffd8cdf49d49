//! The route of one robot: what it remembers between steps.

use super::escape::Escape;
use super::field::Beyond;
use super::{CostField, LearnedCosts, RouteParams, Unreachable, VisitMemory};
use crate::cost::Weights;
use crate::grid::{Cell, Dir, Window};
use crate::land::{FarLand, Gains};
use crate::list::Seldom;
use crate::names::named;
use serde::{Deserialize, Serialize};

/// Moves that a plan holds; a longer route is planned again after so many.
pub const PLAN: usize = 32;

/// Moves without coming nearer to the target than ever before after which the robot follows the wall, if it cannot
/// learn.
const IDLE: u8 = 20;
/// The same for a robot that learns: more, as that is the shorter way out more often than not.
const IDLE_LEARNING: u8 = 100;

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

/// What one robot's routing keeps between steps: visits (`M` cells), the planned chain, and what gets it out of
/// dead ends that are larger than its window.
///
/// While each move brings the robot nearer to its target than it ever was, the paper's rule decides. When one does not,
/// and there are walls in sight (or many do not), it *learns*: the window is searched for the costs from all its cells,
/// and what turns out dearer than believed is remembered, for up to `L` cells (LSS-LRTA*, S. Koenig and X. Sun,
/// "Comparing real-time and incremental heuristic search for real-time situated agents", JAAMAS 18, 2009; here at each
/// move, and the costs from the window's inner cells are kept from falling too). Others are no walls: with one in sight
/// nothing is learned, and the paper's rule decides. What `L` cells cannot hold, or with `L` = 0, the wall gets it out:
/// after 20 moves (100 with a memory) the robot walks along it until it is nearer than ever. So it arrives wherever
/// there is a way that it may go undisturbed, with any gains, `M` and `L`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Router<const M: usize, const L: usize = 0> {
    visits: VisitMemory<M>,
    here: Option<Cell>,
    target: Option<Cell>,
    /// The moves to come, last one first, each with the impassability that it was planned for.
    plan: Seldom<(Dir, u8), PLAN>,
    learned: LearnedCosts<L>,
    /// Impassability of the easiest land seen on the way to this target.
    easiest: u8,
    /// Least squared distance to the target so far.
    least: u64,
    /// Moves since then.
    idle: u8,
    /// Along the wall.
    escape: Option<Escape>,
}

impl<const M: usize, const L: usize> Default for Router<M, L> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const M: usize, const L: usize> Router<M, L> {
    /// Knows nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            visits: VisitMemory::new(),
            here: None,
            target: None,
            plan: Seldom::new(),
            learned: LearnedCosts::new(),
            easiest: u8::MAX,
            least: u64::MAX,
            idle: 0,
            escape: None,
        }
    }

    /// What the robot remembers of its way.
    #[must_use]
    pub const fn visits(&self) -> &VisitMemory<M> {
        &self.visits
    }

    /// Moves since it was nearest to its target, up to 255.
    pub(crate) const fn idle(&self) -> u8 {
        self.idle
    }

    /// Tells where the robot is and where it is heading; to be called each step. A changed cell
    /// counts as a visit and as a move of the planned chain, a target that moves by more than the window forgets the visits.
    pub fn observe(&mut self, params: &RouteParams, cell: Cell, target: Cell) {
        if self.target.is_some_and(|old| old.chebyshev(target) > u32::from(params.radius)) {
            self.visits.clear();
        }
        if self.target != Some(target) {
            self.target = Some(target);
            self.plan.clear();
            self.begin_anew();
        }
        if self.here != Some(cell) {
            let made = self.here.and_then(|before| Dir::between(before, cell)).unwrap_or_default();
            self.advance(made);
            self.here = Some(cell);
            self.visits.enter(cell);
            self.idle = self.idle.saturating_add(1);
            if self.escape.as_mut().is_some_and(|escape| !escape.has_made(params, made)) {
                // Pushed aside: another try first.
                self.escape = None;
                self.idle = 1;
            }
        }
        let distance = cell.distance_squared(target);
        if distance == 0 {
            // Whoever is pushed off its target comes back by a new way.
            self.begin_anew();
        } else if distance < self.least {
            self.least = distance;
            self.idle = 0;
            self.escape = None;
        }
    }

    /// Forgets what it has learned of the way, as for a robot that is led by others for a while.
    pub fn begin_anew(&mut self) {
        self.learned.clear();
        self.easiest = u8::MAX;
        self.least = u64::MAX;
        self.idle = 0;
        self.escape = None;
    }

    /// Weights of the eight moves by a new search; see [`CostField::weights`]. Along a wall the one that keeps to it
    /// weighs nothing. Work: three searches, and O(L w h) while it learns.
    ///
    /// # Errors
    /// [`Unreachable`] when no exit of the window can be reached.
    pub fn weights<const CELLS: usize>(
        &mut self,
        params: &RouteParams,
        field: &mut CostField<CELLS>,
        window: &Window<'_>,
        from: Cell,
        target: Cell,
        others: impl IntoIterator<Item = Cell> + Clone,
    ) -> Result<Weights, Unreachable> {
        self.weights_over(params, field, window, (from, target), others, None)
    }

    /// [`Router::weights`] of a robot that may know `land` beyond its window, and prices the exits by it instead of learning.
    /// With no tile known the price is the same. Work: besides, [`FarLand::look`].
    ///
    /// # Errors
    /// [`Unreachable`] when no exit of the window can be reached.
    pub fn weights_over<const CELLS: usize>(
        &mut self,
        params: &RouteParams,
        field: &mut CostField<CELLS>,
        window: &Window<'_>,
        (from, target): (Cell, Cell),
        others: impl IntoIterator<Item = Cell> + Clone,
        land: Option<&dyn FarLand>,
    ) -> Result<Weights, Unreachable> {
        if self.escapes() {
            let mut weights = field.weights(params, window, from, target, others, Some(&self.visits))?;
            let escape = self.escape.get_or_insert(Escape::new());
            if let Some(dir) = escape.choose(params, window, from, target) {
                weights.set(dir, 0);
            }
            return Ok(weights);
        }
        let is_alone = || others.clone().into_iter().all(|other| other.chebyshev(from) > u32::from(params.radius));
        if L > 0 && self.idle > 0 && land.is_none() && is_alone() {
            field.load(params, window, from);
            let (easiest, has_walls) = field.land();
            self.easiest = self.easiest.min(easiest);
            if has_walls || u16::from(self.idle) > 2 * u16::from(params.radius) {
                return field.learn(params, (from, target), self.easiest, &mut self.learned);
            }
        }
        let beyond = Beyond { learned: self.learned.as_slice(), land: None };
        let mut weights = None;
        if let Some(land) = land {
            let gains = Gains { a0: params.a0, a3: params.a3, norm: params.norm };
            land.look(&gains, target, &mut |outlook| {
                let beyond = Beyond { land: Some(outlook), ..beyond };
                let visits = Some(&self.visits);
                weights = Some(field.weights_knowing(params, window, (from, target), others.clone(), visits, &beyond));
            });
        }
        weights.unwrap_or_else(|| {
            field.weights_knowing(params, window, (from, target), others, Some(&self.visits), &beyond)
        })
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
        // A way out is found anew in each cell.
        let is_anew = self.escapes() || L > 0 && self.idle > 0;
        if is_anew || !self.plan_holds(params, window, from, others.clone()) {
            let weights = self.weights(params, field, window, from, target, others)?;
            if is_anew {
                self.plan.clear();
                return weights.best().ok_or(Unreachable);
            }
            self.draw_plan(params, field, window, from, &weights);
        }
        self.plan.last().map(|&(dir, _)| dir).ok_or(Unreachable)
    }

    /// Whether the robot follows the wall, or begins to.
    fn escapes(&self) -> bool {
        let patience = if L == 0 { IDLE } else { IDLE_LEARNING };
        self.escape.is_some() || self.idle > patience
    }

    /// Takes the first move off the plan, once the robot has made it; drops a plan that the robot left.
    fn advance(&mut self, made: Dir) {
        if self.plan.pop().is_some_and(|(dir, _)| dir != made) {
            self.plan.clear();
        }
    }

    /// Whether the land on the chain is as planned, as far as the window shows it, no corner beside it has closed, and nobody is
    /// in the way.
    fn plan_holds(
        &self,
        params: &RouteParams,
        window: &Window<'_>,
        from: Cell,
        others: impl IntoIterator<Item = Cell> + Clone,
    ) -> bool {
        let mut cell = from;
        !self.plan.is_empty()
            && self.plan.iter().rev().all(|&(dir, u)| {
                let is_open = params.opens(window, cell, dir);
                cell = cell + dir.offset();
                is_open && window.get(cell) == Some(u) && others.clone().into_iter().all(|other| other != cell)
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
