use super::twist::{Kinematics, Twist};
use staya_controller::scalar::Scalar;
use staya_controller::time::Duration;

/// The capabilities of the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits<S> {
    /// Top rim speed, m/s: that of the slowest motor under load with an old battery.
    pub speed_mps: S,
    /// How fast a rim may change its speed, m/s^2; [`Scalar::MAX`]: at once.
    pub acceleration_mps2: S,
}

/// Keeps rim speeds within limits without distorting the motion.
///
/// - Too fast: all wheels slow down by one factor, which keeps the direction or the curve.
/// - Too sudden: all wheels make the same fraction of their change, the largest possible.
/// - A motion that is not finite counts as a stop, which respects the acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer<S, K, const W: usize> {
    kinematics: K,
    limits: Limits<S>,
    rims_mps: [S; W],
}

impl<S: Scalar, K: Kinematics<S, W>, const W: usize> Mixer<S, K, W> {
    /// Starts with a stationary robot; `None` unless both limits are above 0 and the speed finite.
    #[must_use]
    pub fn new(kinematics: K, limits: Limits<S>) -> Option<Self> {
        let Limits { speed_mps: speed, acceleration_mps2: acceleration } = limits;
        let sensible = speed > S::ZERO && speed.is_finite() && acceleration > S::ZERO;
        sensible.then_some(Self { kinematics, limits, rims_mps: [S::ZERO; W] })
    }

    /// The rim speeds for the next `span`, m/s. Call it as often as the motors are set; a span of 0
    /// or less changes nothing if acceleration is limited. O(W).
    #[must_use]
    pub fn mix(&mut self, twist: &Twist<S>, span: Duration) -> [S; W] {
        let wish = self.slowed(self.kinematics.wheels(twist));
        let span_s = S::from_micro(span.as_micros().max(0));
        let most = self.limits.acceleration_mps2 * span_s;
        let mut pairs = self.rims_mps.iter().zip(&wish);
        let change = pairs.try_fold(S::ZERO, |most, (now, wish)| finite_max(most, *wish - *now));
        let part = match change {
            Some(change) if change > most && self.limits.acceleration_mps2 < S::MAX => most.checked_div(change),
            _ => None,
        };
        for (now, wish) in self.rims_mps.iter_mut().zip(wish) {
            *now = match part {
                Some(part) => *now + (wish - *now) * part,
                None => wish,
            };
        }
        self.rims_mps
    }

    /// Sets all speeds to 0 at once, for emergencies, and when the motors were off.
    pub fn stop(&mut self) {
        self.rims_mps = [S::ZERO; W];
    }

    /// The robot's wheels.
    #[must_use]
    pub const fn kinematics(&self) -> &K {
        &self.kinematics
    }

    fn slowed(&self, rims_mps: [S; W]) -> [S; W] {
        let top = self.limits.speed_mps;
        let mut rims = rims_mps.iter();
        match rims.try_fold(S::ZERO, |most, rim| finite_max(most, *rim)) {
            Some(most) if most <= top => rims_mps,
            Some(most) => match top.checked_div(most) {
                Some(factor) => rims_mps.map(|rim| (rim * factor).clamp(-top, top)),
                None => [S::ZERO; W],
            },
            None => [S::ZERO; W],
        }
    }
}

fn finite_max<S: Scalar>(most: S, value: S) -> Option<S> {
    value.is_finite().then(|| most.max(value.abs()))
}
