//! Routing of a single robot to its own goal (A. V. Kuznetsov 2017, KUZ, algorithm 1).

use super::OnGrid;
use super::guidance::{Action, BadInput, Decision, Guidance, GuidanceInput, Status, Teamwork, ToCells};
use super::move_history::{MoveHistory, avoid_crossing, on_grid, reachable_goal};
use crate::cost::{Gain, Weights};
use crate::grid::{Cell, Dir, Window};
use crate::list;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::route::{CostField, Replan, RouteParams, Router};
use crate::scalar::Scalar;
use crate::shuffle::Sharpness;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Scratch memory of the guidance laws on the grid; `CELLS` as for [`CostField`].
#[derive(Clone, Debug)]
pub struct GridWorkspace<const CELLS: usize> {
    pub(super) field: CostField<CELLS>,
    pub(super) land: [u8; CELLS],
}

impl<const CELLS: usize> Default for GridWorkspace<CELLS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const CELLS: usize> GridWorkspace<CELLS> {
    /// Creates a workspace.
    #[must_use]
    pub const fn new() -> Self {
        Self { field: CostField::new(), land: [0; CELLS] }
    }

    /// The last search.
    #[must_use]
    pub const fn field(&self) -> &CostField<CELLS> {
        &self.field
    }
}

/// Windowed routing to the own goal. Remembers the visits of `M` cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RouteGuidance<const CELLS: usize, const M: usize, const L: usize = 0> {
    params: RouteParams,
    replan: Replan,
    sharpness: Sharpness,
    router: Router<M, L>,
    travel: MoveHistory,
}

impl<const CELLS: usize, const M: usize, const L: usize> RouteGuidance<CELLS, M, L> {
    /// Creates the law. By default it searches in each cell and tries cheap moves first.
    #[must_use]
    pub const fn new(params: RouteParams) -> Self {
        Self {
            params,
            replan: Replan::EachCell,
            sharpness: Sharpness::Greedy,
            router: Router::new(),
            travel: MoveHistory::new(),
        }
    }

    /// Sets when to repeat the search; [`Replan::UntilChanged`] offers one move, unshuffled.
    #[must_use]
    pub const fn replan(mut self, replan: Replan) -> Self {
        self.replan = replan;
        self
    }

    /// Sets how strictly the order of moves follows their weights.
    #[must_use]
    pub const fn sharpness(mut self, sharpness: Sharpness) -> Self {
        self.sharpness = sharpness;
        self
    }

    fn moves<S>(
        &mut self,
        input: &GuidanceInput<'_, S>,
        window: &Window<'_>,
        (cell, target): (Cell, Cell),
        is_redirected: bool,
        rng: &mut Rng,
        workspace: &mut GridWorkspace<CELLS>,
    ) -> Option<Vec<Dir, 8>> {
        let params = &self.params;
        let field = &mut workspace.field;
        let others = input.neighbors.iter().map(|neighbor| neighbor.cell);
        if self.replan == Replan::UntilChanged && !is_redirected {
            let dir = self.router.follow(params, field, window, cell, target, others).ok()?;
            return Some(list::collect([dir]));
        }
        let aside = |weights: Weights| self.travel.without_last(weights);
        let mut weights = if is_redirected && cell == target {
            Weights::CLOSED
        } else {
            self.router.weights_over(params, field, window, (cell, target), others, input.land).ok()?
        };
        if is_redirected {
            weights = aside(weights);
            if weights.best().is_none() {
                weights = aside(params.open_moves(window, cell));
            }
        }
        // The robot that sent the request may be in the preferred direction, so vary the choice.
        let sharpness = if is_redirected { Sharpness::HalvedPer(Gain::ONE) } else { self.sharpness };
        Some(MoveHistory::order(&weights, sharpness, 8, rng))
    }
}

impl<const CELLS: usize, const M: usize, const L: usize> Teamwork for RouteGuidance<CELLS, M, L> {
    fn redirect(&mut self) {
        self.travel.redirect();
    }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize> Guidance<S> for RouteGuidance<CELLS, M, L> {
    type Input<'a> = OnGrid<'a>;
    type Destination = ToCells;
    type Workspace = GridWorkspace<CELLS>;
    type Payload = ();

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S>,
        here: &OnGrid<'_>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        let (cell, window) = on_grid(here)?;
        let target = reachable_goal(&window, input.goal);
        self.router.observe(&self.params, cell, target);
        let makes_way = self.travel.take_redirection();
        let mut status = Status { is_at_goal: cell == target, makes_way, ..Status::default() };
        let mut moves = Vec::new();
        if !status.is_at_goal || makes_way {
            let open = self.moves(input, &window, (cell, target), makes_way, rng, workspace);
            status.is_stuck = open.is_none();
            moves = open.unwrap_or_default();
            avoid_crossing(&mut moves, input, (&window, self.params.norm), cell);
        }
        let choice = moves.first().copied().unwrap_or_default();
        let idle = if makes_way { u8::MAX } else { self.router.idle() };
        Ok(Decision {
            action: Action::Moves(moves),
            status,
            target,
            asks: list::collect(self.travel.note(input, cell, choice, idle)),
            ..Decision::default()
        })
    }

    fn goes_by_velocity(&self) -> bool {
        false
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
    }
}
