//! One neighbour that is seen: a Kalman filter.

use super::sighting::{Sighting, TrackParams};
use crate::geom::{Position, Vec3};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Least variance of a measured place, micrometres squared times a million: (4 mm)^2. Places are whole millimetres, and
/// fixed point has no smaller square.
const LEAST_VARIANCE: i32 = 16;

/// Where a neighbour is and how it goes, by all that was seen and heard of it.
///
/// A Kalman filter for a velocity that is constant but for white noise of the acceleration (Y. Bar-Shalom, X. R. Li,
/// T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section 6.3.2: the discrete model). Errors are alike
/// along all axes, so that one covariance of 2 x 2 serves all of them. A measurement that is older than the last one is
/// brought up to that one's time first, and its error with it.
///
/// 80 bytes (`f32`); constant work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track<S> {
    /// Who it is, or a number that only the robot itself knows ([`RobotId::is_local`]).
    pub id: RobotId,
    /// When it was as below.
    pub at: Instant,
    /// World position.
    pub position: Position,
    /// What of the position is less than a millimetre, metres.
    rest_m: Vec3<S>,
    /// World velocity, m/s.
    pub velocity_mps: Vec3<S>,
    /// Variance of the position along each axis, m^2.
    pub position_variance: S,
    /// Covariance of position and velocity, m^2/s.
    covariance: S,
    /// Variance of the velocity along each axis, m^2/s^2.
    pub velocity_variance: S,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// When it was seen last, if lately.
    pub(super) seen: Option<Instant>,
    /// When it was heard last, if ever.
    pub(super) heard: Option<Instant>,
    /// What the table says that is no news here.
    pub(super) known: Option<(Instant, Position)>,
}

fn square<S: Scalar>(x: S) -> S {
    x * x
}

fn seconds<S: Scalar>(span: Duration) -> S {
    S::from_micro(span.as_micros())
}

impl<S: Scalar> Track<S> {
    /// Somebody at a place, who goes as he likes.
    pub(super) fn new(id: RobotId, at: Instant, position: Position, deviation_m: S, params: &TrackParams<S>) -> Self {
        Self {
            id,
            at,
            position,
            rest_m: Vec3::ZERO,
            velocity_mps: Vec3::ZERO,
            position_variance: variance(deviation_m),
            covariance: S::ZERO,
            velocity_variance: square(params.speed_mps),
            radius_m: S::ZERO,
            seen: None,
            heard: None,
            known: None,
        }
    }

    /// The velocity of one that is new, and its standard deviation, m/s.
    pub(super) fn goes(&mut self, velocity_mps: Vec3<S>, deviation_mps: S) {
        (self.velocity_mps, self.velocity_variance) = (velocity_mps, variance(deviation_mps));
    }

    /// The standard deviation of the position along each axis, metres.
    #[must_use]
    pub fn deviation_m(&self) -> S {
        self.position_variance.sqrt()
    }

    /// Where it is from `from` on at its time, metres.
    pub(super) fn offset_m(&self, from: Position) -> Vec3<S> {
        self.position.since(from) + self.rest_m
    }

    /// The same at a later time; at an earlier one as it is.
    #[must_use]
    pub(super) fn predicted(mut self, to: Instant, params: &TrackParams<S>) -> Self {
        let span = to.since(self.at);
        if span <= Duration::ZERO {
            return self;
        }
        let dt = seconds::<S>(span);
        let noise = square(params.acceleration_mps2);
        self.go(self.velocity_mps * dt);
        self.position_variance +=
            dt * (self.covariance * S::TWO + dt * self.velocity_variance) + noise * square(square(dt) * S::HALF);
        self.covariance += dt * self.velocity_variance + noise * square(dt) * dt * S::HALF;
        self.velocity_variance += noise * square(dt);
        self.at = to;
        self
    }

    fn go(&mut self, way_m: Vec3<S>) {
        let way_m = self.rest_m + way_m;
        if let Some(position) = self.position.moved(way_m) {
            self.rest_m = way_m - position.since(self.position);
            self.position = position;
        }
    }

    /// Takes in where it was seen, at `place`, at `at`.
    pub(super) fn see(&mut self, sighting: &Sighting<S>, place: Position, at: Instant, params: &TrackParams<S>) {
        let off = self.off(place, sighting.deviation_m, at, params);
        *self = self.predicted(at, params);
        if let Some((off_m, surprise)) = off
            && surprise > params.gate
        {
            // It has turned as nobody expected: little of what was known of it holds.
            self.position_variance += square(off_m);
            (self.covariance, self.velocity_variance) = (S::ZERO, self.velocity_variance.max(square(params.speed_mps)));
        }
        let late = seconds::<S>(self.at.since(at));
        let drift = square(late) * (self.velocity_variance + square(params.acceleration_mps2 * late * S::HALF));
        self.correct_position(place, self.velocity_mps * late, variance(sighting.deviation_m) + drift);
        if let Some((velocity_mps, deviation_mps)) = sighting.velocity_mps {
            let drift = square(params.acceleration_mps2 * late);
            self.correct_velocity(velocity_mps, variance(deviation_mps) + drift);
        }
        self.radius_m = sighting.radius_m;
        self.seen = Some(self.seen.filter(|seen| at.is_before(*seen)).unwrap_or(at));
    }

    /// Takes in what it has said: where it was at `at`, and how it went on from there.
    pub(super) fn hear(&mut self, position: Position, velocity_mps: Vec3<S>, at: Instant, params: &TrackParams<S>) {
        *self = self.predicted(at, params);
        let late = seconds::<S>(self.at.since(at));
        let drift = square(late) * (square(params.heard_mps) + square(params.acceleration_mps2 * late * S::HALF));
        self.correct_position(position, velocity_mps * late, variance(params.heard_m) + drift);
        self.correct_velocity(velocity_mps, variance(params.heard_mps) + square(params.acceleration_mps2 * late));
        self.heard = Some(at);
    }

    /// A measured place, `way_m` from `place`, of a variance in m^2: weighted by the inverse variances, its own and that
    /// of what is known.
    fn correct_position(&mut self, place: Position, way_m: Vec3<S>, variance: S) {
        let known = self.position_variance;
        let gain = |of: S| of.checked_div(known + variance);
        let (Some(gain_m), Some(gain_mps), Some(left)) = (gain(known), gain(self.covariance), gain(variance)) else {
            return;
        };
        let surprise = place.since(self.position) + way_m - self.rest_m;
        self.velocity_mps += surprise * gain_mps;
        self.go(surprise * gain_m);
        self.velocity_variance = (self.velocity_variance - gain_mps * self.covariance).max(S::ZERO);
        self.covariance *= left;
        self.position_variance = known * left;
    }

    /// A measured velocity of a variance in m^2/s^2.
    fn correct_velocity(&mut self, velocity_mps: Vec3<S>, variance: S) {
        let known = self.velocity_variance;
        let gain = |of: S| of.checked_div(known + variance);
        let (Some(gain_m), Some(gain_mps), Some(left)) = (gain(self.covariance), gain(known), gain(variance)) else {
            return;
        };
        let surprise = velocity_mps - self.velocity_mps;
        self.go(surprise * gain_m);
        self.velocity_mps += surprise * gain_mps;
        self.position_variance = (self.position_variance - gain_m * self.covariance).max(S::ZERO);
        self.covariance *= left;
        self.velocity_variance = known * left;
    }

    /// How well a measured place of a body of `radius_m` goes with it: the distance in standard deviations. `None`: it is
    /// beyond the gate, and so far off that both have room beside each other.
    pub(super) fn fit(
        &self,
        place: Position,
        deviation_m: S,
        radius_m: S,
        at: Instant,
        params: &TrackParams<S>,
    ) -> Option<S> {
        let (off_m, surprise) = self.off(place, deviation_m, at, params)?;
        (surprise <= params.gate || off_m < self.radius_m + radius_m).then_some(surprise)
    }

    /// How far from where it should be a measured place is, metres and in standard deviations; `None`: nobody can say.
    fn off(&self, place: Position, deviation_m: S, at: Instant, params: &TrackParams<S>) -> Option<(S, S)> {
        let then = self.predicted(at, params);
        // Of a late one the track's way since then is not known better than its velocity.
        let late = seconds::<S>(then.at.since(at));
        let spread = then.position_variance + square(late) * then.velocity_variance + variance(deviation_m);
        let off_m = (then.offset_m(place) - then.velocity_mps * late).norm();
        Some((off_m, off_m.checked_div(spread.sqrt())?))
    }
}

/// The square of a standard deviation, not less than [`LEAST_VARIANCE`].
fn variance<S: Scalar>(deviation: S) -> S {
    square(deviation).max(S::from_micro(LEAST_VARIANCE))
}
