//! `safety = "NAME"` of a group of robots, and the tables with the values of safety layers beside
//! it.

use super::read::{Line, Table, Usual, Wrong};
use super::rows::{Word, contradicts, fill, heading, line, read, rows};
use super::source::{Checked, Section};
use super::table::Fields;
use crate::shown::Shown as _;
use crate::voxel::{ModelError, NeighborModel};
use crate::{defaults, table};
use staya_controller::agent::{Around, LayerSettings, OrcaSettings, Settings as _};
use staya_controller::parameters::Parameter;
use std::path::PathBuf;

table! {
    /// Fields of `[plane.orca]` beside the values of the layer.
    pub struct OrcaTable {
        /// File of a functional voxel model that replaces the formula (`staya voxel build
        /// neighbor`). Default: none.
        pub model: Option<PathBuf>;
        /// Silence until a lost robot stands even if most are lost. Default: 60.
        pub stands_after_s: Option<f64>, 0.0..=600.0, "seconds";
        /// How long a robot stands and listens after its start. Default: six steps, delays.
        pub listen_s: Option<f64>, 0.0..=600.0, "seconds";
        /// Whether a robot that has heard none stands. Default: if one starts within range.
        pub expects_others: Option<bool>;
        /// Speed of a robot that has lost all others; `inf`: unchanged. Default: 0.
        pub alone_mps: Option<f64>, 0.0..=f64::INFINITY, "m/s";
    }
}

defaults!(OrcaTable);

/// `safety` and the tables of safety layers among the fields of a group.
#[derive(Clone, Debug, Default)]
pub struct LayerPart {
    /// The name, if it is given.
    name: Option<String>,
    /// The tables that are given, with their values.
    tables: Vec<(&'static str, Vec<(String, f32)>)>,
    /// Fields of ORCA's table beside the values.
    pub beside: OrcaTable,
}

fn all() -> impl Iterator<Item = LayerSettings> {
    LayerSettings::ALL.iter().filter_map(|(name, _)| LayerSettings::by_name(name))
}

/// The names of all tables of layers.
pub(super) fn sections() -> Vec<&'static str> {
    let mut sections: Vec<_> = all().filter(|layer| !rows_of(*layer).is_empty()).map(|layer| layer.section()).collect();
    sections.dedup();
    sections
}

/// The table of the layer with this name.
pub(super) fn section(name: &str) -> Option<&'static str> {
    Some(LayerSettings::by_name(name)?.section())
}

fn rows_of(mut layer: LayerSettings) -> Vec<(&'static Parameter, Option<f32>)> {
    rows(&mut |visit| layer.tables(visit))
}

/// The rows of all layers with this table, each once.
fn rows_in(section: &str) -> Vec<(&'static Parameter, Option<f32>)> {
    let mut rows: Vec<(&'static Parameter, Option<f32>)> = Vec::new();
    for (row, value) in all().filter(|layer| layer.section() == section).flat_map(rows_of) {
        if rows.iter().all(|(known, _)| known.name != row.name) {
            rows.push((row, value));
        }
    }
    rows
}

/// The names of all fields of a table of layers.
pub(super) fn names_in(section: &str) -> Vec<&'static str> {
    let rows = rows_in(section).into_iter().map(|(row, _)| row.name);
    let beside = if section == OrcaSettings::SECTION { OrcaTable::names() } else { Vec::new() };
    rows.chain(beside).collect()
}

impl LayerPart {
    /// The layer with its defaults; ORCA if none is named.
    pub(super) fn kind(&self) -> LayerSettings {
        let named = self.name.as_deref().and_then(LayerSettings::by_name);
        // A name that no layer has was refused when it was read.
        named.unwrap_or_else(|| LayerSettings::Orca(OrcaSettings::default()))
    }

    /// A given value.
    pub(super) fn get(&self, row: &str) -> Option<f32> {
        self.tables.iter().flat_map(|(_, values)| values).find(|(name, _)| name == row).map(|(_, value)| *value)
    }

    /// The layer, with the values of the file and those that depend on others.
    pub(super) fn build(&self, at: &Section<'_>, around: &Around) -> Checked<LayerSettings> {
        let mut layer = self.kind();
        let (name, section) = (layer.name(), layer.section());
        if let Some((given, _)) = self.tables.iter().find(|(given, _)| *given != section) {
            let remedy = format!("give {}.safety = \"{given}\", or leave this table out", at.path);
            return Err(at.error(given, format!("these robots have the safety layer \"{name}\""), remedy));
        }
        let values = self.tables.first().map_or(&[][..], |(_, values)| values);
        let is_row = |row: &str, layer: LayerSettings| rows_of(layer).iter().any(|(known, _)| known.name == row);
        if let Some((row, _)) = values.iter().find(|(row, _)| !is_row(row, layer)) {
            let other = all().find(|other| other.section() == section && is_row(row, *other));
            let remedy = match other {
                Some(other) => format!("give safety = \"{}\", or leave it out", other.name()),
                None => "leave it out".to_owned(),
            };
            return Err(at.error(
                &format!("{section}.{row}"),
                format!("the layer \"{name}\" has no such value"),
                remedy,
            ));
        }
        fill(&mut |visit| layer.tables(visit), at, (section, &format!("the layer \"{name}\"")), values)?;
        layer.adapt(&|row| self.get(row).is_some(), around).map_err(|wrong| contradicts(at, section, wrong))?;
        Ok(layer)
    }
}

impl LayerPart {
    /// The model that replaces the formula of `layer`, if a file is given.
    pub(super) fn half_planes(&self, at: &Section<'_>, layer: LayerSettings) -> Checked<Option<NeighborModel>> {
        let Some(name) = &self.beside.model else { return Ok(None) };
        let field = "orca.model";
        let has_formula = matches!(layer, LayerSettings::Orca(_) | LayerSettings::Fly(_));
        let what = format!("the layer \"{}\" has its own table", layer.name());
        at.require(has_formula, field, what, "give safety = \"orca\" or \"fly\", or leave it out")?;
        let path = at.source.file(name);
        let read = NeighborModel::read(&path).map_err(|error| {
            let remedy = match error {
                ModelError::Read(_) => "file names are relative to the scenario file",
                _ => "give a file of `staya voxel build neighbor`",
            };
            at.error(field, format!("{}: {error}", path.shown()), remedy)
        });
        read.map(Some)
    }
}

impl Fields for LayerPart {
    fn names() -> Vec<&'static str> {
        ["safety"].into_iter().chain(sections()).collect()
    }

    fn fields(table: &Table<'_>) -> Result<Self, Wrong> {
        let name = table.read::<Word>("safety", None)?.map(|Word(name)| name);
        if let Some(name) = &name
            && LayerSettings::by_name(name).is_none()
        {
            let known: Vec<_> = LayerSettings::ALL.iter().map(|(name, _)| (*name, ())).collect();
            return table.of("safety", |node| super::word(node, &known)).map(|()| Self::default());
        }
        let (mut tables, mut beside) = (Vec::new(), OrcaTable::default());
        for section in sections().into_iter().filter(|section| table.has(section)) {
            let rows: Vec<_> = rows_in(section).into_iter().map(|(row, _)| row).collect();
            let values = table.of(section, |node| {
                let table = Table::new(node, &names_in(section))?;
                if section == OrcaSettings::SECTION {
                    beside = OrcaTable::fields(&table)?;
                }
                read(&table, &rows)
            })?;
            tables.push((section, values));
        }
        Ok(Self { name, tables, beside })
    }

    fn part_lines() -> Vec<Line> {
        let usual = Usual::Value(format!("\"{}\"", OrcaSettings::NAME));
        let words = LayerSettings::ALL.iter().map(|(name, _)| *name).collect();
        let name =
            Line { words, default: usual, ..heading("safety", "The safety layer of the robots, by name.", Vec::new()) };
        let tables = sections().into_iter().map(|section| {
            let rows = rows_in(section).into_iter();
            let mut inner: Vec<_> = rows.map(|(row, default)| line(row, default)).collect();
            if section == OrcaSettings::SECTION {
                inner.extend(OrcaTable::part_lines());
            }
            let what = LayerSettings::ALL.iter().find(|(name, _)| *name == section).map_or("", |(_, what)| what);
            heading(section, what, inner)
        });
        [name].into_iter().chain(tables).collect()
    }
}
