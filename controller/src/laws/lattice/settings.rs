//! Settings of the alpha flock.

use super::{Algorithm, Gain, LatticeGuidance, LatticeParams, ReferenceMotion};
use crate::law::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
use crate::parameters::{Parameters, row, switch};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Ratio of the alpha gain to the goal gain in algorithm 2: see [`LatticeParams::gamma`].
pub const GAMMA_OF_TWO: f32 = 50.0;

/// Settings of [`LatticeGuidance`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LatticeSettings {
    /// Distances, gains and terms.
    pub params: LatticeParams<f32>,
    /// The paper's algorithm, 1 to 3.
    pub algorithm: u8,
    /// Whether robots do not push neighbours that are nearer to the goal.
    pub takes_turns: bool,
    /// Whether the goal moves with its velocity.
    pub goal_moves: bool,
    /// Distance behind a stationary goal over which its velocity fades, metres; infinite: never.
    pub goal_rest_m: f32,
}

crate::parameters! {
    impl[] LatticeSettings {
        row("algorithm", "LAT_ALGORITHM", "", [1.0, 3.0], "1: other robots only; 2: also the goal; 3: also obstacles")
            => algorithm,
        switch("takes_turns", "LAT_TURNS", "gaps one by one: robots nearer to the goal go first")
            => takes_turns,
        switch("goal_moves", "LAT_GOAL_MOVES", "whether the goal moves with its velocity") => goal_moves,
        row("goal_rest_m", "LAT_REST_M", "m", [0.01, 1e6], "way behind a goal at rest in which its velocity fades")
            .depends("never") => goal_rest_m,
    }
}

impl Default for LatticeSettings {
    /// [`LatticeParams::new`] for a spacing of one metre.
    fn default() -> Self {
        let params = LatticeParams::new(1.0);
        Self { params, algorithm: 3, takes_turns: false, goal_moves: true, goal_rest_m: f32::INFINITY }
    }
}

impl LatticeSettings {
    /// How the goal moves.
    #[must_use]
    pub const fn motion(&self) -> ReferenceMotion<f32> {
        match self.goal_moves {
            true => ReferenceMotion::Dynamic,
            false if self.goal_rest_m.is_finite() => ReferenceMotion::Resting(self.goal_rest_m),
            false => ReferenceMotion::Static,
        }
    }
}

impl Settings for LatticeSettings {
    const NAME: &'static str = "lattice";
    const WHAT: &'static str = "equal distances around a common goal: the alpha flock (R. Olfati-Saber, OLF)";

    fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }

    /// Gains default to values that are stable with this radio's delay.
    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        let wrong = |row, what, remedy| Err(Contradiction::new(row, what, remedy));
        let params = &mut self.params;
        params.algorithm = match (self.algorithm, self.takes_turns) {
            (1, false) => Algorithm::One,
            (2, false) => Algorithm::Two,
            (_, false) => Algorithm::Three,
            (3, true) => Algorithm::ThreeInTurn,
            (_, true) => {
                let what = "robots take turns in algorithm 3 only";
                return wrong("takes_turns", what, "give algorithm = 3, or leave it out");
            }
        };
        let mut usual = LatticeParams::<f32>::new(1.0);
        if params.algorithm == Algorithm::Two {
            // The pull grows with the size of the flock.
            usual.gamma = Gain::critical(usual.alpha.position / GAMMA_OF_TWO);
        }
        if !is_given("c1_alpha") {
            usual = usual.stable_for(around.delay_s, around.rate_hz);
        }
        for (names, gain, usual) in [
            (["c1_alpha", "c2_alpha"], &mut params.alpha, usual.alpha),
            (["c1_beta", "c2_beta"], &mut params.beta, usual.beta),
            (["c1_gamma", "c2_gamma"], &mut params.gamma, usual.gamma),
        ] {
            let [on_places, on_velocities] = names.map(is_given);
            gain.position = if on_places { gain.position } else { usual.position };
            let critical = Gain::critical(gain.position).velocity;
            gain.velocity = match (on_places, on_velocities) {
                (_, true) => gain.velocity,
                (true, false) => critical,
                (false, false) => usual.velocity,
            };
        }
        if !params.is_sound() {
            return wrong("repulsion", "less than the attraction", "give at least the attraction");
        }
        if self.goal_moves && is_given("goal_rest_m") {
            let what = "a goal that moves gives no rest";
            return wrong("goal_rest_m", what, "give goal_moves = false, or leave it out");
        }
        Ok(())
    }
}

impl SettingsOfLaw for LatticeSettings {
    const MOTION: Motion = Motion::Velocities;
    const GOALS: Goals = Goals::Shared(1);
}

impl<S: Scalar, const CELLS: usize, const M: usize, const L: usize, H> MakesLaw<S, CELLS, M, L, H> for LatticeSettings {
    type Law = LatticeGuidance<S>;

    fn law(&self, _: H) -> LatticeGuidance<S> {
        LatticeGuidance::following(self.params.cast(), self.motion().cast())
    }
}
