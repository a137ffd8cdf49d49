//! What a plan's file may say: every field, as docs/sweeps.md explains them.

use crate::sweep::sample::Kind;
use serde::Deserialize;
use std::path::PathBuf;

/// A whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    /// Name of the plan; its results go to `out/<name>`. Letters, digits, `-` and `_`.
    pub name: String,
    /// The scenario, relative to the plan's file.
    pub scenario: PathBuf,
    /// How many seeds (1, 2, ...), a list of them, or `{ from, count }`. Default: the scenario's own.
    pub seeds: Option<Seeds>,
    /// Figures of `summary.json` to keep. Default: all but what robots waited for.
    pub measures: Option<Vec<String>>,
    /// Fields with one value for all runs.
    #[serde(default)]
    pub set: toml::Table,
    /// Fields with several values, crossed with each other: the last one changes first.
    #[serde(default)]
    pub axes: toml::Table,
    /// Fields whose values advance together, crossed with the rest.
    #[serde(default)]
    pub zip: Vec<toml::Table>,
    /// Fields with random values, crossed with the rest.
    #[serde(default)]
    pub sample: Vec<SampleTable>,
    /// Pictures of figures. Default: each chosen figure over the first axes.
    #[serde(default)]
    pub plot: Vec<PlotTable>,
}

/// `seeds`.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "invalid seeds, expected a number, a list of numbers, or { from, count }")]
pub enum Seeds {
    /// 1 to so many.
    Count(u32),
    /// These.
    List(Vec<u64>),
    /// So many from one on.
    Range(SeedRange),
}

/// `seeds = { from, count }`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeedRange {
    /// The first.
    pub from: u64,
    /// How many.
    pub count: u32,
}

/// `{ from, to, ... }`: an axis by its ends.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeTable {
    /// The first value.
    pub from: f64,
    /// The last one, or with `step` the most that one may be.
    pub to: f64,
    /// How many; not in a sample.
    pub count: Option<u32>,
    /// From one to the next, instead of `count`.
    pub step: Option<f64>,
    /// Equal ratios instead of equal distances. Default: false.
    #[serde(default)]
    pub log: bool,
    /// Rounded to whole numbers, each once. Default: false.
    #[serde(default)]
    pub whole: bool,
}

/// `[[sample]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleTable {
    /// `"random"` or `"latin_hypercube"`.
    pub kind: Kind,
    /// How many.
    pub count: u32,
    /// Seed of the sample, which has nothing to do with those of the runs. Default: 0.
    #[serde(default)]
    pub seed: u64,
    /// From where to where, or of which values.
    pub axes: toml::Table,
}

/// `[[plot]]`: a figure over one axis, or over two.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlotTable {
    /// A figure that the plan measures.
    pub figure: String,
    /// The axis from left to right.
    pub over: String,
    /// The second axis: curves if it has a few values, else a map.
    pub and: Option<String>,
}
