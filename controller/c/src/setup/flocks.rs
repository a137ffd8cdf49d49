//! Parameters of the flocks.

use super::positive;
use crate::Number;
use crate::choices::{StayaLatticeTerms, StayaLaw};
use crate::law::Law;
use crate::memory::{answers, plain};
use crate::setup::StayaSetup;
use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{BoidsGuidance, BoidsSettings, GoalFlockGuidance, LatticeGuidance};
use staya_controller::boids::BoidsParams;
use staya_controller::goal_flock::GoalParams;
use staya_controller::lattice::{Gain, LatticeParams};
use staya_controller::scalar::cast;

/// The alpha flock (R. Olfati-Saber 2006, algorithms 1 to 3); see `staya_lattice_defaults`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaLattice {
    /// Distance of neighbours (d), metres; 0.01 to 100, more than two radii plus the distance
    /// covered in half a second.
    pub spacing_m: f32,
    /// Range of interaction over spacing; above 1, below 1.7 for an even lattice.
    pub range_ratio: f32,
    /// Distance from obstacles over spacing; above 0, at most 4.
    pub obstacle_ratio: f32,
    /// Bounds of attraction (a) and repulsion (b): 0 < a <= b.
    pub attraction: f32,
    /// See `attraction`.
    pub repulsion: f32,
    /// Gains between robots on positions (1/s^2) and on velocities (1/s). Old beacons need small
    /// gains: see `staya_lattice_soften`.
    pub alpha_position: f32,
    /// See `alpha_position`.
    pub alpha_velocity: f32,
    /// Gains of obstacles; well above the others.
    pub beta_position: f32,
    /// See `beta_position`.
    pub beta_velocity: f32,
    /// Gains of the reference.
    pub gamma_position: f32,
    /// See `gamma_position`.
    pub gamma_velocity: f32,
    /// StayaLatticeTerms.
    pub terms: u8,
    /// Other than 0: the reference moves with its velocity. Agents only.
    pub reference_moves: u8,
}

/// The goal flock (V. E. and V. V. Pavlovsky): only the ratios of the gains matter.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaGoalFlock {
    /// Pull of the goal (K1).
    pub goal_gain: f32,
    /// Pull of the middle of the neighbours (K2).
    pub center_gain: f32,
    /// Push of neighbours that are too near (K3).
    pub repulsion_gain: f32,
    /// Distance up to which neighbours count, metres; at least twice `min_distance_m`.
    pub neighborhood_m: f32,
    /// Least distance of two centres, metres; at least two radii.
    pub min_distance_m: f32,
    /// Distance within which a goal counts as reached, metres: about the neighbourhood, as a crowd
    /// needs space. Agents only.
    pub arrival_m: f32,
    /// Seed of the random choice of goals. Agents only.
    pub seed: u32,
}

/// Boids (V. A. Starovoitova 2018).
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaBoids {
    /// Distance below which a boid turns away, metres.
    pub crowded_m: f32,
    /// Distance up to which a neighbour counts, metres.
    pub closest_m: f32,
    /// Largest turn towards the others in a step, radians.
    pub max_turn_rad: f32,
    /// Turn away from a neighbour that is too near in a step, radians.
    pub max_turn_away_rad: f32,
}

plain!(StayaLattice, StayaGoalFlock, StayaBoids);

impl StayaLattice {
    fn from_params(params: &LatticeParams<f32>, terms: u8, reference_moves: u8) -> Self {
        let LatticeParams { spacing_m, range_ratio, obstacle_ratio, attraction, repulsion, .. } = *params;
        let LatticeParams { alpha, beta, gamma, .. } = params;
        Self {
            spacing_m,
            range_ratio,
            obstacle_ratio,
            attraction,
            repulsion,
            alpha_position: alpha.position,
            alpha_velocity: alpha.velocity,
            beta_position: beta.position,
            beta_velocity: beta.velocity,
            gamma_position: gamma.position,
            gamma_velocity: gamma.velocity,
            terms,
            reference_moves,
        }
    }

    pub(crate) fn defaults(spacing_m: f32) -> Self {
        Self::from_params(&LatticeParams::new(spacing_m), StayaLatticeTerms::All as u8, 1)
    }

    fn in_f32(&self) -> Checked<LatticeParams<f32>> {
        let gain = |position, velocity| Gain { position, velocity };
        let algorithm = StayaLatticeTerms::chosen(self.terms)?;
        let Self { spacing_m, range_ratio, obstacle_ratio, attraction, repulsion, .. } = *self;
        let alpha = gain(self.alpha_position, self.alpha_velocity);
        let beta = gain(self.beta_position, self.beta_velocity);
        let gamma = gain(self.gamma_position, self.gamma_velocity);
        Ok(LatticeParams {
            algorithm,
            spacing_m,
            range_ratio,
            obstacle_ratio,
            attraction,
            repulsion,
            alpha,
            beta,
            gamma,
        })
    }

    pub(crate) fn params(&self) -> Checked<LatticeParams<Number>> {
        let params = self.in_f32()?.cast();
        if params.is_sound() { Ok(params) } else { Err(StayaStatus::Number) }
    }
}

impl StayaGoalFlock {
    pub(crate) fn defaults(min_distance_m: f32) -> Self {
        let GoalParams { goal_gain, center_gain, repulsion_gain, neighborhood_m, .. } =
            GoalParams::new(min_distance_m, 1.0);
        let (arrival_m, seed) = (neighborhood_m, 0);
        Self { goal_gain, center_gain, repulsion_gain, neighborhood_m, min_distance_m, arrival_m, seed }
    }

    pub(crate) fn params(&self, speed_mps: f32) -> Checked<GoalParams<Number>> {
        let Self { goal_gain, center_gain, repulsion_gain, neighborhood_m, min_distance_m, .. } = *self;
        let params =
            GoalParams { goal_gain, center_gain, repulsion_gain, neighborhood_m, min_distance_m, speed_mps }.cast();
        if params.is_sound() { Ok(params) } else { Err(StayaStatus::Number) }
    }
}

impl StayaBoids {
    pub(crate) fn defaults(unit_m: f32) -> Self {
        let BoidsSettings { crowded_m, closest_m, max_turn: max_turn_rad, max_turn_away: max_turn_away_rad, .. } =
            BoidsSettings::default();
        Self { crowded_m: crowded_m * unit_m, closest_m: closest_m * unit_m, max_turn_rad, max_turn_away_rad }
    }

    pub(crate) fn params(&self) -> BoidsParams<Number> {
        let Self { crowded_m, closest_m, max_turn_rad: max_turn, max_turn_away_rad: max_turn_away } = *self;
        BoidsParams::new(cast(crowded_m), cast(closest_m), cast(max_turn), cast(max_turn_away))
    }
}

#[cfg(feature = "flocks")]
pub(super) fn law(setup: &StayaSetup, law: StayaLaw) -> Checked<Law> {
    let StayaSetup { lattice, goal_flock, boids, speed_mps, .. } = setup;
    Ok(match law {
        StayaLaw::Lattice => Law::Lattice(LatticeGuidance::new(lattice.params()?, lattice.reference_moves != 0)),
        StayaLaw::GoalFlock => {
            positive(&[goal_flock.arrival_m])?;
            let (params, seed) = (goal_flock.params(*speed_mps)?, goal_flock.seed.into());
            Law::GoalFlock(GoalFlockGuidance::new(params, cast(goal_flock.arrival_m), seed))
        }
        _ => Law::Boids(BoidsGuidance::new(boids.params(), cast(*speed_mps))),
    })
}

/// Writes the paper's values of the lattice for a spacing, metres, as in a setup's defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_lattice_defaults(lattice: *mut StayaLattice, spacing_m: f32) -> StayaStatus {
    answers!(|call| call.write(lattice, StayaLattice::defaults(spacing_m)))
}

/// Reduces the gains as far as required if beacons are `delay_s` old when they arrive and come
/// `rate_hz` times per second. Stiffer gains make the lattice oscillate and break apart.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_lattice_soften(lattice: *mut StayaLattice, delay_s: f32, rate_hz: f32) -> StayaStatus {
    answers!(|call| {
        let before = *call.shared(lattice)?;
        let params = before.in_f32()?.stable_for(delay_s, rate_hz);
        call.write(lattice, StayaLattice::from_params(&params, before.terms, before.reference_moves))
    })
}
