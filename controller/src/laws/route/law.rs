//! Routing of a single robot to its own goal (A. V. Kuznetsov 2017, KUZ, algorithm 1).

use super::{Replan, RouteParams, Router};
use crate::cost::{Gain, Weights};
use crate::grid::{Cell, Dir, Window};
use crate::law::{Action, BadInput, Decision, Law, OnGrid, Progress, Radio, Report, Tools, View};
use crate::laws::cells::{
    FarMap, Grid, GridMessage, GridOrder, GridPayload, GridTask, GridWorkspace, MoveHistory, avoid_crossing,
};
use crate::list;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::shuffle::Sharpness;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Windowed routing to the own goal, with a map `H` of the terrain beyond the window. Remembers the
/// visits of `M` cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RouteGuidance<const CELLS: usize, const M: usize, const L: usize = 0, H = ()> {
    params: RouteParams,
    replan: Replan,
    sharpness: Sharpness,
    router: Router<M, L>,
    travel: MoveHistory,
    task: GridTask,
    map: H,
}

impl<const CELLS: usize, const M: usize, const L: usize> RouteGuidance<CELLS, M, L> {
    /// Creates the law without a map. It searches in each cell and tries cheap moves first.
    #[must_use]
    pub const fn new(params: RouteParams) -> Self {
        Self::with_map(params, ())
    }
}

impl<const CELLS: usize, const M: usize, const L: usize, H> RouteGuidance<CELLS, M, L, H> {
    /// Creates the law with a map.
    #[must_use]
    pub const fn with_map(params: RouteParams, map: H) -> Self {
        Self {
            params,
            replan: Replan::EachCell,
            sharpness: Sharpness::Greedy,
            router: Router::new(),
            travel: MoveHistory::new(),
            task: GridTask::NEW,
            map,
        }
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &H {
        &self.map
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

    fn moves<S: Copy>(
        &mut self,
        input: &View<'_, S, Grid>,
        window: &Window<'_>,
        (cell, target): (Cell, Cell),
        is_redirected: bool,
        rng: &mut Rng,
        workspace: &mut GridWorkspace<CELLS>,
    ) -> Option<Vec<Dir, 8>>
    where
        H: FarMap,
    {
        let params = &self.params;
        let field = &mut workspace.field;
        let others = input.on_grid().map(|neighbor| neighbor.cell);
        if self.replan == Replan::UntilChanged && !is_redirected {
            let dir = self.router.follow(params, field, window, cell, target, others).ok()?;
            return Some(list::collect([dir]));
        }
        let aside = |weights: Weights| self.travel.without_last(weights);
        let mut weights = if is_redirected && cell == target {
            Weights::CLOSED
        } else {
            self.router.weights_over(params, field, window, (cell, target), others, self.map.land()).ok()?
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

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H: FarMap> Law<S>
    for RouteGuidance<CELLS, M, L, H>
{
    type Surroundings<'a> = OnGrid<'a>;
    type Protocol = Grid;
    type Workspace = GridWorkspace<CELLS>;

    fn decide(
        &mut self,
        input: &View<'_, S, Grid>,
        here: &OnGrid<'_>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Tools { rng, mut radio, workspace } = tools;
        let Some(goal) = self.task.goal(input, Cell::default()) else { return Ok(Decision::idle()) };
        let (cell, window) = here.seen()?;
        self.map.see(&window, cell, goal);
        let target = window.reachable(goal);
        self.task.show(goal, target);
        self.router.observe(&self.params, cell, target);
        let makes_way = self.travel.take_redirection();
        let mut progress = Progress::at_goal(cell == target);
        let mut moves = Vec::new();
        if progress == Progress::Going || makes_way {
            let open = self.moves(input, &window, (cell, target), makes_way, rng, workspace);
            if open.is_none() && progress == Progress::Going {
                progress = Progress::Stuck;
            }
            moves = open.unwrap_or_default();
            avoid_crossing(&mut moves, input, (&window, self.params.norm), cell);
        }
        let choice = moves.first().copied().unwrap_or_default();
        let idle = if makes_way { u8::MAX } else { self.router.idle() };
        if let Some(blocker) = self.travel.note(input, cell, choice, idle) {
            radio.send(blocker, &GridMessage::Redirect, radio.valid);
        }
        Ok(Decision { makes_way, ..Decision::new(Action::Moves(moves), progress) })
    }

    fn payload(&mut self, here: &OnGrid<'_>, heading: Dir, radio: &mut Radio<'_, Grid>) -> GridPayload {
        if let Some(patch) = self.map.say(radio.now()) {
            radio.broadcast(&GridMessage::Land(patch));
        }
        self.task.payload(here, heading)
    }

    fn receive(&mut self, from: RobotId, message: &GridMessage, radio: &mut Radio<'_, Grid>) -> bool {
        self.task.receive(from, message, radio);
        match message {
            GridMessage::Redirect => self.travel.redirect(),
            GridMessage::Land(patch) => self.map.hear(patch),
            GridMessage::Stop { .. } | GridMessage::Resume { .. } => {}
        }
        true
    }

    fn order(&mut self, order: &GridOrder) -> bool {
        self.task.order(order, Cell::default())
    }

    fn report(&self) -> Report {
        self.task.report()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
    }
}
