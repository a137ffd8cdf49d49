//! TOML text of a scenario or another settings file, and errors that point into it.

use super::read::{Field as Read, Limits, Node, Wrong, json};
use super::{Field, write};
use crate::file::read_remedy;
use crate::shown::{Shown as _, one_line};
use std::cell::RefCell;
use std::fmt::{self, Display, Formatter};
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Why a scenario or another settings file was refused.
#[derive(Debug, Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("{}: {source}; {}", .path.shown(), read_remedy(.source))]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Cause, as reported by the system.
        source: std::io::Error,
    },
    /// The content is invalid.
    #[error("{}:{place}: {}{}; {}", .path.shown(), one_line(&prefix(.field)), one_line(.what), one_line(.remedy))]
    Field {
        /// Path of the file.
        path: PathBuf,
        /// Place in the file.
        place: Location,
        /// Path of the field, such as `radio.loss` or `robots.list[2].start`; empty if unknown.
        field: String,
        /// Cause of the error.
        what: String,
        /// How to correct it.
        remedy: String,
    },
}

impl ScenarioError {
    /// The error of a value that is in no file: field, cause and remedy.
    #[must_use]
    pub fn without_place(&self) -> String {
        match self {
            Self::Io { .. } => self.to_string(),
            Self::Field { field, what, remedy, .. } => {
                format!("{}{}; {}", one_line(&prefix(field)), one_line(what), one_line(remedy))
            }
        }
    }
}

/// Result of a check.
pub(super) type Checked<T = ()> = Result<T, ScenarioError>;

/// Place in a text. Both are counted from 1; columns are characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Location {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

impl Location {
    /// Begin of a text.
    pub const START: Self = Self { line: 1, column: 1 };

    fn of(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        Self { line: 1 + before.matches('\n').count(), column }
    }
}

impl Display for Location {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

fn prefix(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!("{field}: ") }
}

/// Text of a settings file and the position of each field in it.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    path: &'a Path,
    text: &'a str,
    root: Node<'a>,
    files: RefCell<Vec<PathBuf>>,
}

impl<'a> Source<'a> {
    /// Parses the TOML syntax; the meaning of fields is not checked.
    pub fn new(path: &'a Path, text: &'a str) -> Result<Self, ScenarioError> {
        match DeTable::parse(text) {
            Ok(root) => {
                let root = Spanned::new(root.span(), DeValue::Table(root.into_inner()));
                Ok(Self { path, text, root, files: vec![path.to_owned()].into() })
            }
            Err(error) => {
                let span = error.span().unwrap_or_default();
                let twice = if error.message().starts_with("duplicate key") { twice(text, &span) } else { None };
                let [what, remedy] = twice.unwrap_or_else(|| {
                    let remedy = "this is not TOML; strings need quotes, tables [brackets]";
                    [first_line(error.message()), remedy.to_owned()]
                });
                let place = Location::of(text, span.start);
                Err(ScenarioError::Field { path: path.to_owned(), place, field: String::new(), what, remedy })
            }
        }
    }

    /// Path of the text.
    #[must_use]
    pub const fn path(&self) -> &'a Path {
        self.path
    }

    /// Path of a file that the text names, relative to the folder of the text. Adds it to
    /// [`files`](Self::files).
    #[must_use]
    pub fn file(&self, name: &Path) -> PathBuf {
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        self.reads([path.clone()]);
        path
    }

    /// Adds files to [`files`](Self::files).
    pub fn reads(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.files.borrow_mut().extend(files);
    }

    /// Removes and returns the files that the settings were read from, with that of the text.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        self.files.take()
    }

    /// Creates an error about a field. If the field is absent, the place is that of its table.
    pub fn error(&self, field: &str, what: impl Into<String>, remedy: impl Into<String>) -> ScenarioError {
        self.error_at(self.find(field).0.map_or(0..0, Spanned::span), field, what, remedy)
    }

    /// The whole text as a table.
    pub(super) const fn whole(&self) -> Section<'_> {
        Section { source: self, path: String::new() }
    }

    /// Creates an error about a range of bytes in the text.
    pub fn error_at(
        &self,
        span: Range<usize>,
        field: &str,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ScenarioError {
        ScenarioError::Field {
            path: self.path.to_owned(),
            place: self.location(span.start),
            field: field.to_owned(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// The place of a byte of the text.
    #[must_use]
    pub fn location(&self, byte: usize) -> Location {
        Location::of(self.text, byte)
    }

    /// The parsed fields with their positions.
    #[must_use]
    pub fn root(&self) -> &DeTable<'a> {
        self.root.get_ref().as_table().expect("a file is a table")
    }

    /// The fields as JSON; numbers that JSON lacks are null.
    pub(super) fn json(&self) -> serde_json::Value {
        json(self.root.get_ref())
    }

    pub(super) fn root_mut(&mut self) -> &mut DeTable<'a> {
        match self.root.get_mut() {
            DeValue::Table(table) => table,
            _ => unreachable!("a file is a table"),
        }
    }

    /// Reads the whole file as a table of [`table!`](crate::table!); `list` is the page that
    /// documents all fields.
    ///
    /// # Errors
    /// A field is unknown, missing, of another type, or out of range.
    pub fn read<T: Read>(&self, list: &str) -> Result<T, ScenarioError> {
        self.read_by(T::read, list)
    }

    /// Like [`read`](Self::read), by a function.
    pub(super) fn read_by<T>(
        &self,
        read: impl FnOnce(&Node<'_>) -> Result<T, Wrong>,
        list: &str,
    ) -> Result<T, ScenarioError> {
        read(&self.root).map_err(|wrong| self.refuse(wrong, list))
    }

    /// Reads a table of the file, which may be absent, like [`read`](Self::read).
    ///
    /// # Errors
    /// See [`read`](Self::read).
    pub fn read_table<T: Read>(&self, name: &str, list: &str) -> Result<T, ScenarioError> {
        let read = match self.root().get(name) {
            Some(node) => T::read(node),
            None => T::read(&Spanned::new(0..0, DeValue::Table(DeTable::new()))),
        };
        read.map_err(|wrong| self.refuse(wrong.under(name), list))
    }

    fn refuse(&self, wrong: Wrong, list: &str) -> ScenarioError {
        let remedy = match wrong.remedy {
            Some(remedy) if wrong.is_listed => format!("{remedy} ({list} lists all fields)"),
            Some(remedy) => remedy,
            None => format!("{list} lists all fields with their units"),
        };
        self.error_at(wrong.span.unwrap_or_default(), &wrong.path, first_line(&wrong.what), remedy)
    }

    /// Sets a field and creates missing tables. `value` is a TOML value; other text is a string.
    /// Its place is that of the replaced value or else of the table.
    ///
    /// # Errors
    /// Says what is in the way.
    pub fn set(&mut self, field: &Field, value: &'a str) -> Result<(), String> {
        let parsed = DeValue::parse(value).map(Spanned::into_inner);
        field.set(&mut self.root, parsed.unwrap_or_else(|_| DeValue::String(value.into())))
    }

    /// The value of a field, if it is there.
    #[must_use]
    pub fn get(&self, field: &str) -> Option<&Node<'a>> {
        let (deepest, is_field) = self.find(field);
        deepest.filter(|_| is_field)
    }

    /// Whether this field or table is there.
    #[must_use]
    pub fn has(&self, field: &str) -> bool {
        self.get(field).is_some()
    }

    /// The fields as TOML text.
    #[must_use]
    pub fn written(&self) -> String {
        write::file(self.root())
    }

    /// The deepest value on the path of a field, and whether it is the field itself.
    fn find(&self, field: &str) -> (Option<&Node<'a>>, bool) {
        let (mut node, mut found) = (&self.root, None);
        for step in field.split(['.', '[', ']']).filter(|step| !step.is_empty()) {
            let next = match node.get_ref() {
                DeValue::Table(table) => table.get(step),
                DeValue::Array(list) => step.parse::<usize>().ok().and_then(|index| list.get(index)),
                _ => None,
            };
            let Some(next) = next else { return (found, false) };
            (node, found) = (next, Some(next));
        }
        (found, found.is_some())
    }
}

/// A table in the text, for errors about its fields.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    pub source: &'a Source<'a>,
    /// Path of the table.
    pub path: String,
}

impl Section<'_> {
    /// Path of a field of the table.
    pub fn field(&self, name: &str) -> String {
        let dot = if self.path.is_empty() || name.starts_with('[') { "" } else { "." };
        format!("{}{dot}{name}", self.path)
    }

    /// A table in the table.
    pub fn at(&self, name: impl AsRef<str>) -> Self {
        Self { source: self.source, path: self.field(name.as_ref()) }
    }

    /// Whether a field is there.
    pub fn has(&self, name: &str) -> bool {
        self.source.has(&self.field(name))
    }

    /// Creates an error about the table itself; see [`Source::error`].
    pub fn unfit(&self, what: impl Into<String>, remedy: impl Into<String>) -> ScenarioError {
        self.source.error(&self.path, what, remedy)
    }

    /// Creates an error about a field; see [`Source::error`].
    pub fn error(&self, name: &str, what: impl Into<String>, remedy: impl Into<String>) -> ScenarioError {
        self.source.error(&self.field(name), what, remedy)
    }

    /// Refuses a field unless `holds`.
    pub fn require(&self, holds: bool, name: &str, what: impl Into<String>, remedy: impl Into<String>) -> Checked {
        if holds { Ok(()) } else { Err(self.error(name, what, remedy)) }
    }

    /// Refuses the value of a field if it is out of range.
    pub fn limit(&self, name: &str, value: f64, limits: &Limits) -> Checked {
        limits.check(value).map_err(|[what, remedy]| self.error(name, what, remedy))
    }

    /// Like [`limit`](Self::limit), for a range that depends on other fields.
    pub fn within(&self, name: &str, value: f64, range: RangeInclusive<f64>, unit: &'static str) -> Checked {
        self.limit(name, value, &Limits::new(range, unit))
    }
}

/// Cause and remedy for a key or table at `span` that the text has before, too.
fn twice(text: &str, span: &Range<usize>) -> Option<[String; 2]> {
    /// A key that stands where the second one does.
    const HERE: &str = "staya-looks-here";
    let (before, name) = (text.get(..span.start)?, text.get(span.clone())?);
    let (above, line) = before.rsplit_once('\n').unwrap_or(("", before));
    let first = if line.trim_start().starts_with('[') {
        let header = text.get(before.len() - line.len()..)?.lines().next()?;
        let path = header.trim().trim_start_matches('[').split(']').next()?;
        let root = Spanned::new(0..0, DeValue::Table(DeTable::parse(above).ok()?.into_inner()));
        let (tables, last) = path.rsplit_once('.').unwrap_or(("", path));
        let table = tables.split('.').filter(|step| !step.is_empty()).try_fold(&root, |node, step| {
            let next = node.get_ref().as_table()?.get(step.trim())?;
            next.get_ref().as_array().map_or(Some(next), |list| list.iter().next_back())
        })?;
        table.get_ref().as_table()?.get_key_value(last.trim()).map(|(key, _)| key.span())
    } else {
        // Only inline tables are open at that place.
        ["", "}", "}]", "}}", "}]}", "}}}"].into_iter().find_map(|end| {
            let begun = format!("{before}{HERE} = 0{end}");
            let root = DeTable::parse(&begun).ok()?.into_inner();
            beside(&root, HERE, name.trim_matches(['"', '\'']))
        })
    }?;
    let [first, second] = [first.start, span.start].map(|byte| Location::of(text, byte).line);
    let lines = if first == second { format!("in line {first}") } else { format!("in lines {first} and {second}") };
    Some([format!("`{name}` is given twice, {lines}"), "keep one of them".to_owned()])
}

/// Place of the key `name` in the table that has the key `here`.
fn beside(table: &DeTable<'_>, here: &str, name: &str) -> Option<Range<usize>> {
    if table.contains_key(here) {
        return table.get_key_value(name).map(|(key, _)| key.span());
    }
    table.values().find_map(|value| inside(value, here, name))
}

fn inside(value: &Node<'_>, here: &str, name: &str) -> Option<Range<usize>> {
    match value.get_ref() {
        DeValue::Table(table) => beside(table, here, name),
        DeValue::Array(list) => list.iter().find_map(|value| inside(value, here, name)),
        _ => None,
    }
}

fn first_line(message: &str) -> String {
    message.lines().next().unwrap_or_default().to_owned()
}
