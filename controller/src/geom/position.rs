use super::Vec3;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// A position in the world in whole millimetres, within 2147 km of the shared origin along each
/// axis. Integers, because 1000 km from the origin 32-bit floats resolve only 6 cm, and fixed point
/// ends at 32 km; all else is computed from differences, which are small.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Position {
    /// East, north, up; millimetres.
    pub mm: [i32; 3],
}

impl Position {
    /// The shared origin.
    pub const ORIGIN: Self = Self::from_mm([0; 3]);

    /// The position with these coordinates in millimetres.
    #[must_use]
    pub const fn from_mm(mm: [i32; 3]) -> Self {
        Self { mm }
    }

    /// The position in metres, rounded to millimetres, saturating; `None` for NaN. For hosts.
    #[must_use]
    pub fn from_metres([x, y, z]: [f64; 3]) -> Option<Self> {
        Self::ORIGIN.moved(Vec3::new(x, y, z))
    }

    /// The vector from `other` to here, metres; exact up to the scalar's own precision, saturates.
    #[must_use]
    pub fn since<S: Scalar>(self, other: Self) -> Vec3<S> {
        let [a, b, c] = self.mm;
        let [x, y, z] = other.mm;
        let way = |to: i32, from: i32| S::from_milli(to.saturating_sub(from));
        Vec3::new(way(a, x), way(b, y), way(c, z))
    }

    /// The position moved by `way_m`, metres; saturates, `None` if `way_m` is not a number.
    #[must_use]
    pub fn moved<S: Scalar>(self, way_m: Vec3<S>) -> Option<Self> {
        let [x, y, z] = self.mm;
        let go = |from: i32, way: S| way.to_milli().map(|mm| from.saturating_add(mm));
        Some(Self::from_mm([go(x, way_m.x)?, go(y, way_m.y)?, go(z, way_m.z)?]))
    }
}
