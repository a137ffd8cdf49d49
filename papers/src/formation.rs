//! Moving in formation as published (A. V. Kuznetsov 2017, KUZ, algorithm 2): each robot weighs its
//! own shortest route against all neighbours that it finds. For comparison only: with weights that
//! keep the published error it takes up to 2.4 times as long as Staya's law, and five runs of 1400
//! leave a robot behind (`staya experiment formation`).
//!
//! [`PublishedFormation::decide`] follows algorithm 2 line by line; its criteria are in
//! [`crate::criteria`]. Where the paper is ambiguous or contradicts itself:
//! - t = 0 (line 4) ends when every robot of the template was found once, since packets are lost.
//! - Lines 11 and 19 would replace the true target when repeated. The true one is kept.
//! - Line 12 heads for the cell that `def` points at, in one of eight directions.
//! - A robot that is asked to stop stands, as does each one that passes the request on, unless it
//!   heads for `def`. It continues when its own sum is about r0 again (line 15). On the wire each
//!   stop belongs to its sender, so line 16 cancels only own requests.
//! - A robot that has reached its target stands there (eq. 2) and sends no requests.
//! - `predict` uses the target in another robot's beacon and the own template for its neighbours.
//! - Line 24 shuffles again, which is another draw. Missing and surplus robots are redirected (item
//!   6).

use crate::criteria::{Kept, PublishedParams, smallest_below, sum_of_deviations, sums, sums_of_other};
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    Action, BadInput, Decision, Grid, GridMessage, GridNeighbor, GridOrder, GridPayload, GridTask, GridWorkspace, Law,
    OnGrid, Progress, Radio, Report, TemplateAssembler, Tools, View, Wait,
};
use staya_controller::cost::{Gain, Weights};
use staya_controller::formation::{
    Found, GraphDistance, Member, Prediction, Seen, def, find_neighbors, graph_distance,
};
use staya_controller::grid::{BLOCKED, Cell, Dir, Window};
use staya_controller::parameters::Parameters;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::route::{CostField, RouteParams, VisitMemory};
use staya_controller::scalar::Scalar;
use staya_controller::shuffle::{Sharpness, weighted_shuffle};
use staya_controller::template::Template;
use staya_controller::time::Duration;

/// Moving in formation as published, with the visits of `M` cells and a template of `F` neighbours.
/// Work of a decision: one search, plus one per neighbour found with [`Prediction::Reflexive`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PublishedFormation<const CELLS: usize, const M: usize, const F: usize> {
    route: RouteParams,
    formation: PublishedParams,
    sharpness: Sharpness,
    template: Template<F>,
    assembler: TemplateAssembler<F>,
    visits: VisitMemory<M>,
    here: Option<Cell>,
    leader: RobotId,
    /// The leader is fixed (line 4).
    has_chosen: bool,
    /// The temporary target (lines 11 and 19).
    detour: Option<Cell>,
    has_asked: bool,
    choice: Dir,
    is_redirected: bool,
    task: GridTask,
}

impl<const CELLS: usize, const M: usize, const F: usize> PublishedFormation<CELLS, M, F> {
    /// Creates the law for one place in the formation.
    #[must_use]
    pub const fn new(route: RouteParams, formation: PublishedParams, template: Template<F>) -> Self {
        Self {
            route,
            formation,
            sharpness: Sharpness::Greedy,
            template,
            assembler: TemplateAssembler::new(),
            visits: VisitMemory::new(),
            here: None,
            leader: RobotId::NONE,
            has_chosen: false,
            detour: None,
            has_asked: false,
            choice: Dir::Stay,
            is_redirected: false,
            task: GridTask::NEW,
        }
    }

    /// Sets how strictly the order of moves follows their weights. The paper shuffles.
    #[must_use]
    pub const fn sharpness(mut self, sharpness: Sharpness) -> Self {
        self.sharpness = sharpness;
        self
    }

    /// Returns how far the neighbours are from their places in the template. O(F N).
    #[must_use]
    pub fn graph_distance(&self, cell: Cell, neighbors: impl Iterator<Item = GridNeighbor> + Clone) -> GraphDistance {
        let robots = neighbors.map(|other| seen_at(&other, other.cell));
        graph_distance(cell, &find_neighbors(&self.template, cell, self.formation.eps, robots))
    }

    /// Algorithm 5 with `predict`.
    #[inline(never)]
    fn found<S: Copy>(
        &self,
        input: &View<'_, S, Grid>,
        window: &Window<'_>,
        cell: Cell,
        field: &mut CostField<CELLS>,
    ) -> Found<F> {
        let robots = input.on_grid().map(|other| seen_at(&other, other.cell));
        let mut found = find_neighbors(&self.template, cell, self.formation.eps, robots);
        for member in &mut found.members {
            if let Some(next) = self.predict(input, window, cell, member, field) {
                member.seen.predicted = next;
            }
        }
        found
    }

    /// Position of another robot at the next tick (section 7, item 1); `None` if it does not move.
    fn predict<S: Copy>(
        &self,
        input: &View<'_, S, Grid>,
        window: &Window<'_>,
        own: Cell,
        member: &Member,
        field: &mut CostField<CELLS>,
    ) -> Option<Cell> {
        let seen = &member.seen;
        let neighbor = input.grid_neighbor(seen.id)?;
        let is_free = (input.now + input.tick).since(neighbor.busy_until) >= Duration::ZERO;
        if !is_free || !matches!(seen.mode, Mode::Cruise | Mode::Forming) || neighbor.target == seen.cell {
            return None;
        }
        let is_in_sight = Dir::MOVES.iter().all(|dir| window.get(seen.cell + dir.offset()).is_some());
        if self.formation.prediction == Prediction::Constant || !is_in_sight {
            let next = seen.cell + seen.heading.offset();
            return (window.get(next) != Some(BLOCKED)).then_some(next);
        }
        let params = RouteParams { a2: Gain::ZERO, ..self.route };
        let no_robots = core::iter::empty();
        let ways = field.weights::<0>(&params, window, seen.cell, neighbor.target, no_robots, None).ok()?;
        let cell_of = |id: RobotId| input.grid_neighbor(id).map(|third| third.cell);
        let price = sums_of_other(self.formation.gain, (member, own), &self.template.entries, cell_of);
        ways.plus(&price).best().map(|dir| seen.cell + dir.offset())
    }

    /// Lines 10 to 23. Returns a message to the own leader, and whether to continue despite a stop.
    fn keep(
        &mut self,
        (own, valid): (RobotId, Duration),
        (cell, target): (Cell, Cell),
        (is_leader, sum): (bool, u32),
        found: &Found<F>,
    ) -> (Option<GridMessage>, bool) {
        let kept = self.formation.judge(sum);
        match kept {
            Kept::Lost if is_leader => self.detour = Some(cell + def(cell, &found.members).offset()),
            Kept::Lost => {
                let leader = found.members.iter().find(|member| member.seen.id == self.leader);
                self.detour = leader.map(|member| member.seen.cell - member.offset).or(self.detour);
            }
            Kept::Well => self.detour = None,
            Kept::Fairly => {}
        }
        let is_asked_for = kept == Kept::Lost;
        let ask = match kept {
            Kept::Lost => Some(GridMessage::stop(own, valid)),
            Kept::Well if self.has_asked => Some(GridMessage::Resume { origin: own }),
            Kept::Well | Kept::Fairly => None,
        };
        self.has_asked = is_asked_for || (self.has_asked && ask.is_none());
        self.detour = self.detour.filter(|&detour| detour != target);
        (ask, kept == Kept::Well || (is_leader && self.detour.is_some()))
    }

    /// Line 24 and item 6: the robots to redirect.
    fn ask_others<S: Copy>(&self, input: &View<'_, S, Grid>, found: &Found<F>) -> [Option<RobotId>; 2] {
        if !self.formation.is_crowded(found) {
            return [None; 2];
        }
        let is_found = |id: RobotId| found.members.iter().any(|member| member.seen.id == id);
        let mut missing = self.template.entries.iter().map(|entry| entry.id);
        let missing = missing.find(|&id| input.neighbor(id).is_some() && !is_found(id));
        let surplus = Some(found.surplus).filter(|id| id.is_some());
        [surplus, missing]
    }
}

const fn seen_at(other: &GridNeighbor, predicted: Cell) -> Seen {
    Seen { id: other.id, cell: other.cell, predicted, heading: other.heading, leader: other.leader, mode: other.mode }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize> Law<S> for PublishedFormation<CELLS, M, F> {
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
        let Some(goal) = self.task.goal(input, self.template.offset) else { return Ok(Decision::idle()) };
        let (cell, window) = here.seen()?;
        if self.here != Some(cell) {
            self.here = Some(cell);
            self.visits.enter(cell);
        }
        let field = workspace.field_mut();
        let target = window.reachable(goal);
        let is_redirected = core::mem::take(&mut self.is_redirected);
        self.task.show(goal, target);
        (self.task.shown.leader, self.task.shown.slot) = (self.leader, self.template.slot);
        if cell == target {
            return Ok(Decision::new(Action::Stay, Progress::Arrived));
        }
        // Lines 3 to 6.
        let found = self.found(input, &window, cell, field);
        if !self.has_chosen {
            self.leader = smallest_below(input.id, &found.members);
            self.has_chosen = found.less == 0;
        }
        self.task.shown.leader = self.leader;
        // Lines 2, 7 and 8.
        let heads_for = window.reachable(self.detour.unwrap_or(target));
        let price = sums(self.formation.gain, cell, &found.members);
        let ways = if heads_for == cell {
            // Algorithm 3, line 6.
            Some(Weights::CLOSED)
        } else {
            let others = input.on_grid().map(|neighbor| neighbor.cell);
            field.weights(&self.route, &window, cell, heads_for, others, Some(&self.visits)).ok()
        };
        let is_stuck = ways.is_none();
        let mut weights = ways.unwrap_or(Weights::CLOSED).plus(&price);
        if is_redirected {
            weights = weights.without(self.choice);
        }
        let mut moves = weighted_shuffle(&weights, self.sharpness, rng);
        if self.formation.is_crowded(&found) {
            // Line 25.
            moves = weighted_shuffle(&weights, self.sharpness, rng);
        }
        self.choice = moves.first().copied().unwrap_or_default();
        // Lines 9 to 23.
        let sum = sum_of_deviations(cell + self.choice.offset(), &found.members);
        let is_leader = input.on_grid().any(|other| other.leader == input.id);
        let valid = radio.valid;
        let (ask, continues) = self.keep((input.id, valid), (cell, target), (is_leader, sum), &found);
        if let Some(message) = ask.filter(|_| self.leader.is_some()) {
            radio.send(self.leader, &message, valid);
        }
        for to in self.ask_others(input, &found).into_iter().flatten() {
            radio.send(to, &GridMessage::Redirect, valid);
        }
        let stands = self.task.is_stopped(input.now) && !continues;
        let progress = match self.detour {
            _ if stands => Progress::Waiting(Wait::Stopped),
            _ if is_stuck => Progress::Stuck,
            Some(_) => Progress::Forming,
            None => Progress::Going,
        };
        Ok(Decision::new(Action::Moves(moves), progress))
    }

    fn payload(&mut self, here: &OnGrid<'_>, heading: Dir, _: &mut Radio<'_, Grid>) -> GridPayload {
        self.task.payload(here, heading)
    }

    fn receive(&mut self, from: RobotId, message: &GridMessage, radio: &mut Radio<'_, Grid>) -> bool {
        self.task.receive(from, message, radio);
        self.is_redirected |= *message == GridMessage::Redirect;
        true
    }

    fn order(&mut self, order: &GridOrder) -> bool {
        if self.task.order(order, self.template.offset) {
            return true;
        }
        let Ok(whole) = self.assembler.order(order) else { return false };
        if let Some(template) = whole {
            self.template = template;
            (self.leader, self.has_chosen) = (RobotId::NONE, false);
            self.detour = None;
        }
        true
    }

    fn needs(&self, id: RobotId) -> bool {
        self.template.entries.iter().any(|entry| entry.id == id)
    }

    /// The law decides itself which requests to stop it follows.
    fn report(&self) -> Report {
        Report { stopped_until: None, ..self.task.report() }
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.route);
    }
}
