//! Boids as a law.

use super::BoidsParams;
use crate::geom::Vec2;
use crate::law::{Action, BadInput, Decision, InPlane, Law, Progress, Tools, View};
use crate::laws::waypoint::Waypoints;
use crate::parameters::{Parameters, SPEED};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

crate::parameters! {
    impl[S: Scalar] BoidsGuidance<S> { SPEED => speed_mps }
}

/// Boids (V. A. Starovoitova 2018, STA): constant speed, headings that follow the neighbours.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct BoidsGuidance<S> {
    params: BoidsParams<S>,
    speed_mps: S,
    heading: Option<Vec2<S>>,
}

impl<S: Scalar> BoidsGuidance<S> {
    /// Creates the law. The first heading is that of the body, or random if it stands.
    #[must_use]
    pub const fn new(params: BoidsParams<S>, speed_mps: S) -> Self {
        Self { params, speed_mps, heading: None }
    }
}

impl<S: Scalar> Law<S> for BoidsGuidance<S> {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        _: &InPlane<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let mut draw = || {
            let turn = S::from_ratio(tools.rng.below(20_000).cast_signed() - 10_000, 10_000);
            let (sin, cos) = (turn * S::PI).sin_cos();
            Vec2::new(cos, sin)
        };
        let moving = view.body.velocity_mps.xy().normalized();
        let heading = moving.or(self.heading).unwrap_or_else(&mut draw);
        let heading = self.params.steer(view.id, heading, view.nearby);
        self.heading = Some(heading);
        let wish_mps = (heading * self.speed_mps).extend(S::ZERO);
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }
}
