//! Travelling in formation (A. V. Kuznetsov 2017, KUZ, algorithm 2): the top leader chooses the way for all, the others
//! keep their places beside it. See [`crate::formation`] for what differs from the paper and why.

use super::guidance::{Action, Ask, BadInput, Decision, Guidance, GuidanceInput, Status, Teamwork, ToCells};
use super::route_guidance::GridWorkspace;
use super::travel::{PATIENCE, Travel, on_grid, reachable_goal};
use super::tunable::Tunable;
use super::{OnGrid, Parameter, Wait};
use crate::cost::Weights;
use crate::formation::{
    Anchor, Footprint, FormationParams, Found, GraphDistance, Member, NextMove, Pace, Ranks, Recovery, Seen, Steering,
    blended, def, distances, find_leader, find_neighbors, graph_distance, should_stay,
};
use crate::grid::{Cell, Dir, Window};
use crate::list;
use crate::neighbor::Neighbor;
use crate::rand::Rng;
use crate::robot::{Mode, RobotId};
use crate::route::{RouteParams, Router};
use crate::scalar::Scalar;
use crate::shuffle::Sharpness;
use crate::template::Template;
use crate::wire::{RequestKind, TemplateAssembler, TemplateAssignment};
use core::iter::successors;
use heapless::Vec;
use serde::{Deserialize, Serialize};

mod foresight;
mod in_plane;

pub use in_plane::FormationInPlane;

/// Moves that a robot of a formation tries: its best and the next best. One that is crowded out of
/// both waits; trying all eight it would run away from its place.
const ALTERNATIVES: usize = 2;

/// Travelling in formation; remembers visits of `M` cells and a template of `F` neighbours.
///
/// Without a template the robot travels alone. `K` is how followers take their leader to go on: by its next move, or by its
/// [`Course`](crate::formation::Course).
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FormationGuidance<const CELLS: usize, const M: usize, const F: usize, const L: usize = 0, K = NextMove> {
    route: RouteParams,
    formation: FormationParams,
    sharpness: Sharpness,
    /// As it was given; what the robot goes by is [`Self::view`].
    template: Template<F>,
    ranks: Ranks,
    assembler: TemplateAssembler<F>,
    router: Router<M, L>,
    travel: Travel,
    pace: Pace,
    leader: RobotId,
    /// From the leader's place to one's own.
    leader_offset: Cell,
    /// Decisions in which somebody stood in a neighbour's place.
    crowded: u8,
    /// The robot has asked its leader to stop.
    has_asked: bool,
    /// Decisions on end in which it waited for others.
    waited: u16,
    /// Decisions on end in which it was behind, or not there yet when the top leader was.
    behind: u16,
    /// Nobody falls behind, as in the plane: the slowest makes the pace.
    #[serde(with = "crate::digest::uncounted")]
    is_rigid: bool,
    steering: K,
}

/// What a follower steers by.
struct Guide {
    /// The top leader as an anchor.
    anchor: Anchor,
    /// Own deviation behind its place, [`UNIT`](crate::grid::UNIT)s.
    lag: u32,
    /// The top leader stands at its goal.
    has_arrived: bool,
}

impl<const CELLS: usize, const M: usize, const F: usize, const L: usize> FormationGuidance<CELLS, M, F, L> {
    /// With these parameters and this place in the formation.
    #[must_use]
    pub const fn new(route: RouteParams, formation: FormationParams, template: Template<F>) -> Self {
        Self::steered(route, formation, template, NextMove)
    }
}

impl<const CELLS: usize, const M: usize, const F: usize, const L: usize, K: Steering>
    FormationGuidance<CELLS, M, F, L, K>
{
    /// The same, with followers who steer by `steering`.
    #[must_use]
    pub const fn steered(route: RouteParams, formation: FormationParams, template: Template<F>, steering: K) -> Self {
        Self {
            route,
            formation,
            sharpness: Sharpness::Greedy,
            template,
            ranks: Ranks::new(),
            assembler: TemplateAssembler::new(),
            router: Router::new(),
            travel: Travel::new(),
            pace: Pace::new(),
            leader: RobotId::NOBODY,
            leader_offset: Cell::new(0, 0),
            crowded: 0,
            has_asked: false,
            waited: 0,
            behind: 0,
            is_rigid: false,
            steering,
        }
    }

    /// How strictly the order of moves follows their weights.
    #[must_use]
    pub const fn sharpness(mut self, sharpness: Sharpness) -> Self {
        self.sharpness = sharpness;
        self
    }

    /// The template that it keeps.
    #[must_use]
    pub const fn template(&self) -> &Template<F> {
        &self.template
    }

    /// How far the neighbours are from what the template wants, for robot `id` in `cell` that knows
    /// `neighbors`: see [`Agent::neighbors`](super::Agent::neighbors). O(F N).
    #[must_use]
    pub fn graph_distance<S>(&self, id: RobotId, cell: Cell, neighbors: &[Neighbor<S>]) -> GraphDistance {
        let robots = neighbors.iter().map(|other| seen_at(other, other.cell));
        let found = find_neighbors(&self.view(id, neighbors), cell, self.formation.eps, robots);
        graph_distance(cell, &found)
    }

    /// The template as it is when some have died and others closed ranks.
    fn view<S>(&self, own: RobotId, neighbors: &[Neighbor<S>]) -> Template<F> {
        if self.formation.closes_ranks {
            self.ranks.view(own, &self.template, holders(neighbors))
        } else {
            self.template.clone()
        }
    }

    // What has much on the stack is not inlined below, so that only one of it is there at a time.

    /// The robot farthest up the leader chain whose place is known, and one's own place relative to its
    /// place: the top leader if it was heard, else a leader that the template names.
    fn top<S>(&self, input: &GuidanceInput<'_, S>, view: &Template<F>) -> Option<(RobotId, Cell)> {
        let heard = |id: RobotId| input.neighbor(id);
        let first = heard(self.leader)?;
        // Numbers fall along the chain, so that it ends; a wrong beacon cannot make it a circle.
        let chain = successors(Some(first), |robot| heard(robot.leader).filter(|next| next.id < robot.id));
        let placed = chain.filter_map(|robot| {
            let named = view.entries.iter().find(|e| e.id == robot.id);
            let offset = match named {
                Some(entry) => Cell::default() - entry.offset,
                None if !robot.leader.is_somebody() => view.offset,
                None if robot.id == self.leader => self.leader_offset,
                None => return None,
            };
            Some((robot.id, offset))
        });
        placed.last()
    }

    /// Whom to follow: once found, the leader stays while it is heard, however far it is (the paper
    /// looks for it at t = 0 only).
    fn choose_leader<S>(&mut self, input: &GuidanceInput<'_, S>, found: &Found<F>) {
        let leader = find_leader(input.id, &found.members);
        if leader.is_somebody() || input.neighbor(self.leader).is_none() {
            self.leader = leader;
        }
        // In a place for anyone the template does not tell whose place it is.
        let member = found.members.iter().find(|m| m.seen.id == self.leader);
        if let Some(member) = member {
            self.leader_offset = Cell::default() - member.offset;
        }
    }

    /// The way of a robot that leads or is alone: for itself, on land priced for all.
    #[inline(never)]
    fn lead<S>(
        &mut self,
        input: &GuidanceInput<'_, S>,
        window: &Window<'_>,
        (cell, target): (Cell, Cell),
        (found, view): (&Found<F>, &Template<F>),
        workspace: &mut GridWorkspace<CELLS>,
    ) -> Option<Weights> {
        let GridWorkspace { field, land } = workspace;
        let shown = if self.formation.footprint == 0 || found.members.is_empty() {
            None
        } else {
            let around = (cell, self.route.radius);
            let footprint = if self.is_rigid { Footprint::Dearest } else { Footprint::Mean(self.formation.footprint) };
            blended(window, around, &view.entries, footprint, land)
        };
        let shown = shown.as_ref().unwrap_or(window);
        let others = input.neighbors.iter().map(|neighbor| neighbor.cell);
        self.router.weights_over(&self.route, field, shown, (cell, target), others, input.land).ok()
    }

    /// The way of a follower to its place.
    #[inline(never)]
    fn follow<S>(
        &self,
        input: &GuidanceInput<'_, S>,
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
        let place = reachable_goal(window, far);
        let near = if near == far { place } else { reachable_goal(window, near) };
        let price = distances(&self.formation, cell, Some(near), members);
        if place == cell {
            return Some(price);
        }
        // Beyond the window it can circle before a hill, hence remembers; near its place it comes by
        // the same cells for good reasons.
        let is_in_sight = window.get(place).is_some();
        let visits = (!is_in_sight).then_some(self.router.visits());
        let others = input.neighbors.iter().map(|neighbor| neighbor.cell);
        let weights = workspace.field.weights(&self.route, window, cell, place, others, visits).ok()?;
        Some(weights.plus(&price))
    }

    /// The top leader seen by a follower.
    fn guide<S>(
        &mut self,
        input: &GuidanceInput<'_, S>,
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

    /// Whether the robot has been behind, or not there when the top leader was, for so long that it goes to its goal by
    /// itself, until it is back in its place.
    fn has_lost_touch(&mut self, guide: &Guide) -> bool {
        let limit = if self.behind == 0 { self.formation.halt_lag } else { self.formation.resume_lag };
        let is_behind = guide.has_arrived || guide.lag > u32::from(limit.min(self.formation.halt_lag));
        self.behind = if is_behind { self.behind.saturating_add(1) } else { 0 };
        self.behind > self.formation.patience
    }

    /// Asks a stranger who has stood in a neighbour's place for long to choose another direction (KUZ
    /// section 7, item 6).
    fn ask_surplus(&mut self, found: &Found<F>) -> Option<Ask> {
        if found.more == 0 {
            self.crowded = 0;
            return None;
        }
        self.crowded = self.crowded.saturating_add(1);
        if self.crowded < PATIENCE {
            return None;
        }
        self.crowded = 0;
        Some(Ask { to: found.surplus, kind: RequestKind::Redirect })
    }

    /// Asks the leader to stop when too far behind, and to resume when near again.
    fn ask_pace(&mut self, leader: RobotId, lag: u32) -> Option<Ask> {
        let has_fallen_behind = self.pace.update(&self.formation, lag);
        let kind = match (has_fallen_behind, self.has_asked) {
            (true, _) => RequestKind::Stop,
            (false, true) => RequestKind::Resume,
            (false, false) => return None,
        };
        self.has_asked = has_fallen_behind;
        Some(Ask { to: leader, kind })
    }
}

/// Whether a robot follows oneself, as far as its leaders were heard. Numbers fall along the chain, so that it ends.
fn comes_after<S>(input: &GuidanceInput<'_, S>, other: RobotId, leader: RobotId) -> bool {
    let heard = |id: RobotId| input.neighbor(id);
    let chain = successors(Some((other, leader)), |&(id, leader)| {
        heard(leader).filter(|next| leader != input.id && next.id < id).map(|next| (next.id, next.leader))
    });
    chain.last().is_some_and(|(_, leader)| leader.is_somebody())
}

/// Who says to hold which place.
fn holders<S>(neighbors: &[Neighbor<S>]) -> impl Iterator<Item = (RobotId, u8)> + Clone {
    neighbors.iter().map(|other| (other.id, other.slot))
}

/// A neighbour as the formation sees it.
fn seen_at<S>(other: &Neighbor<S>, predicted: Cell) -> Seen {
    Seen { id: other.id, cell: other.cell, predicted, heading: other.heading, leader: other.leader, mode: other.mode }
}

impl<const CELLS: usize, const M: usize, const F: usize, const L: usize, K> Teamwork
    for FormationGuidance<CELLS, M, F, L, K>
{
    fn redirect(&mut self) {
        self.travel.redirect();
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_anew: bool) -> bool {
        if is_anew {
            self.assembler.forget();
        }
        match self.assembler.put(part) {
            Ok(Some(template)) => {
                self.template = template;
                self.ranks = Ranks::new();
                self.pace = Pace::new();
                self.leader = RobotId::NOBODY;
                (self.waited, self.behind) = (0, 0);
                true
            }
            Ok(None) => true,
            Err(_) => false,
        }
    }

    fn goal_offset(&self) -> Cell {
        self.template.offset
    }

    fn needs(&self, id: RobotId) -> bool {
        self.template.entries.iter().any(|entry| entry.id == id)
    }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, K: Steering> Guidance<S>
    for FormationGuidance<CELLS, M, F, L, K>
{
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
        if self.formation.closes_ranks && cell != input.goal + self.ranks.shift() {
            self.ranks.close(input.id, &self.template, holders(input.neighbors));
        }
        let view = &self.view(input.id, input.neighbors);
        let target = reachable_goal(&window, input.goal + self.ranks.shift());
        self.router.observe(&self.route, cell, target);

        let mut seen = Vec::new();
        self.seen(input, (&window, view), &mut workspace.field, &mut seen);
        let found = find_neighbors(view, cell, self.formation.eps, seen.iter().copied());
        self.choose_leader(input, &found);
        let leader = self.leader;
        let guide = self.guide(input, view, cell, &seen);
        let goes_alone = guide.as_ref().is_some_and(|guide| self.has_lost_touch(guide));
        let guide = guide.filter(|_| !goes_alone);
        let mut status =
            Status { is_at_goal: cell == target, makes_way: self.travel.take_redirection(), ..Status::default() };
        let mut asks = Vec::new();
        let mut stays = false;
        let weights = if let Some(guide) = &guide {
            self.router.begin_anew();
            list::extend(&mut asks, self.ask_pace(leader, guide.lag));
            status.is_off_place = self.pace.waits();
            // The goal counts when the formation is there.
            status.is_at_goal &= guide.has_arrived;
            let weights = self.follow(input, &window, (cell, target), guide, &found, workspace);
            if let (Some(first), false) = (weights.and_then(|w| w.best()), guide.has_arrived) {
                // By the place that it should have, be it in a wall.
                let [_, place] = self.steering.aims(&self.formation, &guide.anchor, target);
                stays = should_stay(cell, place, first);
            }
            weights
        } else {
            // Who says that he cannot go on is not waited for, nor who has arrived: a part of the formation that lost the rest
            // on the way would wait for ever for those who are at the goal before it.
            // Nor who follows somebody else, nor anybody by one who has lost touch.
            let goes_on = |mode: Mode| mode.gives_way() && mode != Mode::Arrived;
            let able = found.members.iter();
            let able = able.filter(|Member { seen, .. }| {
                !goes_alone && goes_on(seen.mode) && comes_after(input, seen.id, seen.leader)
            });
            let behind = able.map(|member| {
                let off = member.seen.cell - (cell + member.offset);
                self.steering.lag(off, self.travel.choice())
            });
            let waits = self.pace.update(&self.formation, behind.max().unwrap_or(0));
            self.waited = if waits { self.waited.saturating_add(1) } else { 0 };
            let is_bearable = self.waited <= self.formation.patience;
            status.waits_for = (waits && is_bearable).then_some(Wait::Formation);
            if goes_alone && core::mem::take(&mut self.has_asked) {
                list::extend(&mut asks, Some(Ask { to: leader, kind: RequestKind::Resume }));
            }
            self.lead(input, &window, (cell, target), (&found, view), workspace)
        };
        status.is_stuck = weights.is_none() && !status.is_at_goal;
        let mut weights = weights.unwrap_or(Weights::CLOSED);
        if status.makes_way {
            weights = self.travel.without_last(weights);
            stays = false;
        }
        let alternatives = if self.travel.is_jammed() { Dir::MOVES.len() } else { ALTERNATIVES };
        let mut moves = Travel::order(&weights, self.sharpness, alternatives, rng);
        if status.waits_for.is_some() && self.formation.recovery == Recovery::Def {
            let towards = def(cell, &found.members);
            status.recovers = towards != Dir::Stay;
            status.waits_for = (!status.recovers).then_some(Wait::Formation);
            moves = list::collect(status.recovers.then_some(towards));
        }
        if stays {
            moves.clear();
        }
        let choice = moves.first().copied().unwrap_or_default();
        let blocked = self.travel.note(input, cell, choice, 0);
        if status.waits_for.is_none() && !status.is_at_goal {
            // Asks hold three: for the pace, and these two.
            list::extend(&mut asks, blocked);
            list::extend(&mut asks, self.ask_surplus(&found));
        }
        Ok(Decision { action: Action::Moves(moves), status, target, leader, slot: view.slot, asks })
    }

    fn goes_by_velocity(&self) -> bool {
        false
    }

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        self.route.get(parameter).or_else(|| self.formation.get(parameter))
    }

    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        Tunable::<S>::tune(&mut self.route, parameter, value) || self.formation.tune(parameter, value)
    }
}
