//! Settings of boids.

use super::{BoidsGuidance, BoidsParams, CLOSEST, CROWDED, TURN, TURN_AWAY};
use crate::law::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
use crate::parameters::Parameters;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// Settings of [`BoidsGuidance`]: the inputs of [`BoidsParams::new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BoidsSettings {
    /// Distance below which a boid turns away, metres.
    pub crowded_m: f32,
    /// Distance up to which a neighbour counts, metres.
    pub closest_m: f32,
    /// Largest turn towards the mean heading and the centre, radians per step.
    pub max_turn: f32,
    /// Largest turn away, radians per step.
    pub max_turn_away: f32,
    /// Speed, m/s.
    pub speed_mps: f32,
}

crate::parameters! {
    impl[] BoidsSettings {
        CROWDED => crowded_m,
        CLOSEST => closest_m,
        TURN => max_turn,
        TURN_AWAY => max_turn_away,
    }
}

impl Default for BoidsSettings {
    /// The values of the paper at a scale of one metre: 30, 150, 0.05, 0.02.
    fn default() -> Self {
        Self { crowded_m: 30.0, closest_m: 150.0, max_turn: 0.05, max_turn_away: 0.02, speed_mps: 0.0 }
    }
}

impl BoidsSettings {
    /// The parameters of the rules.
    #[must_use]
    pub fn params<S: Scalar>(&self) -> BoidsParams<S> {
        let Self { crowded_m, closest_m, max_turn, max_turn_away, .. } = *self;
        BoidsParams::new(cast(crowded_m), cast(closest_m), cast(max_turn), cast(max_turn_away))
    }
}

impl Settings for BoidsSettings {
    const NAME: &'static str = "boids";
    const WHAT: &'static str = "constant speed, and headings that follow the neighbours (V. A. Starovoitova, STA)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
    }

    fn adapt(&mut self, _: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        self.speed_mps = around.cruise_mps.unwrap_or_default();
        Ok(())
    }
}

impl SettingsOfLaw for BoidsSettings {
    const MOTION: Motion = Motion::Velocities;
    const GOALS: Goals = Goals::None;
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H> MakesLaw<S, CELLS, M, L, H> for BoidsSettings {
    type Law = BoidsGuidance<S>;

    fn law(&self, _: H) -> BoidsGuidance<S> {
        BoidsGuidance::new(self.params(), cast(self.speed_mps))
    }
}
