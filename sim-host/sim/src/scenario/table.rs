//! Macros that define what a settings file contains: [`table!`](crate::table!) a struct with
//! reader, ranges, units, defaults and documentation, [`one_of!`](crate::one_of!) fields that
//! exclude each other, [`choice!`](crate::choice!) and [`names!`](crate::names!) named values,
//! [`kinds!`](crate::kinds!) tables with a field `kind`.

use super::read::{Field, Line, Table, Wrong};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The fields of a table, or some of them.
pub trait Fields: Sized {
    /// Their names.
    fn names() -> Vec<&'static str>;

    /// Reads the fields.
    ///
    /// # Errors
    /// See [`Field::read`]; also a missing field.
    fn fields(table: &Table<'_>) -> Result<Self, Wrong>;

    /// Their documentation.
    fn part_lines() -> Vec<Line>;
}

/// Fields of which a table has one. In an `Option`, the table may have none.
pub trait OneOf: Fields {
    /// Reads the field that the table has, if it has one.
    ///
    /// # Errors
    /// See [`Field::read`]; also two of the fields.
    fn one(table: &Table<'_>) -> Result<Option<Self>, Wrong>;
}

impl<T: OneOf> Fields for Option<T> {
    fn names() -> Vec<&'static str> {
        T::names()
    }

    fn fields(table: &Table<'_>) -> Result<Self, Wrong> {
        T::one(table)
    }

    fn part_lines() -> Vec<Line> {
        T::part_lines()
    }
}

/// Name of a field without the mark of names that are words of Rust.
#[must_use]
pub fn plain(name: &'static str) -> &'static str {
    name.strip_prefix("r#").unwrap_or(name)
}

/// Reads a table without fields.
///
/// # Panics
/// If `T` has a required field.
#[must_use]
pub fn empty<T: Field>() -> T {
    let node = Spanned::new(0..0, DeValue::Table(DeTable::new()));
    T::read(&node).unwrap_or_else(|wrong| panic!("{}", wrong.what))
}

/// Reads enums with the names of [`Named`](staya_controller::names::Named).
#[macro_export]
macro_rules! names {
    ($($name:ty),* $(,)?) => { $(
        impl $crate::scenario::Read for $name {
            const KIND: &'static str = "a name in quotes";

            fn read(node: &$crate::scenario::Node<'_>) -> Result<Self, $crate::scenario::Wrong> {
                $crate::scenario::word(node, <Self as staya_controller::names::Named>::NAMES)
            }

            fn words() -> Vec<&'static str> {
                <Self as staya_controller::names::Named>::NAMES.iter().map(|(word, _)| *word).collect()
            }

            fn written(&self) -> Option<String> {
                Some(format!("{:?}", staya_controller::names::Named::name(*self)))
            }
        }
    )* };
}

/// Defines an enum whose values have names in files: `Variant = "name"`.
#[macro_export]
macro_rules! choice {
    ($(#[$outer:meta])* pub enum $name:ident {
        $($(#[$inner:meta])* $variant:ident = $word:literal),* $(,)?
    }) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[$inner])* $variant),*
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self {
                    $(Self::$variant => $word),*
                })
            }
        }

        impl $crate::scenario::Read for $name {
            const KIND: &'static str = "a name in quotes";

            fn read(node: &$crate::scenario::Node<'_>) -> Result<Self, $crate::scenario::Wrong> {
                $crate::scenario::word(node, &[$(($word, Self::$variant)),*])
            }

            fn words() -> Vec<&'static str> {
                vec![$($word),*]
            }

            fn written(&self) -> Option<String> {
                Some(format!("\"{self}\""))
            }
        }
    };
}

/// Reads an enum whose variants are tables with a field `kind`.
#[macro_export]
macro_rules! kinds {
    ($name:ident { $($variant:ident = $word:literal { $($field:ident),* }),* $(,)? }) => {
        impl $crate::scenario::Read for $name {
            const KIND: &'static str = "a table";

            fn read(node: &$crate::scenario::Node<'_>) -> Result<Self, $crate::scenario::Wrong> {
                type Make<T> = fn(&$crate::scenario::Table<'_>) -> Result<T, $crate::scenario::Wrong>;
                let kinds: &[(&str, (Make<Self>, &[&str]))] = &[$((
                    $word,
                    (
                        |table| Ok(Self::$variant { $($field: table.need(stringify!($field))?),* }),
                        &["kind", $(stringify!($field)),*],
                    ),
                )),*];
                let (make, table) = $crate::scenario::Table::kind(node, kinds)?;
                make(&table)
            }
        }
    };
}

/// Defines fields of a table that exclude each other: an enum whose variants hold one field each,
/// `Variant(Type) = "name"`. It is a table, or a `part` of a [`table!`](crate::table!).
#[macro_export]
macro_rules! one_of {
    ($(#[$outer:meta])* pub enum $name:ident {
        $($(#[doc = $doc:literal])* $variant:ident($type:ty) = $field:literal $(, $range:expr, $unit:literal)?;)*
    }) => {
        $(#[$outer])*
        #[derive(Clone, Debug)]
        pub enum $name {
            $($(#[doc = $doc])* $variant($type)),*
        }

        impl $crate::scenario::OneOf for $name {
            fn one(table: &$crate::scenario::Table<'_>) -> Result<Option<Self>, $crate::scenario::Wrong> {
                let names = [$($field),*];
                match names.map(|name| usize::from(table.has(name))).iter().sum::<usize>() {
                    0 => return Ok(None),
                    1 => {}
                    _ => return Err(table.unclear(&names)),
                }
                $(if let Some(value) = table.read($field, $crate::table!(@limits $($range, $unit)?).as_ref())? {
                    return Ok(Some(Self::$variant(value)));
                })*
                Ok(None)
            }
        }

        impl $crate::scenario::Fields for $name {
            fn names() -> Vec<&'static str> {
                vec![$($field),*]
            }

            fn fields(table: &$crate::scenario::Table<'_>) -> Result<Self, $crate::scenario::Wrong> {
                <Self as $crate::scenario::OneOf>::one(table)?.ok_or_else(|| table.unclear(&[$($field),*]))
            }

            fn part_lines() -> Vec<$crate::scenario::Line> {
                vec![$($crate::table!(@line $field, concat!($($doc),*), $type, (); $($range, $unit)?)),*]
            }
        }

        $crate::table!(@read $name);
    };
}

/// Defines a table of a settings file: a struct with documented fields, each with type, default
/// (after `=`; without one it is required, unless it is an `Option`), and either range and unit or
/// the parameter of the controller whose range it has. The fields of a struct or an enum in `part`
/// belong to the same table.
#[macro_export]
macro_rules! table {
    ($(#[$outer:meta])* pub struct $name:ident {
        $(part $part:ident: $part_type:ty;)*
        $(
            $(#[doc = $doc:literal])*
            pub $field:ident: $type:ty $(= $default:expr)? $(, $range:expr $(, $unit:literal)?)?;
        )*
    }) => {
        $(#[$outer])*
        #[derive(Clone, Debug)]
        pub struct $name {
            $(/// Fields of the same table.
            pub $part: $part_type,)*
            $($(#[doc = $doc])* pub $field: $type,)*
        }

        impl $crate::scenario::Fields for $name {
            fn names() -> Vec<&'static str> {
                let parts: Vec<Vec<&'static str>> = vec![$(<$part_type as $crate::scenario::Fields>::names(),)*];
                let own = [$($crate::scenario::plain(stringify!($field))),*];
                parts.into_iter().flatten().chain(own).collect()
            }

            fn fields(table: &$crate::scenario::Table<'_>) -> Result<Self, $crate::scenario::Wrong> {
                Ok(Self {
                    $($part: $crate::scenario::Fields::fields(table)?,)*
                    $($field: {
                        let name = $crate::scenario::plain(stringify!($field));
                        let value = table.read(name, $crate::table!(@limits $($range $(, $unit)?)?).as_ref())?;
                        $crate::table!(@or table, name, value $(, $default)?)
                    }),*
                })
            }

            fn part_lines() -> Vec<$crate::scenario::Line> {
                let parts: Vec<Vec<_>> = vec![$(<$part_type as $crate::scenario::Fields>::part_lines()),*];
                let own = [$($crate::table!(
                    @line $crate::scenario::plain(stringify!($field)), concat!($($doc),*), $type,
                    ($($default)?); $($range $(, $unit)?)?
                )),*];
                parts.into_iter().flatten().chain(own).collect()
            }
        }

        $crate::table!(@read $name);
    };
    (@read $name:ident) => {
        impl $crate::scenario::Read for $name {
            const KIND: &'static str = "a table";

            fn read(node: &$crate::scenario::Node<'_>) -> Result<Self, $crate::scenario::Wrong> {
                let names = <Self as $crate::scenario::Fields>::names();
                $crate::scenario::Fields::fields(&$crate::scenario::Table::new(node, &names)?)
            }

            fn lines() -> Vec<$crate::scenario::Line> {
                <Self as $crate::scenario::Fields>::part_lines()
            }
        }
    };
    (@limits) => { None::<$crate::scenario::Limits> };
    (@limits $row:expr) => { Some($crate::scenario::Limits::of(&$row)) };
    (@limits $range:expr, $unit:literal) => { Some($crate::scenario::Limits::new($range, $unit)) };
    (@usual $type:ty,) => { $crate::scenario::Usual::None };
    (@usual $type:ty, $default:expr) => { $crate::scenario::Usual::of::<$type>(&$default) };
    (@line $name:expr, $doc:expr, $type:ty, ($($default:expr)?); $($range:expr $(, $unit:literal)?)?) => {
        {
            let (doc, default) = $crate::scenario::documented($doc, $crate::table!(@usual $type, $($default)?));
            $crate::scenario::Line {
                name: $name,
                doc,
                kind: <$type as $crate::scenario::Read>::KIND,
                limits: $crate::table!(@limits $($range $(, $unit)?)?),
                words: <$type as $crate::scenario::Read>::words(),
                default,
                reads: |node| <$type as $crate::scenario::Read>::read(node).map(drop),
                inner: <$type as $crate::scenario::Read>::lines(),
            }
        }
    };
    (@or $table:ident, $name:ident, $value:ident) => {
        match $value {
            Some(value) => value,
            None => return Err($table.missing($name)),
        }
    };
    (@or $table:ident, $name:ident, $value:ident, $default:expr) => { $value.unwrap_or_else(|| $default) };
}

/// Implements [`Default`] for tables without required fields.
#[macro_export]
macro_rules! defaults {
    ($($name:ty),* $(,)?) => { $(
        impl Default for $name {
            fn default() -> Self {
                $crate::scenario::empty()
            }
        }
    )* };
}
