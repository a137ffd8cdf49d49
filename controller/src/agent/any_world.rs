//! Adapts a law of the plane to surroundings of any kind.

use super::guidance::{BadInput, Decision, Guidance, GuidanceInput, Teamwork, pass_on};
use super::{AnySurroundings, InPlane, Surroundings, Waypoint};
use crate::grid::Cell;
use crate::land::LandPatch;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::TemplateAssignment;
use serde::{Deserialize, Serialize};

/// A law of the plane or of space with [`AnySurroundings`] as its input. Surroundings of the grid
/// alone put the robot into [`Mode::Fault`](crate::robot::Mode::Fault).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AnyWorld<G>(pub G);

impl<G: Teamwork> Teamwork for AnyWorld<G> {
    pass_on!(orders: self => self.0);
    pass_on!(land: self => self.0);
}

impl<S: Scalar, G> Guidance<S> for AnyWorld<G>
where
    G: for<'a> Guidance<S, Input<'a> = InPlane<'a, S>>,
{
    type Input<'a> = AnySurroundings<'a, S>;
    type Destination = G::Destination;
    type Workspace = G::Workspace;
    type Payload = G::Payload;

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S, Self::Payload>,
        here: &AnySurroundings<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        let plane = here.in_plane().ok_or(BadInput)?;
        self.0.decide(input, &plane, rng, workspace)
    }

    fn goes_to_cells(&self) -> bool {
        self.0.goes_to_cells()
    }

    fn goes_by_velocity(&self) -> bool {
        self.0.goes_by_velocity()
    }

    fn has_own_goal(&self) -> bool {
        self.0.has_own_goal()
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool {
        self.0.assign_waypoint(index, waypoint)
    }

    fn payload(&mut self, now: Instant) -> Self::Payload {
        self.0.payload(now)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.0.parameters(visit);
    }
}
