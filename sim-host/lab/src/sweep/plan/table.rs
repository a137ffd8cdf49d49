//! Structure of a plan's file; docs/sweeps.md explains every field.

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
    /// A number of seeds (1, 2, ...), a list of them, or `{ from, count }`. Default: the scenario's
    /// own.
    pub seeds: Option<Seeds>,
    /// Figures of `summary.json` to record. Default: all except the reasons for waiting.
    pub measures: Option<Vec<String>>,
    /// Fields with one value for all runs.
    #[serde(default)]
    pub set: toml::Table,
    /// Fields with several values, crossed with each other; the last one changes first.
    #[serde(default)]
    pub axes: toml::Table,
    /// Fields whose values advance together, crossed with the rest.
    #[serde(default)]
    pub zip: Vec<toml::Table>,
    /// Fields with random values, crossed with the rest.
    #[serde(default)]
    pub sample: Vec<SampleTable>,
    /// Pictures of figures. Default: each recorded figure over the first axes.
    #[serde(default)]
    pub plot: Vec<PlotTable>,
}

/// `seeds`.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "invalid seeds, expected a number, a list of numbers, or { from, count }")]
pub enum Seeds {
    /// Seeds 1 to this number.
    Count(u32),
    /// Listed seeds.
    List(Vec<u64>),
    /// Consecutive seeds.
    Range(SeedRange),
}

/// `seeds = { from, count }`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeedRange {
    /// The first seed.
    pub from: u64,
    /// Number of seeds.
    pub count: u32,
}

/// `{ from, to, ... }`: an axis given by its ends.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeTable {
    /// The first value.
    pub from: f64,
    /// The last value; with `step`, its upper limit.
    pub to: f64,
    /// Number of values; not in a sample.
    pub count: Option<u32>,
    /// Distance of two values, instead of `count`.
    pub step: Option<f64>,
    /// Equal ratios instead of equal distances. Default: false.
    #[serde(default)]
    pub log: bool,
    /// Rounded to whole numbers without duplicates. Default: false.
    #[serde(default)]
    pub whole: bool,
}

/// `[[sample]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleTable {
    /// `"random"` or `"latin_hypercube"`.
    pub kind: Kind,
    /// Number of samples.
    pub count: u32,
    /// Seed of the sample, independent of the seeds of the runs. Default: 0.
    #[serde(default)]
    pub seed: u64,
    /// Range or list of values of each field.
    pub axes: toml::Table,
}

/// `[[plot]]`: a figure over one axis, or over two.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlotTable {
    /// A figure that the plan records.
    pub figure: String,
    /// The axis from left to right.
    pub over: String,
    /// The second axis: curves if it has a few values, else a map.
    pub and: Option<String>,
}
