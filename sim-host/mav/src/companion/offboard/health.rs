//! Trust in an autopilot's position estimate. An estimator that lost GPS keeps sending positions
//! that look fresh but drift, so status messages decide. An autopilot that sends none is trusted.

use staya_mavlink::constants::*;
use staya_mavlink::dialect::MavMessage;
use std::time::Duration;

pub const WELL_FOR: Duration = Duration::from_secs(5);
const REPORT_VALID: Duration = Duration::from_secs(2);
/// ArduPilot's failsafe (`FS_EKF_THRESH`) triggers at this innovation ratio.
const EKF_LIMIT: f32 = 0.8;
/// PX4's estimator rejects measurements at this innovation ratio.
const ESTIMATOR_LIMIT: f32 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// `GPS_RAW_INT`, `GPS2_RAW`: no receiver has a 3D fix, although one had.
    Gps,
    /// `EKF_STATUS_REPORT` or `ESTIMATOR_STATUS`: no position, no velocity, or large innovations.
    Estimator,
    /// `SYS_STATUS`: GPS or attitude is enabled but unhealthy.
    Sensors,
}

impl Doubt {
    pub const fn words(self) -> &'static str {
        match self {
            Self::Gps => "GPS lost its fix",
            Self::Estimator => "estimator failed (EKF)",
            Self::Sensors => "GPS or AHRS unhealthy",
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct Health {
    had_fix: bool,
    fixed_at: [Option<Duration>; 2],
    /// By [`Doubt`].
    is_bad: [bool; 3],
    well_at: Duration,
    pub reports: u64,
}

/// `innovations` are fractions of the accepted limit.
fn is_well(flags: u16, bad: u16, innovations: [f32; 2]) -> bool {
    const NEEDED: u16 = ESTIMATOR_ATTITUDE | ESTIMATOR_VELOCITY_HORIZ | ESTIMATOR_POS_HORIZ_ABS;
    // NaN stands for a quantity that PX4 does not measure; it is not an error.
    flags & NEEDED == NEEDED && flags & bad == 0 && !innovations.iter().any(|share| *share >= 1.0)
}

impl Health {
    /// Returns the problem that the message starts.
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
        self.is_bad[doubt as usize] = is_bad;
        if self.is_bad.contains(&true) {
            self.well_at = now + WELL_FOR;
        }
        is_new.then_some(doubt)
    }

    /// A vehicle that never had a fix does not need GPS.
    fn has_lost_fix(&mut self, receiver: usize, fix_type: u8, now: Duration) -> bool {
        let has_fix = fix_type >= GPS_FIX_TYPE_3D_FIX;
        self.fixed_at[receiver] = has_fix.then_some(now);
        self.had_fix |= has_fix;
        let is_fixed = |at: &Option<Duration>| at.is_some_and(|at| now.saturating_sub(at) <= REPORT_VALID);
        self.had_fix && !self.fixed_at.iter().any(is_fixed)
    }

    pub fn is_trusted(&self, now: Duration) -> bool {
        now >= self.well_at && !self.is_bad.contains(&true)
    }
}

#[cfg(test)]
mod tests;
