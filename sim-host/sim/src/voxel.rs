//! Functional voxel models of velocity obstacles from files, which replace ORCA's formula (FVM).

use crate::file;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::orca::{self, HalfPlane, HalfSpace, HalfSpaces, InSpace, MovingBall, Params};
use staya_controller::rand::Rng;
use staya_voxel::{FileError, ModelIn, VoxelNeighborIn};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use thiserror::Error;

type Neighbor = VoxelNeighborIn<Arc<[u8]>, f32>;

/// The models in use, by checksum: the saved state of a robot names its model only.
static IN_USE: Mutex<BTreeMap<u32, Weak<Loaded>>> = Mutex::new(BTreeMap::new());

struct Loaded {
    bytes: Arc<[u8]>,
    neighbor: Neighbor,
}

/// A model of the half-planes of every pair of robots (`staya voxel build neighbor`), which all its
/// robots share.
#[derive(Clone)]
pub struct NeighborModel(Arc<Loaded>);

/// Why a file is not such a model.
#[derive(Debug, Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("{0}")]
    Read(#[from] std::io::Error),
    /// The file is not a model of three variables.
    #[error("{0}")]
    File(#[from] FileError),
    /// Some pairs of robots are outside.
    #[error("its function is not defined for every pair of robots")]
    Extent,
    /// Half-planes differ too much from those of the formula.
    #[error("its half-planes are {0:.0} degrees off on average, so it is of another function")]
    Function(f64),
}

/// The coarsest model, of 3 x 2 x 2 nodes of 4 bits, is off by 8 degrees on average.
const MOST_DEGREES: f64 = 15.0;
/// Largest size of a model that `staya voxel build` makes.
const MOST_BYTES: u64 = 64 << 20;
const SAMPLES: u32 = 1000;
const PURPOSE: u32 = u32::from_be_bytes(*b"look");

impl NeighborModel {
    /// Reads and checks a model.
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        Self::from_bytes(file::read(path, MOST_BYTES)?.into())
    }

    fn from_bytes(bytes: Arc<[u8]>) -> Result<Self, ModelError> {
        let mut in_use = IN_USE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(model) = in_use.values().filter_map(Weak::upgrade).find(|model| model.bytes == bytes) {
            return Ok(Self(model));
        }
        let neighbor = Neighbor::new(ModelIn::from_bytes(Arc::clone(&bytes))?);
        if !neighbor.covers_all_pairs() {
            return Err(ModelError::Extent);
        }
        let degrees = degrees_off(&neighbor);
        if degrees.is_nan() || degrees > MOST_DEGREES {
            return Err(ModelError::Function(degrees));
        }
        let (checksum, model) = (neighbor.model().checksum(), Arc::new(Loaded { bytes, neighbor }));
        in_use.retain(|_, model| model.strong_count() > 0);
        in_use.insert(checksum, Arc::downgrade(&model));
        drop(in_use);
        Ok(Self(model))
    }
}

/// Mean angle between half-planes of random pairs by the model and by the formula, degrees.
fn degrees_off(neighbor: &Neighbor) -> f64 {
    let params = Params { horizon_s: 1.0, separation_s: 1.0, share: 1.0 };
    let angle = |number| {
        let mut rng = Rng::keyed(1, PURPOSE, number, 0);
        let mut between = |low: f32, high: f32| low + (high - low) * rng.below(1 << 16) as f32 / 65_536.0;
        let offset_m = Vec2::new(1.0 / between(0.05, 0.95), 0.0);
        let disc = MovingBall { offset_m, velocity_mps: Vec2::ZERO, radii_m: 1.0, tie: Vec2::ZERO };
        let own = offset_m + Vec2::new(between(-2.0, 2.0), between(-2.0, 2.0));
        let [exact, found] = [orca::half_plane(own, &disc, &params), neighbor.half_space(own, &disc, &params)];
        exact.zip(found).map_or(f64::NAN, |(exact, found)| {
            let (sin, cos) = (exact.normal.det(found.normal), exact.normal.dot(found.normal));
            libm::atan2(sin.into(), cos.into()).abs().to_degrees()
        })
    };
    (0..SAMPLES).map(angle).sum::<f64>() / f64::from(SAMPLES)
}

impl fmt::Debug for NeighborModel {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "NeighborModel({:08x}, {} bytes)", self.0.neighbor.model().checksum(), self.0.bytes.len())
    }
}

impl PartialEq for NeighborModel {
    fn eq(&self, other: &Self) -> bool {
        self.0.bytes == other.0.bytes
    }
}

/// States have its checksum only.
impl Serialize for NeighborModel {
    fn serialize<T: Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        self.0.neighbor.serialize(serializer)
    }
}

/// Finds the model of a scenario that is loaded.
impl<'de> Deserialize<'de> for NeighborModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let checksum = u32::deserialize(deserializer)?;
        let in_use = IN_USE.lock().unwrap_or_else(PoisonError::into_inner);
        let model = in_use.get(&checksum).and_then(Weak::upgrade);
        model.map(Self).ok_or_else(|| de::Error::custom("no scenario with this voxel model is loaded"))
    }
}

impl HalfSpaces<f32> for NeighborModel {
    type Velocity = Vec2<f32>;

    fn half_space(&self, own: Vec2<f32>, disc: &MovingBall<Vec2<f32>>, params: &Params<f32>) -> Option<HalfPlane<f32>> {
        self.0.neighbor.half_space(own, disc, params)
    }
}

/// The same model in space.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ModelInSpace {
    /// The model.
    pub model: NeighborModel,
    /// The space.
    pub space: InSpace<f32>,
}

impl HalfSpaces<f32> for ModelInSpace {
    type Velocity = Vec3<f32>;

    fn half_space(
        &self,
        own: Vec3<f32>,
        ball: &MovingBall<Vec3<f32>>,
        params: &Params<f32>,
    ) -> Option<HalfSpace<Vec3<f32>>> {
        self.space.stretched(own, ball, |own, ball| self.model.0.neighbor.of_ball(own, ball, params))
    }

    fn downwash(&self) -> f32 {
        self.space.downwash
    }
}
