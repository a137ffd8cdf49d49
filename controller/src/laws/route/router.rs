use super::escape::Escape;
use super::field::Beyond;
use super::{CostField, LearnedCosts, RouteParams, Unreachable, VisitMemory};
use crate::cost::Weights;
use crate::grid::{Cell, Dir, Window};
use crate::land::{FarLand, Gains};
use crate::list::SparseVec;
use crate::names::named;
use serde::{Deserialize, Serialize};

/// Most moves in a plan.
pub const PLAN: usize = 32;

/// Moves without a new least distance to the target until the robot follows the wall.
const IDLE: u8 = 20;
/// The same for a robot that learns, which is usually shorter.
const IDLE_LEARNING: u8 = 100;

named! {
    /// When to search for a new route.
    #[derive(Default)]
    pub enum Replan {
        /// Whenever the robot is free to leave its cell (alg. 1): O((2r + 1)^2) per cell.
        #[default]
        EachCell = "each_cell",
        /// At the end of the planned chain or when something on it changed (KUZ section 3): fewer
        /// searches, slower reactions to changes beside the chain.
        UntilChanged = "until_changed",
    }
}

/// One robot's routing state: visits (`M` cells), the planned chain, and the way out of dead ends.
///
/// While each move brings the robot closer to its target than ever before, the paper's rule
/// decides. Otherwise, if walls are in sight (or for many moves), the robot *learns*: it stores the
/// costs that are higher than assumed, for up to `L` cells (LSS-LRTA*, S. Koenig and X. Sun,
/// "Comparing real-time and incremental heuristic search for real-time situated agents", JAAMAS 18,
/// 2009). With another robot in sight nothing is learned.
///
/// Dead ends that `L` cells cannot represent (any with `L` = 0) are left along the wall: after 20
/// moves (100 with a memory) the robot follows it until it is closer than ever. So it arrives
/// wherever an undisturbed path exists, with any gains, `M` and `L`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Router<const M: usize, const L: usize = 0> {
    visits: VisitMemory<M>,
    here: Option<Cell>,
    target: Option<Cell>,
    /// Last move first, each with the impassability that it was planned for.
    plan: SparseVec<(Dir, u8), PLAN>,
    learned: LearnedCosts<L>,
    easiest: u8,
    /// Least squared distance to the target so far.
    least: u64,
    idle: u8,
    escape: Option<Escape>,
}

impl<const M: usize, const L: usize> Default for Router<M, L> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const M: usize, const L: usize> Router<M, L> {
    /// Creates an empty state.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            visits: VisitMemory::new(),
            here: None,
            target: None,
            plan: SparseVec::new(),
            learned: LearnedCosts::new(),
            easiest: u8::MAX,
            least: u64::MAX,
            idle: 0,
            escape: None,
        }
    }

    /// The memory of visited cells.
    #[must_use]
    pub const fn visits(&self) -> &VisitMemory<M> {
        &self.visits
    }

    #[cfg(feature = "agent")]
    pub(crate) const fn idle(&self) -> u8 {
        self.idle
    }

    /// Updates the robot's cell and target; call it at each step. A changed cell counts as a visit
    /// and a move of the plan. A target that moves by more than the window clears the visits.
    pub fn observe(&mut self, params: &RouteParams, cell: Cell, target: Cell) {
        if self.target.is_some_and(|old| old.chebyshev(target) > u32::from(params.radius)) {
            self.visits.clear();
        }
        if self.target != Some(target) {
            self.target = Some(target);
            self.plan.clear();
            self.forget_route();
        }
        if self.here != Some(cell) {
            let made = self.here.and_then(|before| Dir::between(before, cell)).unwrap_or_default();
            self.advance(made);
            self.here = Some(cell);
            self.visits.enter(cell);
            self.idle = self.idle.saturating_add(1);
            if self.escape.as_mut().is_some_and(|escape| !escape.has_made(params, made)) {
                // Pushed aside: try the normal rule first.
                self.escape = None;
                self.idle = 1;
            }
        }
        let distance = cell.distance_squared(target);
        if distance == 0 {
            self.forget_route();
        } else if distance < self.least {
            self.least = distance;
            self.idle = 0;
            self.escape = None;
        }
    }

    /// Clears the knowledge of the route.
    pub fn forget_route(&mut self) {
        self.learned.clear();
        self.easiest = u8::MAX;
        self.least = u64::MAX;
        self.idle = 0;
        self.escape = None;
    }

    /// Weights of the eight moves by a new search ([`CostField::weights`]); along a wall that is
    /// followed, zero. Work: three searches, and O(L w h) while learning.
    ///
    /// # Errors
    /// [`Unreachable`] if no exit of the window can be reached.
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

    /// Like [`Router::weights`], with exits priced by the known `land` beyond the window instead of
    /// learning, if any tile is known; along no wall if all of it is. Additional work:
    /// [`FarLand::look`].
    ///
    /// # Errors
    /// [`Unreachable`] if no exit of the window can be reached.
    pub fn weights_over<const CELLS: usize>(
        &mut self,
        params: &RouteParams,
        field: &mut CostField<CELLS>,
        window: &Window<'_>,
        (from, target): (Cell, Cell),
        others: impl IntoIterator<Item = Cell> + Clone,
        land: Option<&dyn FarLand>,
    ) -> Result<Weights, Unreachable> {
        if !land.is_some_and(FarLand::is_whole) && self.escapes() {
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

    /// The next move of the planned chain, which is planned again when it ends or something on it
    /// changed. [`Router::observe`] detects whether the robot makes it.
    ///
    /// # Errors
    /// [`Unreachable`] if no exit of the window can be reached.
    pub fn follow<const CELLS: usize>(
        &mut self,
        params: &RouteParams,
        field: &mut CostField<CELLS>,
        window: &Window<'_>,
        from: Cell,
        target: Cell,
        others: impl IntoIterator<Item = Cell> + Clone,
    ) -> Result<Dir, Unreachable> {
        let is_restarted = self.escapes() || L > 0 && self.idle > 0;
        if is_restarted || !self.plan_holds(params, window, from, others.clone()) {
            let weights = self.weights(params, field, window, from, target, others)?;
            if is_restarted {
                self.plan.clear();
                return weights.best().ok_or(Unreachable);
            }
            self.draw_plan(params, field, window, from, &weights);
        }
        self.plan.last().map(|&(dir, _)| dir).ok_or(Unreachable)
    }

    fn escapes(&self) -> bool {
        let patience = if L == 0 { IDLE } else { IDLE_LEARNING };
        self.escape.is_some() || self.idle > patience
    }

    /// Drops a plan that the robot left.
    fn advance(&mut self, made: Dir) {
        if self.plan.pop().is_some_and(|(dir, _)| dir != made) {
            self.plan.clear();
        }
    }

    /// Land and corners are as planned, as far as visible, and no robot is in the way.
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
