//! Serializes a format's state. Digests skip which format it is: a whole swarm uses one.

use super::AnyWire;
use core::fmt;
use core::marker::PhantomData;
use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use staya_controller::digest::uncounted;

#[derive(Serialize)]
struct Uncounted<T: Serialize>(#[serde(with = "uncounted")] T);

impl<S: Serialize, G: Serialize> Serialize for AnyWire<S, G> {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        let number: u8 = match self {
            Self::Postcard(_) => 0,
            Self::Mavlink(_) => 1,
            Self::Sealed(_) => 2,
            Self::Signed(_) => 3,
        };
        let mut parts = serializer.serialize_tuple(2)?;
        parts.serialize_element(&Uncounted(number))?;
        each!(self, wire => parts.serialize_element(wire))?;
        parts.end()
    }
}

impl<'de, S: Deserialize<'de>, G: Deserialize<'de>> Deserialize<'de> for AnyWire<S, G> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(2, Parts(PhantomData))
    }
}

struct Parts<S, G>(PhantomData<(S, G)>);

impl<'de, S: Deserialize<'de>, G: Deserialize<'de>> Visitor<'de> for Parts<S, G> {
    type Value = AnyWire<S, G>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("the number of a wire format, and its state")
    }

    fn visit_seq<P: SeqAccess<'de>>(self, mut parts: P) -> Result<Self::Value, P::Error> {
        fn next<'de, T: Deserialize<'de>, P: SeqAccess<'de>>(parts: &mut P) -> Result<T, P::Error> {
            parts.next_element()?.ok_or_else(|| P::Error::custom("a wire format without its state"))
        }
        Ok(match next::<u8, P>(&mut parts)? {
            0 => AnyWire::Postcard(next(&mut parts)?),
            1 => AnyWire::Mavlink(next(&mut parts)?),
            2 => AnyWire::Sealed(next(&mut parts)?),
            3 => AnyWire::Signed(next(&mut parts)?),
            number => {
                return Err(P::Error::invalid_value(Unexpected::Unsigned(number.into()), &"a wire format, 0 to 3"));
            }
        })
    }
}
