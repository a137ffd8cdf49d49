//! Runs a guidance law of the grid on a body that moves in the plane.

use super::guidance::{Action, BadInput, Decision, Guidance, GuidanceInput, Teamwork};
use super::{CellState, InCells, OnGrid};
use crate::geom::Vec2;
use crate::grid::{Cell, Dir};
use crate::parameters::{Parameters, SPEED};
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::TemplateAssignment;
use serde::{Deserialize, Serialize};

/// Distance from the centre, along an axis, that counts as the next cell; thousandths of a cell.
const LEAVES_AT: i32 = 750;

/// Moves towards the centre of the cell that a guidance law `G` of the grid would move to.
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
}

impl<S: Scalar, G> CellFollower<S, G> {
    /// Runs `law` at a cruising speed of `speed_mps`, within the speed limit of the body.
    #[must_use]
    pub const fn new(law: G, speed_mps: S) -> Self {
        Self { law, speed_mps, last: None }
    }

    pub(super) const fn speed_mps(&self) -> S {
        self.speed_mps
    }

    pub(super) fn discard_decision(&mut self) {
        self.last = None;
    }

    /// The wrapped law.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.law
    }
}

impl<S, G: Teamwork> Teamwork for CellFollower<S, G> {
    fn redirect(&mut self) {
        self.law.redirect();
        self.last = None;
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_restarted: bool) -> bool {
        self.law.assign_template(part, is_restarted)
    }

    fn goal_offset(&self) -> Cell {
        self.law.goal_offset()
    }

    fn needs(&self, id: RobotId) -> bool {
        self.law.needs(id)
    }
}

impl<S: Scalar, G> Guidance<S> for CellFollower<S, G>
where
    G: for<'a> Guidance<S, Input<'a> = OnGrid<'a>>,
{
    type Input<'a> = InCells<'a, S>;
    type Destination = G::Destination;
    type Workspace = G::Workspace;
    type Payload = G::Payload;

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S, Self::Payload>,
        here: &InCells<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        let Self { law, speed_mps, last } = self;
        follow(speed_mps.max(S::from_milli(1)), last, input, here, &mut |grid| law.decide(input, &grid, rng, workspace))
    }

    fn payload(&mut self, now: Instant) -> Self::Payload {
        self.law.payload(now)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
        self.law.parameters(visit);
    }
}

/// One step of a law that decides by `decide`. Not generic over the law, so it is compiled once.
#[inline(never)]
fn follow<S: Scalar, P>(
    speed_mps: S,
    last: &mut Option<Last<S>>,
    input: &GuidanceInput<'_, S, P>,
    here: &InCells<'_, S>,
    decide: &mut dyn FnMut(OnGrid<'_>) -> Result<Decision<S>, BadInput>,
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
    let crossing_s = crossing_s.filter(|span| *span > S::ZERO).ok_or(BadInput)?;
    let way = |decision: &Decision<S>| {
        let dir = decision.action.moves().first().copied();
        to_center(cell + dir.unwrap_or(Dir::Stay).offset())
    };
    let is_due = |last: &Last<S>| {
        let age_s = S::from_micro(input.now.since(last.at).as_micros());
        let ahead = way(&last.decision).normalized().unwrap_or_default();
        let gets_on = input.body.velocity_mps.xy().dot(ahead) > speed * S::HALF;
        last.cell != cell || age_s < S::ZERO || age_s >= crossing_s && !gets_on
    };
    let mut decision = match &*last {
        Some(last) if !is_due(last) => Decision { asks: heapless::Vec::new(), ..last.decision.clone() },
        _ => {
            *last = None;
            let grid = OnGrid { cell: CellState { cell, ..here.grid.cell }, ..here.grid };
            let decision = decide(grid)?;
            *last = Some(Last { cell, at: input.now, decision: decision.clone() });
            decision
        }
    };
    let mut way = way(&decision);
    let is_last = decision.action.moves().first().is_none_or(|dir| cell + dir.offset() == decision.target);
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
