//! Settings of the law of waypoints.

use super::WaypointGuidance;
use crate::law::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
use crate::parameters::Parameters;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// Settings of [`WaypointGuidance`]: those of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WaypointSettings {
    /// Preferred speed, m/s.
    pub speed_mps: f32,
    /// Distance at which the goal counts as reached, metres.
    pub tolerance_m: f32,
}

impl Settings for WaypointSettings {
    const NAME: &'static str = "waypoint";
    const WHAT: &'static str = "straight through waypoints to a goal";

    fn tables(&mut self, _: &mut dyn FnMut(&mut dyn Parameters)) {}

    fn adapt(&mut self, _: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.speed_mps = around.cruise_mps.unwrap_or_default();
        self.tolerance_m = around.tolerance_m;
        Ok(())
    }
}

impl SettingsOfLaw for WaypointSettings {
    const MOTION: Motion = Motion::Velocities;
    const GOALS: Goals = Goals::Waypoints;
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H> MakesLaw<S, CELLS, M, L, H>
    for WaypointSettings
{
    type Law = WaypointGuidance<S>;

    fn law(&self, _: H) -> WaypointGuidance<S> {
        WaypointGuidance::new(cast(self.speed_mps), cast(self.tolerance_m))
    }
}
