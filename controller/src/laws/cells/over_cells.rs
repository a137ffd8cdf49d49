//! A law over cells, wherever its robot moves.

use crate::grid::{Cell, Dir};
use crate::law::{
    AnySurroundings, BadInput, Decision, InCells, Law, MessageOf, OnGrid, OrderOf, PayloadOf, Radio, Report, Tools,
    View,
};
use crate::parameters::Parameters;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// A law over cells that moves a body in the plane (`P`), or from cell to cell (`G`).
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum OverCells<P, G> {
    /// By velocities.
    InPlane(P),
    /// From cell to cell.
    OnGrid(G),
}

/// Does the same with the law inside, whichever it is.
macro_rules! each {
    ($any:expr, $law:ident => $call:expr) => {
        match $any {
            OverCells::InPlane($law) => $call,
            OverCells::OnGrid($law) => $call,
        }
    };
}

impl<S: Scalar, P, G> Law<S> for OverCells<P, G>
where
    P: for<'a> Law<S, Surroundings<'a> = InCells<'a, S>, Protocol = G::Protocol, Workspace = G::Workspace>,
    G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>>,
{
    type Surroundings<'a> = AnySurroundings<'a, S>;
    type Protocol = G::Protocol;
    type Workspace = G::Workspace;

    fn decide(
        &mut self,
        view: &View<'_, S, G::Protocol>,
        here: &AnySurroundings<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Tools { rng, radio, workspace } = tools;
        match (self, here) {
            (Self::InPlane(law), AnySurroundings::InCells(here)) => {
                law.decide(view, here, Tools { rng, radio, workspace })
            }
            (Self::OnGrid(law), AnySurroundings::OnGrid(here)) => {
                law.decide(view, here, Tools { rng, radio, workspace })
            }
            _ => Err(BadInput),
        }
    }

    fn payload(
        &mut self,
        here: &AnySurroundings<'_, S>,
        heading: Dir,
        radio: &mut Radio<'_, G::Protocol>,
    ) -> PayloadOf<Self, S> {
        match (self, here) {
            (Self::InPlane(law), AnySurroundings::InCells(here)) => law.payload(here, heading, radio),
            (Self::OnGrid(law), AnySurroundings::OnGrid(here)) => law.payload(here, heading, radio),
            _ => PayloadOf::<Self, S>::default(),
        }
    }

    fn receive_payload(&mut self, from: RobotId, payload: &PayloadOf<Self, S>, sent: Instant) {
        each!(self, law => law.receive_payload(from, payload, sent));
    }

    fn receive(&mut self, from: RobotId, message: &MessageOf<Self, S>, radio: &mut Radio<'_, G::Protocol>) -> bool {
        each!(self, law => law.receive(from, message, radio))
    }

    fn order(&mut self, order: &OrderOf<Self, S>) -> bool {
        each!(self, law => law.order(order))
    }

    fn needs(&self, id: RobotId) -> bool {
        each!(self, law => law.needs(id))
    }

    fn report(&self) -> Report {
        each!(self, law => law.report())
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        each!(self, law => law.expects(id))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        each!(self, law => law.parameters(visit));
    }
}
