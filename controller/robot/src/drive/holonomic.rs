use super::twist::{Kinematics, Twist};
use staya_controller::scalar::Scalar;

/// Three or four omni wheels at equal angles on a circle, each rolling along it, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Omni<S, const W: usize> {
    /// Cosine and sine of each wheel's angle.
    places: [(S, S); W],
    radius_m: S,
    per_radius: S,
}

impl<S: Scalar, const W: usize> Omni<S, W> {
    const ENOUGH: () = assert!(W >= 3 && W <= 16, "fewer wheels cannot go any way");

    /// The first wheel is at `first_rad` from the nose (counter-clockwise), all are `radius_m` from
    /// the centre. `None` unless the radius is more than 0 and both are finite.
    #[must_use]
    pub fn new(first_rad: S, radius_m: S) -> Option<Self> {
        let () = Self::ENOUGH;
        let per_radius = S::ONE.checked_div(radius_m)?;
        if !(first_rad.is_finite() && radius_m.is_finite() && radius_m > S::ZERO) {
            return None;
        }
        let turn = S::PI + S::PI;
        let places = core::array::from_fn(|wheel| {
            let part = S::from_ratio(wheel as i32, W as i32);
            let (sin, cos) = (first_rad + part * turn).sin_cos();
            (cos, sin)
        });
        Some(Self { places, radius_m, per_radius })
    }
}

impl<S: Scalar, const W: usize> Kinematics<S, W> for Omni<S, W> {
    fn wheels(&self, twist: &Twist<S>) -> [S; W] {
        let turn = twist.turn_radps * self.radius_m;
        self.places.map(|(cos, sin)| twist.left_mps * cos - twist.forward_mps * sin + turn)
    }

    fn twist(&self, rims_mps: &[S; W]) -> Twist<S> {
        let mut sum = Twist::<S>::default();
        for ((cos, sin), rim) in self.places.iter().zip(rims_mps) {
            sum.forward_mps += -*sin * *rim;
            sum.left_mps += *cos * *rim;
            sum.turn_radps += *rim;
        }
        // The squares of the sines add up to W/2, as do those of the cosines.
        Twist {
            forward_mps: sum.forward_mps * S::from_ratio(2, W as i32),
            left_mps: sum.left_mps * S::from_ratio(2, W as i32),
            turn_radps: sum.turn_radps * S::from_ratio(1, W as i32) * self.per_radius,
        }
    }
}

/// Four mecanum wheels: front left, front right, rear left, rear right; the rollers form an X.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Mecanum<S> {
    /// Half the wheel base plus half the track.
    arm_m: S,
    per_arm: S,
}

impl<S: Scalar> Mecanum<S> {
    /// `wheel_base_m` is between the axles, `track_m` between left and right wheels; `None` unless
    /// their sum is more than 0 and finite.
    #[must_use]
    pub fn new(wheel_base_m: S, track_m: S) -> Option<Self> {
        let arm_m = (wheel_base_m + track_m) * S::HALF;
        let per_arm = S::ONE.checked_div(arm_m)?;
        (arm_m > S::ZERO && arm_m.is_finite()).then_some(Self { arm_m, per_arm })
    }
}

impl<S: Scalar> Kinematics<S, 4> for Mecanum<S> {
    fn wheels(&self, twist: &Twist<S>) -> [S; 4] {
        let (x, y) = (twist.forward_mps, twist.left_mps);
        let turn = twist.turn_radps * self.arm_m;
        [x - y - turn, x + y + turn, x + y - turn, x - y + turn]
    }

    fn twist(&self, &[fl, fr, rl, rr]: &[S; 4]) -> Twist<S> {
        let quarter = S::HALF * S::HALF;
        Twist {
            forward_mps: (fl + fr + rl + rr) * quarter,
            left_mps: (fr + rl - fl - rr) * quarter,
            turn_radps: (fr + rr - fl - rl) * quarter * self.per_arm,
        }
    }
}
