//! Parameters of collision avoidance.

use crate::Number;
use crate::choices::StayaPushOutModel;
use crate::memory::plain;
use crate::status::Checked;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::{AvoidParams, DeadlockParams};
use staya_controller::push_out::{Evasion, PushOutParams};
use staya_controller::scalar::cast;

/// Optimal reciprocal collision avoidance (J. van den Berg and others 2011).
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaOrca {
    /// Time ahead for which collisions with robots are excluded, seconds; 1 to 5. With a longer
    /// time robots give way earlier and crowds become slower. A time shorter than the body needs to
    /// stop (speed / acceleration) is not safe.
    pub horizon_s: f32,
    /// Time ahead for which collisions with obstacles are excluded, seconds. In front of a wall a
    /// robot slows to (distance / this time).
    pub wall_horizon_s: f32,
    /// Own share of a correction: 0.5 if all robots use the same. Less is not safe.
    pub share: f32,
    /// Distance kept in addition to the radii, metres: the error of the known positions.
    pub margin_m: f32,
    /// How far the preferred velocity turns to the right while a robot is in the way, radians; 0.4
    /// to 0.6, 0 disables it.
    pub lean_rad: f32,
    /// How long a gap is left to robots whose turn it is: the time to travel this many own radii at
    /// full speed; 4 to 16.
    pub patience_radii: f32,
    /// Growth of the ball around a silent robot, m/s: the highest speed that others can have. Less
    /// is not safe if the radio is bad.
    pub growth_mps: f32,
    /// Limit of this growth for a stationary robot, metres.
    pub growth_max_m: f32,
    /// In space: ratio of the vertical to the horizontal distance between robots; 1 or more, for
    /// quadrotors 2.5.
    pub downwash: f32,
}

/// Push-out (V. E. and V. V. Pavlovsky).
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaPushOut {
    /// Least distance of two centres, and of a centre from an obstacle, metres; more than bodies
    /// need by the length of a step.
    pub min_distance_m: f32,
    /// StayaPushOutModel.
    pub model: u8,
    /// Other than 0: evades only the nearest of the robots in the way.
    pub only_nearest: u8,
}

plain!(StayaOrca, StayaPushOut);

impl StayaOrca {
    pub(crate) fn defaults() -> Self {
        let AvoidParams { horizon_s, wall_horizon_s, share, margin_m, deadlock } = AvoidParams::<f32>::default();
        let DeadlockParams { lean_rad, patience_radii } = deadlock;
        let (growth_mps, growth_max_m, downwash) = (0.5, 0.3, 1.0);
        Self {
            horizon_s,
            wall_horizon_s,
            share,
            margin_m,
            lean_rad,
            patience_radii,
            growth_mps,
            growth_max_m,
            downwash,
        }
    }

    pub(crate) fn params(&self) -> AvoidParams<Number> {
        let Self { horizon_s, wall_horizon_s, share, margin_m, lean_rad, patience_radii, .. } = *self;
        let deadlock = DeadlockParams { lean_rad, patience_radii };
        AvoidParams { horizon_s, wall_horizon_s, share, margin_m, deadlock }.cast()
    }

    pub(crate) fn inflation(&self) -> StalenessInflation<Number> {
        StalenessInflation { growth_mps: cast(self.growth_mps), max_m: cast(self.growth_max_m) }
    }
}

#[cfg(feature = "push-out")]
impl StayaPushOut {
    pub(crate) fn params(&self) -> Checked<PushOutParams<Number>> {
        Ok(PushOutParams {
            model: StayaPushOutModel::chosen(self.model)?,
            evasion: if self.only_nearest == 0 { Evasion::Multiple } else { Evasion::Single },
            min_distance_m: cast(self.min_distance_m),
        })
    }
}
