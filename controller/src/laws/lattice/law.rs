//! The alpha flock as a law.

use super::{LatticeParams, Reference, ReferenceMotion, acceleration};
use crate::law::{Action, BadInput, Decision, InPlane, Law, Progress, Tools, View};
use crate::laws::waypoint::{Waypoint, WaypointOrder, Waypoints};
use crate::parameters::Parameters;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// The alpha flock (R. Olfati-Saber 2006, OLF): equal distances, with waypoint 0 as the reference.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct LatticeGuidance<S> {
    params: LatticeParams<S>,
    reference: Option<Waypoint<S>>,
    motion: ReferenceMotion<S>,
}

impl<S: Scalar> LatticeGuidance<S> {
    /// Creates the law. `moves`: the reference moves with its velocity (a dynamic gamma-agent) or
    /// only has one (a static one, as in the obstacle courses of the paper).
    #[must_use]
    pub const fn new(params: LatticeParams<S>, moves: bool) -> Self {
        Self::following(params, if moves { ReferenceMotion::Dynamic } else { ReferenceMotion::Static })
    }

    /// Creates the law with a reference of the given motion.
    #[must_use]
    pub const fn following(params: LatticeParams<S>, motion: ReferenceMotion<S>) -> Self {
        Self { params, reference: None, motion }
    }
}

impl<S: Scalar> Law<S> for LatticeGuidance<S> {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        here: &InPlane<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let motion = self.motion;
        let reference = self.reference.as_mut().map(|waypoint| {
            let offset_m = if motion == ReferenceMotion::Dynamic {
                waypoint.way(view.state.position, view.now)
            } else {
                waypoint.position.since(view.state.position)
            };
            Reference { offset_m, velocity_mps: motion.wanted(offset_m, waypoint.velocity_mps) }
        });
        let body = &view.body;
        let change = acceleration(&self.params, body, view.nearby, here.obstacles, reference.as_ref());
        let wish_mps = body.velocity_mps + change * body.step_s;
        if !wish_mps.is_finite() {
            return Err(BadInput);
        }
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going))
    }

    fn order(&mut self, &WaypointOrder { index, waypoint }: &WaypointOrder) -> bool {
        if index == 0 {
            self.reference = Some(waypoint.cast());
        }
        index == 0
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
    }
}
