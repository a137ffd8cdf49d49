use super::twist::{Kinematics, Twist};
use staya_controller::agent::KinematicState;
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::scalar::Scalar;

/// Two wheels on one axle: left, right.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Differential<S> {
    half_track_m: S,
    per_track: S,
}

impl<S: Scalar> Differential<S> {
    /// `track_m`: distance between the wheels' contact points; `None` unless above 0 and finite.
    #[must_use]
    pub fn new(track_m: S) -> Option<Self> {
        let per_track = S::ONE.checked_div(track_m)?;
        (track_m > S::ZERO && track_m.is_finite()).then_some(Self { half_track_m: track_m * S::HALF, per_track })
    }
}

impl<S: Scalar> Kinematics<S, 2> for Differential<S> {
    fn wheels(&self, twist: &Twist<S>) -> [S; 2] {
        let turn = twist.turn_radps * self.half_track_m;
        [twist.forward_mps - turn, twist.forward_mps + turn]
    }

    fn twist(&self, &[left, right]: &[S; 2]) -> Twist<S> {
        Twist { forward_mps: (left + right) * S::HALF, left_mps: S::ZERO, turn_radps: (right - left) * self.per_track }
    }
}

/// Lets a robot that rolls ahead and turns follow any velocity: controls a point ahead of its axle.
///
/// A point at distance D ahead of the axle's middle moves with v ahead and with D w to the side, so
/// any velocity of the point corresponds to a pair (v, w): the usual feedback linearisation (J.
/// Snape, J. van den Berg, S. Guy, D. Manocha 2010, "Smooth and collision-free navigation for
/// multiple robots under differential-drive constraints"). Therefore:
///
/// - Give the controller the state of that point ([`Self::state`]) and goals for it.
/// - The radius in [`AgentConfig`](staya_controller::agent::AgentConfig) is [`Self::radius`].
/// - The top speed is that of the wheels in the worst direction: [`Self::max_speed`].
///
/// D trades space for speed. Half the track leaves 71 % of the wheels' speed. With a small D the
/// robot turns on the spot at the slightest change, and its top speed approaches zero. A robot sent
/// straight back drives in reverse until any disturbance, and then swings round.
///
/// The radius still needs a margin for latency and acceleration. With acceleration a of the point
/// and a command delay t, allow for speed * t + speed^2 / (2 a) in directions that change at once.
/// With a as its `max_acceleration_mps2`, the controller accounts for the second term.
///
/// The alternative, NH-ORCA (J. Alonso-Mora, A. Breitenmoser, M. Rufli, P. Beardsley, R. Siegwart
/// 2010), keeps the centre but must forbid velocities with a larger tracking error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LookAhead<S> {
    ahead_m: S,
    per_ahead: S,
}

impl<S: Scalar> LookAhead<S> {
    /// Places the point `ahead_m` ahead of the axle; `None` unless more than 0 and finite.
    #[must_use]
    pub fn new(ahead_m: S) -> Option<Self> {
        let per_ahead = S::ONE.checked_div(ahead_m)?;
        (ahead_m > S::ZERO && ahead_m.is_finite()).then_some(Self { ahead_m, per_ahead })
    }

    /// The motion that moves the point with `velocity_mps` in the world, at `heading_rad`
    /// (counter-clockwise from east).
    #[must_use]
    pub fn twist(&self, velocity_mps: Vec2<S>, heading_rad: S) -> Twist<S> {
        let wish = Twist::holonomic(velocity_mps, heading_rad, S::ZERO);
        Twist { forward_mps: wish.forward_mps, left_mps: S::ZERO, turn_radps: wish.left_mps * self.per_ahead }
    }

    /// The state of the point, for the controller, from the axle's state and its turn rate
    /// `turn_radps`. A position that is not a number remains the axle's.
    #[must_use]
    pub fn state(&self, axle: &KinematicState<S>, heading_rad: S, turn_radps: S) -> KinematicState<S> {
        let (sin, cos) = heading_rad.sin_cos();
        let way = Vec2::new(cos, sin) * self.ahead_m;
        let swing = way.perp() * turn_radps;
        KinematicState {
            position: axle.position.moved(way.extend(S::ZERO)).unwrap_or(axle.position),
            velocity_mps: axle.velocity_mps + Vec3::new(swing.x, swing.y, S::ZERO),
        }
    }

    /// Radius of the disc around the point that holds the body at any heading, metres;
    /// `body_radius_m` is around the axle's middle.
    #[must_use]
    pub fn radius(&self, body_radius_m: S) -> S {
        body_radius_m + self.ahead_m
    }

    /// The speed of the point in any direction if the wheels can have `wheel_mps` at `track_m`,
    /// m/s. The ratio also applies to accelerations.
    ///
    /// At angle t to the nose the faster wheel moves at u (cos t + k sin t), k = track / (2 D).
    #[must_use]
    pub fn max_speed(&self, wheel_mps: S, track_m: S) -> S {
        let k = track_m * S::HALF * self.per_ahead;
        let factor = S::norm([S::ONE, k, S::ZERO]);
        wheel_mps.checked_div(factor).unwrap_or(S::ZERO)
    }
}
