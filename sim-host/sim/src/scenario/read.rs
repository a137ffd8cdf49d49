//! Reads the values of a settings file without serde. An error carries the place of the value.
//! [`table!`](crate::table!) and its relatives define types that are read this way.

use staya_controller::parameters::Parameter;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
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

    fn about(what: impl Into<String>) -> Self {
        Self { span: None, path: String::new(), what: what.into(), remedy: None, is_listed: true }
    }

    /// Creates an error about a value that is not `needed`.
    pub fn not(node: &Node<'_>, needed: &str) -> Self {
        Self::new(node, format!("{} is not {needed}", in_words(node.get_ref())))
    }

    /// Creates an error about a name that is not `known`; `what` is a field or a value.
    fn unknown(what: &str, name: &str, known: &[&'static str], hint: &str) -> Self {
        let remedy = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => "this table has no fields".to_owned(),
            None => format!("{hint} {}", listed(known)),
        };
        Self { remedy: Some(remedy), ..Self::about(format!("unknown {what} `{name}`")) }
    }

    /// Adds the position, unless it is known.
    fn at(mut self, span: Range<usize>) -> Self {
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

pub(super) fn listed(names: &[&str]) -> String {
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

/// The value of a field that is absent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Usual {
    /// None: the field is required, an alternative, or a table of defaults.
    None,
    /// This one, as in a file.
    Value(String),
    /// It depends on others, as these words say.
    Words(Cow<'static, str>),
}

impl Display for Usual {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => Ok(()),
            Self::Value(value) => f.write_str(value),
            Self::Words(words) => f.write_str(words),
        }
    }
}

impl Usual {
    /// The default `value` of a field of type `T`.
    #[must_use]
    pub fn of<T: Field>(value: &T) -> Self {
        value.written().map_or(Self::None, Self::Value)
    }
}

/// The documentation of a field and its default. The documentation of an optional field says what
/// the default is: `Default: the highest speed.`
#[must_use]
pub fn documented(doc: &'static str, default: Usual) -> (Cow<'static, str>, Usual) {
    const MARK: &str = " Default: ";
    match doc.split_once(MARK) {
        Some((doc, words)) if default == Usual::None => {
            let (words, rest) = words.split_once(". ").unwrap_or((words.trim_end_matches('.'), ""));
            (format!("{doc} {rest}").trim().to_owned().into(), Usual::Words(words.into()))
        }
        _ => (doc.trim().into(), default),
    }
}

/// A documented field of a table.
#[derive(Debug)]
pub struct Line {
    /// Name of the field.
    pub name: &'static str,
    /// Documentation, one sentence or more.
    pub doc: Cow<'static, str>,
    /// Kind of its value, such as `a number`.
    pub kind: &'static str,
    /// Least and greatest value, and the unit.
    pub limits: Option<Limits>,
    /// The words, if the value is one of some.
    pub words: Vec<&'static str>,
    /// Value if the field is absent.
    pub default: Usual,
    /// Reads a value as the field does, without its limits.
    pub reads: fn(&Node<'_>) -> Result<(), Wrong>,
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

    /// The words, if this is one of some.
    #[must_use]
    fn words() -> Vec<&'static str> {
        Vec::new()
    }

    /// The value as in a file; `None` for a table.
    #[must_use]
    fn written(&self) -> Option<String> {
        None
    }
}

/// Least and greatest value of a number, and its unit in the words of error texts.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    range: RangeInclusive<f64>,
    unit: &'static str,
}

impl Limits {
    /// Creates limits; the unit `probability` has an error text of its own.
    #[must_use]
    pub const fn new(range: RangeInclusive<f64>, unit: &'static str) -> Self {
        Self { range, unit }
    }

    /// Limits of a parameter, as decimal numbers: the nearest double of a float such as 0.001 is
    /// greater.
    #[must_use]
    pub fn of(row: &Parameter) -> Self {
        let [low, high] = row.range.map(|end| end.to_string().parse().unwrap_or(f64::from(end)));
        let units = [("m", "metres"), ("s", "seconds"), ("rad", "radians")];
        let unit = units.iter().find(|(short, _)| *short == row.unit).map_or(row.unit, |(_, unit)| unit);
        Self::new(low..=high, unit)
    }

    /// The least and the greatest value.
    #[must_use]
    pub const fn ends(&self) -> (f64, f64) {
        (*self.range.start(), *self.range.end())
    }

    /// Cause and remedy, if the value is out of range.
    pub(super) fn check(&self, value: f64) -> Result<(), [String; 2]> {
        match (self.range.contains(&value), short(value), self.unit) {
            (true, ..) => Ok(()),
            (_, value, "probability") => {
                let (low, high) = (self.range.start(), self.range.end());
                Err([format!("{value} is not a probability"), format!("give a number from {low} to {high}")])
            }
            (_, value, _) => Err([format!("{value} is out of range"), format!("give {self}")]),
        }
    }

    /// Checks a number, or the numbers of a list.
    pub(super) fn check_node(&self, node: &Node<'_>) -> Result<(), Wrong> {
        if let DeValue::Array(list) = node.get_ref() {
            let mut elements = list.iter().enumerate();
            return elements.try_for_each(|(at, element)| {
                self.check_node(element).map_err(|wrong| wrong.under(&format!("[{at}]")))
            });
        }
        let Some([what, remedy]) = number(node).and_then(|value| self.check(value).err()) else { return Ok(()) };
        Err(Wrong { remedy: Some(remedy), is_listed: false, ..Wrong::new(node, what) })
    }
}

impl Display for Limits {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let space = if self.unit.is_empty() { "" } else { " " };
        write!(f, "{} to {}{space}{}", short(*self.range.start()), short(*self.range.end()), self.unit)
    }
}

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
        // The table of a law that does not exist: the error is about the law.
        let law = known.contains(&"law").then(|| fields.table.get("law")?.get_ref().as_str()).flatten();
        let is_known = |name: &str| known.contains(&present(name)) || Some(name) == law;
        let Some((key, _)) = fields.table.iter().find(|(key, _)| !is_known(key.get_ref())) else {
            return Ok(fields);
        };
        let name = key.get_ref();
        let mut wrong = Wrong::unknown("field", name, known, "this table has").at(key.span());
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
    pub fn read<T: Field>(&self, name: &str, limits: Option<&Limits>) -> Result<Option<T>, Wrong> {
        let Some((key, node)) = self.field(name) else { return Ok(T::absent()) };
        match T::read(node) {
            Ok(value) => within(node, limits).map(|()| Some(value)),
            Err(wrong) => Err(wrong),
        }
        .map_err(|wrong| wrong.under(key))
    }

    fn field(&self, name: &str) -> Option<(&'a str, &'a Node<'a>)> {
        let found = self.table.iter().find(|(key, _)| present(key.get_ref()) == name);
        found.map(|(key, node)| (key.get_ref().as_ref(), node))
    }

    /// Reads the value of a field by `read`; an error carries the field's place.
    ///
    /// # Errors
    /// Those of `read`; also a missing field.
    pub fn of<T>(&self, name: &str, read: impl FnOnce(&Node<'_>) -> Result<T, Wrong>) -> Result<T, Wrong> {
        let Some((key, node)) = self.table.iter().find(|(key, _)| key.get_ref() == name) else {
            return Err(self.missing(name));
        };
        read(node).map_err(|wrong| wrong.under(key.get_ref()))
    }

    /// Whether a field is there.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.table.keys().any(|key| present(key.get_ref()) == name)
    }

    /// Reads a field that must be there.
    ///
    /// # Errors
    /// It is missing, or see [`Field::read`].
    pub fn need<T: Field>(&self, name: &str) -> Result<T, Wrong> {
        self.read(name, None)?.ok_or_else(|| self.missing(name))
    }

    /// Reads the field `kind` and checks that the others are those of this kind.
    ///
    /// # Errors
    /// See [`Field::read`]; also an unknown kind.
    pub fn kind<K: Copy>(
        node: &'a Node<'a>,
        kinds: &[(&'static str, (K, &[&'static str]))],
    ) -> Result<(K, Self), Wrong> {
        let table = Self::any(node)?;
        let Some((key, kind)) = table.table.get_key_value("kind") else { return Err(table.missing("kind")) };
        let (kind, known) = word(kind, kinds).map_err(|wrong| wrong.under(key.get_ref()))?;
        Ok((kind, Self::new(node, known)?))
    }

    /// The error about a table that has none of several fields, or more than one.
    #[must_use]
    pub fn unclear(&self, names: &[&str]) -> Wrong {
        let mut given: Vec<_> = self.table.keys().filter(|key| names.contains(&key.get_ref().as_ref())).collect();
        given.sort_by_key(|key| key.span().start);
        let wrong = match given[..] {
            [first, key, ..] => {
                Wrong::about(format!("`{}` is given, too", first.get_ref())).at(key.span()).under(key.get_ref())
            }
            _ => Wrong::new(self.node, "a field is missing"),
        };
        Wrong { remedy: Some("give exactly one of ".to_owned() + &listed(names)), ..wrong }
    }

    /// The error about a missing field.
    #[must_use]
    pub fn missing(&self, name: &str) -> Wrong {
        Wrong::new(self.node, format!("missing field `{name}`"))
    }
}

fn within(node: &Node<'_>, limits: Option<&Limits>) -> Result<(), Wrong> {
    limits.map_or(Ok(()), |limits| limits.check_node(node))
}

/// Earlier names of fields, each with the present one.
const RENAMED: [(&str, &str); 16] = [
    ("eyes", "sensing"),
    ("claims", "plausibility"),
    ("remember_s", "stands_after_s"),
    // Of behaviours alone.
    ("margin", "margin_m"),
    ("spacing", "spacing_m"),
    ("alpha", "c1_alpha"),
    ("beta", "c1_beta"),
    ("gamma", "c1_gamma"),
    ("min_distance", "min_distance_m"),
    ("neighborhood", "neighborhood_m"),
    ("goal_gain", "k1"),
    ("center_gain", "k2"),
    ("repulsion_gain", "k3"),
    ("speed", "speed_mps"),
    ("crowded", "crowded_m"),
    ("closest", "closest_m"),
];

/// Present name of a field that has another one in older files.
fn present(name: &str) -> &str {
    match name {
        "doubt_mps" => "inflation_mps",
        "doubt_m" => "inflation_m",
        name => name,
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
        Wrong::unknown("value", name, &known, "give one of").at(node.span())
    })
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
