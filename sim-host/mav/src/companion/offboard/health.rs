//! Whether an autopilot's own estimate of place and velocity can be believed, by what it says of it.
//!
//! An estimator that has lost its GPS goes on telling positions, as fresh as ever and more wrong each second. What it says besides is heeded here; an
//! autopilot that says nothing of it is believed.

use staya_mavlink::constants::{
    EKF_GPS_GLITCHING, EKF_UNINITIALIZED, ESTIMATOR_ACCEL_ERROR, ESTIMATOR_ATTITUDE, ESTIMATOR_CONST_POS_MODE,
    ESTIMATOR_GPS_GLITCH, ESTIMATOR_POS_HORIZ_ABS, ESTIMATOR_VELOCITY_HORIZ, GPS_FIX_TYPE_3D_FIX, MAV_SYS_STATUS_AHRS,
    MAV_SYS_STATUS_SENSOR_GPS,
};
use staya_mavlink::dialect::MavMessage;
use std::time::Duration;

/// How long all must be well until it is believed again.
pub const WELL_FOR: Duration = Duration::from_secs(5);
/// A receiver's report that is older counts for nothing.
const REPORT_VALID: Duration = Duration::from_secs(2);
/// From here on ArduPilot's own failsafe (`FS_EKF_THRESH`) takes an innovation for too large.
const EKF_LIMIT: f32 = 0.8;
/// From here on PX4's estimator refuses what sensors say.
const ESTIMATOR_LIMIT: f32 = 1.0;

/// Why a position is not believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// `GPS_RAW_INT`, `GPS2_RAW`: there was a fix in three dimensions, and no receiver has one any more.
    Gps,
    /// `EKF_STATUS_REPORT` or `ESTIMATOR_STATUS`: no place, no velocity, or innovations that are too large.
    Estimator,
    /// `SYS_STATUS`: GPS or attitude are switched on and not healthy.
    Sensors,
}

impl Doubt {
    /// In words, at most 40 bytes.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Gps => "GPS has lost its fix",
            Self::Estimator => "its estimator fails (EKF)",
            Self::Sensors => "GPS or AHRS is not healthy",
        }
    }
}

/// What was said of it, in one boot of the autopilot.
#[derive(Clone, Debug, Default)]
pub struct Health {
    had_fix: bool,
    /// When each of two receivers had a fix last.
    fixed_at: [Option<Duration>; 2],
    /// By the places in [`Doubt`].
    is_bad: [bool; 3],
    well_at: Duration,
    /// Reports of the estimator.
    pub reports: u64,
}

/// Whether flags and innovations, as parts of what is still accepted, are such that place and velocity are known.
fn is_well(flags: u16, bad: u16, innovations: [f32; 2]) -> bool {
    const NEEDED: u16 = ESTIMATOR_ATTITUDE | ESTIMATOR_VELOCITY_HORIZ | ESTIMATOR_POS_HORIZ_ABS;
    // What is not a number is no innovation: PX4 says so of what it does not measure.
    flags & NEEDED == NEEDED && flags & bad == 0 && !innovations.iter().any(|share| *share >= 1.0)
}

impl Health {
    /// Takes a message in; the doubt that is new with it.
    pub fn hear(&mut self, message: &MavMessage, now: Duration) -> Option<Doubt> {
        let (doubt, is_bad) = match message {
            MavMessage::GPS_RAW_INT(gps) => (Doubt::Gps, self.has_lost_fix(0, gps.fix_type, now)),
            MavMessage::GPS2_RAW(gps) => (Doubt::Gps, self.has_lost_fix(1, gps.fix_type, now)),
            MavMessage::EKF_STATUS_REPORT(ekf) => {
                let bad = ESTIMATOR_CONST_POS_MODE | EKF_UNINITIALIZED | EKF_GPS_GLITCHING;
                let innovations = [ekf.velocity_variance, ekf.pos_horiz_variance].map(|share| share / EKF_LIMIT);
                (Doubt::Estimator, !is_well(ekf.flags, bad, innovations))
            }
            MavMessage::ESTIMATOR_STATUS(status) => {
                let bad = ESTIMATOR_CONST_POS_MODE | ESTIMATOR_GPS_GLITCH | ESTIMATOR_ACCEL_ERROR;
                let innovations = [status.vel_ratio, status.pos_horiz_ratio].map(|share| share / ESTIMATOR_LIMIT);
                (Doubt::Estimator, !is_well(status.flags, bad, innovations))
            }
            MavMessage::SYS_STATUS(status) => {
                let used = status.onboard_control_sensors_present & status.onboard_control_sensors_enabled;
                let failed = used & !status.onboard_control_sensors_health;
                (Doubt::Sensors, failed & (MAV_SYS_STATUS_SENSOR_GPS | MAV_SYS_STATUS_AHRS) != 0)
            }
            _ => return None,
        };
        self.reports += u64::from(doubt == Doubt::Estimator);
        let is_new = is_bad && self.is_trusted(now);
        let [gps, estimator, sensors] = &mut self.is_bad;
        match doubt {
            Doubt::Gps => *gps = is_bad,
            Doubt::Estimator => *estimator = is_bad,
            Doubt::Sensors => *sensors = is_bad,
        }
        if self.is_bad.contains(&true) {
            self.well_at = now + WELL_FOR;
        }
        is_new.then_some(doubt)
    }

    /// Whether, with this report of a receiver, there is no fix any more. Who never had one goes by something else.
    fn has_lost_fix(&mut self, receiver: usize, fix_type: u8, now: Duration) -> bool {
        let has_fix = fix_type >= GPS_FIX_TYPE_3D_FIX;
        if let Some(fixed_at) = self.fixed_at.get_mut(receiver) {
            *fixed_at = has_fix.then_some(now);
        }
        self.had_fix |= has_fix;
        let is_fixed = |at: &Option<Duration>| at.is_some_and(|at| now.saturating_sub(at) <= REPORT_VALID);
        self.had_fix && !self.fixed_at.iter().any(is_fixed)
    }

    /// Whether its positions can be believed.
    pub fn is_trusted(&self, now: Duration) -> bool {
        now >= self.well_at && !self.is_bad.contains(&true)
    }
}

#[cfg(test)]
mod tests;
