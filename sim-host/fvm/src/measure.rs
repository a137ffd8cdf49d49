//! Measures the errors of models.

use crate::Function;
use serde::Serialize;
use staya_controller::geom::Vec2;
use staya_controller::orca::{HalfSpaces, MovingBall, Params, half_plane};
use staya_controller::rand::Rng;
use staya_stats::{mean, quantile};
use staya_voxel::{Local, Model};

/// Interpolation of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reading {
    /// The plane of the nearest node.
    Nearest,
    /// A blend of the surrounding planes.
    Blend,
}

impl Reading {
    /// Evaluates a model at a point; `None` outside of it.
    #[must_use]
    pub fn local<const V: usize>(self, model: &Model<'_, f32, V>, at: [f32; V]) -> Option<Local<f32, V>> {
        match self {
            Self::Nearest => model.nearest(at),
            Self::Blend => model.blend(at),
        }
    }
}

/// Statistics of errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Maximum.
    pub max: f64,
}

impl Errors {
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let max = values.iter().copied().fold(0.0, f64::max);
        Some(Self { mean: mean(values)?, p99: quantile(values, 0.99)?, max })
    }
}

/// Errors found by [`measure`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Errors of values, in the function's units.
    pub value: Errors,
    /// Lengths of the differences of gradients.
    pub gradient: Errors,
    /// Angles between gradients, degrees, except where the function is constant.
    pub angle_deg: Errors,
}

const PURPOSE: u32 = u32::from_be_bytes(*b"fvm\0");

/// Compares a model with its function at random points of its extent, a function of the seed.
/// `None` without points.
#[must_use]
pub fn measure<const V: usize>(
    function: &Function<V>,
    model: &Model<'_, f32, V>,
    reading: Reading,
    points: u32,
    seed: u64,
) -> Option<Measured> {
    let extent = model.extent().map(|ends| ends.map(f64::from));
    let apart = extent.map(|[low, high]| 1e-6 * (high - low));
    let (mut values, mut gradients, mut angles) = (Vec::new(), Vec::new(), Vec::new());
    for point in 0..points {
        let mut rng = Rng::keyed(seed, PURPOSE, point, 0);
        let at = extent.map(|[low, high]| {
            let share = f64::from(rng.next_u32()) / f64::from(u32::MAX);
            (low + (high - low) * (1e-5 + (1.0 - 2e-5) * share)) as f32
        });
        let found = reading.local(model, at)?;
        let at = at.map(f64::from);
        values.push((f64::from(found.value) - function.value(at)).abs());
        let (found, exact) = (found.gradient.map(f64::from), function.gradient(at, apart));
        let dot = |a: &[f64; V], b: &[f64; V]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let difference = std::array::from_fn(|axis| found[axis] - exact[axis]);
        gradients.push(libm::sqrt(dot(&difference, &difference)));
        let lengths = libm::sqrt(dot(&found, &found) * dot(&exact, &exact));
        if lengths > 0.0 {
            angles.push(libm::acos((dot(&found, &exact) / lengths).clamp(-1.0, 1.0)).to_degrees());
        }
    }
    Some(Measured { value: Errors::of(&values)?, gradient: Errors::of(&gradients)?, angle_deg: Errors::of(&angles)? })
}

/// Errors of half-planes of neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HalfPlaneErrors {
    /// Angles between normals, degrees.
    pub angle_deg: Errors,
    /// Differences of the required changes of velocity, in (R_A + R_B) / tau.
    pub change: Errors,
}

/// Compares half-planes of `source` with the formula on random pairs of robots: radii 0.1 to 0.5 m,
/// up to 5 m apart, velocities up to 1.5 m/s along each axis, horizon 2 s. `None` without pairs.
#[must_use]
pub fn half_planes<P: HalfSpaces<f32, Velocity = Vec2<f32>>>(
    source: &P,
    pairs: u32,
    seed: u64,
) -> Option<HalfPlaneErrors> {
    const HORIZON_S: f64 = 2.0;
    let (mut angles, mut changes) = (Vec::new(), Vec::new());
    for pair in 0..pairs {
        let mut rng = Rng::keyed(seed, PURPOSE, pair, 1);
        let mut number = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let radii_m = number(0.2, 1.0);
        let (distance, angle) = (number(radii_m + 1e-3, 5.0), number(-180.0, 180.0));
        let (sin, cos) = libm::sincos(angle.to_radians());
        let mut vector = || Vec2::new(number(-1.5, 1.5) as f32, number(-1.5, 1.5) as f32);
        let (own, velocity_mps) = (vector(), vector());
        let offset_m = Vec2::new((cos * distance) as f32, (sin * distance) as f32);
        let ball = MovingBall { offset_m, velocity_mps, radii_m: radii_m as f32, tie: Vec2::ZERO };
        let params = Params { horizon_s: HORIZON_S as f32, separation_s: 0.05, share: 1.0 };
        let found = source.half_space(own, &ball, &params)?;
        let wide = |v: Vec2<f32>| Vec2::new(f64::from(v.x), f64::from(v.y));
        let exact_ball = MovingBall {
            offset_m: wide(offset_m),
            velocity_mps: wide(velocity_mps),
            radii_m: f64::from(ball.radii_m),
            tie: Vec2::ZERO,
        };
        let params = Params { horizon_s: HORIZON_S, separation_s: 0.05, share: 1.0 };
        let exact = half_plane(wide(own), &exact_ball, &params)?;
        let normal = wide(found.normal);
        angles.push(libm::atan2(exact.normal.det(normal), exact.normal.dot(normal)).to_degrees().abs());
        let change = (wide(found.point) - wide(own)).dot(normal);
        changes.push((change - exact.penetration(wide(own))).abs() * HORIZON_S / radii_m);
    }
    Some(HalfPlaneErrors { angle_deg: Errors::of(&angles)?, change: Errors::of(&changes)? })
}
