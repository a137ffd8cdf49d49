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

/// The rest of some encoded fields, read without a deserializer.
#[cfg(feature = "host")]
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

#[cfg(feature = "host")]
impl Fields<'_> {
    pub(crate) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, after) = self.0.split_first_chunk()?;
        self.0 = after;
        Some(*bytes)
    }

    pub(crate) fn fixed<T: Fixed<Bytes = [u8; N]>, const N: usize>(&mut self) -> Option<T> {
        self.take().map(T::from_bytes)
    }

    /// A varint below 2^28: groups of 7 bits, at most four of them.
    pub(crate) fn number(&mut self) -> Option<u32> {
        let mut number = 0;
        for shift in [0, 7, 14, 21] {
            let [byte] = self.take()?;
            number |= u32::from(byte & 0x7F).wrapping_shl(shift);
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }
}

pub(crate) fn serialize<T: Fixed, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    value.to_bytes().serialize(to)
}

pub(crate) fn deserialize<'de, T: Fixed, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    T::Bytes::deserialize(from).map(T::from_bytes)
}
