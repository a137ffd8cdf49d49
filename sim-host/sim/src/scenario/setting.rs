//! Settings that replace fields of a scenario file: `radio.loss=0.3`.

use super::{Field, Overrides, Read as _, Scenario, ScenarioError, Source};
use crate::file::{TEXT, read_text};
use std::path::Path;
use std::str::FromStr;

/// A field path with its new value.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    field: Field,
    /// A TOML value; other text is a string, for use in shells.
    value: String,
}

impl FromStr for Setting {
    type Err = String;

    /// Parses `FIELD=VALUE`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("give FIELD=VALUE, as in radio.loss=0.3")?;
        let field = Field::read(name.trim())
            .ok_or_else(|| format!("{name:?} names no field; give one as in radio.loss or plane.group[0].count"))?;
        Ok(Self { field, value: value.trim().to_owned() })
    }
}

impl Scenario {
    /// Like [`Scenario::load`], with settings applied.
    ///
    /// # Errors
    /// See [`Scenario::load`]; also two settings of one field. The place is that of the field in
    /// the file, if it is there.
    pub fn load_with(path: &Path, overrides: &Overrides, settings: &[Setting]) -> Result<Self, ScenarioError> {
        Self::parse_with(&read(path)?, path, overrides, settings)
    }

    /// Like [`Scenario::load_with`], for the text of a file `path` that need not exist.
    ///
    /// # Errors
    /// See [`Scenario::load_with`].
    pub fn parse_with(
        text: &str,
        path: &Path,
        overrides: &Overrides,
        settings: &[Setting],
    ) -> Result<Self, ScenarioError> {
        let mut source = Source::new(path, text)?;
        let ticks = source.get("ticks").filter(|_| !settings.is_empty()).and_then(|node| u32::read(node).ok());
        set(&mut source, settings)?;
        Self::build(source, overrides, ticks.unwrap_or_default()).map_err(|mut error| {
            if let ScenarioError::Field { field, what, .. } = &mut error
                && settings.iter().any(|setting| setting.field.is_about(field))
            {
                what.push_str(" (by --set)");
            }
            error
        })
    }
}

/// Reads a scenario file and applies settings. Without settings, the text is unchanged.
///
/// # Errors
/// The file cannot be read, is not TOML, or has another value where a table of the field should be.
pub fn text_with(path: &Path, settings: &[Setting]) -> Result<String, ScenarioError> {
    let text = read(path)?;
    if settings.is_empty() { Ok(text) } else { with_settings(&text, path, settings) }
}

/// Applies settings to a scenario's text; comments are lost. `path` appears in errors.
///
/// # Errors
/// See [`text_with`].
pub fn with_settings(text: &str, path: &Path, settings: &[Setting]) -> Result<String, ScenarioError> {
    let mut source = Source::new(path, text)?;
    set(&mut source, settings)?;
    Ok(source.written())
}

fn read(path: &Path) -> Result<String, ScenarioError> {
    read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })
}

fn set<'a>(source: &mut Source<'a>, settings: &'a [Setting]) -> Result<(), ScenarioError> {
    for (index, Setting { field, value }) in settings.iter().enumerate() {
        if settings[index + 1..].iter().any(|later| later.field.has(field.name())) {
            return Err(source.error(field.name(), "it is set twice (by --set)", "give one --set of this field"));
        }
        source.set(field, value).map_err(|what| {
            source.error(field.name(), format!("{what} (by --set)"), "name a field as the scenario's file has it")
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
