//! Structure of a plan's file; docs/sweeps.md explains every field.

use crate::sweep::sample::Kind;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    /// Letters, digits, `-` and `_`; results go to `out/<name>`.
    pub name: String,
    /// One line.
    #[serde(default)]
    pub title: String,
    /// Several scenarios are the first axis. Required without `study`.
    pub scenario: Option<Files>,
    /// Kind of run instead of runs of the scenario.
    pub study: Option<String>,
    /// Default: the scenario's own seed.
    pub seeds: Option<Seeds>,
    /// Figures of `summary.json`. Default: all except the reasons for waiting.
    pub measures: Option<Vec<String>>,
    #[serde(default)]
    pub set: toml::Table,
    /// Crossed with each other; the last one changes first.
    #[serde(default)]
    pub axes: toml::Table,
    /// Tables advance together, crossed with the rest.
    #[serde(default)]
    pub zip: Vec<toml::Table>,
    /// Crossed with the rest.
    #[serde(default)]
    pub sample: Vec<SampleTable>,
    /// Default: each recorded figure over the first axes.
    #[serde(default)]
    pub plot: Vec<PlotTable>,
    /// Points of which the first run is drawn.
    #[serde(default)]
    pub picture: Vec<PictureTable>,
    /// Distributions of figures over the runs of some points.
    #[serde(default)]
    pub histogram: Vec<HistogramTable>,
    #[serde(default)]
    pub gain: Vec<GainTable>,
    /// A CSV file with values of a paper: columns of axes, then of measures.
    pub reference: Option<PathBuf>,
    #[serde(default)]
    pub accept: Vec<AcceptTable>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "invalid scenario, expected the name of a file, or a list of names")]
pub enum Files {
    One(PathBuf),
    List(Vec<PathBuf>),
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "invalid seeds, expected a number, a list of numbers, or { from, count }")]
pub enum Seeds {
    Count(u32),
    List(Vec<u64>),
    Range(SeedRange),
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeedRange {
    pub from: u64,
    pub count: u32,
    /// Number with `--quick`. Default: 1.
    pub quick: Option<u32>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeTable {
    pub from: f64,
    /// With `step`, the upper limit.
    pub to: f64,
    pub count: Option<u32>,
    /// Instead of `count`.
    pub step: Option<f64>,
    /// Equal ratios instead of equal distances. Default: false.
    #[serde(default)]
    pub log: bool,
    /// Whole numbers without duplicates.
    #[serde(default)]
    pub whole: bool,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleTable {
    pub kind: Kind,
    pub count: u32,
    /// Independent of the seeds of the runs.
    #[serde(default)]
    pub seed: u64,
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
    /// Whether the axes of curves are logarithmic. Default: false.
    #[serde(default)]
    pub log: bool,
}

/// `[[picture]]`: moments of the first run of some points.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureTable {
    /// Values of axes; a list for several. Default: all points.
    #[serde(default, rename = "where")]
    pub at: toml::Table,
}

/// `[[histogram]]`: the distribution of a figure, with its Norton-Rice law.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HistogramTable {
    /// A figure that the plan records.
    pub figure: String,
    /// Values of axes; a list for several. Default: all points.
    #[serde(default, rename = "where")]
    pub at: toml::Table,
}

/// `[[gain]]`: means of a figure minus those at one value of an axis.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainTable {
    /// A figure that the plan records.
    pub figure: String,
    /// The axis.
    pub over: String,
    /// Its value without gain.
    pub from: f64,
}

/// `[[accept]]`: what the runs must show.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AcceptTable {
    /// A figure that the plan records.
    pub measure: String,
    /// Values of axes; a list for several. Default: all points.
    #[serde(default, rename = "where")]
    pub at: toml::Table,
    pub equals: Option<f64>,
    pub at_most: Option<f64>,
    pub at_least: Option<f64>,
    /// Relative distance of the mean from the reference.
    pub within: Option<f64>,
    /// Whether limits are those of the mean, not of each run. Default: false.
    #[serde(default)]
    pub mean: bool,
}
