//! Integers of fixed width on the wire, little-endian, for `#[serde(with = "fixint")]`. Varints of
//! positions and times would raise the greatest length of a frame.

use crate::grid::Cell;
use crate::time::Instant;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) trait Fixed: Copy {
    type Bytes: Serialize + for<'de> Deserialize<'de>;
    fn to_bytes(self) -> Self::Bytes;
    fn from_bytes(bytes: Self::Bytes) -> Self;
}

macro_rules! integer {
    ($($integer:ty),*) => {$(
        impl Fixed for $integer {
            type Bytes = [u8; size_of::<$integer>()];
            fn to_bytes(self) -> Self::Bytes {
                self.to_le_bytes()
            }
            fn from_bytes(bytes: Self::Bytes) -> Self {
                Self::from_le_bytes(bytes)
            }
        }
    )*};
}
integer!(u16, i16, u32, i32);

macro_rules! array {
    ($($len:literal),*) => {$(
        impl<T: Fixed> Fixed for [T; $len] {
            type Bytes = [T::Bytes; $len];
            fn to_bytes(self) -> Self::Bytes {
                self.map(T::to_bytes)
            }
            fn from_bytes(bytes: Self::Bytes) -> Self {
                bytes.map(T::from_bytes)
            }
        }
    )*};
}
array!(2, 3);

impl Fixed for Cell {
    type Bytes = <[i16; 2] as Fixed>::Bytes;
    fn to_bytes(self) -> Self::Bytes {
        [self.x, self.y].to_bytes()
    }
    fn from_bytes(bytes: Self::Bytes) -> Self {
        let [x, y] = <[i16; 2]>::from_bytes(bytes);
        Self::new(x, y)
    }
}

impl Fixed for Instant {
    type Bytes = <u32 as Fixed>::Bytes;
    fn to_bytes(self) -> Self::Bytes {
        self.as_micros().to_bytes()
    }
    fn from_bytes(bytes: Self::Bytes) -> Self {
        Self::from_micros(u32::from_bytes(bytes))
    }
}

pub(crate) fn serialize<T: Fixed, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    value.to_bytes().serialize(to)
}

pub(crate) fn deserialize<'de, T: Fixed, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    T::Bytes::deserialize(from).map(T::from_bytes)
}
