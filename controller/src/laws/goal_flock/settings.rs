//! Settings of the goal flock.

use super::law::GOALS;
use super::{GoalFlockGuidance, GoalParams};
use crate::law::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
use crate::parameters::{Parameters, TOLERANCE};
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// Settings of [`GoalFlockGuidance`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GoalFlockSettings {
    /// Distances, gains and speed.
    pub params: GoalParams<f32>,
    /// Distance at which the goal counts as reached, metres.
    pub arrival_m: f32,
    /// Seed of the draws of goals.
    pub seed: u64,
}

crate::parameters! {
    impl[] GoalFlockSettings { TOLERANCE.depends("`neighborhood_m`") => arrival_m }
}

impl Default for GoalFlockSettings {
    /// For a least distance of one metre.
    fn default() -> Self {
        let params = GoalParams::new(1.0, 1.0);
        Self { params, arrival_m: params.neighborhood_m, seed: 0 }
    }
}

impl Settings for GoalFlockSettings {
    const NAME: &'static str = "goal_flock";
    const WHAT: &'static str = "together to the middle of the goals, then each to one (V. E. and V. V. Pavlovsky, PAV)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }

    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        let params = &mut self.params;
        params.speed_mps = around.cruise_mps.unwrap_or_default();
        self.seed = around.seed;
        if !is_given("neighborhood_m") {
            params.neighborhood_m = 4.0 * params.min_distance_m;
        }
        if !is_given("tolerance_m") {
            self.arrival_m = params.neighborhood_m;
        }
        if params.neighborhood_m < 2.0 * params.min_distance_m {
            let (what, remedy) = ("less than 2 min_distance_m", "give more, or leave it out");
            return Err(Contradiction::new("neighborhood_m", what, remedy));
        }
        Ok(())
    }
}

impl SettingsOfLaw for GoalFlockSettings {
    const MOTION: Motion = Motion::Velocities;
    const GOALS: Goals = Goals::Shared(GOALS as u8);
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H> MakesLaw<S, CELLS, M, L, H>
    for GoalFlockSettings
{
    type Law = GoalFlockGuidance<S>;

    fn law(&self, _: H) -> GoalFlockGuidance<S> {
        GoalFlockGuidance::new(self.params.cast(), cast(self.arrival_m), self.seed)
    }
}
