//! Moving in formation in the plane.

use super::{FormationGuidance, comes_after};
use crate::formation::{Drive, NextMove, behind, is_straight, scaled};
use crate::geom::Vec2;
use crate::grid::{BLOCKED, Cell, Dir, Window};
use crate::law::{Action, BadInput, Decision, InCells, Law, Progress, Radio, Report, Tools, View, Wait};
use crate::laws::cells::{CellFollower, FarMap, Grid, GridMessage, GridOrder, GridPayload, GridWorkspace};
use crate::laws::waypoint::{Claim, GoalOccupancy};
use crate::neighbor::Neighbor;
use crate::parameters::Parameters;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::template::{Template, TemplateEntry};
use crate::time::Duration;
use serde::{Deserialize, Serialize};

/// [`FormationGuidance`] on a body that moves in the plane; [`crate::formation::Drive`] is the
/// control law.
///
/// Leaders and requests are those of the grid, as often as [`CellFollower`] decides. In each step a
/// follower heads for its place as a point, with the velocity of its leader, and the top leader
/// straight for its goal on even terrain, at the pace of the slowest robot in contact. Where the
/// straight line is blocked or costly, both follow the cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FormationInPlane<S, const CELLS: usize, const M: usize, const F: usize, const L: usize = 0, H = ()> {
    cells: CellFollower<S, FormationGuidance<CELLS, M, F, L, NextMove, H>>,
    beside: GoalOccupancy<S>,
    wish_mps: Vec2<S>,
    waited: Duration,
    is_there: bool,
}

struct Step<'a, S> {
    window: Window<'a>,
    cell: Cell,
    offset_m: Vec2<S>,
    cell_m: S,
    drive: Drive<S>,
}

impl<'a, S: Scalar> Step<'a, S> {
    /// `None` without a view of the land.
    fn new(input: &View<'_, S, Grid>, here: &InCells<'a, S>) -> Option<Self> {
        Some(Self {
            window: here.grid.window?,
            cell: here.grid.cell.cell,
            offset_m: here.in_cell.offset_m,
            cell_m: here.in_cell.cell_m,
            drive: Drive::new(&input.body),
        })
    }

    fn metres(&self, cells: Cell) -> Vec2<S> {
        Vec2::new(S::from_i32(cells.x.into()) * self.cell_m, S::from_i32(cells.y.into()) * self.cell_m)
    }

    fn to_middle(&self, cell: Cell) -> Vec2<S> {
        self.metres(cell - self.cell) - self.offset_m
    }

    /// Offset of a place `offset` cells from another robot, extrapolated by its velocity, from the
    /// own body, metres.
    #[inline(never)]
    fn beside(&self, input: &View<'_, S, Grid>, other: &Neighbor<S, GridPayload>, offset: Cell) -> Vec2<S> {
        let offset_m = other.offset_at(input.state.position, input.now, input.ages.expire_after);
        (offset_m + input.ahead_m).xy() + self.metres(offset)
    }

    fn is_straight(&self, way_m: Vec2<S>, is_good: &dyn Fn(Cell) -> bool) -> bool {
        is_straight(&self.window, (self.cell, self.offset_m, self.cell_m), way_m, is_good)
    }

    /// No cell of the way is impassable or costs more than twice the own one.
    fn is_open(&self, way_m: Vec2<S>) -> bool {
        let own = self.window.get(self.cell).unwrap_or(BLOCKED);
        self.is_straight(way_m, &|cell| {
            self.window.get(cell).is_some_and(|u| u != BLOCKED && (cell == self.cell || u <= own.saturating_mul(2)))
        })
    }

    fn slowest_mps(&self, own_mps: S, entries: &[TemplateEntry]) -> S {
        let price = |cell: Cell| self.window.get(cell).filter(|&u| u != BLOCKED);
        let own = price(self.cell).unwrap_or(1);
        let dearest = entries.iter().filter_map(|entry| price(self.cell + entry.offset)).fold(own, u8::max);
        own_mps * S::from_ratio(own.into(), dearest.into())
    }

    /// No visible cell is easier than those below the line and below the places of the others.
    fn is_even(&self, way_m: Vec2<S>, entries: &[TemplateEntry]) -> bool {
        let least = self.window.cells().iter().copied().filter(|&u| u != BLOCKED).min();
        let is_dear = |cell: Cell| self.window.get(cell).is_some_and(|u| u != BLOCKED && Some(u) > least);
        let is_even = |cell: Cell| {
            self.window.is_passable(cell) && !is_dear(cell) && !entries.iter().any(|entry| is_dear(cell + entry.offset))
        };
        self.is_straight(way_m, &is_even)
    }
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, H>
    FormationInPlane<S, CELLS, M, F, L, H>
{
    /// Runs `law` at a cruising speed of `speed_mps`, minus a tenth for the top leader.
    #[must_use]
    pub fn new(mut law: FormationGuidance<CELLS, M, F, L, NextMove, H>, speed_mps: S) -> Self {
        law.is_rigid = true;
        Self {
            cells: CellFollower::new(law, speed_mps),
            beside: GoalOccupancy::NEW,
            wish_mps: Vec2::ZERO,
            waited: Duration::ZERO,
            is_there: false,
        }
    }

    /// The wrapped law of the grid.
    #[must_use]
    pub const fn inside(&self) -> &FormationGuidance<CELLS, M, F, L, NextMove, H> {
        self.cells.inside()
    }

    /// Returns the leader and the own place relative to it, unless this robot leads or is alone.
    fn leader(&self, input: &View<'_, S, Grid>, view: &Template<F>) -> Option<(Neighbor<S, GridPayload>, Cell)> {
        let law = self.inside();
        let (id, offset) = law.top(input, view)?;
        let keeps_touch = law.behind <= law.formation.patience;
        input.neighbor(id).filter(|_| keeps_touch).map(|leader| (leader, offset))
    }

    #[inline(never)]
    fn refine(
        &mut self,
        input: &View<'_, S, Grid>,
        here: &InCells<'_, S>,
        radio: &mut Radio<'_, Grid>,
        decision: &mut Decision<S>,
    ) -> Result<(), BadInput>
    where
        H: FarMap,
    {
        let Action::Velocity { wish_mps: by_cells_mps, .. } = decision.action else { return Ok(()) };
        let step = Step::new(input, here).ok_or(BadInput)?;
        let view = self.inside().view(input.id, input.on_grid());
        let target = Law::<S>::report(&self.cells).target;
        let to_goal_m = step.to_middle(target.ok_or(BadInput)?);
        let keeps = decision.makes_way || decision.progress == Progress::Recovering;
        let is_straight;
        let mut wish_mps;
        let mut progress = match decision.progress {
            Progress::Waiting(wait) => Progress::Waiting(wait),
            _ => Progress::Going,
        };
        if let Some((leader, offset)) = self.leader(input, &view) {
            let has_arrived = leader.mode == Mode::Arrived;
            let (way_m, place_mps) = if has_arrived {
                (to_goal_m, Vec2::ZERO)
            } else {
                (step.beside(input, &leader, offset), leader.velocity_mps.xy())
            };
            is_straight = step.is_open(way_m);
            wish_mps = if is_straight { step.drive.follow(way_m, place_mps) } else { by_cells_mps.xy() };
            if progress == Progress::Going && way_m.norm() > step.drive.halt_m() {
                progress = Progress::Forming;
            }
            // A robot that is ahead or aside does not hold up the others.
            if !step.drive.is_far_behind(way_m, place_mps) {
                radio.retain(|message| !matches!(message, GridMessage::Stop { .. }));
            }
            if has_arrived {
                progress = self.comes_to_rest(input, to_goal_m, &step.drive, &mut wish_mps).unwrap_or(progress);
            }
            self.wish_mps = input.body.velocity_mps.xy();
            self.waited = Duration::ZERO;
        } else {
            let is_near = to_goal_m.norm() < step.cell_m && step.is_open(to_goal_m);
            is_straight = is_near || step.is_even(to_goal_m, &view.entries);
            let way_m = if is_straight { to_goal_m } else { by_cells_mps.xy() };
            let ahead = way_m.normalized().unwrap_or_default();
            let lag_m = self.lag_to_wait_for(input, &view, &step, ahead);
            let slowest_mps = step.slowest_mps(input.body.max_speed_mps, &view.entries).min(self.cells.speed_mps());
            let speed = step.drive.leads_at(lag_m, to_goal_m.norm()).min(slowest_mps);
            wish_mps = step.drive.gently(self.wish_mps, scaled(ahead, speed));
            self.wish_mps = wish_mps;
            let stands = lag_m >= step.drive.halt_m() && wish_mps == Vec2::ZERO;
            let rest = self.comes_to_rest(input, to_goal_m, &step.drive, &mut wish_mps);
            progress = rest.unwrap_or(if stands { Progress::Waiting(Wait::Team) } else { Progress::Going });
        }
        let is_stuck = decision.progress == Progress::Stuck && !is_straight;
        decision.progress = match progress {
            Progress::Going | Progress::Forming if is_stuck => Progress::Stuck,
            Progress::Going if keeps && !decision.makes_way => Progress::Recovering,
            progress => progress,
        };
        if keeps {
            return Ok(());
        }
        if is_straight {
            radio.retain(|message| *message != GridMessage::Redirect);
        }
        decision.action = Action::Velocity { wish_mps: wish_mps.extend(S::ZERO), way_m: None };
        Ok(())
    }

    /// What the land under the slowest robot allows the top leader. Without it the leader would
    /// decide again in mid-cell, for ever between two ways that seem equally good.
    fn pace_mps(&self, input: &View<'_, S, Grid>, here: &InCells<'_, S>) -> S {
        let most_mps = input.body.max_speed_mps;
        let step = Step::new(input, here).filter(|_| !self.inside().leader.is_some());
        step.map_or(most_mps, |step| step.slowest_mps(most_mps, &self.inside().view(input.id, input.on_grid()).entries))
    }

    /// Returns that the robot is at its goal, or beside it if occupied. Adjusts the wish of a robot
    /// that must let another one pass first.
    fn comes_to_rest(
        &mut self,
        input: &View<'_, S, Grid>,
        way_m: Vec2<S>,
        drive: &Drive<S>,
        wish_mps: &mut Vec2<S>,
    ) -> Option<Progress> {
        let tolerance_m = drive.tolerance_m(self.is_there);
        let claim = self.beside.claim(input, way_m.extend(S::ZERO), tolerance_m);
        if let Claim::Yields(room_m) = claim {
            let away = -way_m.normalized().unwrap_or_default();
            *wish_mps = if way_m.norm() < room_m { away * input.body.max_speed_mps } else { Vec2::ZERO };
        }
        let is_beside = claim == Claim::IsBeside;
        self.is_there = way_m.norm() <= tolerance_m || is_beside;
        self.is_there.then(|| Progress::arrived(is_beside))
    }

    /// Metres; 0 if patience is exhausted or the robot travels alone.
    fn lag_to_wait_for(
        &mut self,
        input: &View<'_, S, Grid>,
        view: &Template<F>,
        step: &Step<'_, S>,
        ahead: Vec2<S>,
    ) -> S {
        if self.inside().leader.is_some() {
            return S::ZERO;
        }
        let lag_m = lag_m(input, view, step, ahead);
        let patience = Duration::from_millis(i32::from(self.inside().formation.patience) * 1000);
        let has_to_stand = lag_m >= step.drive.halt_m();
        let waited = self.waited.as_micros().saturating_add(input.tick.as_micros());
        self.waited = if has_to_stand { Duration::from_micros(waited) } else { Duration::ZERO };
        if self.waited <= patience {
            return lag_m;
        }
        self.waited = patience;
        S::ZERO
    }
}

fn lag_m<S: Scalar, const F: usize>(
    input: &View<'_, S, Grid>,
    view: &Template<F>,
    step: &Step<'_, S>,
    ahead: Vec2<S>,
) -> S {
    let lag = |entry: &TemplateEntry| {
        let other = input.neighbor(entry.id)?;
        let is_under_way = other.mode.gives_way() && other.mode != Mode::Arrived;
        let follows = is_under_way && comes_after(input, other.id, other.payload?.leader);
        follows.then(|| behind(step.beside(input, &other, Cell::default() - entry.offset), ahead))
    };
    view.entries.iter().filter_map(lag).fold(S::ZERO, S::max)
}

impl<S: Scalar, const CELLS: usize, const M: usize, const F: usize, const L: usize, H: FarMap> Law<S>
    for FormationInPlane<S, CELLS, M, F, L, H>
{
    type Surroundings<'a> = InCells<'a, S>;
    type Protocol = Grid;
    type Workspace = GridWorkspace<CELLS>;

    fn decide(
        &mut self,
        input: &View<'_, S, Grid>,
        here: &InCells<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Tools { rng, mut radio, workspace } = tools;
        if input.neighbor(self.inside().leader).is_none() && self.inside().leader.is_some() {
            self.cells.discard_decision();
        }
        let pace_mps = self.pace_mps(input, here);
        let tools = Tools { rng, radio: radio.of(), workspace };
        let mut decision = self.cells.decide_at(pace_mps, input, here, tools)?;
        if decision.progress != Progress::Idle {
            self.refine(input, here, &mut radio, &mut decision)?;
        }
        Ok(decision)
    }

    fn payload(&mut self, here: &InCells<'_, S>, heading: Dir, radio: &mut Radio<'_, Grid>) -> GridPayload {
        self.cells.payload(here, heading, radio)
    }

    fn receive(&mut self, from: RobotId, message: &GridMessage, radio: &mut Radio<'_, Grid>) -> bool {
        self.cells.receive(from, message, radio)
    }

    fn order(&mut self, order: &GridOrder) -> bool {
        self.cells.order(order)
    }

    fn needs(&self, id: RobotId) -> bool {
        self.cells.needs(id)
    }

    fn report(&self) -> Report {
        self.cells.report()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.cells.parameters(visit);
    }
}
