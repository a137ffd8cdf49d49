//! Serde deserializer for the tables of a parsed file. The deserializer of the `toml` crate accepts
//! any source of events; its generic layers produce three times as much machine code for the
//! scenario tables.

use super::read::{Wrong, short};
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error as _, Expected, IntoDeserializer as _, MapAccess, SeqAccess,
    Unexpected, VariantAccess, Visitor,
};
use serde::{Deserialize, forward_to_deserialize_any};
use std::borrow::Cow;
use std::fmt;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

impl fmt::Display for Wrong {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.what)
    }
}

impl std::error::Error for Wrong {}

impl serde::de::Error for Wrong {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::about(message.to_string())
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::about(format!("{} is not {}", in_words(found), needed(&expected.to_string())))
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(found, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        // "an array of length 3", or "3 elements in sequence".
        let expected = expected.to_string();
        let wanted = expected.split(' ').find(|word| word.parse::<usize>().is_ok()).unwrap_or("other numbers");
        Self::about(format!("the list has {length} values, {wanted} are needed"))
    }

    fn unknown_variant(name: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_value(name, known)
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_field(name, known)
    }
}

fn in_words(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Str(text) => format!("{text:?}"),
        Unexpected::Bool(value) => value.to_string(),
        Unexpected::Signed(value) => value.to_string(),
        Unexpected::Unsigned(value) => value.to_string(),
        Unexpected::Float(value) => short(value),
        Unexpected::Seq => "a list".to_owned(),
        Unexpected::Map => "a table".to_owned(),
        Unexpected::Other(what) => format!("a {what}"),
        other => other.to_string(),
    }
}

/// Names the values that a type accepts, without the name of the Rust type.
pub(super) fn needed(expected: &str) -> &str {
    match expected {
        "f64" | "f32" => "a number",
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        "u32" => "a whole number from 0 to 4294967295",
        "u64" | "usize" => "a whole number, 0 or more",
        "i16" => "a whole number from -32768 to 32767",
        "i32" | "i64" => "a whole number",
        "a boolean" => "true or false",
        "path string" => "a file name in quotes",
        "string" | "a string" => "a text in quotes",
        "any value" => "a value of any field",
        "a sequence" => "a list",
        "a map" => "a table",
        _ if expected.starts_with("struct ") => "a table",
        _ if expected.starts_with("enum ") || expected.ends_with(" identifier") => "a name in quotes",
        _ if expected.starts_with("tuple ") || expected.starts_with("an array of length ") => "a list",
        _ => expected,
    }
}

pub fn read<'a, 'de: 'a, T: Deserialize<'a>>(root: &'a Spanned<DeValue<'de>>) -> Result<T, Wrong> {
    T::deserialize(Node(root))
}

struct Table<'a, 'de>(&'a DeTable<'de>);

impl<'a> Deserializer<'a> for Table<'a, '_> {
    type Error = Wrong;

    fn deserialize_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Wrong> {
        visitor.visit_map(Entries { entries: Box::new(self.0.iter()), last: None })
    }

    forward_to_deserialize_any! {
        <W: Visitor<'a>>
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

type Entry<'a, 'de> = (&'a Spanned<Cow<'de, str>>, &'a Spanned<DeValue<'de>>);

struct Entries<'a, 'de> {
    entries: Box<dyn Iterator<Item = Entry<'a, 'de>> + 'a>,
    last: Option<Entry<'a, 'de>>,
}

impl<'a> MapAccess<'a> for Entries<'a, '_> {
    type Error = Wrong;

    fn next_key_seed<K: DeserializeSeed<'a>>(&mut self, seed: K) -> Result<Option<K::Value>, Wrong> {
        let Some((key, value)) = self.entries.next() else {
            return Ok(None);
        };
        self.last = Some((key, value));
        let name: StrDeserializer<'_, Wrong> = key.get_ref().as_ref().into_deserializer();
        seed.deserialize(name).map(Some).map_err(|error| error.at(key.span()).under(key.get_ref()))
    }

    fn next_value_seed<V: DeserializeSeed<'a>>(&mut self, seed: V) -> Result<V::Value, Wrong> {
        let (key, value) = self.last.take().ok_or_else(|| Wrong::about("a value without a key"))?;
        seed.deserialize(Node(value)).map_err(|error| error.at(value.span()).under(key.get_ref()))
    }
}

struct Elements<'a, 'de>(std::iter::Enumerate<std::slice::Iter<'a, Spanned<DeValue<'de>>>>);

impl<'a> SeqAccess<'a> for Elements<'a, '_> {
    type Error = Wrong;

    fn next_element_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<Option<T::Value>, Wrong> {
        let Some((index, value)) = self.0.next() else {
            return Ok(None);
        };
        let read = seed.deserialize(Node(value)).map(Some);
        read.map_err(|error| error.at(value.span()).under(&format!("[{index}]")))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.0.len())
    }
}

struct Node<'a, 'de>(&'a Spanned<DeValue<'de>>);

impl<'a> Deserializer<'a> for Node<'a, '_> {
    type Error = Wrong;

    fn deserialize_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Wrong> {
        let read = match self.0.get_ref() {
            DeValue::String(text) => visitor.visit_str(text),
            DeValue::Boolean(value) => visitor.visit_bool(*value),
            DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(value) => visitor.visit_i64(value),
                Err(_) => match u64::from_str_radix(integer.as_str(), integer.radix()) {
                    Ok(value) => visitor.visit_u64(value),
                    Err(_) => Err(Wrong::about("a whole number beyond 64 bits")),
                },
            },
            DeValue::Float(float) => match float.as_str().parse() {
                Ok(value) => visitor.visit_f64(value),
                Err(_) => Err(Wrong::about("invalid number")),
            },
            DeValue::Datetime(_) => Err(Wrong::invalid_type(Unexpected::Other("date"), &visitor)),
            DeValue::Array(list) => {
                let mut elements = Elements(list.iter().enumerate());
                let read = visitor.visit_seq(&mut elements);
                match (elements.0.len(), read) {
                    (left @ 1.., Ok(_)) => Err(Wrong::about(format!(
                        "the list has {} values, {} are needed",
                        list.len(),
                        list.len() - left
                    ))),
                    (_, read) => read,
                }
            }
            DeValue::Table(table) => Table(table).deserialize_any(visitor),
        };
        read.map_err(|error| error.at(self.0.span()))
    }

    fn deserialize_option<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Wrong> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'a>>(self, _: &'static str, visitor: V) -> Result<V::Value, Wrong> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'a>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Wrong> {
        let span = self.0.span();
        let read = match self.0.get_ref() {
            DeValue::String(name) => visitor.visit_enum(Variant { name, value: None }),
            DeValue::Table(table) if table.len() == 1 => match table.iter().next() {
                Some((name, value)) => visitor.visit_enum(Variant { name: name.get_ref(), value: Some(value) }),
                None => Err(Wrong::about("an empty table")),
            },
            _ => Err(Wrong::about("not a name in quotes, and not a table with one entry")),
        };
        read.map_err(|error| error.at(span))
    }

    forward_to_deserialize_any! {
        <W: Visitor<'a>>
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map identifier ignored_any
    }

    fn deserialize_struct<V: Visitor<'a>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Wrong> {
        // A derived visitor would read the fields of a list by their order.
        match self.0.get_ref() {
            DeValue::Array(_) => Err(Wrong::about("a list is not a table").at(self.0.span())),
            _ => self.deserialize_any(visitor),
        }
    }
}

struct Variant<'a, 'de> {
    name: &'a str,
    value: Option<&'a Spanned<DeValue<'de>>>,
}

impl<'a> EnumAccess<'a> for Variant<'a, '_> {
    type Error = Wrong;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'a>>(self, seed: V) -> Result<(V::Value, Self), Wrong> {
        let name: StrDeserializer<'_, Wrong> = self.name.into_deserializer();
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'a, 'de> Variant<'a, 'de> {
    fn content(self) -> Result<Node<'a, 'de>, Wrong> {
        self.value.map(Node).ok_or_else(|| Wrong::about(format!("{} needs a value: {} = ...", self.name, self.name)))
    }
}

impl<'a> VariantAccess<'a> for Variant<'a, '_> {
    type Error = Wrong;

    fn unit_variant(self) -> Result<(), Wrong> {
        match self.value {
            None => Ok(()),
            Some(_) => Err(Wrong::about(format!("{} takes no value", self.name))),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'a>>(self, seed: T) -> Result<T::Value, Wrong> {
        seed.deserialize(self.content()?)
    }

    fn tuple_variant<V: Visitor<'a>>(self, _: usize, visitor: V) -> Result<V::Value, Wrong> {
        self.content()?.deserialize_any(visitor)
    }

    fn struct_variant<V: Visitor<'a>>(self, fields: &'static [&'static str], visitor: V) -> Result<V::Value, Wrong> {
        self.content()?.deserialize_struct("", fields, visitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_and_tiny_numbers_have_an_exponent() {
        for (value, text) in [
            (1e308, "1e308"),
            (-2.5e-9, "-2.5e-9"),
            (600_000.0, "600000"),
            (0.0, "0"),
            (-1.5, "-1.5"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
