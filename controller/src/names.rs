//! One word for each value of an enum, the same in files, on command lines and in reports.
//!
//! `named!` makes the enum and its words in one place: serde's, [`Display`]'s, [`FromStr`](core::str::FromStr)'s and a
//! list of all. A firmware that reads and prints none of them has none of them in it.

use core::fmt::{self, Debug, Display, Formatter};
use core::marker::PhantomData;

/// An enum whose values have names, in `snake_case`.
pub trait Named: Copy + PartialEq + 'static {
    /// All values, each with its name.
    const NAMES: &'static [(&'static str, Self)];

    /// The name, as scenario files have it.
    fn name(self) -> &'static str;

    /// The value of that name; dashes may stand for underscores. O(values).
    ///
    /// # Errors
    /// [`UnknownName`] if no value has it.
    fn from_name(name: &str) -> Result<Self, UnknownName<Self>> {
        let is_same = |own: &str| own.len() == name.len() && own.bytes().zip(name.bytes()).all(|(a, b)| is_like(a, b));
        let found = Self::NAMES.iter().find(|(own, _)| is_same(own));
        found.map(|(_, value)| *value).ok_or(UnknownName(PhantomData))
    }
}

/// Whether `given` can stand for the letter of a name.
const fn is_like(own: u8, given: u8) -> bool {
    own == given || (own == b'_' && given == b'-')
}

/// A word that names no value of `T`.
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
    /// All names that there are.
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

/// An enum of plain values, each with its name: `Variant = "name"`.
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
            /// As scenario files have it.
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
        /// How to go on.
        #[derive(Default)]
        pub enum Way {
            /// As before.
            #[default]
            Straight = "straight",
            /// Elsewhere.
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
    fn what_names_nothing_is_told_what_there_is() {
        for wrong in ["", "Straight", "straigh", "straight ", "off-to-the-", "off to the left"] {
            let error = wrong.parse::<Way>().expect_err(wrong);
            assert_eq!(error.to_string(), "give one of straight, off_to_the_left");
        }
    }
}
