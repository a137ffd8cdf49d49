//! Parameters that can be tuned while a robot runs.

use crate::agent::StayaAgent;
use crate::memory::{self, resident, resident_mut};
use crate::status::{Checked, StayaStatus, answer};
use core::ffi::{CStr, c_char};
use staya_controller::agent::Parameter;

/// A parameter that `staya_set_parameter` can change while the robot runs. `staya_parameter_name`,
/// `staya_parameter_unit` and `staya_parameter_range` describe it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum StayaParameter {
    /// Radius that others keep clear of; not less than the body's, m.
    Radius = 0,
    /// Time between two beacons, s.
    BeaconPeriod = 1,
    /// Preferred speed, m/s.
    Speed = 2,
    /// Distance within which the goal counts as reached, m.
    Tolerance = 3,
    /// Time ahead without a collision with a robot, s.
    Horizon = 4,
    /// Time ahead without a collision with an obstacle, s.
    WallHorizon = 5,
    /// Own share of a correction.
    Share = 6,
    /// Distance kept in addition to the radii, m.
    Margin = 7,
    /// How far to turn to the right while a robot is in the way, rad.
    Lean = 8,
    /// How long a gap is left to robots whose turn it is, radii.
    PatienceRadii = 9,
    /// Least distance of two robots' centres, m.
    MinDistance = 10,
    /// Distance up to which neighbours count, m.
    Neighborhood = 11,
    /// Pull of the goal (K1).
    GoalGain = 12,
    /// Pull of the middle of the neighbours (K2).
    CenterGain = 13,
    /// Push of neighbours that are too near (K3).
    RepulsionGain = 14,
    /// Distance of neighbours in the lattice (d), m.
    Spacing = 15,
    /// Range of interaction over spacing.
    RangeRatio = 16,
    /// Distance from obstacles over spacing.
    ObstacleRatio = 17,
    /// Bound of the attraction (a).
    Attraction = 18,
    /// Bound of the repulsion (b), not less than a.
    Repulsion = 19,
    /// Gain between robots, on positions, 1/s^2.
    AlphaPosition = 20,
    /// Gain between robots, on velocities, 1/s.
    AlphaVelocity = 21,
    /// Gain of obstacles, on positions, 1/s^2.
    BetaPosition = 22,
    /// Gain of obstacles, on velocities, 1/s.
    BetaVelocity = 23,
    /// Gain of the reference, on positions, 1/s^2.
    GammaPosition = 24,
    /// Gain of the reference, on velocities, 1/s.
    GammaVelocity = 25,
    /// Distance below which a boid turns away, m.
    Crowded = 26,
    /// Distance up to which a neighbour counts, m.
    Closest = 27,
    /// Largest turn towards the others in a step, rad.
    MaxTurn = 28,
    /// Turn away from a neighbour that is too near in a step, rad.
    MaxTurnAway = 29,
    /// Weight of travel time.
    TimeGain = 30,
    /// Additional cost of a cell with another robot, ticks.
    OthersGain = 31,
    /// Additional cost of a cell for each earlier visit, ticks.
    VisitsGain = 32,
    /// Price of a cell between the window and the target, ticks.
    WayGain = 33,
    /// Distance from its place up to which a robot is found, cells.
    Eps = 34,
    /// Price of a cell off the own place, ticks.
    PlaceGain = 35,
    /// How far a robot may fall behind before the leader waits, cells.
    HaltLag = 36,
    /// How near it must be before the leader continues, cells.
    ResumeLag = 37,
    /// How far ahead of the leader the others aim, cells.
    Lead = 38,
    /// Share of the others' land in the leader's price, /16.
    Footprint = 39,
    /// How long robots wait before each continues alone, decisions.
    Patience = 40,
}

const ALL: [(StayaParameter, Parameter, &CStr, &CStr); 41] = [
    (StayaParameter::Radius, Parameter::Radius, c"radius_m", c"m"),
    (StayaParameter::BeaconPeriod, Parameter::BeaconPeriod, c"beacon_period_s", c"s"),
    (StayaParameter::Speed, Parameter::Speed, c"speed_mps", c"m/s"),
    (StayaParameter::Tolerance, Parameter::Tolerance, c"tolerance_m", c"m"),
    (StayaParameter::Horizon, Parameter::Horizon, c"horizon_s", c"s"),
    (StayaParameter::WallHorizon, Parameter::WallHorizon, c"wall_horizon_s", c"s"),
    (StayaParameter::Share, Parameter::Share, c"share", c""),
    (StayaParameter::Margin, Parameter::Margin, c"margin_m", c"m"),
    (StayaParameter::Lean, Parameter::Lean, c"lean_rad", c"rad"),
    (StayaParameter::PatienceRadii, Parameter::PatienceRadii, c"patience_radii", c"radii"),
    (StayaParameter::MinDistance, Parameter::MinDistance, c"min_distance_m", c"m"),
    (StayaParameter::Neighborhood, Parameter::Neighborhood, c"neighborhood_m", c"m"),
    (StayaParameter::GoalGain, Parameter::GoalGain, c"k1", c""),
    (StayaParameter::CenterGain, Parameter::CenterGain, c"k2", c""),
    (StayaParameter::RepulsionGain, Parameter::RepulsionGain, c"k3", c""),
    (StayaParameter::Spacing, Parameter::Spacing, c"spacing_m", c"m"),
    (StayaParameter::RangeRatio, Parameter::RangeRatio, c"range_ratio", c""),
    (StayaParameter::ObstacleRatio, Parameter::ObstacleRatio, c"obstacle_ratio", c""),
    (StayaParameter::Attraction, Parameter::Attraction, c"attraction", c""),
    (StayaParameter::Repulsion, Parameter::Repulsion, c"repulsion", c""),
    (StayaParameter::AlphaPosition, Parameter::AlphaPosition, c"c1_alpha", c"1/s^2"),
    (StayaParameter::AlphaVelocity, Parameter::AlphaVelocity, c"c2_alpha", c"1/s"),
    (StayaParameter::BetaPosition, Parameter::BetaPosition, c"c1_beta", c"1/s^2"),
    (StayaParameter::BetaVelocity, Parameter::BetaVelocity, c"c2_beta", c"1/s"),
    (StayaParameter::GammaPosition, Parameter::GammaPosition, c"c1_gamma", c"1/s^2"),
    (StayaParameter::GammaVelocity, Parameter::GammaVelocity, c"c2_gamma", c"1/s"),
    (StayaParameter::Crowded, Parameter::Crowded, c"crowded_m", c"m"),
    (StayaParameter::Closest, Parameter::Closest, c"closest_m", c"m"),
    (StayaParameter::MaxTurn, Parameter::MaxTurn, c"max_turn", c"rad"),
    (StayaParameter::MaxTurnAway, Parameter::MaxTurnAway, c"max_turn_away", c"rad"),
    (StayaParameter::TimeGain, Parameter::TimeGain, c"a0", c""),
    (StayaParameter::OthersGain, Parameter::OthersGain, c"a1", c"ticks"),
    (StayaParameter::VisitsGain, Parameter::VisitsGain, c"a2", c"ticks"),
    (StayaParameter::WayGain, Parameter::WayGain, c"a3", c"ticks"),
    (StayaParameter::Eps, Parameter::Eps, c"eps_cells", c"cells"),
    (StayaParameter::PlaceGain, Parameter::PlaceGain, c"place_gain", c"ticks"),
    (StayaParameter::HaltLag, Parameter::HaltLag, c"halt_cells", c"cells"),
    (StayaParameter::ResumeLag, Parameter::ResumeLag, c"resume_cells", c"cells"),
    (StayaParameter::Lead, Parameter::Lead, c"lead_cells", c"cells"),
    (StayaParameter::Footprint, Parameter::Footprint, c"footprint", c"/16"),
    (StayaParameter::Patience, Parameter::Patience, c"patience", c"decisions"),
];

fn known(number: u32) -> Checked<(Parameter, &'static CStr, &'static CStr)> {
    let found = ALL.into_iter().find(|(known, ..)| *known as u32 == number);
    found.map(|(_, parameter, name, unit)| (parameter, name, unit)).ok_or(StayaStatus::Unknown)
}

/// The name of parameter 0, 1, 2 and so on, such as "horizon_s"; null beyond the last one.
#[unsafe(no_mangle)]
pub extern "C" fn staya_parameter_name(parameter: u32) -> *const c_char {
    match known(parameter) {
        Ok((_, name, _)) => name.as_ptr(),
        Err(_) => core::ptr::null(),
    }
}

/// The unit of a parameter, empty for a plain number; null if the number does not exist.
#[unsafe(no_mangle)]
pub extern "C" fn staya_parameter_unit(parameter: u32) -> *const c_char {
    match known(parameter) {
        Ok((_, _, unit)) => unit.as_ptr(),
        Err(_) => core::ptr::null(),
    }
}

/// Returns the least and the greatest value of a parameter.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_parameter_range(parameter: u32, least: *mut f32, greatest: *mut f32) -> StayaStatus {
    let ask = || {
        let [low, high] = known(parameter)?.0.range();
        // SAFETY: valid space for both by the caller's contract, or `write` rejects it.
        unsafe {
            memory::write(least, low)?;
            memory::write(greatest, high)
        }
    };
    answer(ask())
}

/// Returns the present value of a StayaParameter; `STAYA_STATUS_PARAMETER` if the robot lacks it.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_get_parameter(agent: *const StayaAgent, parameter: u32, value: *mut f32) -> StayaStatus {
    let ask = || {
        let (parameter, ..) = known(parameter)?;
        // SAFETY: an agent by the caller's contract, or `resident` rejects it.
        let agent = unsafe { resident(agent)? };
        let known = agent.inside().parameter(parameter).ok_or(StayaStatus::Parameter)?;
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(value, known) }
    };
    answer(ask())
}

/// Changes a parameter (StayaParameter) from the next step on. `STAYA_STATUS_PARAMETER`, and no
/// change, if the robot lacks it, or the value is out of range or contradicts other parameters.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_set_parameter(agent: *mut StayaAgent, parameter: u32, value: f32) -> StayaStatus {
    let set = || {
        let (parameter, ..) = known(parameter)?;
        // SAFETY: an agent not used elsewhere by contract, or `resident_mut` rejects it.
        let agent = unsafe { resident_mut(agent)? };
        let is_set = agent.inside_mut().set_parameter(parameter, value);
        is_set.then_some(()).ok_or(StayaStatus::Parameter)
    };
    answer(set())
}
