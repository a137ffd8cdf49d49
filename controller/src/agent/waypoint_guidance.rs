//! Straight to a place.

use super::Parameter;
use super::guidance::{BadInput, Guidance, Guided, Place, View};
use crate::geom::Vec3;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::Serialize;

/// Straight to a place, which may move; there it stays, and goes along with one that moves.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WaypointGuidance<S> {
    place: Option<Place<S>>,
    /// How near is there, metres.
    tolerance_m: S,
    /// Cruising speed, m/s; the body's own limit holds too.
    speed_mps: S,
}

impl<S: Scalar> WaypointGuidance<S> {
    /// Without a place yet. `tolerance_m`: how near counts as being there, at least some millimetres, since
    /// places are rounded to them; `speed_mps`: how fast it wants to go.
    #[must_use]
    pub const fn new(speed_mps: S, tolerance_m: S) -> Self {
        Self {
            place: None,
            tolerance_m,
            speed_mps,
        }
    }
}

impl<S: Scalar> Guidance<S> for WaypointGuidance<S> {
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Guided<S>, BadInput> {
        view.can_go()?;
        let place = self.place.as_mut().ok_or(BadInput)?;
        let way = place.way(view.pose.position, view.now);
        let distance = way.norm();
        let speed = self.speed_mps.min(view.body.max_speed_mps);
        // On the last step no farther than the place.
        let needed = distance.checked_div(view.body.step_s).unwrap_or(speed);
        let ahead = way.normalized().unwrap_or_default();
        let is_at_goal = distance <= self.tolerance_m;
        Ok(Guided {
            velocity_mps: place.velocity_mps + ahead * needed.min(speed),
            way_m: Some(way),
            is_at_goal,
            // Who stood when it is there would lose a place that moves.
            makes_way: is_at_goal && place.velocity_mps != Vec3::ZERO,
            ..Guided::default()
        })
    }

    fn assign_place(&mut self, index: u8, place: &Place<S>) -> bool {
        if index == 0 {
            self.place = Some(*place);
        }
        index == 0
    }

    fn has_own_goal(&self) -> bool {
        self.place.is_some()
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
