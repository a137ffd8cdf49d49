//! The robot's position, computed from its wheels.

use crate::drive::{Twist, wrap_angle};
use staya_controller::agent::KinematicState;
use staya_controller::geom::{Position, Vec2};
use staya_controller::scalar::Scalar;
use staya_controller::time::Duration;

/// The wrapping 16-bit counter of an incremental encoder. Read it every 32,766 ticks or sooner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder<S> {
    rim_m: S,
    ticks_per_turn: u16,
    last: Option<u16>,
    /// Ticks since the initial angle, less than one turn.
    in_turn: i32,
    is_inverted: bool,
}

impl<S: Scalar> Encoder<S> {
    /// An encoder on a wheel of `wheel_radius_m` with `ticks_per_turn` counts per turn of the wheel
    /// (all edges, including the gear); `None` unless both are above 0. An inverted one counts down
    /// ahead.
    #[must_use]
    pub fn new(wheel_radius_m: S, ticks_per_turn: u16, is_inverted: bool) -> Option<Self> {
        let sensible = wheel_radius_m > S::ZERO && ticks_per_turn > 0;
        sensible.then_some(Self {
            rim_m: (S::PI + S::PI) * wheel_radius_m,
            ticks_per_turn,
            last: None,
            in_turn: 0,
            is_inverted,
        })
    }

    /// The distance that the rim travelled since the last call, metres; 0 in the first call.
    /// Rounding errors do not accumulate: it is the difference of two positions on the rim.
    #[must_use]
    pub fn travelled(&mut self, count: u16) -> S {
        let last = self.last.replace(count).unwrap_or(count);
        let ticks = i32::from(count.wrapping_sub(last).cast_signed());
        let ticks = if self.is_inverted { -ticks } else { ticks };
        let sum = self.in_turn + ticks;
        let per_turn = i32::from(self.ticks_per_turn);
        let turns = sum.checked_div_euclid(per_turn).unwrap_or(0);
        let in_turn = sum.checked_rem_euclid(per_turn).unwrap_or(0);
        let before = core::mem::replace(&mut self.in_turn, in_turn);
        S::from_i32(turns) * self.rim_m + self.place(in_turn) - self.place(before)
    }

    fn place(&self, in_turn: i32) -> S {
        let part = S::from_i32(in_turn).checked_div(S::from_i32(self.ticks_per_turn.into()));
        part.unwrap_or(S::ZERO) * self.rim_m
    }
}

/// Position and heading of the robot's middle (two wheels: of the axle), a sum of small motions.
///
/// It drifts: wheels slip, and each error of the heading affects all later motion. Correct it from
/// time to time by another source (beacons, a camera, satellites): [`Self::correct`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry<S> {
    position: Position,
    rest_m: Vec2<S>,
    heading_rad: S,
    twist: Twist<S>,
}

impl<S: Scalar> Odometry<S> {
    /// Starts with a stationary robot; `None` unless `heading_rad` (from east) is finite.
    #[must_use]
    pub fn new(position: Position, heading_rad: S) -> Option<Self> {
        heading_rad.is_finite().then(|| Self {
            position,
            rest_m: Vec2::ZERO,
            heading_rad: wrap_angle(heading_rad),
            twist: Twist::default(),
        })
    }

    /// Adds the motion of the body within `span`: `way` in metres and radians, for example
    /// [`Kinematics::twist`](crate::drive::Kinematics::twist) of the distances of the rims. A
    /// motion that is not a number is ignored. Runge-Kutta of second order.
    pub fn advance(&mut self, way: &Twist<S>, span: Duration) {
        let mid = self.heading_rad + way.turn_radps * S::HALF;
        let (sin, cos) = mid.sin_cos();
        let step = Vec2::new(way.forward_mps, way.left_mps).rotate(cos, sin) + self.rest_m;
        let [Some(x), Some(y)] = [step.x, step.y].map(S::to_milli) else {
            return;
        };
        if !(step.is_finite() && way.is_finite()) {
            return;
        }
        let [east, north, up] = self.position.mm;
        self.position.mm = [east.saturating_add(x), north.saturating_add(y), up];
        self.rest_m = step - Vec2::new(S::from_milli(x), S::from_milli(y));
        self.heading_rad = wrap_angle(self.heading_rad + way.turn_radps);
        let span_s = S::from_micro(span.as_micros());
        let per_second = |way: S| way.checked_div(span_s);
        let twist = || {
            Some(Twist {
                forward_mps: per_second(way.forward_mps)?,
                left_mps: per_second(way.left_mps)?,
                turn_radps: per_second(way.turn_radps)?,
            })
        };
        self.twist = twist().unwrap_or(self.twist);
    }

    /// Replaces position and heading by better ones.
    pub fn correct(&mut self, position: Position, heading_rad: S) {
        self.position = position;
        self.rest_m = Vec2::ZERO;
        if heading_rad.is_finite() {
            self.heading_rad = wrap_angle(heading_rad);
        }
    }

    /// Position and velocity of the robot's middle in the world.
    #[must_use]
    pub fn state(&self) -> KinematicState<S> {
        let (sin, cos) = self.heading_rad.sin_cos();
        let velocity = Vec2::new(self.twist.forward_mps, self.twist.left_mps).rotate(cos, sin);
        KinematicState { position: self.position, velocity_mps: velocity.extend(S::ZERO) }
    }

    /// The heading, counter-clockwise from east, in (-pi, pi].
    #[must_use]
    pub const fn heading_rad(&self) -> S {
        self.heading_rad
    }

    /// The last motion, m/s and rad/s.
    #[must_use]
    pub const fn twist(&self) -> Twist<S> {
        self.twist
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{Differential, Kinematics};
    use proptest::prelude::*;
    use staya_controller::scalar::Q16;

    const SPAN: Duration = Duration::from_millis(50);

    fn way<S: Scalar>(forward: f64, turn: f64) -> Twist<S> {
        Twist { forward_mps: S::from_f64(forward).unwrap(), left_mps: S::ZERO, turn_radps: S::from_f64(turn).unwrap() }
    }

    #[test]
    fn counters_wrap_and_begin_anywhere() {
        let mut encoder = Encoder::new(0.05f64, 1000, false).unwrap();
        let tick = 0.1 * core::f64::consts::PI / 1000.0;
        assert_eq!(encoder.travelled(65_500), 0.0);
        assert!((encoder.travelled(100) - 136.0 * tick).abs() < 1e-12);
        assert!((encoder.travelled(65_530) + 106.0 * tick).abs() < 1e-12);
        assert_eq!(encoder.travelled(65_530), 0.0);
        let mut other = Encoder::new(0.05f64, 1000, true).unwrap();
        assert_eq!(other.travelled(0), 0.0);
        assert!((other.travelled(32_767) + 32_767.0 * tick).abs() < 1e-9);
        assert!(Encoder::new(0.0f32, 1000, false).is_none());
        assert!(Encoder::new(f32::NAN, 1000, false).is_none());
        assert!(Encoder::new(0.1f32, 0, false).is_none());
    }

    #[test]
    fn fixed_point_ticks_do_not_drift() {
        // A tick of 0.03 mm is two of the least numbers: single ticks would be imprecise.
        let mut encoder = Encoder::new(Q16::from_ratio(3, 100), 6000, false).unwrap();
        let mut sum = Encoder::travelled(&mut encoder, 0);
        let mut count = 0u16;
        for _ in 0..60_000 {
            count = count.wrapping_add(1);
            sum += encoder.travelled(count);
        }
        let exact = 10.0 * core::f64::consts::TAU * 0.03;
        assert!((sum.to_f64() - exact).abs() < 1e-3, "{sum:?} {exact}");
    }

    #[test]
    fn a_circle_closes() {
        fn check<S: Scalar>(tolerance_mm: i32) {
            let mut odometry = Odometry::new(Position::from_mm([5, 6, 7]), S::ONE).unwrap();
            let step = way(0.01, core::f64::consts::TAU / 400.0);
            for _ in 0..400 {
                odometry.advance(&step, SPAN);
            }
            let [x, y, z] = odometry.state().position.mm;
            assert!((x - 5).abs() <= tolerance_mm && (y - 6).abs() <= tolerance_mm && z == 7, "{x} {y}");
            assert!((odometry.heading_rad().to_f64() - 1.0).abs() < 0.01);
        }
        check::<f64>(1);
        check::<f32>(1);
        check::<Q16>(6);
    }

    #[test]
    fn steps_below_a_millimetre_add_up() {
        let mut odometry = Odometry::new(Position::ORIGIN, 0.0f32).unwrap();
        for _ in 0..1000 {
            odometry.advance(&way(0.0001, 0.0), SPAN);
        }
        assert_eq!(odometry.state().position.mm, [100, 0, 0]);
        let velocity = odometry.state().velocity_mps;
        assert!((velocity.x - 0.002).abs() < 1e-6 && velocity.y == 0.0);
    }

    #[test]
    fn a_motion_that_is_not_a_number_is_ignored() {
        let mut odometry = Odometry::new(Position::ORIGIN, 0.5f32).unwrap();
        odometry.advance(&way(0.1, 0.1), SPAN);
        let before = odometry;
        for bad in [f32::NAN, f32::INFINITY] {
            let mut bad_way = way(0.1, 0.1);
            bad_way.forward_mps = bad;
            odometry.advance(&bad_way, SPAN);
            bad_way = way(0.1, 0.1);
            bad_way.turn_radps = bad;
            odometry.advance(&bad_way, SPAN);
            odometry.correct(before.position, bad);
        }
        assert_eq!(odometry.state().position, before.state().position);
        assert_eq!(odometry.heading_rad(), before.heading_rad());
        odometry.advance(&way(0.0, 0.0), Duration::ZERO);
        assert_eq!(odometry.twist(), before.twist(), "no time, no news of the speed");
        assert!(Odometry::new(Position::ORIGIN, f32::NAN).is_none());
    }

    #[test]
    fn a_fix_replaces_the_computed_position() {
        let mut odometry = Odometry::new(Position::ORIGIN, 0.0f32).unwrap();
        odometry.advance(&way(0.0004, 0.3), SPAN);
        odometry.correct(Position::from_mm([9, 9, 9]), 7.0);
        assert_eq!(odometry.state().position.mm, [9, 9, 9]);
        assert!((odometry.heading_rad() - (7.0 - core::f32::consts::TAU)).abs() < 1e-6);
        odometry.advance(&way(0.0, 0.0), SPAN);
        assert_eq!(odometry.state().position.mm, [9, 9, 9]);
    }

    proptest! {
        #[test]
        fn driving_there_and_back_returns_to_the_start(ways in proptest::collection::vec((-0.05f64..0.05, -0.4f64..0.4), 1..60)) {
            let two = Differential::new(0.2).unwrap();
            let mut odometry = Odometry::new(Position::ORIGIN, 0.3).unwrap();
            let there = ways.iter().map(|(f, t)| way::<f64>(*f, *t));
            let back = ways.iter().rev().map(|(f, t)| way::<f64>(-f, -t));
            for step in there.chain(back) {
                odometry.advance(&two.twist(&two.wheels(&step)), SPAN);
            }
            prop_assert!(odometry.state().position.mm.iter().all(|mm| mm.abs() <= 1));
            prop_assert!((odometry.heading_rad() - 0.3).abs() < 1e-9);
        }
    }
}
