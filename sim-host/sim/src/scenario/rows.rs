//! Values of laws and safety layers in files, by the rows of the controller's tables.

use super::ranges::short;
use super::read::{Field as _, Limits, Line, Node, Table, Usual, Wrong};
use super::source::{Checked, Section, Source};
use staya_controller::agent::Contradiction;
use staya_controller::parameters::{Absent, BY_BODY, Parameter, Parameters};
use std::path::Path;
use toml::de::DeValue;

/// Given values by the names of their rows.
pub type Values = [(String, f32)];

/// Calls its argument with each table of a law or a layer.
pub type Tables<'a> = dyn FnMut(&mut dyn FnMut(&mut dyn Parameters)) + 'a;

/// Stores the values that the table has, whatever the others are.
pub(super) fn store(table: &mut dyn Parameters, values: &Values) {
    for (name, value) in values {
        if let Some(index) = table.index(name) {
            let _ = table.store(index, *value, false);
        }
    }
}

/// The first value that is not a whole number although a whole one is stored, with the stored
/// number.
fn rounded(tables: &mut Tables<'_>, values: &Values) -> Option<(&'static str, f32, f32)> {
    /// Gains are rounded to sixteenths, lengths to parts of a cell.
    const FINE: f32 = 0.04;
    let mut found = None;
    tables(&mut |table| {
        for (name, value) in values {
            let Some(index) = table.index(name) else { continue };
            let stored = table.get(index).unwrap_or(*value);
            if value.fract() != 0.0 && stored.fract() == 0.0 && (stored - value).abs() > FINE {
                found = found.or(Some((table.table()[index].name, *value, stored)));
            }
        }
    });
    found
}

/// The rows, each with its default value.
pub(super) fn rows(tables: &mut Tables<'_>) -> Vec<(&'static Parameter, Option<f32>)> {
    let mut rows = Vec::new();
    tables(&mut |table| {
        rows.extend(table.table().iter().enumerate().map(|(index, row)| (row, table.get(index))));
    });
    rows
}

/// Stores given values of a law or a layer, as `name` says, whose table is `section` of the group
/// `at`.
pub(super) fn fill(
    tables: &mut Tables<'_>,
    at: &Section<'_>,
    (section, name): (&str, &str),
    values: &Values,
) -> Checked {
    let is_given = |row: &str| values.iter().any(|(given, _)| given == row);
    let missing = rows(tables).into_iter().find(|(row, _)| row.absent == Absent::Needed && !is_given(row.name));
    if let Some((row, _)) = missing {
        let remedy = format!("give {}, {}, in [{}]", row.name, Limits::of(row), at.field(section));
        return Err(at.error(section, format!("{name} needs `{}`: {}", row.name, row.what), remedy));
    }
    tables(&mut |table| store(table, values));
    if let Some((row, value, stored)) = rounded(tables, values) {
        let remedy = format!("give {stored}, or another whole number");
        return Err(at.error(&format!("{section}.{row}"), format!("{value} is not a whole number"), remedy));
    }
    Ok(())
}

/// The error of values that contradict each other.
pub(super) fn contradicts(at: &Section<'_>, section: &str, wrong: Contradiction) -> super::ScenarioError {
    let remedy = match wrong.least {
        Some(least) => format!("give {} or more, or leave it out", short(least.into())),
        None => wrong.remedy.to_owned(),
    };
    at.error(&format!("{section}.{}", wrong.row), wrong.what, remedy)
}

/// Stores the values of `text`, a table in TOML, in tables, by the rules of scenario files. Returns
/// the names of the values. Rows of `needed` must be given, too.
///
/// # Errors
/// The field, the cause and the remedy; `list` is where all fields are documented.
pub fn store_given(
    text: &str,
    list: &str,
    needed: &[&str],
    tables: &mut Tables<'_>,
) -> Result<Vec<&'static str>, String> {
    let mut rows: Vec<&'static Parameter> = Vec::new();
    tables(&mut |table| rows.extend(table.table()));
    let names: Vec<_> = rows.iter().map(|row| row.name).collect();
    let source = Source::new(Path::new(""), text).map_err(|error| error.without_place())?;
    let values =
        source.read_by(|node| read(&Table::new(node, &names)?, &rows), list).map_err(|error| error.without_place())?;
    let (given, others): (Vec<_>, Vec<_>) =
        rows.into_iter().partition(|row| values.iter().any(|(name, _)| name == row.name));
    let is_needed = |row: &&&Parameter| row.absent == Absent::Needed || needed.contains(&row.name);
    if let Some(row) = others.iter().find(is_needed) {
        return Err(format!("missing `{}`: {}; give {}", row.name, row.what, Limits::of(row)));
    }
    tables(&mut |table| store(table, &values));
    match rounded(tables, &values) {
        None => Ok(given.into_iter().map(|row| row.name).collect()),
        Some((row, value, stored)) => {
            Err(format!("{row}: {value} is not a whole number; give {stored}, or another whole number"))
        }
    }
}

/// Reads the values of a table of a file that has these rows.
pub(super) fn read(table: &Table<'_>, rows: &[&'static Parameter]) -> Result<Vec<(String, f32)>, Wrong> {
    let value = |row: &&'static Parameter| Ok(value(table, row)?.map(|value| (row.name.to_owned(), value)));
    rows.iter().filter_map(|row| value(row).transpose()).collect()
}

fn value(table: &Table<'_>, row: &Parameter) -> Result<Option<f32>, Wrong> {
    if row.is_switch() {
        return Ok(table.read::<bool>(row.name, None)?.map(|is| f32::from(u8::from(is))));
    }
    if row.words.is_empty() {
        return Ok(table.read::<f64>(row.name, Some(&Limits::of(row)))?.map(|value| value as f32));
    }
    let Some(Word(word)) = table.read::<Word>(row.name, None)? else { return Ok(None) };
    match row.words.iter().position(|known| *known == word) {
        Some(index) => Ok(Some(index as f32)),
        None => {
            let known: Vec<_> = row.words.iter().map(|word| (*word, ())).collect();
            table.of(row.name, |node| super::word(node, &known)).map(|_| None)
        }
    }
}

/// A name in quotes.
pub(super) struct Word(pub String);

impl super::Read for Word {
    const KIND: &'static str = "a name in quotes";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::String(text) => Ok(Self(text.clone().into_owned())),
            _ => Err(Wrong::not(node, Self::KIND)),
        }
    }
}

/// The documentation of the rows of tables, with the values of the tables as defaults, also of rows
/// that in a run depend on the body.
pub fn lines_of(tables: &mut Tables<'_>) -> Vec<Line> {
    let mut all = Vec::new();
    tables(&mut |table| {
        for (index, row) in table.table().iter().enumerate() {
            let mut line = line(row, table.get(index));
            let of_body = matches!(row.absent, Absent::OfBody(_) | Absent::Depends(BY_BODY));
            if let Some(value) = table.get(index).filter(|_| of_body) {
                line.default = Usual::Value(value.to_string());
            }
            all.push(line);
        }
    });
    all
}

/// The documentation of a row.
pub(super) fn line(row: &'static Parameter, default: Option<f32>) -> Line {
    let (kind, limits, reads): (_, _, fn(&Node<'_>) -> _) = match (row.is_switch(), row.words.is_empty()) {
        (true, _) => (bool::KIND, None, |node| bool::read(node).map(drop)),
        (_, true) => (f64::KIND, Some(Limits::of(row)), |node| f64::read(node).map(drop)),
        _ => (Word::KIND, None, |node| Word::read(node).map(drop)),
    };
    let shown = |value: f32| match row.words.get(value as usize) {
        Some(word) if row.is_switch() => (*word).to_owned(),
        Some(word) => format!("\"{word}\""),
        None => value.to_string(),
    };
    let default = match row.absent {
        Absent::Default => default.map_or(Usual::None, |value| Usual::Value(shown(value))),
        Absent::Depends(on) => Usual::Words(on.into()),
        Absent::OfBody(name) => Usual::Words(format!("that of the body, `{name}`").into()),
        Absent::Needed => Usual::None,
    };
    let words = if row.is_switch() { Vec::new() } else { row.words.to_vec() };
    Line { name: row.name, doc: row.what.into(), kind, limits, words, default, reads, inner: Vec::new() }
}

/// The documentation of a field with a name in quotes, or of a table.
pub(super) fn heading(name: &'static str, doc: &'static str, inner: Vec<Line>) -> Line {
    let (kind, reads): (_, fn(&Node<'_>) -> _) = match inner.is_empty() {
        true => (Word::KIND, |node| Word::read(node).map(drop)),
        false => ("a table", |node| Table::any(node).map(drop)),
    };
    Line { name, doc: doc.into(), kind, limits: None, words: Vec::new(), default: Usual::None, reads, inner }
}
