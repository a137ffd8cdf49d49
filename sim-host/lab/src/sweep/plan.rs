//! Sweep plans: fields of a scenario that vary between runs, and their values.

mod accept;
mod axes;
mod check;
mod fit;
mod read;
mod reference;
mod table;

use crate::error::SweepError;
use crate::measure::{Job, by_engine};
use crate::probe;
use crate::study::{Given, Study};
use crate::sweep::value::Value;
use accept::Choice;
pub use accept::{Acceptance, Judgement, Verdict};
pub use axes::Change;
use axes::{Axis, SCENARIO};
pub use fit::Fit;
pub use reference::Reference;
use staya_controller::digest::{chained, digest};
use staya_sim::file::{MAP, TEXT, read, read_text};
use staya_sim::scenario::{Field, Location, ScenarioError, Source};
use staya_sim::shown::Shown as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
pub use table::{GainTable, PlotTable};
use toml::Spanned;
use toml::de::DeValue;

const LIST: &str = "docs/sweeps.md";
/// Some hundred megabytes of rows.
const MOST: u64 = 1_000_000;
/// Increase when equal plans give other runs.
const FORMAT: u64 = 1;

/// A checked plan. A run is a function of the plan and its number.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the plan; results go to `out/sweeps/NAME`.
    pub name: String,
    /// Description in one line; may be empty.
    pub title: String,
    path: PathBuf,
    study: Option<&'static dyn Study>,
    bases: Vec<Base>,
    axes: Vec<Axis>,
    /// Axes that advance together, as ranges of `axes`; groups are crossed with each other.
    groups: Vec<Range<usize>>,
    /// Fields with one value for all runs, as TOML, and their places in the plan.
    set: Vec<(Field, String, Location)>,
    seeds: Vec<u64>,
    /// Whether the command line chose fewer seeds than the file.
    pub has_few_seeds: bool,
    measures: Vec<String>,
    /// Requested pictures; empty for the default.
    pub plots: Vec<PlotTable>,
    pictures: Vec<Choice>,
    /// Measures with the points whose distribution is drawn.
    pub(crate) histograms: Vec<(String, Choice)>,
    /// Gains over axes.
    pub gains: Vec<GainTable>,
    /// Values of a paper.
    pub reference: Option<Reference>,
    /// Conditions on the measures.
    pub accept: Vec<Acceptance>,
    /// Laws that measures follow.
    pub fits: Vec<Fit>,
    fingerprint: u64,
}

/// The file of a scenario.
#[derive(Clone, Debug)]
struct Base {
    path: PathBuf,
    text: String,
}

/// Changes of a plan by the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Values of axes and of other fields.
    pub fields: Vec<Change>,
    /// The first seed.
    pub seed: Option<u64>,
    /// Number of seeds.
    pub seeds: Option<u32>,
    /// As few seeds as the plan allows.
    pub is_quick: bool,
}

/// One run of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<'a> {
    /// Number of the run.
    pub number: u64,
    /// Number of its point; runs of a point differ in their seeds only.
    pub point: u64,
    /// Value of each axis, in order.
    pub values: Vec<&'a Value>,
    /// The same as TOML.
    texts: Vec<String>,
    /// Seed of the run.
    pub seed: u64,
}

impl Plan {
    /// Path of the plan's file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of the results, unless another one is named: not that of a run with this name.
    #[must_use]
    pub fn out(&self) -> PathBuf {
        Path::new("out/sweeps").join(&self.name)
    }

    /// Number of runs.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.count().unwrap_or(MOST)
    }

    /// Runs per point.
    #[must_use]
    pub fn seeds(&self) -> u64 {
        self.seeds.len() as u64
    }

    fn count(&self) -> Option<u64> {
        let values = self.groups.iter().map(|group| self.axes[group.start].values.len() as u64);
        values.chain([self.seeds()]).try_fold(1u64, u64::checked_mul)
    }

    /// The conditions as verdicts that hold, then the laws that measures follow.
    #[must_use]
    pub fn expected(&self) -> Vec<Verdict> {
        let accepted = self.accept.iter().map(|accept| accept.verdict(Judgement::Holds, String::new()));
        accepted.chain(self.fits.iter().map(|fit| fit.verdict(Judgement::Holds, String::new()))).collect()
    }

    /// Names of the axes, in the order of the file.
    pub fn axes(&self) -> impl Iterator<Item = &str> {
        self.axes.iter().map(|axis| axis.field.name())
    }

    /// Values of an axis; `None` if there is no such axis.
    #[must_use]
    pub fn values(&self, axis: &str) -> Option<&[Value]> {
        self.find(axis).map(|index| &self.axes[index].values[..])
    }

    /// Axes that the command line adds to those of the file.
    pub(crate) fn added(&self) -> impl Iterator<Item = &str> {
        self.axes.iter().filter(|axis| axis.is_added() && axis.values.len() > 1).map(|axis| axis.field.name())
    }

    /// Index of an axis, by its name or the end of it after a dot.
    #[must_use]
    pub fn find(&self, axis: &str) -> Option<usize> {
        let names: Vec<&str> = self.axes().collect();
        axes::find(names.into_iter(), axis)
    }

    /// Points of which a picture is wanted.
    pub(crate) fn pictured(&self) -> impl Iterator<Item = u64> {
        let points = 0..self.runs() / self.seeds();
        points.filter(|point| {
            let values = self.values_of(point * self.seeds());
            self.pictures.iter().any(|choice| choice.has(&values))
        })
    }

    /// Values of the axes of a run, as table cells.
    #[must_use]
    pub fn values_of(&self, run: u64) -> Vec<String> {
        self.run(run).values.iter().map(ToString::to_string).collect()
    }

    /// Whether the values of axis `index` form a geometric sequence.
    #[must_use]
    pub fn is_log(&self, index: usize) -> bool {
        self.axes.get(index).is_some_and(|axis| axis.is_log)
    }

    /// Names of the figures in rows.
    #[must_use]
    pub fn measures(&self) -> &[String] {
        &self.measures
    }

    /// Checks whether a picture can be drawn.
    ///
    /// # Errors
    /// The plan does not have a figure or an axis of the picture. Returns the field, the cause and
    /// the remedy.
    pub fn check_plot(&self, plot: &PlotTable) -> Result<(), (&'static str, String, String)> {
        let list = |names: &mut dyn Iterator<Item = &str>| match names.collect::<Vec<_>>() {
            names if names.is_empty() => "there is none".to_owned(),
            names => format!("give one of {}", names.join(", ")),
        };
        if !self.measures().contains(&plot.figure) {
            let what = format!("{} is not measured", plot.figure);
            let remedy = list(&mut self.measures().iter().map(String::as_str));
            return Err(("figure", what, remedy));
        }
        for (field, axis) in [("over", Some(&plot.over)), ("and", plot.and.as_ref())] {
            if let Some(axis) = axis.filter(|axis| self.find(axis).is_none()) {
                let what = format!("{axis} is not an axis of the plan");
                return Err((field, what, list(&mut self.axes())));
            }
        }
        if plot.and.as_ref() == Some(&plot.over) {
            return Err(("and", format!("{} is both axes", plot.over), "give another one, or leave it out".to_owned()));
        }
        Ok(())
    }

    /// Fingerprint, 16 hex digits; other runs or rows have another fingerprint.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        format!("{:016x}", self.fingerprint)
    }

    /// Run `number` from 0. Seeds change first, then the last axis.
    ///
    /// # Panics
    /// If there is no such run.
    #[must_use]
    pub fn run(&self, number: u64) -> Run<'_> {
        assert!(number < self.runs(), "a run of the plan");
        let point = number / self.seeds();
        let mut values = vec![&Value::Whole(0); self.axes.len()];
        let mut rest = point;
        for group in self.groups.iter().rev() {
            let count = self.axes[group.start].values.len() as u64;
            let at = (rest % count) as usize;
            rest /= count;
            for index in group.clone() {
                values[index] = &self.axes[index].values[at];
            }
        }
        let texts = values.iter().map(|value| value.toml()).collect();
        Run { number, point, values, texts, seed: self.seeds[(number % self.seeds()) as usize] }
    }

    /// Most parallel runs on a machine; 1 for timed runs, which need it for themselves.
    #[must_use]
    pub fn at_once(&self) -> usize {
        let is_timed = self.measures.iter().any(|name| name.starts_with("cost."));
        if is_timed || self.study.is_some_and(Study::is_timed) { 1 } else { usize::MAX }
    }

    /// Meaning of a figure.
    #[must_use]
    pub fn meaning(&self, figure: &str) -> &'static str {
        let of_study = self.study.map_or(Vec::new(), Study::measures);
        let found = of_study.into_iter().chain(probe::measures()).find(|(name, _)| name == figure);
        found.map_or("a figure of summary.json", |(_, meaning)| meaning)
    }

    /// Kind of run instead of runs of the scenario.
    pub(crate) fn study(&self) -> Option<&'static dyn Study> {
        self.study
    }

    /// Fields of a run, not checked.
    pub(crate) fn given<'a>(&'a self, run: &'a Run<'_>) -> Result<Given<'a>, ScenarioError> {
        let mut source = self.base(run).source(&self.path, &self.set)?;
        for (axis, value) in self.axes.iter().zip(&run.texts).filter(|(axis, _)| axis.field.name() != SCENARIO) {
            source
                .set(&axis.field, value)
                .map_err(|what| obstructed(&self.path, axis.place.unwrap_or(Location::START), &axis.field, what))?;
        }
        Ok(Given { source, measures: &self.measures, seed: run.seed })
    }

    /// A run whose fields are checked.
    pub(crate) fn job(&self, run: &Run<'_>) -> Result<Job, SweepError> {
        let given = self.given(run)?;
        if let Some(study) = self.study.filter(|study| !study.takes_scenario())
            && let Some(field) = given.source.root().keys().map(Spanned::get_ref).find(|field| *field != "study")
        {
            let what = format!("{field} is given, but there is no scenario in study {}", study.name());
            return Err(SweepError::new(self.path.shown(), what, "give fields of study.* only"));
        }
        let job = match self.study {
            Some(study) => study.read(&given),
            None => given.scenario().map(|scenario| by_engine(scenario, &self.measures)).map_err(SweepError::Plan),
        };
        job.map_err(|error| match error {
            SweepError::Plan(error) => self.said_of_plan(run, error).into(),
            other => other,
        })
    }

    fn base(&self, run: &Run<'_>) -> &Base {
        let name = self.axes.first().filter(|axis| axis.field.name() == SCENARIO).map(|_| run.values[0]);
        name.and_then(|name| self.bases.iter().find(|base| base.name() == *name)).unwrap_or(&self.bases[0])
    }

    /// Converts an error of a generated scenario to places in the user's files.
    pub(super) fn said_of_plan(&self, run: &Run<'_>, error: ScenarioError) -> ScenarioError {
        let ScenarioError::Field { path, place, field, what, remedy } = error else {
            return error;
        };
        let mut meant = self.axes.iter().filter(|axis| axis.field.is_about(&field));
        if let Some((axis, place)) = meant.find_map(|axis| Some((axis, axis.place?))) {
            let field = axis.field.name().to_owned();
            let is_word = axis.is_range && what.contains("quotes");
            let (what, remedy) = if is_word { axes::no_range("a text") } else { (what, remedy) };
            return ScenarioError::Field { path: self.path.clone(), place, field, what, remedy };
        }
        let values: Vec<_> = self.axes().zip(&run.values).map(|(name, value)| format!("{name} = {value}")).collect();
        let values = values.join(", ");
        let what = if values.is_empty() { what } else { format!("{what} (with {values} of {})", self.path.shown()) };
        ScenarioError::Field { path, place, field, what, remedy }
    }

    /// Covers everything that rows depend on: fields, values, seeds, figures, the scenario's files.
    fn digest(&self) -> u64 {
        let text = |base: &Base| base.source(&self.path, &self.set).map(|source| source.written()).unwrap_or_default();
        let format = self.study.map_or(FORMAT, |study| chained(FORMAT, digest(study.name().as_bytes())));
        let mut all = self.bases.iter().fold(format, |all, base| chained(all, digest(text(base).as_bytes())));
        let mut add = |bytes: &[u8]| all = chained(all, digest(bytes));
        for (axis, index) in self.axes.iter().zip(0u64..) {
            add(axis.field.name().as_bytes());
            let group = self.groups.iter().position(|group| group.contains(&(index as usize))).unwrap_or_default();
            add(&(group as u64).to_le_bytes());
            axis.values.iter().for_each(|value| add(format!("{value:?}").as_bytes()));
        }
        self.seeds.iter().for_each(|seed| add(&seed.to_le_bytes()));
        self.measures.iter().for_each(|name| add(name.as_bytes()));
        self.files().iter().for_each(|file| add(&read(file, MAP).unwrap_or_default()));
        all
    }

    fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        for base in &self.bases {
            let (path, mut words) = (&base.path, Vec::new());
            if let Ok(source) = base.source(&self.path, &self.set) {
                source.root().values().for_each(|node| collect_words(node.get_ref(), &mut words));
            }
            for value in self.axes.iter().flat_map(|axis| &axis.values) {
                if let Value::Word(word) = value {
                    words.push(word.clone());
                }
            }
            let folder = path.parent().unwrap_or(Path::new(""));
            files.extend(words.iter().map(|word| folder.join(word)).filter(|path| path.is_file()));
        }
        // A ROS map consists of two files.
        let images = files.iter().filter(|path| path.extension().is_some_and(|ext| ext == "yaml")).filter_map(|path| {
            let text = read_text(path, TEXT).ok()?;
            let name = text.lines().find_map(|line| line.trim().strip_prefix("image:"))?;
            Some(path.with_file_name(name.trim().trim_matches(['"', '\''])))
        });
        let images: Vec<_> = images.collect();
        files.extend(images);
        files
    }
}

impl Base {
    fn read(source: &Source<'_>, field: &str, name: &Path) -> Result<Self, ScenarioError> {
        let path = source.file(name);
        let text = read_text(&path, TEXT).map_err(|error| {
            source.error(field, format!("{}: {error}", path.shown()), "names are relative to the plan's file")
        })?;
        Ok(Self { path, text })
    }

    /// The fields of the scenario with those that all runs share.
    fn source<'a>(&'a self, plan: &Path, set: &'a [(Field, String, Location)]) -> Result<Source<'a>, ScenarioError> {
        let mut source = Source::new(&self.path, &self.text)?;
        for (field, value, place) in set {
            source.set(field, value).map_err(|what| obstructed(plan, *place, field, what))?;
        }
        Ok(source)
    }

    /// Value of the axis of scenarios.
    fn name(&self) -> Value {
        Value::Word(self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned())
    }
}

fn obstructed(plan: &Path, place: Location, field: &Field, what: String) -> ScenarioError {
    let (path, field, remedy) = (plan.to_owned(), field.name().to_owned(), "name a field of the scenario".to_owned());
    ScenarioError::Field { path, place, field, what, remedy }
}

fn collect_words(value: &DeValue<'_>, words: &mut Vec<String>) {
    match value {
        DeValue::String(word) => words.push(word.to_string()),
        DeValue::Array(list) => list.iter().for_each(|node| collect_words(node.get_ref(), words)),
        DeValue::Table(table) => table.values().for_each(|node| collect_words(node.get_ref(), words)),
        _ => {}
    }
}

#[cfg(test)]
mod tests;
