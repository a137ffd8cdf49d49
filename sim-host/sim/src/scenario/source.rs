//! TOML text of a scenario or another settings file, and errors that point into it.

use super::de;
use super::read::{Field, Node};
use crate::file::read_remedy;
use serde::Deserialize;
use std::cell::RefCell;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Why a scenario or another settings file was refused.
#[derive(Debug, Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("{}: {source}; {}", .path.display(), read_remedy(.source))]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Cause, as reported by the system.
        source: std::io::Error,
    },
    /// The content is invalid.
    #[error("{}:{line}: {}{what}; {remedy}", .path.display(), prefix(.field))]
    Field {
        /// Path of the file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Path of the field, such as `radio.loss` or `robots.list[2].start`; empty if unknown.
        field: String,
        /// Cause of the error.
        what: String,
        /// How to correct it.
        remedy: String,
    },
}

fn prefix(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!("{field}: ") }
}

/// Text of a settings file and the position of each field in it.
#[derive(Debug)]
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
            Err(error) => Err(ScenarioError::Field {
                path: path.to_owned(),
                line: line_of(text, error.span()),
                field: String::new(),
                what: first_line(error.message()),
                remedy: "this is not TOML; strings need quotes, tables [brackets]".to_owned(),
            }),
        }
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

    /// The whole text.
    #[must_use]
    pub fn text(&self) -> &'a str {
        self.text
    }

    /// Creates an error about a field. If the field is absent, the line is that of its table.
    pub fn error(&self, field: &str, what: impl Into<String>, remedy: impl Into<String>) -> ScenarioError {
        ScenarioError::Field {
            path: self.path.to_owned(),
            line: line_of(self.text, self.span(field)),
            field: field.to_owned(),
            what: what.into(),
            remedy: remedy.into(),
        }
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
            line: line_of(self.text, Some(span)),
            field: field.to_owned(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// The parsed fields with their positions.
    #[must_use]
    pub fn root(&self) -> &DeTable<'a> {
        self.root.get_ref().as_table().expect("a file is a table")
    }

    /// Reads the whole file as a table of [`table!`](crate::table!); `list` is the page that
    /// documents all fields.
    ///
    /// # Errors
    /// A field is unknown, missing, of another type, or out of range.
    pub fn table<T: Field>(&self, list: &str) -> Result<T, ScenarioError> {
        T::read(&self.root).map_err(|wrong| {
            let remedy = match wrong.remedy {
                Some(remedy) if wrong.is_listed => format!("{remedy} ({list} lists all fields)"),
                Some(remedy) => remedy,
                None => format!("{list} lists all fields with their units"),
            };
            self.error_at(wrong.span, &wrong.path, wrong.what, remedy)
        })
    }

    /// Deserializes the whole file; `list` is the page that documents all fields.
    ///
    /// # Errors
    /// A field is unknown, missing, or of another type; the error names file, line and field.
    pub fn read<'s, T: Deserialize<'s>>(&'s self, list: &str) -> Result<T, ScenarioError> {
        de::read(&self.root).map_err(|error| self.serde_error(&error, list))
    }

    fn serde_error(&self, error: &de::Error, list: &str) -> ScenarioError {
        let span = error.span.clone();
        let mut field = String::new();
        // The span of the whole file is empty.
        if let Some(span) = span.as_ref().filter(|span| !span.is_empty()) {
            deepest(self.root(), span, &mut field);
        }
        ScenarioError::Field {
            path: self.path.to_owned(),
            line: line_of(self.text, span),
            field,
            what: first_line(&error.message),
            remedy: match &error.remedy {
                Some(remedy) => format!("{remedy} ({list} lists all fields)"),
                None => format!("{list} lists all fields with their units"),
            },
        }
    }

    /// Whether the file has this field or table at its top level.
    pub fn has(&self, name: &str) -> bool {
        self.root().get(name).is_some()
    }

    /// Whether the file has this field.
    pub fn stands(&self, field: &str) -> bool {
        let mut at = Some(self.root());
        let mut segments = field.split('.').peekable();
        while let Some(segment) = segments.next() {
            let mut parts = segment.split(['[', ']']).filter(|part| !part.is_empty());
            let mut value = at.and_then(|table| table.get(parts.next()?)).map(Spanned::get_ref);
            for index in parts {
                value = match (value, index.parse::<usize>()) {
                    (Some(DeValue::Array(array)), Ok(index)) => array.get(index).map(Spanned::get_ref),
                    _ => None,
                };
            }
            match (value, segments.peek()) {
                (Some(_), None) => return true,
                (Some(DeValue::Table(inner)), Some(_)) => at = Some(inner),
                _ => return false,
            }
        }
        false
    }

    fn span(&self, field: &str) -> Option<Range<usize>> {
        let mut span = None;
        let mut table = self.root();
        for segment in field.split('.') {
            let mut parts = segment.split(['[', ']']).filter(|part| !part.is_empty());
            let Some(entry) = parts.next().and_then(|name| table.get(name)) else {
                return span;
            };
            let mut value = entry;
            span = Some(value.span());
            for index in parts {
                let element = match (value.get_ref(), index.parse::<usize>()) {
                    (DeValue::Array(array), Ok(index)) => array.get(index),
                    _ => None,
                };
                let Some(element) = element else { return span };
                value = element;
                span = Some(value.span());
            }
            match value.get_ref() {
                DeValue::Table(inner) => table = inner,
                _ => return span,
            }
        }
        span
    }
}

fn deepest(table: &DeTable<'_>, span: &Range<usize>, field: &mut String) {
    for (key, value) in table {
        if holds(&key.span(), span) || holds(&value.span(), span) {
            if !field.is_empty() {
                field.push('.');
            }
            field.push_str(key.get_ref());
            deepest_value(value.get_ref(), span, field);
            return;
        }
        // The span of a `[table]` header does not cover the lines below it.
        let tables = match value.get_ref() {
            DeValue::Table(inner) => vec![(String::new(), inner)],
            DeValue::Array(array) => array
                .iter()
                .enumerate()
                .filter_map(|(index, element)| match element.get_ref() {
                    DeValue::Table(inner) => Some((format!("[{index}]"), inner)),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        };
        for (index, inner) in tables {
            let mut below = String::new();
            deepest(inner, span, &mut below);
            if !below.is_empty() {
                if !field.is_empty() {
                    field.push('.');
                }
                field.push_str(&format!("{}{index}.{below}", key.get_ref()));
                return;
            }
        }
    }
}

fn deepest_value(value: &DeValue<'_>, span: &Range<usize>, field: &mut String) {
    match value {
        DeValue::Table(inner) => deepest(inner, span, field),
        DeValue::Array(array) => {
            let found = array.iter().enumerate().find(|(_, e)| holds(&e.span(), span));
            if let Some((index, element)) = found {
                field.push_str(&format!("[{index}]"));
                deepest_value(element.get_ref(), span, field);
            }
        }
        _ => {}
    }
}

fn holds(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

fn line_of(text: &str, span: Option<Range<usize>>) -> usize {
    let start = span.map_or(0, |span| span.start);
    1 + text.bytes().take(start).filter(|&byte| byte == b'\n').count()
}

fn first_line(message: &str) -> String {
    message.lines().next().unwrap_or_default().to_owned()
}
