//! Reads the tables of a settings file without serde. [`table!`](crate::table!) defines a struct
//! with reader, ranges, units, defaults and documentation. An error carries the place of the value.

use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::PathBuf;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A parsed value with its place in the text.
pub type Node<'a> = Spanned<DeValue<'a>>;

/// Why a value was refused.
#[derive(Debug)]
pub struct Wrong {
    /// Position of the value or its key, bytes.
    pub span: Option<Range<usize>>,
    /// Path of the field below the value that is being read.
    pub path: String,
    /// Cause.
    pub what: String,
    /// How to correct it; `None`: see the list of all fields.
    pub remedy: Option<String>,
    /// Whether the list of all fields helps beside the remedy.
    pub is_listed: bool,
}

impl Wrong {
    /// Creates an error about a value.
    pub fn new(node: &Node<'_>, what: impl Into<String>) -> Self {
        Self::about(what).at(node.span())
    }

    pub(super) fn about(what: impl Into<String>) -> Self {
        Self { span: None, path: String::new(), what: what.into(), remedy: None, is_listed: true }
    }

    /// Creates an error about a value that is not `needed`.
    pub fn not(node: &Node<'_>, needed: &str) -> Self {
        Self::new(node, format!("{} is not {needed}", in_words(node.get_ref())))
    }

    pub(super) fn unknown_field(name: &str, known: &[&'static str]) -> Self {
        let remedy = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => "this table has no fields".to_owned(),
            None => format!("this table has {}", listed(known)),
        };
        Self { remedy: Some(remedy), ..Self::about(format!("unknown field `{name}`")) }
    }

    pub(super) fn unknown_value(name: &str, known: &[&'static str]) -> Self {
        let remedy = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("give one of {}", listed(known)),
        };
        Self { remedy: Some(remedy), ..Self::about(format!("unknown value `{name}`")) }
    }

    /// Adds the position, unless it is known.
    pub(super) fn at(mut self, span: Range<usize>) -> Self {
        self.span.get_or_insert(span);
        self
    }

    /// Adds the key of the table, or the index of the list, above the path.
    pub(super) fn under(mut self, key: &str) -> Self {
        let dot = if self.path.is_empty() || self.path.starts_with('[') { "" } else { "." };
        self.path = format!("{key}{dot}{}", self.path);
        self
    }
}

/// The known name that is most similar to `name`, if any is similar.
pub fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let similar = known.map(|one| (strsim::jaro_winkler(name, one), one)).filter(|(likeness, _)| *likeness > 0.8);
    similar.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, one)| one)
}

fn listed(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// Formats a number for an error text: huge and tiny numbers have an exponent.
pub(super) fn short(value: f64) -> String {
    let has_few_digits = value == 0.0 || (1e-6..1e12).contains(&value.abs()) || !value.is_finite();
    if has_few_digits { value.to_string() } else { format!("{value:e}") }
}

fn in_words(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Integer(value) => value.to_string(),
        DeValue::Float(value) => value.as_str().parse().map_or_else(|_| value.to_string(), short),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// A documented field of a table.
#[derive(Debug)]
pub struct Line {
    /// Name of the field.
    pub name: &'static str,
    /// Documentation, one sentence or more.
    pub doc: &'static str,
    /// Kind of its value, such as `a number`.
    pub kind: &'static str,
    /// Least and greatest value, and the unit.
    pub range: Option<(RangeInclusive<f64>, &'static str)>,
    /// Value if the field is absent, as Rust code; empty if there is none.
    pub default: &'static str,
    /// Fields of the table, or of the tables in the list.
    pub inner: Vec<Line>,
}

/// A type that can be read from a settings file.
pub trait Field: Sized {
    /// Kind of the value for people.
    const KIND: &'static str;

    /// Reads a value.
    ///
    /// # Errors
    /// The value has another type, length or name, or is out of range.
    fn read(node: &Node<'_>) -> Result<Self, Wrong>;

    /// Value of an absent field without a default.
    #[must_use]
    fn absent() -> Option<Self> {
        None
    }

    /// Fields, if this is a table or a list of tables.
    #[must_use]
    fn lines() -> Vec<Line> {
        Vec::new()
    }
}

/// The fields of a table, or some of them.
pub trait Fields: Sized {
    /// Names of its parts' fields, then of its own.
    const NAMES: &'static [&'static [&'static str]];

    /// Reads the fields.
    ///
    /// # Errors
    /// See [`Field::read`]; also a missing field.
    fn fields(table: &Table<'_>) -> Result<Self, Wrong>;
}

fn integer(node: &Node<'_>) -> Option<i128> {
    let DeValue::Integer(value) = node.get_ref() else { return None };
    i128::from_str_radix(value.as_str(), value.radix()).ok()
}

fn number(node: &Node<'_>) -> Option<f64> {
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
    ($($type:ty, $kind:literal, $value:pat => $read:expr;)*) => { $(
        impl Field for $type {
            const KIND: &'static str = $kind;

            fn read(node: &Node<'_>) -> Result<Self, Wrong> {
                match node.get_ref() {
                    $value => Ok($read),
                    _ => Err(Wrong::not(node, $kind)),
                }
            }
        }
    )* };
}
values! {
    bool, "true or false", DeValue::Boolean(value) => *value;
    String, "a text in quotes", DeValue::String(text) => text.clone().into_owned();
    PathBuf, "a file name in quotes", DeValue::String(text) => PathBuf::from(text.as_ref());
}

impl Field for f64 {
    const KIND: &'static str = "a number";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        number(node).ok_or_else(|| Wrong::not(node, Self::KIND))
    }
}

impl Field for f32 {
    const KIND: &'static str = f64::KIND;

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        f64::read(node).map(|value| value as Self)
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
        let entry = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, &Node<'_>)| {
            let value = T::read(value).map_err(|wrong| wrong.under(key.get_ref()))?;
            Ok((key.get_ref().clone().into_owned(), value))
        };
        table.iter().map(entry).collect()
    }
}

/// A table that is allowed and read by other means: [`Source::get`](super::Source::get).
#[derive(Clone, Copy, Debug, Default)]
pub struct AnyTable;

impl Field for AnyTable {
    const KIND: &'static str = "a table";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        Table::any(node).map(|_| Self)
    }
}

/// A table that is being read.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    node: &'a Node<'a>,
    table: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// The fields of `node`.
    ///
    /// # Errors
    /// It is not a table, or has a field that is not `known`.
    pub fn new(node: &'a Node<'a>, known: &[&'static str]) -> Result<Self, Wrong> {
        let fields = Self::any(node)?;
        let Some((key, _)) = fields.table.iter().find(|(key, _)| !known.contains(&present(key.get_ref()))) else {
            return Ok(fields);
        };
        let name = key.get_ref();
        let mut wrong = Wrong::unknown_field(name, known).at(key.span());
        if let Some((_, new)) = RENAMED.iter().find(|(old, new)| old == name && known.contains(new)) {
            wrong.remedy = Some(format!("the field is called `{new}` now"));
        }
        Err(wrong.under(name))
    }

    /// The fields of `node`, whatever they are called.
    ///
    /// # Errors
    /// It is not a table.
    pub fn any(node: &'a Node<'a>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::Table(table) => Ok(Self { node, table }),
            _ => Err(Wrong::not(node, "a table")),
        }
    }

    /// Reads a field whose numbers are within a range. `None`: it is absent and has no value then.
    ///
    /// # Errors
    /// See [`Field::read`].
    pub fn read<T: Field>(&self, name: &str, range: Option<&(RangeInclusive<f64>, &str)>) -> Result<Option<T>, Wrong> {
        let mut fields = self.table.iter().filter(|(key, _)| present(key.get_ref()) == name);
        let Some((key, node)) = fields.next() else { return Ok(T::absent()) };
        let value = T::read(node).and_then(|value| {
            range.map_or(Ok(()), |(range, unit)| within(node, range, unit))?;
            Ok(Some(value))
        });
        value.map_err(|wrong| wrong.under(key.get_ref()))
    }

    /// Reads a field that must be there.
    ///
    /// # Errors
    /// It is missing, or see [`Field::read`].
    pub fn need<T: Field>(&self, name: &str) -> Result<T, Wrong> {
        self.read(name, None)?.ok_or_else(|| self.missing(name))
    }

    /// The error about a missing field.
    #[must_use]
    pub fn missing(&self, name: &str) -> Wrong {
        Wrong::new(self.node, format!("missing field `{name}`"))
    }
}

/// Earlier names of fields, each with the present one.
const RENAMED: [(&str, &str); 3] = [("eyes", "sensing"), ("claims", "plausibility"), ("remember_s", "stands_after_s")];

/// Present name of a field that has another one in older files.
fn present(name: &str) -> &str {
    match name {
        "doubt_mps" => "inflation_mps",
        "doubt_m" => "inflation_m",
        name => name,
    }
}

/// Checks a number, or the numbers of a list.
fn within(node: &Node<'_>, range: &RangeInclusive<f64>, unit: &str) -> Result<(), Wrong> {
    if let DeValue::Array(list) = node.get_ref() {
        let mut elements = list.iter().enumerate();
        return elements.try_for_each(|(at, element)| {
            within(element, range, unit).map_err(|wrong| wrong.under(&format!("[{at}]")))
        });
    }
    match number(node) {
        Some(value) if !range.contains(&value) => {
            let (what, remedy) = out_of(value, range, unit);
            Err(Wrong { remedy: Some(remedy), is_listed: false, ..Wrong::new(node, what) })
        }
        _ => Ok(()),
    }
}

/// Cause and remedy of a value that is out of range.
pub(super) fn out_of(value: f64, range: &RangeInclusive<f64>, unit: &str) -> (String, String) {
    let (value, low, high) = (short(value), short(*range.start()), short(*range.end()));
    match unit {
        "probability" => (format!("{value} is not a probability"), format!("give a number from {low} to {high}")),
        _ => (format!("{value} is out of range"), format!("give {low} to {high} {unit}").trim_end().to_owned()),
    }
}

/// Name of a field without the mark of names that are words of Rust.
#[must_use]
pub const fn plain(name: &'static str) -> &'static str {
    match name.as_bytes() {
        [b'r', b'#', rest @ ..] => match std::str::from_utf8(rest) {
            Ok(name) => name,
            Err(_) => name,
        },
        _ => name,
    }
}

/// Reads one of several names.
///
/// # Errors
/// The value is not a text, or has another name.
pub fn word<T: Copy>(node: &Node<'_>, names: &[(&'static str, T)]) -> Result<T, Wrong> {
    let DeValue::String(name) = node.get_ref() else { return Err(Wrong::not(node, "a name in quotes")) };
    let found = names.iter().find(|(known, _)| known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let known: Vec<_> = names.iter().map(|(known, _)| *known).collect();
        Wrong::unknown_value(name, &known).at(node.span())
    })
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
                use $crate::scenario::Table;
                #[derive(Clone, Copy)]
                struct Kind(&'static str, &'static [&'static str]);
                const KINDS: &[(&str, Kind)] = &[$(($word, Kind($word, &["kind", $(stringify!($field)),*]))),*];
                impl $crate::scenario::Read for Kind {
                    const KIND: &'static str = "a name in quotes";

                    fn read(node: &$crate::scenario::Node<'_>) -> Result<Self, $crate::scenario::Wrong> {
                        $crate::scenario::word(node, KINDS)
                    }
                }
                let Kind(kind, known) = Table::any(node)?.need("kind")?;
                let table = Table::new(node, known)?;
                $(if kind == $word {
                    return Ok(Self::$variant { $($field: table.need(stringify!($field))?),* });
                })*
                Err(table.missing("kind"))
            }
        }
    };
}

/// Defines a table of a settings file: a struct with documented fields, each with type, default
/// (after `=`; without one it is required, unless it is an `Option`), range and unit. The fields of
/// a struct in `part` belong to the same table.
#[macro_export]
macro_rules! table {
    ($(#[$outer:meta])* pub struct $name:ident {
        $(part $part:ident: $part_type:ty;)*
        $($(#[doc = $doc:literal])* pub $field:ident: $type:ty $(= $default:expr)? $(, $range:expr, $unit:literal)?;)*
    }) => {
        $(#[$outer])*
        #[derive(Clone, Debug)]
        pub struct $name {
            $(/// Fields of the same table.
            pub $part: $part_type,)*
            $($(#[doc = $doc])* pub $field: $type,)*
        }

        impl $crate::scenario::Fields for $name {
            const NAMES: &'static [&'static [&'static str]] =
                &[$(<$part_type as $crate::scenario::Fields>::NAMES[0],)* &[$($crate::scenario::plain(stringify!($field))),*]];

            fn fields(table: &$crate::scenario::Table<'_>) -> Result<Self, $crate::scenario::Wrong> {
                Ok(Self {
                    $($part: $crate::scenario::Fields::fields(table)?,)*
                    $($field: {
                        let name = $crate::scenario::plain(stringify!($field));
                        let value = table.read(name, $crate::table!(@range $($range, $unit)?).as_ref())?;
                        $crate::table!(@or table, name, value $(, $default)?)
                    }),*
                })
            }
        }

        impl $crate::scenario::Read for $name {
            const KIND: &'static str = "a table";

            fn read(node: &$crate::scenario::Node<'_>) -> Result<Self, $crate::scenario::Wrong> {
                let names = <Self as $crate::scenario::Fields>::NAMES.concat();
                $crate::scenario::Fields::fields(&$crate::scenario::Table::new(node, &names)?)
            }

            fn lines() -> Vec<$crate::scenario::Line> {
                let parts: Vec<Vec<$crate::scenario::Line>> =
                    vec![$(<$part_type as $crate::scenario::Read>::lines()),*];
                let own = [$($crate::scenario::Line {
                    name: $crate::scenario::plain(stringify!($field)),
                    doc: concat!($($doc),*),
                    kind: <$type as $crate::scenario::Read>::KIND,
                    range: $crate::table!(@range $($range, $unit)?),
                    default: concat!($(stringify!($default))?),
                    inner: <$type as $crate::scenario::Read>::lines(),
                }),*];
                parts.into_iter().flatten().chain(own).collect()
            }
        }
    };
    (@range) => { None };
    (@range $range:expr, $unit:literal) => { Some(($range, $unit)) };
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

/// Reads a table without fields.
///
/// # Panics
/// If `T` has a required field.
#[must_use]
pub fn empty<T: Field>() -> T {
    let node = Spanned::new(0..0, DeValue::Table(DeTable::new()));
    T::read(&node).unwrap_or_else(|wrong| panic!("{}", wrong.what))
}

/// The fields as JSON; numbers that JSON lacks are null.
pub(super) fn json(value: &DeValue<'_>) -> serde_json::Value {
    match value {
        DeValue::String(text) => text.as_ref().into(),
        DeValue::Boolean(value) => (*value).into(),
        DeValue::Integer(value) => match i64::from_str_radix(value.as_str(), value.radix()) {
            Ok(value) => value.into(),
            Err(_) => u64::from_str_radix(value.as_str(), value.radix()).ok().into(),
        },
        DeValue::Float(value) => value.as_str().parse::<f64>().ok().into(),
        DeValue::Datetime(value) => value.to_string().into(),
        DeValue::Array(list) => list.iter().map(|element| json(element.get_ref())).collect(),
        DeValue::Table(table) => {
            table.iter().map(|(key, value)| (key.get_ref().as_ref(), json(value.get_ref()))).collect()
        }
    }
}

#[cfg(test)]
mod tests;
