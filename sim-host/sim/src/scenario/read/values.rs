//! Values of settings files: numbers, texts, lists and tables of any names.

use super::{Field, Line, Node, Wrong};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use toml::Spanned;
use toml::de::DeValue;

/// A whole number, which may be written with a decimal point or an exponent.
fn integer(node: &Node<'_>) -> Option<i128> {
    match node.get_ref() {
        DeValue::Integer(value) => i128::from_str_radix(value.as_str(), value.radix()).ok(),
        DeValue::Float(value) => {
            let value = value.as_str().parse::<f64>().ok()?;
            // Up to this size each whole number is a double of its own.
            (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i128)
        }
        _ => None,
    }
}

pub(super) fn number(node: &Node<'_>) -> Option<f64> {
    match node.get_ref() {
        DeValue::Float(value) => value.as_str().parse().ok(),
        _ => integer(node).map(|value| value as f64),
    }
}

macro_rules! whole_numbers {
    ($($number:ty, $range:literal;)*) => { $(
        impl Field for $number {
            const KIND: &'static str = "a whole number";

            fn read(node: &Node<'_>) -> Result<Self, Wrong> {
                let value = integer(node).and_then(|value| Self::try_from(value).ok());
                value.ok_or_else(|| Wrong::not(node, concat!("a whole number", $range)))
            }

            fn written(&self) -> Option<String> {
                Some(self.to_string())
            }
        }
    )* };
}
whole_numbers! {
    u8, " from 0 to 255";
    u16, " from 0 to 65535";
    u32, " from 0 to 4294967295";
    u64, ", 0 or more";
    usize, ", 0 or more";
    i16, " from -32768 to 32767";
    i32, "";
}

macro_rules! values {
    ($($type:ty, $kind:literal, $value:pat => $read:expr, $shown:literal;)*) => { $(
        impl Field for $type {
            const KIND: &'static str = $kind;

            fn read(node: &Node<'_>) -> Result<Self, Wrong> {
                match node.get_ref() {
                    $value => Ok($read),
                    _ => Err(Wrong::not(node, $kind)),
                }
            }

            fn written(&self) -> Option<String> {
                Some(format!($shown, self))
            }
        }
    )* };
}
values! {
    bool, "true or false", DeValue::Boolean(value) => *value, "{}";
    String, "a text in quotes", DeValue::String(text) => text.clone().into_owned(), "{:?}";
    PathBuf, "a file name in quotes", DeValue::String(text) => PathBuf::from(text.as_ref()), "{:?}";
}

impl Field for f64 {
    const KIND: &'static str = "a number";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        number(node).ok_or_else(|| Wrong::not(node, Self::KIND))
    }

    fn written(&self) -> Option<String> {
        Some(self.to_string())
    }
}

impl Field for f32 {
    const KIND: &'static str = f64::KIND;

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        f64::read(node).map(|value| value as Self)
    }

    fn written(&self) -> Option<String> {
        Some(self.to_string())
    }
}

impl<T: Field> Field for Option<T> {
    const KIND: &'static str = T::KIND;

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        T::read(node).map(Some)
    }

    fn absent() -> Option<Self> {
        Some(None)
    }

    fn lines() -> Vec<Line> {
        T::lines()
    }

    fn words() -> Vec<&'static str> {
        T::words()
    }
}

impl<T: Field> Field for Vec<T> {
    const KIND: &'static str = "a list";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        let DeValue::Array(list) = node.get_ref() else { return Err(Wrong::not(node, Self::KIND)) };
        let elements = list.iter().enumerate();
        elements.map(|(at, element)| T::read(element).map_err(|wrong| wrong.under(&format!("[{at}]")))).collect()
    }

    fn lines() -> Vec<Line> {
        T::lines()
    }

    fn words() -> Vec<&'static str> {
        T::words()
    }

    fn written(&self) -> Option<String> {
        let elements: Option<Vec<String>> = self.iter().map(Field::written).collect();
        elements.map(|elements| format!("[{}]", elements.join(", ")))
    }
}

impl<T: Field, const N: usize> Field for [T; N] {
    const KIND: &'static str = "a list";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        let list = Vec::read(node)?;
        let count = list.len();
        list.try_into().map_err(|_| Wrong::new(node, format!("the list has {count} values, {N} are needed")))
    }
}

impl<T: Field> Field for BTreeMap<String, T> {
    const KIND: &'static str = "a table";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        let DeValue::Table(table) = node.get_ref() else { return Err(Wrong::not(node, Self::KIND)) };
        let entry = |(key, value): (&Spanned<Cow<'_, str>>, &Node<'_>)| {
            let value = T::read(value).map_err(|wrong| wrong.under(key.get_ref()))?;
            Ok((key.get_ref().clone().into_owned(), value))
        };
        table.iter().map(entry).collect()
    }
}
