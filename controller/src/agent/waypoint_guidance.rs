//! Straight to a waypoint.

use super::guidance::{Action, BadInput, Decision, Guidance, GuidanceInput, Status, Teamwork, ToWaypoints};
use super::{InPlane, Parameter, Waypoint};
use crate::geom::Vec3;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::Serialize;

/// Straight to a waypoint, which may move; there it stays, and goes along with one that moves.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WaypointGuidance<S> {
    waypoint: Option<Waypoint<S>>,
    /// How near is there, metres.
    tolerance_m: S,
    /// Cruising speed, m/s; the body's own limit holds too.
    speed_mps: S,
}

impl<S: Scalar> WaypointGuidance<S> {
    /// Without a waypoint yet. `tolerance_m`: how near counts as being there, at least some millimetres, since
    /// waypoints are rounded to them; `speed_mps`: how fast it wants to go.
    #[must_use]
    pub const fn new(speed_mps: S, tolerance_m: S) -> Self {
        Self { waypoint: None, tolerance_m, speed_mps }
    }
}

impl<S> Teamwork for WaypointGuidance<S> {}

impl<S: Scalar> Guidance<S> for WaypointGuidance<S> {
    type Input<'a> = InPlane<'a, S>;
    type Destination = ToWaypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S>,
        _: &InPlane<'_, S>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Decision<S>, BadInput> {
        input.can_go()?;
        let waypoint = self.waypoint.as_mut().ok_or(BadInput)?;
        let way = waypoint.way(input.state.position, input.now);
        let distance = way.norm();
        let speed = self.speed_mps.min(input.body.max_speed_mps);
        // On the last step no farther than the waypoint.
        let needed = distance.checked_div(input.body.step_s).unwrap_or(speed);
        let ahead = way.normalized().unwrap_or_default();
        let is_at_goal = distance <= self.tolerance_m;
        Ok(Decision {
            action: Action::Velocity { wish_mps: waypoint.velocity_mps + ahead * needed.min(speed), way_m: Some(way) },
            status: Status {
                is_at_goal,
                // Who stood when it is there would lose a waypoint that moves.
                makes_way: is_at_goal && waypoint.velocity_mps != Vec3::ZERO,
                ..Status::default()
            },
            ..Decision::default()
        })
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool {
        if index == 0 {
            self.waypoint = Some(*waypoint);
        }
        index == 0
    }

    fn has_own_goal(&self) -> bool {
        self.waypoint.is_some()
    }

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        match parameter {
            Parameter::Speed => Some(self.speed_mps),
            Parameter::Tolerance => Some(self.tolerance_m),
            _ => None,
        }
    }

    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        match parameter {
            Parameter::Speed => self.speed_mps = value,
            Parameter::Tolerance => self.tolerance_m = value,
            _ => return false,
        }
        true
    }
}
