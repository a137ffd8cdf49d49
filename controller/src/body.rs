//! The robot's own body, as guidance and collision avoidance use it.

use crate::geom::Vec3;
use crate::robot::RobotId;
use crate::scalar::Scalar;

/// The robot's own body at the current step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Body<S> {
    /// Own id.
    pub id: RobotId,
    /// Own velocity in the world, m/s.
    pub velocity_mps: Vec3<S>,
    /// Radius of the ball around the body, metres.
    pub radius_m: S,
    /// Highest speed at the current place, m/s.
    pub max_speed_mps: S,
    /// Largest acceleration, m/s^2; [`Scalar::MAX`] for a body without inertia.
    pub max_acceleration_mps2: S,
    /// Time between two decisions, seconds; above 0.
    pub step_s: S,
}

impl<S: Scalar> Body<S> {
    /// Returns the velocity nearest to `wish_mps` that the body can have after one step, within its
    /// acceleration and speed limits, m/s. A NaN component of the wish counts as zero; a body above
    /// its speed limit (on entering rough terrain) slows down first.
    #[must_use]
    pub fn reach(&self, wish_mps: Vec3<S>) -> Vec3<S> {
        let wish = wish_mps.clamp_norm(self.max_speed_mps);
        let most = self.max_acceleration_mps2 * self.step_s;
        if !self.has_inertia() || !most.is_finite() || !self.velocity_mps.is_finite() {
            return wish;
        }
        let change = wish - self.velocity_mps;
        if change.norm() <= most {
            return wish;
        }
        self.velocity_mps + change.clamp_norm(most)
    }

    /// Returns twice the time that it takes to brake from the highest speed, at most a minute: it
    /// must see a conflict one braking time before the other robot has to brake, too, seconds.
    #[must_use]
    pub fn least_horizon_s(&self) -> S {
        let brake_s = self.max_speed_mps.checked_div(self.max_acceleration_mps2).unwrap_or(S::ZERO);
        if self.has_inertia() { (brake_s * S::TWO).min(S::from_i32(60)) } else { S::ZERO }
    }

    pub(crate) fn has_inertia(&self) -> bool {
        self.max_acceleration_mps2 < S::MAX
    }

    /// Returns the highest speed at which the body can move for one step and then brake to rest
    /// within `distance_m`, m/s. A body that keeps to it in each step brakes at its full
    /// acceleration and stops there, without overshoot.
    #[must_use]
    pub fn stopping_speed(&self, distance_m: S) -> S {
        let distance_m = distance_m.max(S::ZERO);
        let direct = distance_m.checked_div(self.step_s).unwrap_or(self.max_speed_mps);
        if !self.has_inertia() {
            return direct;
        }
        // The whole steps of braking that follow, from v^2 / 2 a + v step / 2 = distance.
        let half = self.max_acceleration_mps2 * self.step_s * S::HALF;
        let braking = (half * half + self.max_acceleration_mps2 * distance_m * S::TWO).sqrt() - half;
        let steps = braking.checked_div(half * S::TWO).and_then(Scalar::floor_to_i32);
        let steps = match steps {
            Some(steps @ 1..) => S::from_i32(steps),
            _ => return direct.min(braking),
        };
        // Solves (steps + 1) v step - steps (steps + 1) half step = distance.
        direct.checked_div(steps + S::ONE).map_or(braking, |mean| mean + steps * half)
    }

    /// Returns the way that it takes to brake from `speed_mps`, metres; 0 without inertia.
    #[must_use]
    pub fn braking_m(&self, speed_mps: S) -> S {
        let speed = speed_mps.max(S::ZERO);
        if speed == S::ZERO || !self.has_inertia() {
            return S::ZERO;
        }
        (speed * speed * S::HALF).checked_div(self.max_acceleration_mps2).unwrap_or(S::ZERO)
    }

    /// Returns the way that the body still covers if it brakes from now on, metres; zero without
    /// inertia.
    #[must_use]
    pub fn stopping_way(&self) -> Vec3<S> {
        let speed_mps = self.velocity_mps.norm();
        let time_s = (speed_mps * S::HALF).checked_div(self.max_acceleration_mps2);
        match time_s {
            Some(time_s) if self.has_inertia() && self.velocity_mps.is_finite() => self.velocity_mps * time_s,
            _ => Vec3::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Q16;
    use proptest::prelude::*;

    fn body(velocity: [f32; 2], speed: f32, acceleration: f32) -> Body<f32> {
        Body {
            id: RobotId(1),
            velocity_mps: Vec3::new(velocity[0], velocity[1], 0.0),
            radius_m: 0.1,
            max_speed_mps: speed,
            max_acceleration_mps2: acceleration,
            step_s: 0.5,
        }
    }

    #[test]
    fn a_body_without_inertia_takes_any_velocity_within_its_speed() {
        let body = body([1.0, 0.0], 2.0, f32::MAX);
        let wish = Vec3::new(-1.0, 0.5, 0.0);
        assert_eq!(body.reach(wish), wish);
        assert!((body.reach(wish * 1e3).norm() - 2.0).abs() < 1e-6);
        assert_eq!(body.reach(Vec3::new(f32::NAN, 0.0, 0.0)), Vec3::ZERO);
        let fixed = Body::<Q16> {
            id: RobotId(1),
            velocity_mps: Vec3::ZERO,
            radius_m: Q16::ONE,
            max_speed_mps: Q16::ONE,
            max_acceleration_mps2: Q16::MAX,
            step_s: Q16::TWO,
        };
        let east = Vec3::new(Q16::ONE, Q16::ZERO, Q16::ZERO);
        assert_eq!(fixed.reach(east), east);
    }

    #[test]
    fn a_body_with_inertia_changes_velocity_in_steps() {
        let body = body([1.0, 0.0], 2.0, 1.0);
        assert_eq!(body.reach(Vec3::new(-2.0, 0.0, 0.0)).x, 0.5);
        assert_eq!(body.reach(Vec3::new(1.25, 0.0, 0.0)).x, 1.25);
        assert_eq!(Body { max_speed_mps: 0.25, ..body }.reach(Vec3::ZERO).x, 0.5);
    }

    proptest! {
        /// One-dimensional drives to a goal: the overshoot, and the time over that of a trapezoid
        /// of speed.
        #[test]
        fn a_body_stops_at_its_goal_in_the_least_time(
            speed in 0.2f64..15.0, most in 0.2f64..10.0, way in 0.05f64..200.0, step_ms in 5u16..300,
        ) {
            let step_s = f64::from(step_ms) / 1000.0;
            let mut body = Body::<f64> {
                id: RobotId(1), velocity_mps: Vec3::ZERO, radius_m: 0.1, max_speed_mps: speed,
                max_acceleration_mps2: most, step_s,
            };
            let (mut at, mut steps, mut farthest) = (0.0, 0, 0.0_f64);
            while (way - at).abs() > 1e-4 * way || body.velocity_mps.x.abs() > 1e-3 * speed {
                let wish = body.stopping_speed((way - at).abs()).min(speed) * (way - at).signum();
                body.velocity_mps = body.reach(Vec3::new(wish, 0.0, 0.0));
                at += body.velocity_mps.x * step_s;
                farthest = farthest.max(at);
                steps += 1;
                prop_assert!(steps < 1_000_000);
            }
            let full = speed * speed / most;
            let trapezoid = if way > full { way / speed + speed / most } else { 2.0 * (way / most).sqrt() };
            prop_assert!(farthest - way <= 1e-9 * way, "overshoot {}", farthest - way);
            let time = f64::from(steps) * step_s;
            prop_assert!(time <= trapezoid * 1.02 + 3.0 * step_s, "{time} s, trapezoid {trapezoid} s");
        }

        #[test]
        fn the_change_of_velocity_is_bounded_and_finite(v in any::<[i8; 2]>(), wish: [u32; 2], most in 0.1f32..9.0) {
            let v = v.map(f32::from);
            let wish = wish.map(f32::from_bits);
            let body = body(v, 3.0, most);
            let got = body.reach(Vec3::new(wish[0], wish[1], 0.0));
            prop_assert!((got - body.velocity_mps).norm() <= most * 0.5 * 1.001 && got.is_finite());
        }
    }
}
