//! Enums with one name per value, identical in files, on command lines and in reports. `named!`
//! also implements serde, [`Display`] and [`FromStr`](core::str::FromStr), and lists all values.

use core::fmt::{self, Debug, Display, Formatter};
use core::marker::PhantomData;

/// An enum whose values have names in `snake_case`.
pub trait Named: Copy + PartialEq + 'static {
    /// All values with their names.
    const NAMES: &'static [(&'static str, Self)];

    /// Returns the name, as in scenario files.
    fn name(self) -> &'static str;

    /// Returns the value with that name; dashes may replace underscores. O(values).
    ///
    /// # Errors
    /// [`UnknownName`] if no value has that name.
    fn from_name(name: &str) -> Result<Self, UnknownName<Self>> {
        let is_same = |own: &str| own.len() == name.len() && own.bytes().zip(name.bytes()).all(|(a, b)| is_like(a, b));
        let found = Self::NAMES.iter().find(|(own, _)| is_same(own));
        found.map(|(_, value)| *value).ok_or(UnknownName(PhantomData))
    }
}

const fn is_like(own: u8, given: u8) -> bool {
    own == given || (own == b'_' && given == b'-')
}

/// A word that does not name a value of `T`.
pub struct UnknownName<T>(PhantomData<T>);

impl<T> Debug for UnknownName<T> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str("UnknownName")
    }
}

impl<T> PartialEq for UnknownName<T> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<T> Eq for UnknownName<T> {}

impl<T: Named> Display for UnknownName<T> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str("give one of ")?;
        for (index, (name, _)) in T::NAMES.iter().enumerate() {
            formatter.write_str(if index == 0 { "" } else { ", " })?;
            formatter.write_str(name)?;
        }
        Ok(())
    }
}

impl<T: Named> core::error::Error for UnknownName<T> {}

/// Defines an enum of plain values with names: `Variant = "name"`.
macro_rules! named {
    ($(#[$outer:meta])* pub enum $name:ident {
        $($(#[$inner:meta])* $variant:ident = $word:literal),* $(,)?
    }) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ::serde::Serialize, ::serde::Deserialize)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum $name {
            $($(#[$inner])* #[serde(rename = $word)] $variant),*
        }

        impl $name {
            /// The names of all values.
            #[allow(dead_code, reason = "not each enum is a choice")]
            pub const WORDS: &'static [&'static str] = &[$($word),*];

            /// Returns the name, as in scenario files.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),*
                }
            }
        }

        impl $crate::names::Named for $name {
            const NAMES: &'static [(&'static str, Self)] = &[$(($word, Self::$variant)),*];

            fn name(self) -> &'static str {
                self.name()
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                formatter.pad(self.name())
            }
        }

        impl core::str::FromStr for $name {
            type Err = $crate::names::UnknownName<Self>;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                $crate::names::Named::from_name(name)
            }
        }
    };
}
pub(crate) use named;

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    named! {
        #[derive(Default)]
        pub enum Way {
            #[default]
            Straight = "straight",
            OffToTheLeft = "off_to_the_left",
        }
    }

    #[test]
    fn a_value_has_one_name_everywhere() {
        for (name, way) in Way::NAMES {
            assert_eq!((way.name(), way.to_string().as_str()), (*name, *name));
            assert_eq!(name.parse(), Ok(*way));
            assert_eq!(name.replace('_', "-").parse(), Ok(*way));
        }
        assert_eq!(Way::default(), Way::Straight);
    }

    #[test]
    fn an_unknown_name_lists_the_valid_ones() {
        for wrong in ["", "Straight", "straigh", "straight ", "off-to-the-", "off to the left"] {
            let error = wrong.parse::<Way>().expect_err(wrong);
            assert_eq!(error.to_string(), "give one of straight, off_to_the_left");
        }
    }
}
