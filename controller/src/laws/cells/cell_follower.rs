//! Runs a law of the grid on a body that moves in the plane.

use crate::geom::Vec2;
use crate::grid::{Cell, Dir};
use crate::law::{
    Action, BadInput, CellState, Decision, InCells, Law, MessageOf, OnGrid, OrderOf, PayloadOf, Progress, Radio,
    Report, Scene, Tools, View,
};
use crate::parameters::{Parameters, SPEED};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// Distance from the centre, along an axis, that counts as the next cell; thousandths of a cell.
const LEAVES_AT: i32 = 750;

/// Moves towards the centre of the cell that a law `G` of the grid would move to.
///
/// The law decides again when the robot is well inside another cell (on the border it could
/// alternate for ever), and at least once per time to cross a cell at cruising speed. It sees other
/// robots by their cells. Robots may share a cell, because the safety layer keeps them apart; that
/// layer receives no way point, since the law settles precedence by prices and requests.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CellFollower<S, G> {
    law: G,
    speed_mps: S,
    last: Option<Last<S>>,
}

crate::parameters! {
    impl[S: Scalar, G] CellFollower<S, G> { SPEED => speed_mps }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Last<S> {
    cell: Cell,
    at: Instant,
    decision: Decision<S>,
    target: Option<Cell>,
}

impl<S: Scalar, G> CellFollower<S, G> {
    /// Runs `law` at a cruising speed of `speed_mps`, within the speed limit of the body.
    #[must_use]
    pub const fn new(law: G, speed_mps: S) -> Self {
        Self { law, speed_mps, last: None }
    }

    pub(crate) const fn speed_mps(&self) -> S {
        self.speed_mps
    }

    pub(crate) fn discard_decision(&mut self) {
        self.last = None;
    }

    /// The wrapped law.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.law
    }

    /// [`Law::decide`] for a robot that goes at `pace_mps` though it could be faster.
    pub(crate) fn decide_at(
        &mut self,
        pace_mps: S,
        view: &View<'_, S, G::Protocol>,
        here: &InCells<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput>
    where
        G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>>,
    {
        let Self { law, speed_mps, last } = self;
        let Tools { rng, mut radio, workspace } = tools;
        let has_goal = law.report().goal.or(view.sent_to).is_some();
        follow((speed_mps.max(S::from_milli(1)), pace_mps, has_goal), last, view, here, &mut |grid| {
            let tools = Tools { rng, radio: radio.of(), workspace };
            let decision = law.decide(view, &grid, tools)?;
            Ok((decision, law.report().target))
        })
    }
}

impl<S: Scalar, G> Law<S> for CellFollower<S, G>
where
    G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>>,
{
    type Surroundings<'a> = InCells<'a, S>;
    type Protocol = G::Protocol;
    type Workspace = G::Workspace;

    fn decide(
        &mut self,
        view: &View<'_, S, Self::Protocol>,
        here: &InCells<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        self.decide_at(view.body.max_speed_mps, view, here, tools)
    }

    fn payload(
        &mut self,
        here: &InCells<'_, S>,
        heading: Dir,
        radio: &mut Radio<'_, Self::Protocol>,
    ) -> PayloadOf<Self, S> {
        self.law.payload(&here.grid, heading, radio)
    }

    fn receive_payload(&mut self, from: RobotId, payload: &PayloadOf<Self, S>, sent: Instant) {
        self.law.receive_payload(from, payload, sent);
    }

    fn receive(&mut self, from: RobotId, message: &MessageOf<Self, S>, radio: &mut Radio<'_, Self::Protocol>) -> bool {
        let takes = self.law.receive(from, message, radio);
        if radio.takes_decision() {
            self.last = None;
        }
        takes
    }

    fn order(&mut self, order: &OrderOf<Self, S>) -> bool {
        self.law.order(order)
    }

    fn needs(&self, id: RobotId) -> bool {
        self.law.needs(id)
    }

    /// The target is that of the last decision.
    fn report(&self) -> Report {
        let shown = self.law.report();
        Report { target: self.last.as_ref().map_or(shown.target, |last| last.target), ..shown }
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        self.law.expects(id)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
        self.law.parameters(visit);
    }
}

/// A decision and its target.
type Targeted<S> = (Decision<S>, Option<Cell>);

/// One step of a law that decides by `decide`. Not generic over the law, so it is compiled once.
#[inline(never)]
fn follow<S: Scalar>(
    (speed_mps, pace_mps, has_goal): (S, S, bool),
    last: &mut Option<Last<S>>,
    input: &Scene<'_, S>,
    here: &InCells<'_, S>,
    decide: &mut dyn FnMut(OnGrid<'_>) -> Result<Targeted<S>, BadInput>,
) -> Result<Decision<S>, BadInput> {
    let (under, place) = (here.grid.cell.cell, here.in_cell);
    let to_center = |cell: Cell| {
        let along = |cells: i16, offset: S| S::from_i32(cells.into()) * place.cell_m - offset;
        let cells = cell - under;
        Vec2::new(along(cells.x, place.offset_m.x), along(cells.y, place.offset_m.y))
    };
    let is_left = |cell: Cell| {
        let Vec2 { x, y } = to_center(cell);
        x.abs().max(y.abs()) > place.cell_m * S::from_milli(LEAVES_AT)
    };
    let cell = last.as_ref().map(|last| last.cell).filter(|&cell| !is_left(cell)).unwrap_or(under);
    let speed = speed_mps.min(input.body.max_speed_mps);
    let crossing_s = place.cell_m.checked_div(speed);
    let Some(crossing_s) = crossing_s.filter(|span| *span > S::ZERO) else {
        return if has_goal { Err(BadInput) } else { Ok(Decision::idle()) };
    };
    let way = |decision: &Decision<S>| {
        let dir = decision.action.moves().first().copied();
        to_center(cell + dir.unwrap_or(Dir::Stay).offset())
    };
    let is_due = |last: &Last<S>| {
        let age_s = S::from_micro(input.now.since(last.at).as_micros());
        let ahead = way(&last.decision).normalized().unwrap_or_default();
        let gets_on = input.body.velocity_mps.xy().dot(ahead) > speed.min(pace_mps) * S::HALF;
        last.cell != cell || age_s < S::ZERO || age_s >= crossing_s && !gets_on
    };
    let (mut decision, target) = match &*last {
        Some(last) if !is_due(last) => (last.decision.clone(), last.target),
        _ => {
            *last = None;
            let grid = OnGrid { cell: CellState { cell, ..here.grid.cell }, ..here.grid };
            let (decision, target) = decide(grid)?;
            if decision.progress == Progress::Idle {
                return Ok(decision);
            }
            *last = Some(Last { cell, at: input.now, decision: decision.clone(), target });
            (decision, target)
        }
    };
    let mut way = way(&decision);
    let is_last = decision.action.moves().first().is_none_or(|dir| Some(cell + dir.offset()) == target);
    let needed = match is_last {
        true => {
            way -= input.ahead_m.xy();
            input.body.stopping_speed(way.norm())
        }
        false => way.norm().checked_div(input.body.step_s).unwrap_or(speed),
    };
    let ahead = way.normalized().unwrap_or_default();
    decision.action = Action::Velocity { wish_mps: (ahead * needed.min(speed)).extend(S::ZERO), way_m: None };
    Ok(decision)
}
