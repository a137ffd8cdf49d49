//! The track of one neighbour that sensors detect: a Kalman filter.

use super::sighting::{Sighting, TrackParams};
use crate::geom::{Position, Vec3};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Smallest variance of a measured position, 10^-6 m^2: (4 mm)^2. Positions are whole millimetres,
/// and fixed point has no smaller square.
const LEAST_VARIANCE: i32 = 16;

/// Estimate of the position and velocity of one neighbour, from detections and beacons.
///
/// A Kalman filter for constant velocity with white noise of the acceleration (Y. Bar-Shalom, X. R.
/// Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section
/// 6.3.2: the discrete model). Errors are equal along all axes, so one 2 x 2 covariance serves all
/// axes. A measurement older than the last one is first extrapolated to the time of the track,
/// together with its error.
///
/// 80 bytes (`f32`); constant work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track<S> {
    /// Id, or a number that only the own robot knows ([`RobotId::is_local`]).
    pub id: RobotId,
    /// Time of the estimate.
    pub at: Instant,
    /// World position.
    pub position: Position,
    /// The part of the position below a millimetre, metres.
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
    pub(super) seen: Option<Instant>,
    pub(super) heard: Option<Instant>,
    /// The entry of the neighbour table that is already part of this estimate.
    pub(super) known: Option<(Instant, Position)>,
}

fn square<S: Scalar>(x: S) -> S {
    x * x
}

fn seconds<S: Scalar>(span: Duration) -> S {
    S::from_micro(span.as_micros())
}

impl<S: Scalar> Track<S> {
    /// Starts a track at a position, with an unknown velocity.
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

    /// Sets the velocity of a new track and its standard deviation, m/s.
    pub(super) fn goes(&mut self, velocity_mps: Vec3<S>, deviation_mps: S) {
        (self.velocity_mps, self.velocity_variance) = (velocity_mps, variance(deviation_mps));
    }

    /// Returns the standard deviation of the position along each axis, metres.
    #[must_use]
    pub fn deviation_m(&self) -> S {
        self.position_variance.sqrt()
    }

    /// Its offset from `from` at the time of the estimate, metres.
    pub(super) fn offset_m(&self, from: Position) -> Vec3<S> {
        self.position.since(from) + self.rest_m
    }

    /// Returns the estimate at a later time; unchanged for an earlier time.
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

    /// Updates the estimate with a detection at `place` at time `at`.
    pub(super) fn see(&mut self, sighting: &Sighting<S>, place: Position, at: Instant, params: &TrackParams<S>) {
        let off = self.off(place, sighting.deviation_m, at, params);
        *self = self.predicted(at, params);
        if let Some((off_m, surprise)) = off
            && surprise > params.gate
        {
            // An unexpected turn: discard most of the previous estimate.
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

    /// Updates the estimate with a beacon: the position at `at`, and the velocity since then.
    pub(super) fn hear(&mut self, position: Position, velocity_mps: Vec3<S>, at: Instant, params: &TrackParams<S>) {
        *self = self.predicted(at, params);
        let late = seconds::<S>(self.at.since(at));
        let drift = square(late) * (square(params.heard_mps) + square(params.acceleration_mps2 * late * S::HALF));
        self.correct_position(position, velocity_mps * late, variance(params.heard_m) + drift);
        self.correct_velocity(velocity_mps, variance(params.heard_mps) + square(params.acceleration_mps2 * late));
        self.heard = Some(at);
    }

    /// Updates with a measured position, `way_m` away from `place`, of a variance in m^2. The
    /// measurement and the estimate are weighted by their inverse variances.
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

    /// Returns the distance, in standard deviations, between the estimate and a measured position
    /// of a body of `radius_m`. `None` if it is beyond the gate and the two bodies would not
    /// overlap.
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

    /// Distance between a measured position and the estimate, in metres and in standard deviations;
    /// `None` if it cannot be computed.
    fn off(&self, place: Position, deviation_m: S, at: Instant, params: &TrackParams<S>) -> Option<(S, S)> {
        let then = self.predicted(at, params);
        // The displacement since a late measurement is only as certain as the velocity.
        let late = seconds::<S>(then.at.since(at));
        let spread = then.position_variance + square(late) * then.velocity_variance + variance(deviation_m);
        let off_m = (then.offset_m(place) - then.velocity_mps * late).norm();
        Some((off_m, off_m.checked_div(spread.sqrt())?))
    }
}

/// The square of a standard deviation, at least [`LEAST_VARIANCE`].
fn variance<S: Scalar>(deviation: S) -> S {
    square(deviation).max(S::from_micro(LEAST_VARIANCE))
}
