//! Structure of a plan's file; docs/sweeps.md explains every field.

use crate::sweep::sample::Kind;
use staya_sim::scenario::{AnyTable, Node, Read, Wrong};
use staya_sim::{choice, table};
use std::path::PathBuf;
use toml::de::DeValue;

table! {
    /// A whole file.
    pub struct PlanFile {
        /// Letters, digits, `-` and `_`; results go to `out/sweeps/<name>`.
        pub name: String;
        /// One line.
        pub title: String = String::new();
        /// Several scenarios are the first axis. Required without `study`.
        pub scenario: Option<Files>;
        /// Kind of run instead of runs of the scenario.
        pub study: Option<String>;
        /// Default: the scenario's own seed.
        pub seeds: Option<Seeds>;
        /// Figures of `summary.json`. Default: all except the reasons for waiting.
        pub measures: Option<Vec<String>>;
        /// Fields with one value for all runs.
        pub set: AnyTable = AnyTable;
        /// Crossed with each other; the last one changes first.
        pub axes: AnyTable = AnyTable;
        /// Tables advance together, crossed with the rest.
        pub zip: Vec<AnyTable> = Vec::new();
        /// Crossed with the rest.
        pub sample: Vec<SampleTable> = Vec::new();
        /// Default: each recorded figure over the first axes.
        pub plot: Vec<PlotTable> = Vec::new();
        /// Points of which the first run is drawn.
        pub picture: Vec<PictureTable> = Vec::new();
        /// Distributions of figures over the runs of some points.
        pub histogram: Vec<HistogramTable> = Vec::new();
        /// Means of figures minus those at one value of an axis.
        pub gain: Vec<GainTable> = Vec::new();
        /// A CSV file with values of a paper: columns of axes, then of measures.
        pub reference: Option<PathBuf>;
        /// Conditions on the measures.
        pub accept: Vec<AcceptTable> = Vec::new();
        /// Laws that measures follow.
        pub fit: Vec<FitTable> = Vec::new();
    }
}

/// The name of a file, or a list of names.
#[derive(Clone, Debug)]
pub enum Files {
    One(PathBuf),
    List(Vec<PathBuf>),
}

impl Read for Files {
    const KIND: &'static str = "the name of a file, or a list of names";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::String(_) => PathBuf::read(node).map(Self::One),
            DeValue::Array(_) => Vec::read(node).map(Self::List),
            _ => Err(Wrong::not(node, Self::KIND)),
        }
    }
}

#[derive(Clone, Debug)]
pub enum Seeds {
    Count(u32),
    List(Vec<u64>),
    Range(SeedRange),
}

impl Read for Seeds {
    const KIND: &'static str = "a number, a list of numbers, or { from, count }";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::Integer(_) => u32::read(node).map(Self::Count),
            DeValue::Array(_) => Vec::read(node).map(Self::List),
            DeValue::Table(_) => SeedRange::read(node).map(Self::Range),
            _ => Err(Wrong::not(node, Self::KIND)),
        }
    }
}

table! {
    #[derive(Copy)]
    pub struct SeedRange {
        /// The first seed.
        pub from: u64;
        /// Number of seeds.
        pub count: u32;
        /// Number with `--quick`. Default: 1.
        pub quick: Option<u32>;
    }
}

table! {
    #[derive(Copy)]
    pub struct RangeTable {
        /// The first value.
        pub from: f64;
        /// With `step`, the upper limit.
        pub to: f64;
        /// Number of values.
        pub count: Option<u32>;
        /// Instead of `count`.
        pub step: Option<f64>;
        /// Equal ratios instead of equal distances. Default: false.
        pub log: bool = false;
        /// Whole numbers without duplicates.
        pub whole: bool = false;
    }
}

table! {
    pub struct SampleTable {
        /// Method.
        pub kind: Kind;
        /// Number of samples.
        pub count: u32;
        /// Independent of the seeds of the runs.
        pub seed: u64 = 0;
        /// Fields, each with a list or a range.
        pub axes: AnyTable;
    }
}

table! {
    /// `[[plot]]`: a figure over one axis, or over two.
    #[derive(PartialEq, Eq)]
    pub struct PlotTable {
        /// A figure that the plan records.
        pub figure: String;
        /// The axis from left to right.
        pub over: String;
        /// The second axis: curves if it has a few values, else a map.
        pub and: Option<String>;
        /// Whether the axes of curves are logarithmic. Default: false.
        pub log: bool = false;
    }
}

table! {
    /// `[[picture]]`: moments of the first run of some points.
    pub struct PictureTable {
        /// Values of axes; a list for several. Default: all points.
        pub r#where: AnyTable = AnyTable;
    }
}

table! {
    /// `[[histogram]]`: the distribution of a figure, with its Norton-Rice law.
    pub struct HistogramTable {
        /// A figure that the plan records.
        pub figure: String;
        /// Values of axes; a list for several. Default: all points.
        pub r#where: AnyTable = AnyTable;
    }
}

table! {
    /// `[[gain]]`: means of a figure minus those at one value of an axis.
    #[derive(PartialEq)]
    pub struct GainTable {
        /// A figure that the plan records.
        pub figure: String;
        /// The axis.
        pub over: String;
        /// Its value without gain.
        pub from: f64;
    }
}

table! {
    /// `[[accept]]`: what the runs must show.
    pub struct AcceptTable {
        /// A sentence of the paper, or of this project; a row of docs/results.md.
        pub claim: String = String::new();
        /// The paper's figure.
        pub paper: String = String::new();
        /// Why the condition is known not to hold.
        pub fails: Option<String>;
        /// A figure that the plan records.
        pub measure: String;
        /// Values of axes; a list for several. Default: all points.
        pub r#where: AnyTable = AnyTable;
        /// Values of axes of the points to divide by, seed by seed.
        pub beside: AnyTable = AnyTable;
        /// Instead: an axis whose preceding value these points have.
        pub previous: Option<String>;
        /// Least and greatest value.
        pub equals: Option<f64>;
        /// Greatest value.
        pub at_most: Option<f64>;
        /// Least value.
        pub at_least: Option<f64>;
        /// Relative distance of the mean from the reference.
        pub within: Option<f64>;
        /// Whether limits are those of the mean, not of each run. Default: false.
        pub mean: bool = false;
        /// Whether limits of the mean are shares of the reference. Default: false.
        pub of_reference: bool = false;
    }
}

choice! {
    /// Law of a measure.
    pub enum Law {
        /// a ln(x + 1) + b over an axis x, by least squares of the means.
        Logarithm = "logarithm",
        /// Norton-Rice law of the runs of a point, by largest likelihood.
        NortonRice = "norton_rice",
    }
}

table! {
    /// `[[fit]]`: a law that a figure follows.
    pub struct FitTable {
        /// A sentence of the paper, or of this project; a row of docs/results.md.
        pub claim: String = String::new();
        /// The paper's fit.
        pub paper: String = String::new();
        /// Why it is known not to follow the law.
        pub fails: Option<String>;
        /// A figure that the plan records.
        pub figure: String;
        /// The law.
        pub law: Law;
        /// With `logarithm`, the axis.
        pub over: Option<String>;
        /// Values of axes; a list for several. Default: all points.
        pub r#where: AnyTable = AnyTable;
        /// Least R2 (`logarithm`) or p of the chi-square test (`norton_rice`).
        pub at_least: f64;
    }
}
