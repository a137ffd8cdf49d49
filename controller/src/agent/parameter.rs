//! What of a running robot can be tuned: by an operator, or by its own firmware.

use super::Agent;
use super::guidance::Guidance;
use super::safety::Safety;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use crate::wire::Wire;

/// A number that may change while the robot runs. What it means and what more or less of it does stands where it is set at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Parameter {
    /// [`AgentConfig::radius_m`](super::AgentConfig::radius_m), metres: less than the body's radius is not safe.
    Radius,
    /// [`AgentConfig::beacon_period`](super::AgentConfig::beacon_period), seconds.
    BeaconPeriod,
    /// Cruising speed, m/s; the body's own limit holds too.
    Speed,
    /// How near counts as being there, metres.
    Tolerance,
    /// Time ahead for which no collision with a robot may happen, seconds.
    Horizon,
    /// The same for what does not move.
    WallHorizon,
    /// Own share of a correction.
    Share,
    /// Kept on top of the radii, metres.
    Margin,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Radius,
        Self::BeaconPeriod,
        Self::Speed,
        Self::Tolerance,
        Self::Horizon,
        Self::WallHorizon,
        Self::Share,
        Self::Margin,
    ];

    /// Least and greatest value that make sense for any robot; [`Agent::set_parameter`] takes no other.
    #[must_use]
    pub const fn range(self) -> [f32; 2] {
        match self {
            Self::Radius => [0.001, 65.0],
            Self::BeaconPeriod => [0.001, 60.0],
            Self::Speed => [0.0, 32.0],
            Self::Tolerance => [0.001, 1000.0],
            Self::Horizon | Self::WallHorizon => [0.01, 60.0],
            Self::Share => [0.0, 1.0],
            Self::Margin => [0.0, 10.0],
        }
    }
}

impl<S: Scalar, G: Guidance<S>, const N: usize, A: Safety<S>, W: Wire> Agent<S, G, N, A, W> {
    /// What a parameter is now; `None` when this robot has no such one.
    #[must_use]
    pub fn parameter(&self, parameter: Parameter) -> Option<f32> {
        let guidance = || self.guidance.parameter(parameter);
        let value = match parameter {
            Parameter::Radius => Some(self.config.radius_m),
            Parameter::BeaconPeriod => Some(S::from_micro(self.config.beacon_period.as_micros())),
            _ => guidance().or_else(|| self.safety.parameter(parameter)),
        };
        value.map(cast)
    }

    /// Changes a parameter from the next step on; whether this robot has such one and `value` is within
    /// [`Parameter::range`].
    pub fn set_parameter(&mut self, parameter: Parameter, value: f32) -> bool {
        let [least, greatest] = parameter.range();
        if !(least..=greatest).contains(&value) {
            return false;
        }
        match parameter {
            Parameter::Radius => self.config.radius_m = cast(value),
            // At most 60 seconds: no rounding in the millions that counts.
            Parameter::BeaconPeriod => {
                self.config.beacon_period = Duration::from_micros((value * 1e6) as i32);
            }
            _ => {
                let value = cast(value);
                return self.guidance.tune(parameter, value) | self.safety.tune(parameter, value);
            }
        }
        true
    }

    /// The guidance law, to be told something between two steps.
    pub const fn guidance_mut(&mut self) -> &mut G {
        &mut self.guidance
    }
}
