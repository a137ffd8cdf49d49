//! Settings that replace fields of a scenario file: `radio.loss=0.3`.

use super::law::names_of;
use super::layer::{names_in, section, sections};
use super::{Field, Fields as _, Overrides, Read as _, Scenario, ScenarioError, ScenarioFile, Source};
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

/// Settings of a law and a safety layer by name, before those of `settings`. A setting with the
/// name of a value alone, such as `k1`, is one of the law, or of the layer if only that has it.
///
/// # Errors
/// See [`text_with`]; also a layer of robots without one, or a value that both have.
pub fn named(
    text: &str,
    path: &Path,
    law: Option<&str>,
    layer: Option<&str>,
    settings: Vec<Setting>,
) -> Result<Vec<Setting>, ScenarioError> {
    let source = Source::new(path, text)?;
    let place = if source.has("plane") { "plane" } else { "grid" };
    if layer.is_some() && place == "grid" {
        let (what, remedy) =
            ("robots that move from cell to cell have no safety layer", "give [plane], or leave it out");
        return Err(source.error("safety", format!("{what} (by --set)"), remedy));
    }
    let (law_names, layer_table) = (law.map(names_of), layer.map(layer_table));
    // The reader of files refuses an unknown name, whatever the values are.
    let is_known = law_names != Some(None) && layer_table != Some(None);
    let of_law = law.zip(law_names.flatten());
    let of_layer = layer_table.flatten().flatten();
    let table = |name: &str| {
        let has = |of: &Option<(_, Vec<&str>)>| of.as_ref().is_some_and(|(_, names)| names.contains(&name));
        match (&of_law, &of_layer) {
            (Some((law, _)), Some((table, _))) if has(&of_law) && has(&of_layer) => {
                let paths = [law, table].map(|table| format!("{place}.{table}.{name}")).join(" and ");
                let what = "the law and the safety layer have such a value (by --set)";
                Err(source.error(name, what, format!("give {paths}")))
            }
            (_, Some((table, _))) if has(&of_layer) => Ok(Some(*table)),
            (Some((law, _)), _) => Ok(Some(*law)),
            (None, of_layer) => Ok(of_layer.as_ref().map(|(table, _)| *table)),
        }
    };
    let mut all = Vec::new();
    for (field, name) in [("law", law), ("safety", layer)] {
        let Some(name) = name else { continue };
        all.push(Setting { field: Field::of(&[place, field]), value: format!("\"{name}\"") });
    }
    let top = ScenarioFile::names();
    for mut setting in settings {
        let name = setting.field.name();
        let is_alone = !name.contains(['.', '[']) && !top.contains(&name);
        if is_alone && !is_known {
            continue;
        }
        if is_alone && let Some(table) = table(name)? {
            setting.field = Field::of(&[place, table, name]);
        }
        all.push(setting);
    }
    Ok(all)
}

/// The table of a safety layer, if it has one, with its fields; `None` for an unknown layer.
fn layer_table(name: &str) -> Option<Option<(&'static str, Vec<&'static str>)>> {
    let table = section(name)?;
    Some(sections().contains(&table).then(|| (table, names_in(table))))
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
