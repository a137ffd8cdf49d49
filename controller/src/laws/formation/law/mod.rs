//! Moving in formation (A. V. Kuznetsov 2017, KUZ, algorithm 2); see [`crate::formation`].

use super::{
    Anchor, Footprint, FormationParams, Found, GapClosing, GraphDistance, Member, NextMove, PaceControl, Recovery,
    Seen, Steering, blended, def, distances, find_leader, find_neighbors, graph_distance, should_stay,
};
use crate::cost::Weights;
use crate::grid::{Cell, Dir, Window};
use crate::law::{Action, BadInput, Decision, Law, OnGrid, Progress, Radio, Report, Tools, View, Wait};
use crate::laws::cells::{
    FarMap, Grid, GridMessage, GridNeighbor, GridOrder, GridPayload, GridTask, GridWorkspace, MoveHistory, PATIENCE,
    TemplateAssembler, avoid_crossing,
};
use crate::list;
use crate::neighbor::Trace;
use crate::parameters::Parameters;
use crate::robot::{Mode, RobotId};
use crate::route::{RouteParams, Router};
use crate::scalar::Scalar;
use crate::shuffle::Sharpness;
use crate::template::Template;
use crate::time::Duration;
use core::iter::successors;
use heapless::Vec;
use serde::{Deserialize, Serialize};

mod foresight;
mod in_plane;

pub use in_plane::FormationInPlane;

/// Moves to try. A robot that finds both occupied waits; with all eight it would leave its place.
const ALTERNATIVES: usize = 2;

/// Moving in formation, with the visits of `M` cells and a template of `F` neighbours; alone
/// without a template. `K` predicts the leader by its next move or by another [`Steering`]; `H` is
/// a map of the terrain beyond the window.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FormationGuidance<
    const CELLS: usize,
    const M: usize,
    const F: usize,
    const L: usize = 0,
    K = NextMove,
    H = (),
> {
    route: RouteParams,
    formation: FormationParams,
    sharpness: Sharpness,
    template: Template<F>,
    ranks: GapClosing,
    assembler: TemplateAssembler<F>,
    router: Router<M, L>,
    travel: MoveHistory,
    pace: PaceControl,
    leader: RobotId,
    leader_offset: Cell,
    crowded: u8,
    has_asked: bool,
    waited: u16,
    /// Consecutive decisions in which it was behind, or off its place with an arrived top leader.
    behind: u16,
    /// As in the plane: the slowest robot sets the pace.
    #[serde(with = "crate::digest::uncounted")]
    is_rigid: bool,
    steering: K,
    task: GridTask,
    map: H,
}

struct Guide {
    anchor: Anchor,
    /// [`UNIT`](crate::grid::UNIT)s behind its place.
    lag: u32,
    has_arrived: bool,
}

impl<const CELLS: usize, const M: usize, const F: usize, const L: usize> FormationGuidance<CELLS, M, F, L> {
    /// Creates the law for one place in the formation, without a map.
    #[must_use]
    pub const fn new(route: RouteParams, formation: FormationParams, template: Template<F>) -> Self {
        Self::steered(route, formation, template, NextMove, ())
    }
}

impl<const CELLS: usize, const M: usize, const F: usize, const L: usize, K: Steering, H>
    FormationGuidance<CELLS, M, F, L, K, H>
{
    /// Creates the law with followers that steer by `steering`, and with a map.
    #[must_use]
    pub const fn steered(
        route: RouteParams,
        formation: FormationParams,
        template: Template<F>,
        steering: K,
        map: H,
    ) -> Self {
        Self {
            route,
            formation,
            sharpness: Sharpness::Greedy,
            template,
            ranks: GapClosing::new(),
            assembler: TemplateAssembler::new(),
            router: Router::new(),
            travel: MoveHistory::new(),
            pace: PaceControl::new(),
            leader: RobotId::NONE,
            leader_offset: Cell::new(0, 0),
            crowded: 0,
            has_asked: false,
            waited: 0,
            behind: 0,
            is_rigid: false,
            steering,
            task: GridTask::NEW,
            map,
        }
    }

    /// Sets how strictly the order of moves follows their weights.
    #[must_use]
    pub const fn sharpness(mut self, sharpness: Sharpness) -> Self {
        self.sharpness = sharpness;
        self
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &H {
        &self.map
    }

    /// The assigned template.
    #[must_use]
    pub const fn template(&self) -> &Template<F> {
        &self.template
    }

    /// Returns how far `neighbors`, the robots of
    /// [`Agent::neighbors`](crate::agent::Agent::neighbors) on the grid, are from their places in
    /// the template of robot `id` in `cell`. O(F N).
    #[must_use]
    pub fn graph_distance(
        &self,
        id: RobotId,
        cell: Cell,
        neighbors: impl Iterator<Item = GridNeighbor> + Clone,
    ) -> GraphDistance {
        let robots = neighbors.clone().map(|other| seen_at(&other, other.cell));
        let found = find_neighbors(&self.view(id, neighbors), cell, self.formation.eps, robots);
        graph_distance(cell, &found)
    }

    fn view(&self, own: RobotId, neighbors: impl Iterator<Item = GridNeighbor> + Clone) -> Template<F> {
        if self.formation.closes_ranks {
            self.ranks.view(own, &self.template, holders(neighbors))
        } else {
            self.template.clone()
        }
    }

    // Functions with large stack frames are not inlined, so only one frame is live at a time.

    /// Returns the highest leader with a known place, and the own place relative to it.
    fn top<S: Copy>(&self, input: &View<'_, S, Grid>, view: &Template<F>) -> Option<(RobotId, Cell)> {
        let heard = |id: RobotId| input.grid_neighbor(id);
        let first = heard(self.leader)?;
        // Ids decrease along the chain, so it ends; a wrong beacon cannot make it a cycle.
        let chain = successors(Some(first), |robot| heard(robot.leader).filter(|next| next.id < robot.id));
        let placed = chain.filter_map(|robot| {
            let named = view.entries.iter().find(|e| e.id == robot.id);
            let offset = match named {
                Some(entry) => Cell::default() - entry.offset,
                None if !robot.leader.is_some() => view.offset,
                None if robot.id == self.leader => self.leader_offset,
                None => return None,
            };
            Some((robot.id, offset))
        });
        placed.last()
    }

    /// Keeps a leader while it is known, however far away (the paper chooses it only at t = 0).
    fn choose_leader<S: Copy>(&mut self, input: &View<'_, S, Grid>, found: &Found<F>) {
        let leader = find_leader(input.id, &found.members);
        if leader.is_some() || input.grid_neighbor(self.leader).is_none() {
            self.leader = leader;
        }
        let member = found.members.iter().find(|m| m.seen.id == self.leader);
        if let Some(member) = member {
            self.leader_offset = Cell::default() - member.offset;
        }
    }

    #[inline(never)]
    fn lead<S: Copy>(
        &mut self,
        input: &View<'_, S, Grid>,
        window: &Window<'_>,
        (cell, target): (Cell, Cell),
        (found, view): (&Found<F>, &Template<F>),
        workspace: &mut GridWorkspace<CELLS>,
    ) -> Option<Weights>
    where
        H: FarMap,
    {
        let GridWorkspace { field, land, .. } = workspace;
        let footprint = Footprint::of(self.formation.footprint, self.is_rigid).filter(|_| !found.members.is_empty());
        let around = (cell, self.route.radius);
        let shown = footprint.and_then(|footprint| blended(window, around, &view.entries, footprint, land));
        let shown = shown.as_ref().unwrap_or(window);
        let others = input.on_grid().map(|neighbor| neighbor.cell);
        self.router.weights_over(&self.route, field, shown, (cell, target), others, self.map.land()).ok()
    }

    #[inline(never)]
    fn follow<S: Copy>(
        &self,
        input: &View<'_, S, Grid>,
        window: &Window<'_>,
        (cell, target): (Cell, Cell),
        guide: &Guide,
        found: &Found<F>,
        workspace: &mut GridWorkspace<CELLS>,
    ) -> Option<Weights> {
        let (aims, members): (_, &[Member]) = if guide.has_arrived {
            ([target; 2], &[])
        } else {
            (self.steering.aims(&self.formation, &guide.anchor, target), &found.members)
        };
        let [far, near] = aims;
        let place = window.reachable(far);
        let near = if near == far { place } else { window.reachable(near) };
        let price = distances(&self.formation, cell, Some(near), members);
        if place == cell {
            return Some(price);
        }
        // Beyond the window the robot could circle in front of an obstacle, so it remembers visits.
        let is_in_sight = window.get(place).is_some();
        let visits = (!is_in_sight).then_some(self.router.visits());
        let others = input.on_grid().map(|neighbor| neighbor.cell);
        let weights = workspace.field.weights(&self.route, window, cell, place, others, visits).ok()?;
        Some(weights.plus(&price))
    }

    fn guide<S: Copy>(
        &mut self,
        input: &View<'_, S, Grid>,
        view: &Template<F>,
        cell: Cell,
        seen: &[Seen],
    ) -> Option<Guide> {
        let top = self.top(input, view);
        let top = top.and_then(|(top, offset)| Some((seen.iter().find(|seen| seen.id == top)?, offset)));
        self.steering.note(top.map_or((input.id, cell), |(seen, _)| (seen.id, seen.cell)));
        let (seen, offset) = top?;
        let off = cell - (seen.cell + offset);
        Some(Guide {
            anchor: Anchor { predicted: seen.predicted, offset, heading: seen.heading },
            lag: self.steering.lag(off, seen.heading),
            has_arrived: seen.mode == Mode::Arrived,
        })
    }

    /// Whether it has been behind for so long that it travels alone until it is back in its place.
    fn has_lost_touch(&mut self, guide: &Guide) -> bool {
        let limit = if self.behind == 0 { self.formation.halt_lag } else { self.formation.resume_lag };
        let is_behind = guide.has_arrived || guide.lag > u32::from(limit.min(self.formation.halt_lag));
        self.behind = if is_behind { self.behind.saturating_add(1) } else { 0 };
        self.behind > self.formation.patience
    }

    /// The robot that passes messages on to the leader: the first one of the formation that is
    /// received, if it comes before this one. None if the leader is received, or no other one.
    fn next_hop<S: Copy>(&self, input: &View<'_, S, Grid>) -> RobotId {
        let is_heard = |id: RobotId| input.neighbor(id).is_some_and(|known| known.trace != Trace::Told);
        if is_heard(self.leader) {
            return RobotId::NONE;
        }
        let members = self.template.entries.iter().map(|entry| entry.id);
        members.filter(|id| *id < input.id && is_heard(*id)).min().unwrap_or(RobotId::NONE)
    }

    /// Returns a foreign robot in a neighbour's place, to be redirected (KUZ section 7).
    fn ask_surplus(&mut self, found: &Found<F>) -> Option<RobotId> {
        if found.more == 0 {
            self.crowded = 0;
            return None;
        }
        self.crowded = self.crowded.saturating_add(1);
        if self.crowded < PATIENCE {
            return None;
        }
        self.crowded = 0;
        Some(found.surplus)
    }

    fn ask_pace(&mut self, own: RobotId, lag: u32, valid: Duration) -> Option<GridMessage> {
        let has_fallen_behind = self.pace.update(&self.formation, lag);
        let message = match (has_fallen_behind, self.has_asked) {
            (true, _) => GridMessage::stop(own, valid),
            (false, true) => GridMessage::Resume { origin: own },
            (false, false) => return None,
        };
        self.has_asked = has_fallen_behind;
        Some(message)
    }
}

/// Whether robot `other` follows this one. Ids decrease along the chain, so it ends.
fn comes_after<S: Copy>(input: &View<'_, S, Grid>, other: RobotId, leader: RobotId) -> bool {
    let heard = |id: RobotId| input.grid_neighbor(id);
    let chain = successors(Some((other, leader)), |&(id, leader)| {
        heard(leader).filter(|next| leader != input.id && next.id < id).map(|next| (next.id, next.leader))
    });
    chain.last().is_some_and(|(_, leader)| leader.is_some())
}

/// The robots that hold places; strangers hold none.
fn holders(neighbors: impl Iterator<Item = GridNeighbor> + Clone) -> impl Iterator<Item = (RobotId, u8)> + Clone {
    neighbors.filter(|other| other.is_peer).map(|other| (other.id, other.slot))
}

const fn seen_at(other: &GridNeighbor, predicted: Cell) -> Seen {
    Seen { id: other.id, cell: other.cell, predicted, heading: other.heading, leader: other.leader, mode: other.mode }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, K: Steering, H: FarMap> Law<S>
    for FormationGuidance<CELLS, M, F, L, K, H>
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
        let valid = radio.valid;
        let mut ask = |to: RobotId, message: &GridMessage| {
            radio.send(to, message, valid);
        };
        let Some(goal) = self.task.goal(input, self.template.offset) else { return Ok(Decision::idle()) };
        let (cell, window) = here.seen()?;
        self.map.see(&window, cell, goal);
        if self.formation.closes_ranks && cell != goal + self.ranks.shift() {
            self.ranks.close(input.id, &self.template, holders(input.on_grid()));
        }
        let view = &self.view(input.id, input.on_grid());
        let target = window.reachable(goal + self.ranks.shift());
        self.router.observe(&self.route, cell, target);

        let mut seen = Vec::new();
        self.seen(input, (&window, view), &mut workspace.field, &mut seen);
        let found = find_neighbors(view, cell, self.formation.eps, seen.iter().copied());
        self.choose_leader(input, &found);
        let leader = self.leader;
        self.task.next_hop = self.next_hop(input);
        let upwards = self.task.towards(leader);
        let guide = self.guide(input, view, cell, &seen);
        let goes_alone = guide.as_ref().is_some_and(|guide| self.has_lost_touch(guide));
        let guide = guide.filter(|_| !goes_alone);
        let makes_way = self.travel.take_redirection();
        let (mut is_at_goal, mut progress) = (cell == target, Progress::Going);
        let mut stays = false;
        let weights = if let Some(guide) = &guide {
            self.router.forget_route();
            if let Some(message) = self.ask_pace(input.id, guide.lag, valid) {
                ask(upwards, &message);
            }
            if self.pace.waits() {
                progress = Progress::Forming;
            }
            is_at_goal &= guide.has_arrived;
            let weights = self.follow(input, &window, (cell, target), guide, &found, workspace);
            if let (Some(first), false) = (weights.and_then(|w| w.best()), guide.has_arrived) {
                // Relative to the assigned place, even if it is impassable.
                let [_, place] = self.steering.aims(&self.formation, &guide.anchor, target);
                stays = should_stay(cell, place, first);
            }
            weights
        } else {
            // Wait only for robots that follow this one and still move: a separated part of the
            // formation would wait for ever for robots that reached the goal first.
            let is_under_way = |mode: Mode| mode.gives_way() && mode != Mode::Arrived;
            let able = found.members.iter();
            let able = able.filter(|Member { seen, .. }| {
                !goes_alone && is_under_way(seen.mode) && comes_after(input, seen.id, seen.leader)
            });
            let behind = able.map(|member| {
                let off = member.seen.cell - (cell + member.offset);
                self.steering.lag(off, self.travel.choice())
            });
            let waits = self.pace.update(&self.formation, behind.max().unwrap_or(0));
            self.waited = if waits { self.waited.saturating_add(1) } else { 0 };
            let is_bearable = self.waited <= self.formation.patience;
            if waits && is_bearable {
                progress = Progress::Waiting(Wait::Team);
            }
            if goes_alone && core::mem::take(&mut self.has_asked) {
                ask(upwards, &GridMessage::Resume { origin: input.id });
            }
            self.lead(input, &window, (cell, target), (&found, view), workspace)
        };
        let is_stuck = weights.is_none();
        let mut weights = weights.unwrap_or(Weights::CLOSED);
        if makes_way {
            weights = self.travel.without_last(weights);
            stays = false;
        }
        let alternatives = if self.travel.is_jammed() { Dir::MOVES.len() } else { ALTERNATIVES };
        let mut moves = MoveHistory::order(&weights, self.sharpness, alternatives, rng);
        if progress == Progress::Waiting(Wait::Team) && self.formation.recovery == Recovery::Def {
            let towards = def(cell, &found.members);
            let recovers = towards != Dir::Stay;
            if recovers {
                progress = Progress::Recovering;
            }
            moves = list::collect(recovers.then_some(towards));
        }
        if stays {
            moves.clear();
        }
        avoid_crossing(&mut moves, input, (&window, self.route.norm), cell);
        let choice = moves.first().copied().unwrap_or_default();
        let blocked = self.travel.note(input, cell, choice, 0);
        if progress != Progress::Waiting(Wait::Team) && !is_at_goal {
            blocked.into_iter().for_each(|to| ask(to, &GridMessage::Redirect));
            self.ask_surplus(&found).into_iter().for_each(|to| ask(to, &GridMessage::Redirect));
        }
        self.task.show(goal, target);
        (self.task.shown.leader, self.task.shown.slot) = (leader, view.slot);
        let progress = match progress {
            _ if is_at_goal => Progress::Arrived,
            Progress::Going | Progress::Forming | Progress::Recovering if is_stuck => Progress::Stuck,
            progress => progress,
        };
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
        if self.task.order(order, self.template.offset) {
            return true;
        }
        let Ok(whole) = self.assembler.order(order) else { return false };
        if let Some(template) = whole {
            self.template = template;
            self.ranks = GapClosing::new();
            self.pace = PaceControl::new();
            self.leader = RobotId::NONE;
            (self.waited, self.behind) = (0, 0);
        }
        true
    }

    fn needs(&self, id: RobotId) -> bool {
        self.template.entries.iter().any(|entry| entry.id == id)
    }

    fn report(&self) -> Report {
        self.task.report()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.route);
        visit(&mut self.formation);
    }
}
