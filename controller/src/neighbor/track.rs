use super::sighting::{Sighting, TrackParams};
use crate::geom::{Position, Vec3};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Smallest variance of a position, 10^-6 m^2: (4 mm)^2, as positions are whole millimetres.
const LEAST_VARIANCE: i32 = 16;

/// Kalman filter for the position and velocity of one neighbour, from detections and beacons.
///
/// Constant velocity with white noise of the acceleration (Y. Bar-Shalom, X. R. Li, T. Kirubarajan,
/// "Estimation with Applications to Tracking and Navigation", 2001, section 6.3.2: the discrete
/// model), with one 2 x 2 covariance for all axes. A late measurement is first extrapolated to the
/// time of the track, together with its error. 80 bytes (`f32`); constant work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track<S> {
    /// Id, or a number that only the own robot knows ([`RobotId::is_local`]).
    pub id: RobotId,
    /// Time of the estimate.
    pub at: Instant,
    /// World position.
    pub position: Position,
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
    /// The table entry that is already part of this estimate.
    pub(super) known: Option<(Instant, Position)>,
}

fn square<S: Scalar>(x: S) -> S {
    x * x
}

fn seconds<S: Scalar>(span: Duration) -> S {
    S::from_micro(span.as_micros())
}

impl<S: Scalar> Track<S> {
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

    pub(super) fn goes(&mut self, velocity_mps: Vec3<S>, deviation_mps: S) {
        (self.velocity_mps, self.velocity_variance) = (velocity_mps, variance(deviation_mps));
    }

    /// Returns the standard deviation of the position along each axis, metres.
    #[must_use]
    pub fn deviation_m(&self) -> S {
        self.position_variance.sqrt()
    }

    /// Offset at the time of the estimate, metres.
    pub(super) fn offset_m(&self, from: Position) -> Vec3<S> {
        self.position.since(from) + self.rest_m
    }

    /// An earlier time leaves the estimate unchanged.
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

    /// Updates the position at `at` and the velocity since then.
    pub(super) fn hear(&mut self, position: Position, velocity_mps: Vec3<S>, at: Instant, params: &TrackParams<S>) {
        *self = self.predicted(at, params);
        let late = seconds::<S>(self.at.since(at));
        let drift = square(late) * (square(params.heard_mps) + square(params.acceleration_mps2 * late * S::HALF));
        self.correct_position(position, velocity_mps * late, variance(params.heard_m) + drift);
        self.correct_velocity(velocity_mps, variance(params.heard_mps) + square(params.acceleration_mps2 * late));
        self.heard = Some(at);
    }

    /// The position is `way_m` away from `place`; the variance is in m^2.
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

    /// Distance between the estimate and a measured position of a body of `radius_m`, in standard
    /// deviations. `None` beyond the gate, unless the two bodies would overlap.
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

    fn off(&self, place: Position, deviation_m: S, at: Instant, params: &TrackParams<S>) -> Option<(S, S)> {
        let then = self.predicted(at, params);
        // The displacement since a late measurement is only as certain as the velocity.
        let late = seconds::<S>(then.at.since(at));
        let spread = then.position_variance + square(late) * then.velocity_variance + variance(deviation_m);
        let off_m = (then.offset_m(place) - then.velocity_mps * late).norm();
        Some((off_m, off_m.checked_div(spread.sqrt())?))
    }
}

fn variance<S: Scalar>(deviation: S) -> S {
    square(deviation).max(S::from_micro(LEAST_VARIANCE))
}
