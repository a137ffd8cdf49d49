//! Robots of ORCA's tests: radius 0.15 m, speed up to 0.5 m/s, 20 decisions per second.

use super::{HalfSpace, MovingBall, Params};
use crate::body::Body;
use crate::geom::{Vec3, Vector};
use crate::neighbor::Nearby;
use crate::rand::Rng;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;

pub const RADIUS_M: f64 = 0.15;
pub const SPEED_MPS: f64 = 0.5;
pub const STEP_S: f64 = 0.05;

pub fn scalar<S: Scalar>(value: f64) -> S {
    S::from_f64(value).unwrap()
}

pub fn params<S: Scalar>(horizon_s: f64, share: f64) -> Params<S> {
    Params { horizon_s: scalar(horizon_s), separation_s: scalar(STEP_S), share: scalar(share) }
}

/// A neighbour without a preferred direction if it is in the same place.
pub fn ball<V: Vector>(offset_m: V, velocity_mps: V, radii_m: V::Scalar) -> MovingBall<V> {
    MovingBall { offset_m, velocity_mps, radii_m, tie: V::ZERO }
}

/// Greatest penetration of any constraint; 0 if none is violated.
pub fn worst<V: Vector<Scalar = f64>>(constraints: &[HalfSpace<V>], at: V) -> f64 {
    let depths = constraints.iter().map(|one| one.penetration(at));
    depths.fold(0.0, f64::max)
}

pub fn body<S: Scalar, const D: usize>(id: u32, velocity_mps: [f64; D]) -> Body<S> {
    Body {
        id: RobotId(id),
        velocity_mps: vector(velocity_mps),
        radius_m: scalar(RADIUS_M),
        max_speed_mps: scalar(SPEED_MPS),
        max_acceleration_mps2: S::MAX,
        step_s: scalar(STEP_S),
    }
}

pub fn robot<S: Scalar, const D: usize>(id: u32, offset_m: [f64; D], velocity_mps: [f64; D]) -> Nearby<S> {
    Nearby {
        id: RobotId(id),
        offset_m: vector(offset_m),
        velocity_mps: vector(velocity_mps),
        radius_m: scalar(RADIUS_M),
        gives_way: true,
        mode: Mode::Cruise,
        is_stranger: false,
    }
}

/// Two components give a vector in the plane.
pub fn vector<S: Scalar, const D: usize>(components: [f64; D]) -> Vec3<S> {
    let at = |axis: usize| scalar(components.get(axis).copied().unwrap_or(0.0));
    Vec3::new(at(0), at(1), at(2))
}

pub fn rng_of(robot: u32, tick: u32) -> Rng {
    Rng::keyed(1, 5, robot, tick)
}

/// Checks the points of a line that a linear program finds nearest to an x, and farthest along the
/// line; each as its x and its distance from the line. `range`: the x that the constraints leave.
pub fn check_range(
    range: Option<[f64; 2]>,
    near: impl Fn(f64) -> Option<(f64, f64)>,
    along: impl Fn(f64) -> Option<(f64, f64)>,
    case: &dyn core::fmt::Debug,
) {
    let Some([low, high]) = range else {
        assert_eq!([near(0.0), along(1.0), along(-1.0)], [None; 3], "{case:?}");
        return;
    };
    let middle = (low + high) / 2.0;
    for (found, x) in
        [(near(-5.0), low), (near(middle), middle), (near(5.0), high), (along(-1.0), low), (along(1.0), high)]
    {
        assert!(found.is_some_and(|(at, off)| (at - x).abs() < 1e-12 && off == 0.0), "{found:?} {x} {case:?}");
    }
}
