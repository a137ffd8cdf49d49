//! How far a model is off the function that it was made of.

use crate::Function;
use serde::Serialize;
use staya_controller::rand::Rng;
use staya_stats::{mean, quantile};
use staya_voxel::{Local, Model};

/// How a model is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reading {
    /// The plane of the nearest node.
    Nearest,
    /// The planes around, blended.
    Blend,
}

impl Reading {
    /// What the model says in a point.
    #[must_use]
    pub fn local<const V: usize>(self, model: &Model<'_, f32, V>, at: [f32; V]) -> Option<Local<f32, V>> {
        match self {
            Self::Nearest => model.nearest(at),
            Self::Blend => model.blend(at),
        }
    }
}

/// Errors of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Over all points.
    pub mean: f64,
    /// What 99 of 100 points do not exceed.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
}

impl Errors {
    fn of(values: &[f64]) -> Option<Self> {
        let max = values.iter().copied().fold(0.0, f64::max);
        Some(Self { mean: mean(values)?, p99: quantile(values, 0.99)?, max })
    }
}

/// What [`measure`] found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Of values, in the function's units.
    pub value: Errors,
    /// Lengths of the differences of gradients.
    pub gradient: Errors,
    /// Angles between gradients, degrees, where the function is not level.
    pub angle_deg: Errors,
}

const PURPOSE: u32 = u32::from_be_bytes(*b"fvm\0");

/// Compares in so many points of the model's extent, at random but the same for equal seeds. `None` without points.
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
            // As the model gets it: a number of single precision.
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
