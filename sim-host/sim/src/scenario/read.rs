//! Reads the values of a settings file without serde. An error carries the place of the value.
//! [`table!`](crate::table!) and its relatives define types that are read this way.

mod fields;
mod values;

pub use fields::Table;
use values::number;

use staya_controller::parameters::Parameter;
use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::ops::{Range, RangeInclusive};
use toml::Spanned;
use toml::de::DeValue;

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

/// A table that is allowed and read by other means: [`Source::get`](super::Source::get).
#[derive(Clone, Copy, Debug, Default)]
pub struct AnyTable;

impl Field for AnyTable {
    const KIND: &'static str = "a table";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        Table::any(node).map(|_| Self)
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
