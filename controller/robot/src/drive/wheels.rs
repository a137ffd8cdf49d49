use super::motor::{FULL, Motor};
use staya_controller::scalar::Scalar;

/// The relation of a motor's duty to its rim speed, measured on the robot: duty = `dead_duty` +
/// (1 - `dead_duty`) * speed / `full_mps`, with the sign of the speed; zero below `still_mps`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration<S> {
    /// Rim speed at full duty under the robot's weight, m/s ([`rim_speed`]); more than 0.
    pub full_mps: S,
    /// The largest part of the full duty, in [0, 1), at which the wheel does not turn yet. A value
    /// that is too large makes the robot jerk at low speed.
    pub dead_duty: S,
    /// The dead band, m/s.
    pub still_mps: S,
    /// The motor's forward direction drives the robot back.
    pub is_inverted: bool,
}

impl<S: Scalar> Calibration<S> {
    /// A motor with the rim speed `full_mps` at full duty, and proportional below.
    #[must_use]
    pub const fn linear(full_mps: S) -> Self {
        Self { full_mps, dead_duty: S::ZERO, still_mps: S::ZERO, is_inverted: false }
    }

    /// The duty for a rim speed; 0 if that is not a number.
    #[must_use]
    pub fn duty(&self, rim_mps: S) -> i16 {
        self.power(rim_mps).map_or(0, |power| {
            let is_back = (rim_mps < S::ZERO) != self.is_inverted;
            if is_back { -power } else { power }
        })
    }

    fn power(&self, rim_mps: S) -> Option<i16> {
        let speed = rim_mps.abs();
        if !(speed > self.still_mps && speed > S::ZERO && rim_mps.is_finite()) {
            return None;
        }
        let part = speed.min(self.full_mps).checked_div(self.full_mps)?;
        let dead = self.dead_duty.clamp(S::ZERO, S::ONE);
        let power = dead + (S::ONE - dead) * part;
        let full = S::from_i32(FULL.into());
        let rounded = (power * full + S::HALF).floor_to_i32()?;
        i16::try_from(rounded.clamp(0, FULL.into())).ok()
    }
}

/// Rim speed, m/s, of a wheel of `radius_m` that turns `turns` times in `span_s`; 0 if undefined.
#[must_use]
pub fn rim_speed<S: Scalar>(radius_m: S, turns: S, span_s: S) -> S {
    let way = (S::PI + S::PI) * radius_m * turns;
    way.checked_div(span_s).unwrap_or(S::ZERO)
}

/// The motors, in the order of the [`Kinematics`](super::Kinematics).
#[derive(Clone, Debug)]
pub struct Wheels<S, M, const W: usize> {
    motors: [(M, Calibration<S>); W],
}

impl<S: Scalar, M: Motor, const W: usize> Wheels<S, M, W> {
    /// Takes motors with their calibrations, without setting them.
    #[must_use]
    pub const fn new(motors: [(M, Calibration<S>); W]) -> Self {
        Self { motors }
    }

    /// Drives the rims at these speeds, m/s.
    ///
    /// # Errors
    /// The error of the first motor that failed. All others are stopped, or the robot would spin.
    pub fn turn(&mut self, rims_mps: &[S; W]) -> Result<(), M::Error> {
        let motors = self.motors.iter_mut().zip(rims_mps);
        for ((motor, calibration), rim) in motors {
            if let Err(error) = motor.set(calibration.duty(*rim)) {
                let _ = self.stop();
                return Err(error);
            }
        }
        Ok(())
    }

    /// Switches off all motors; tries each of them.
    ///
    /// # Errors
    /// The error of the first motor that failed.
    pub fn stop(&mut self) -> Result<(), M::Error> {
        let mut result = Ok(());
        for (motor, _) in &mut self.motors {
            result = result.and(motor.set(0));
        }
        result
    }

    /// Returns the motors.
    #[must_use]
    pub fn release(self) -> [M; W] {
        self.motors.map(|(motor, _)| motor)
    }
}
