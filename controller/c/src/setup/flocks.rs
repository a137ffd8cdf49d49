//! Parameters of the flocks.

use super::positive;
use crate::Number;
use crate::choices::{StayaLatticeTerms, StayaLaw};
use crate::law::Law;
use crate::memory::{self, plain, shared};
use crate::setup::StayaSetup;
use crate::status::{Checked, StayaStatus, answer};
use staya_controller::agent::{BoidsGuidance, BoidsSetup, GoalFlockGuidance, LatticeGuidance};
use staya_controller::flock::boids::BoidsParams;
use staya_controller::flock::goal::GoalParams;
use staya_controller::flock::lattice::{Gain, LatticeParams};
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
        Self {
            spacing_m: params.spacing_m,
            range_ratio: params.range_ratio,
            obstacle_ratio: params.obstacle_ratio,
            attraction: params.attraction,
            repulsion: params.repulsion,
            alpha_position: params.alpha.position,
            alpha_velocity: params.alpha.velocity,
            beta_position: params.beta.position,
            beta_velocity: params.beta.velocity,
            gamma_position: params.gamma.position,
            gamma_velocity: params.gamma.velocity,
            terms,
            reference_moves,
        }
    }

    pub(crate) fn defaults(spacing_m: f32) -> Self {
        Self::from_params(&LatticeParams::new(spacing_m), StayaLatticeTerms::All as u8, 1)
    }

    pub(crate) fn softened(&self, delay_s: f32, rate_hz: f32) -> Checked<Self> {
        let params = self.in_f32()?.stable_for(delay_s, rate_hz);
        Ok(Self::from_params(&params, self.terms, self.reference_moves))
    }

    fn in_f32(&self) -> Checked<LatticeParams<f32>> {
        let gain = |position, velocity| Gain { position, velocity };
        Ok(LatticeParams {
            algorithm: StayaLatticeTerms::of(self.terms)?.into(),
            spacing_m: self.spacing_m,
            range_ratio: self.range_ratio,
            obstacle_ratio: self.obstacle_ratio,
            attraction: self.attraction,
            repulsion: self.repulsion,
            alpha: gain(self.alpha_position, self.alpha_velocity),
            beta: gain(self.beta_position, self.beta_velocity),
            gamma: gain(self.gamma_position, self.gamma_velocity),
        })
    }

    pub(crate) fn params(&self) -> Checked<LatticeParams<Number>> {
        let params = self.in_f32()?.cast();
        if params.is_sound() { Ok(params) } else { Err(StayaStatus::Number) }
    }
}

impl StayaGoalFlock {
    pub(crate) fn defaults(min_distance_m: f32) -> Self {
        let params = GoalParams::new(min_distance_m, 1.0);
        Self {
            goal_gain: params.goal_gain,
            center_gain: params.center_gain,
            repulsion_gain: params.repulsion_gain,
            neighborhood_m: params.neighborhood_m,
            min_distance_m,
            arrival_m: params.neighborhood_m,
            seed: 0,
        }
    }

    pub(crate) fn params(&self, speed_mps: f32) -> Checked<GoalParams<Number>> {
        let params = GoalParams {
            goal_gain: cast(self.goal_gain),
            center_gain: cast(self.center_gain),
            repulsion_gain: cast(self.repulsion_gain),
            neighborhood_m: cast(self.neighborhood_m),
            min_distance_m: cast(self.min_distance_m),
            speed_mps: cast(speed_mps),
        };
        if params.is_sound() { Ok(params) } else { Err(StayaStatus::Number) }
    }
}

impl StayaBoids {
    pub(crate) fn defaults(unit_m: f32) -> Self {
        let BoidsSetup { crowded_m, closest_m, max_turn, max_turn_away } = BoidsSetup::PAPER;
        Self {
            crowded_m: crowded_m * unit_m,
            closest_m: closest_m * unit_m,
            max_turn_rad: max_turn,
            max_turn_away_rad: max_turn_away,
        }
    }

    pub(crate) fn params(&self) -> BoidsParams<Number> {
        let numbers = [self.crowded_m, self.closest_m, self.max_turn_rad, self.max_turn_away_rad];
        let [crowded, closest, turn, away] = numbers.map(cast);
        BoidsParams::new(crowded, closest, turn, away)
    }
}

#[cfg(feature = "flocks")]
pub(super) fn law(setup: &StayaSetup, law: StayaLaw) -> Checked<Law> {
    Ok(match law {
        StayaLaw::Lattice => {
            let moves = setup.lattice.reference_moves != 0;
            Law::Lattice(LatticeGuidance::new(setup.lattice.params()?, moves))
        }
        StayaLaw::GoalFlock => {
            positive(&[setup.goal_flock.arrival_m])?;
            let params = setup.goal_flock.params(setup.speed_mps)?;
            Law::GoalFlock(GoalFlockGuidance::new(
                params,
                cast(setup.goal_flock.arrival_m),
                setup.goal_flock.seed.into(),
            ))
        }
        _ => Law::Boids(BoidsGuidance::new(setup.boids.params(), cast(setup.speed_mps))),
    })
}

/// Writes the paper's values of the lattice for a spacing, metres, as in a setup's defaults.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_lattice_defaults(lattice: *mut StayaLattice, spacing_m: f32) -> StayaStatus {
    // SAFETY: valid space by the caller's contract, or `write` rejects it.
    answer(unsafe { memory::write(lattice, StayaLattice::defaults(spacing_m)) })
}

/// Reduces the gains as far as required if beacons are `delay_s` old when they arrive and come
/// `rate_hz` times per second. Stiffer gains make the lattice oscillate and break apart.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_lattice_soften(lattice: *mut StayaLattice, delay_s: f32, rate_hz: f32) -> StayaStatus {
    // SAFETY: a valid lattice not used elsewhere by contract, or `shared` rejects it.
    let softened = unsafe { shared(lattice) }.and_then(|lattice| lattice.softened(delay_s, rate_hz));
    // SAFETY: as above; the reference has ended.
    answer(softened.and_then(|softened| unsafe { memory::write(lattice, softened) }))
}
