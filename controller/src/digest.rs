//! A hash of any state: equal states have equal digests on every target.
//!
//! [`digest`] mixes the numbers that serde visits, in order, regardless of the width of `usize`,
//! the layout in memory, and the sign and payload of NaN. It detects accidental differences; it
//! does not resist deliberate collisions.

use core::fmt::{self, Display};
use serde::ser::{self, Impossible, Serialize};

/// Returns the hash of the numbers, booleans, options, enums, tuples, structs and sequences in a
/// state; text, maps and byte strings are ignored. O(numbers), with a 64-bit multiplication each.
#[must_use]
pub fn digest<T: Serialize + ?Sized>(value: &T) -> u64 {
    let mut state = Digest(0xCBF2_9CE4_8422_2325);
    // A value that cannot be walked stops the walk at an identical point on all targets.
    let _ = value.serialize(&mut state);
    state.0
}

/// Combines two digests in order.
#[must_use]
pub const fn chained(before: u64, next: u64) -> u64 {
    let mut state = Digest(before);
    state.mix(next as u32);
    state.mix((next >> 32) as u32);
    state.0
}

/// State that digests omit (keys, values derived from other state); it is still serialised.
pub mod uncounted {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) const NAME: &str = "$uncounted";

    /// Serialises the value, except for digests.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<T: Serialize + ?Sized, Z: Serializer>(value: &T, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_newtype_struct(NAME, value)
    }

    /// Deserialises a value written by [`serialize`].
    ///
    /// # Errors
    /// Those of the deserializer.
    pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        T::deserialize(deserializer)
    }
}

struct Digest(u64);

impl Digest {
    /// A bijection of the state for each word, so that no difference is lost. Not inlined, because
    /// a state has hundreds of words and firmware would pay for each.
    #[inline(never)]
    const fn mix(&mut self, word: u32) {
        let mixed = (self.0 ^ word as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 29);
    }

    const fn mix_wide(&mut self, word: u64) {
        self.mix(word as u32);
        self.mix((word >> 32) as u32);
    }
}

#[derive(Debug)]
struct NotWalked;

impl Display for NotWalked {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("not walked")
    }
}

impl core::error::Error for NotWalked {}

impl ser::Error for NotWalked {
    fn custom<T: Display>(_: T) -> Self {
        Self
    }
}

macro_rules! words {
    ($($name:ident: $number:ty),*) => {
        $(fn $name(self, value: $number) -> Result<(), NotWalked> {
            self.mix(value as u32);
            Ok(())
        })*
    };
}

impl ser::Serializer for &mut Digest {
    type Ok = ();
    type Error = NotWalked;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = Impossible<(), NotWalked>;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    words!(
        serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_char: char
    );

    fn serialize_i64(self, value: i64) -> Result<(), NotWalked> {
        self.mix_wide(value.cast_unsigned());
        Ok(())
    }

    fn serialize_u64(self, value: u64) -> Result<(), NotWalked> {
        self.mix_wide(value);
        Ok(())
    }

    fn serialize_f32(self, value: f32) -> Result<(), NotWalked> {
        self.mix(if value.is_nan() { 0x7FC0_0000 } else { value.to_bits() });
        Ok(())
    }

    fn serialize_f64(self, value: f64) -> Result<(), NotWalked> {
        self.mix_wide(if value.is_nan() { 0x7FF8_0000_0000_0000 } else { value.to_bits() });
        Ok(())
    }

    fn serialize_str(self, _: &str) -> Result<(), NotWalked> {
        Err(NotWalked)
    }

    fn serialize_bytes(self, _: &[u8]) -> Result<(), NotWalked> {
        Err(NotWalked)
    }

    fn serialize_none(self) -> Result<(), NotWalked> {
        self.mix(0);
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), NotWalked> {
        self.mix(1);
        value.serialize(self)
    }

    fn serialize_unit(self) -> Result<(), NotWalked> {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Result<(), NotWalked> {
        Ok(())
    }

    fn serialize_unit_variant(self, _: &'static str, variant: u32, _: &'static str) -> Result<(), NotWalked> {
        self.mix(variant);
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, name: &'static str, value: &T) -> Result<(), NotWalked> {
        if name == uncounted::NAME {
            return Ok(());
        }
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        value: &T,
    ) -> Result<(), NotWalked> {
        self.mix(variant);
        value.serialize(self)
    }

    fn serialize_seq(self, len: Option<usize>) -> Result<Self, NotWalked> {
        // Distinguishes a sequence and its successor from another split.
        self.mix(len.map_or(u32::MAX, |len| len as u32));
        Ok(self)
    }

    fn serialize_tuple(self, _: usize) -> Result<Self, NotWalked> {
        Ok(self)
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Self, NotWalked> {
        Ok(self)
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, NotWalked> {
        self.mix(variant);
        Ok(self)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, NotWalked> {
        Err(NotWalked)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, NotWalked> {
        Ok(self)
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, NotWalked> {
        self.mix(variant);
        Ok(self)
    }

    fn collect_str<T: Display + ?Sized>(self, _: &T) -> Result<(), NotWalked> {
        Err(NotWalked)
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

macro_rules! parts {
    ($($name:ident::$part:ident),*) => {
        $(impl ser::$name for &mut Digest {
            type Ok = ();
            type Error = NotWalked;

            fn $part<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotWalked> {
                value.serialize(&mut **self)
            }

            fn end(self) -> Result<(), NotWalked> {
                Ok(())
            }
        })*
    };
}

parts!(
    SerializeSeq::serialize_element,
    SerializeTuple::serialize_element,
    SerializeTupleStruct::serialize_field,
    SerializeTupleVariant::serialize_field
);

macro_rules! named_parts {
    ($($name:ident),*) => {
        $(impl ser::$name for &mut Digest {
            type Ok = ();
            type Error = NotWalked;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                _: &'static str,
                value: &T,
            ) -> Result<(), NotWalked> {
                value.serialize(&mut **self)
            }

            fn end(self) -> Result<(), NotWalked> {
                Ok(())
            }
        })*
    };
}

named_parts!(SerializeStruct, SerializeStructVariant);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{Q16, Scalar};
    use heapless::Vec;
    use serde::Serialize;

    #[derive(Serialize)]
    enum Sample<S> {
        Empty,
        One(S),
        Pair { x: S, y: Option<u16> },
        List(Vec<u8, 4>, bool),
    }

    fn list(items: &[u8], flag: bool) -> u64 {
        digest(&Sample::<f32>::List(items.iter().copied().collect(), flag))
    }

    #[test]
    fn every_part_counts() {
        let samples = [
            digest(&Sample::<f32>::Empty),
            digest(&Sample::One(0.0_f32)),
            digest(&Sample::One(-0.0_f32)),
            digest(&Sample::One(1.0_f32)),
            digest(&Sample::Pair { x: 1.0_f32, y: None }),
            digest(&Sample::Pair { x: 1.0_f32, y: Some(0) }),
            list(&[], true),
            list(&[], false),
            list(&[0], false),
            list(&[0, 0], false),
            list(&[1, 2], false),
            list(&[2, 1], false),
        ];
        for (index, sample) in samples.iter().enumerate() {
            assert!(!samples[..index].contains(sample), "{index}");
        }
    }

    #[test]
    fn digests_are_pinned() {
        // Firmware in the field and hosts of other versions compare these values.
        assert_eq!(digest(&7_u8), 0x1E15_259D_950C_7521);
        assert_eq!(digest(&Q16::from_i32(-2)), digest(&-131_072_i32));
    }

    #[test]
    fn all_nans_have_one_digest() {
        let nan = f32::from_bits(0xFFC0_0001);
        assert!(nan.is_nan());
        assert_eq!(digest(&nan), digest(&f32::NAN));
        assert_eq!(digest(&-f64::NAN), digest(&f64::NAN));
    }

    #[test]
    fn uncounted_state_is_serialised_but_not_digested() {
        #[derive(Serialize, serde::Deserialize, PartialEq, Debug)]
        struct Robot {
            #[serde(with = "uncounted")]
            key: [u8; 4],
            place: i32,
        }
        #[derive(Serialize)]
        struct Seen {
            place: i32,
        }
        let [one, other] = [[1, 2, 3, 4], [5; 4]].map(|key| Robot { key, place: 7 });
        assert_eq!(digest(&one), digest(&other));
        assert_eq!(digest(&one), digest(&Seen { place: 7 }));
        let mut room = [0; 16];
        let bytes = postcard::to_slice(&one, &mut room).expect("there is room");
        assert_eq!(postcard::from_bytes::<Robot>(bytes).expect("they are whole"), one);
    }

    #[test]
    fn order_counts_in_a_chain() {
        assert_ne!(chained(chained(0, 1), 2), chained(chained(0, 2), 1));
    }
}
