//! `#[serde(with = "crate::array")]`: an array of any length, coded as by serde, but with a loop;
//! serde's own code has a part for each element.

use core::fmt::{self, Formatter};
use core::marker::PhantomData;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub fn serialize<T: Serialize, O: Serializer, const N: usize>(array: &[T; N], to: O) -> Result<O::Ok, O::Error> {
    let mut tuple = to.serialize_tuple(N)?;
    array.iter().try_for_each(|element| tuple.serialize_element(element))?;
    tuple.end()
}

pub fn deserialize<'de, T, D, const N: usize>(from: D) -> Result<[T; N], D::Error>
where
    T: Copy + Default + Deserialize<'de>,
    D: Deserializer<'de>,
{
    from.deserialize_tuple(N, Elements(PhantomData))
}

struct Elements<T, const N: usize>(PhantomData<T>);

impl<'de, T: Copy + Default + Deserialize<'de>, const N: usize> Visitor<'de> for Elements<T, N> {
    type Value = [T; N];

    fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "an array of {N} elements")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<[T; N], A::Error> {
        let mut array = [T::default(); N];
        for (at, element) in array.iter_mut().enumerate() {
            *element = elements.next_element()?.ok_or_else(|| Error::invalid_length(at, &self))?;
        }
        Ok(array)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Coded(#[serde(with = "crate::array")] [u64; 32]);

    proptest! {
        #[test]
        fn bytes_are_those_of_serde(array in any::<[u64; 32]>(), cut in 0_usize..32) {
            let [mut ours, mut theirs] = [[0; 400]; 2];
            let ours = postcard::to_slice(&Coded(array), &mut ours).unwrap();
            prop_assert_eq!(&*ours, &*postcard::to_slice(&array, &mut theirs).unwrap());
            prop_assert_eq!(postcard::from_bytes::<Coded>(ours), Ok(Coded(array)));
            prop_assert!(postcard::from_bytes::<Coded>(&ours[..cut]).is_err());
        }
    }
}
