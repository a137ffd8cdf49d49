//! The rounding errors that the gaps between robots must cover: [`Rounding`].

use crate::time::Duration;
use core::fmt;

/// Positions, velocities and radii on the wire are whole millimetres (per second), micrometres.
const HALF_UM: i64 = 500;
/// Excess that a decision may take of a gap, micrometres.
pub(super) const TOLERANCE_UM: i32 = 200;
/// Greatest error of the offset between two robots that the rule allows for, micrometres.
pub(super) const OFFSET_ERROR_UM: i32 = 2_100;
/// Gap that remains between bodies, millimetres.
pub(super) const ROUNDING_MM: i32 = 3;
/// Clocks of robots differ by this rate at most, millionths.
const DRIFT_PPM: i64 = 50;
/// Operations in single precision, nanometres for each metre of distance
/// (bounds by the tool Gappa: 0.08 mm up to 100 m, 0.55 mm up to 1 km).
const FLOAT_NM_PER_M: i64 = 600;

// The remaining gap covers the offset, the radius of the other robot, and the excess of both.
const _: () = assert!(
    OFFSET_ERROR_UM as i64 + HALF_UM + 2 * TOLERANCE_UM as i64 <= ROUNDING_MM as i64 * 1000,
    "the gap that remains does not cover rounding"
);

/// The causes of the rounding error of the offset between two robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rounding {
    /// Time between two decisions of a robot.
    pub step: Duration,
    /// Highest speed of any robot, mm/s.
    pub fastest_mmps: i32,
    /// Greatest distance of robots that limit each other, metres.
    pub range_m: i32,
    /// Whether they move in three dimensions.
    pub is_in_space: bool,
}

/// A rounding error above the one that the rule allows for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooCoarse {
    /// Error of the offset between two robots, micrometres.
    pub error_um: i64,
}

impl fmt::Display for TooCoarse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { error_um } = self;
        write!(f, "offsets between robots are rounded by {error_um} µm; the gaps cover {OFFSET_ERROR_UM} µm")
    }
}

impl core::error::Error for TooCoarse {}

impl Rounding {
    /// Returns the greatest error of the offset between two robots, micrometres: both positions and
    /// the told velocity on each axis, the clocks, and operations in single precision.
    #[must_use]
    pub const fn error_um(self) -> i64 {
        let (step_us, speed, range_m) = (self.step.as_micros() as i64, self.fastest_mmps as i64, self.range_m as i64);
        let axis_um = 2 * HALF_UM + per(HALF_UM * step_us, 1_000_000);
        // Times the square root of the number of axes.
        let length_um = per(axis_um * if self.is_in_space { 17_321 } else { 14_143 }, 10_000);
        let clocks_um = per(per(speed * step_us, 1_000_000) * DRIFT_PPM, 1000);
        length_um + clocks_um + per(range_m * FLOAT_NM_PER_M, 1000)
    }

    /// Returns whether the gaps between robots cover that error.
    ///
    /// # Errors
    /// The step, the speed or the range is too large.
    pub const fn check(self) -> Result<(), TooCoarse> {
        let error_um = self.error_um();
        if error_um > OFFSET_ERROR_UM as i64 { Err(TooCoarse { error_um }) } else { Ok(()) }
    }
}

const fn per(value: i64, divisor: i64) -> i64 {
    match value.checked_div(divisor) {
        Some(value) => value,
        None => i64::MAX,
    }
}

// At a metre a second and up to 100 m, steps of 0.8 s in the plane and of 0.3 s in space are
// covered.
const _: () = {
    let plane = Rounding { step: Duration::from_millis(800), fastest_mmps: 1000, range_m: 100, is_in_space: false };
    let space = Rounding { step: Duration::from_millis(300), is_in_space: true, ..plane };
    assert!(plane.check().is_ok() && space.check().is_ok(), "the gap that remains does not cover rounding");
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cause_alone_can_be_too_coarse() {
        let fine = Rounding { step: Duration::from_millis(100), fastest_mmps: 1000, range_m: 100, is_in_space: false };
        assert_eq!((fine.error_um(), fine.check()), (1485 + 5 + 60, Ok(())));
        let space = Rounding { is_in_space: true, ..fine };
        assert_eq!((space.error_um(), space.check()), (1818 + 5 + 60, Ok(())));
        for coarse in [
            Rounding { step: Duration::from_millis(900), ..fine },
            Rounding { step: Duration::from_millis(400), ..space },
            Rounding { fastest_mmps: 125_000, ..fine },
            Rounding { range_m: 1200, ..fine },
            Rounding { range_m: 600, ..space },
        ] {
            let TooCoarse { error_um } = coarse.check().unwrap_err();
            assert!(error_um > 2100 && error_um < 2300, "{coarse:?}: {error_um}");
        }
    }

    #[test]
    fn the_error_names_the_figures() {
        let text = std::format!("{}", TooCoarse { error_um: 2345 });
        assert_eq!(text, "offsets between robots are rounded by 2345 µm; the gaps cover 2100 µm");
    }
}
