//! Sweep plans: fields of a scenario that vary between runs, and their values.

mod accept;
mod axes;
mod check;
mod table;

use crate::error::SweepError;
use crate::measure::{Job, by_engine};
use crate::probe;
use crate::study::{self, Given, Study};
use crate::sweep::value::Value;
use accept::Choice;
pub use accept::{Acceptance, Reference, Verdict};
pub use axes::Change;
use axes::{Axis, SCENARIO};
use staya_controller::digest::{chained, digest};
use staya_sim::file::{MAP, TEXT, read, read_text};
use staya_sim::scenario::{Field, Location, Read as _, ScenarioError, Source, nearest};
use std::ops::Range;
use std::path::{Path, PathBuf};
use table::{Files, HistogramTable, PlanFile, SeedRange, Seeds};
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
    /// Name of the plan; results go to `out/NAME`.
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
    /// Reads a plan and checks it together with its scenario.
    ///
    /// # Errors
    /// Names file, line and field, with cause and remedy.
    pub fn load(path: &Path, changes: &Changes) -> Result<Self, SweepError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        Self::parse(&text, path, changes)
    }

    /// Name and title of a plan, which is not checked further.
    ///
    /// # Errors
    /// The file cannot be read, or a field is missing or unknown.
    pub fn title(path: &Path) -> Result<(String, String), SweepError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        let PlanFile { name, title, .. } = Source::new(path, &text)?.read(LIST)?;
        Ok((name, title))
    }

    /// Like [`Plan::load`], for the text of a file `path` that need not exist.
    ///
    /// # Errors
    /// See [`Plan::load`].
    pub fn parse(text: &str, path: &Path, changes: &Changes) -> Result<Self, SweepError> {
        let source = Source::new(path, text)?;
        let file: PlanFile = source.read(LIST)?;
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if file.name.is_empty() || file.name.len() > 100 || !file.name.chars().all(allowed) {
            let what = format!("{:?} cannot name a folder of results", file.name);
            return Err(source.error("name", what, "use 1 to 100 letters, digits, - and _").into());
        }
        let study = file.study.as_deref().map(|name| find_study(&source, name)).transpose()?;
        let bases = match &file.scenario {
            None if study.is_some() => vec![Base { path: path.to_owned(), text: String::new() }],
            None => Vec::new(),
            Some(Files::One(name)) => vec![Base::read(&source, "scenario", name)?],
            Some(Files::List(names)) => (0..)
                .zip(names)
                .map(|(index, name): (usize, _)| Base::read(&source, &format!("scenario[{index}]"), name))
                .collect::<Result<_, _>>()?,
        };
        if bases.is_empty() {
            return Err(source.error("scenario", "there is none", "give the name of a file").into());
        }
        let mut all = axes::read(&source, &file, bases.iter().map(Base::name).collect())?;
        all.change(&changes.fields)?;
        let axes::Axes { axes, groups, set } = all;
        let set = set.into_iter().map(|(field, value, span)| (field, value.toml(), source.location(span.start)));
        let set: Vec<_> = set.collect();
        let scenarios: Vec<_> = bases.iter().map(|base| base.source(path, &set)).collect::<Result<_, _>>()?;
        for (axis, scenario) in axes.iter().flat_map(|axis| scenarios.iter().map(move |base| (axis, base))) {
            axes::check_kind(&source, axis, scenario.get(axis.field.name()))?;
        }
        let seeds = match &file.seeds {
            None => vec![scenarios[0].get("seed").and_then(|seed| u64::read(seed).ok()).unwrap_or_default()],
            Some(seeds) => check_seeds(&source, seeds)?,
        };
        let mut plan = Self {
            name: file.name,
            title: file.title,
            path: path.to_owned(),
            study,
            bases,
            axes,
            groups,
            set,
            seeds: changes.seeds(seeds, file.seeds.as_ref()),
            measures: Vec::new(),
            plots: Vec::new(),
            pictures: Vec::new(),
            histograms: Vec::new(),
            gains: Vec::new(),
            reference: None,
            accept: Vec::new(),
            fingerprint: 0,
        };
        if plan.count().is_none_or(|count| count > MOST) {
            let what = "more than a million runs";
            return Err(source
                .error("axes", what, "give fewer values, samples or seeds, or make several plans")
                .into());
        }
        let known = check::check(&plan, &source)?;
        plan.measures = check_measures(&source, file.measures, known, study)?;
        plan.plots = check_plots(&source, &plan, file.plot)?;
        let reference = file.reference.map(|name| Reference::load(&plan, &source.file(&name)));
        plan.reference = reference.transpose()?;
        plan.gains = check_gains(&source, &plan, file.gain)?;
        let choice = |field: String| match Choice::read(&plan, &source, &field) {
            Ok(choice) => Ok(Some(choice)),
            // The point is not among those of a changed plan.
            Err(_) if !changes.fields.is_empty() => Ok(None),
            Err(error) => Err(error),
        };
        let (mut pictures, mut histograms) = (Vec::new(), Vec::new());
        for index in 0..file.picture.len() {
            pictures.extend(choice(format!("picture[{index}].where"))?);
        }
        for (index, HistogramTable { figure, .. }) in file.histogram.into_iter().enumerate() {
            check_measured(&source, &plan, &format!("histogram[{index}].figure"), &figure)?;
            histograms.extend(choice(format!("histogram[{index}].where"))?.map(|choice| (figure, choice)));
        }
        (plan.pictures, plan.histograms) = (pictures, histograms);
        // Limits are those of the unchanged plan; a changed one is another study.
        if changes.fields.is_empty() {
            for (index, accept) in file.accept.into_iter().enumerate() {
                let field = format!("accept[{index}]");
                plan.accept.push(Acceptance::read(&plan, accept, &source, &field)?);
            }
        }
        plan.fingerprint = plan.digest();
        Ok(plan)
    }

    /// Path of the plan's file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
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
            return Err(SweepError::new(self.path.display(), what, "give fields of study.* only"));
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
        let what = if values.is_empty() { what } else { format!("{what} (with {values} of {})", self.path.display()) };
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
            source.error(field, format!("{}: {error}", path.display()), "names are relative to the plan's file")
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

impl Changes {
    fn seeds(&self, mut seeds: Vec<u64>, file: Option<&Seeds>) -> Vec<u64> {
        if self.is_quick {
            let quick = if let Some(Seeds::Range(range)) = file { range.quick } else { None };
            seeds.truncate(quick.unwrap_or(1).max(1) as usize);
        }
        if self.seed.is_some() || self.seeds.is_some() {
            let count = self.seeds.map_or(seeds.len(), |count| count as usize);
            seeds = (self.seed.unwrap_or(seeds[0])..).take(count).collect();
        }
        seeds
    }
}

fn find_study(source: &Source<'_>, name: &str) -> Result<&'static dyn Study, ScenarioError> {
    study::ALL.into_iter().find(|study| study.name() == name).ok_or_else(|| {
        let names = study::ALL.map(Study::name);
        source.error("study", format!("there is no study {name}"), format!("give one of {}", names.join(", ")))
    })
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

fn check_seeds(source: &Source<'_>, seeds: &Seeds) -> Result<Vec<u64>, ScenarioError> {
    let most = MOST as usize;
    let seeds: Vec<u64> = match *seeds {
        Seeds::Count(count) => (1..=u64::from(count)).take(most + 1).collect(),
        Seeds::Range(SeedRange { from, count, .. }) => (from..).take((count as usize).min(most + 1)).collect(),
        Seeds::List(ref seeds) => seeds.clone(),
    };
    let mut sorted = seeds.clone();
    sorted.sort_unstable();
    let what = if seeds.is_empty() {
        "there is none".to_owned()
    } else if let Some(twice) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        format!("{} is listed twice", twice[0])
    } else if seeds.len() > most || sorted.last().is_some_and(|&last| last > i64::MAX as u64) {
        "there are too many, or too large ones".to_owned()
    } else {
        return Ok(seeds);
    };
    Err(source.error("seeds", what, "give a number of them, a list, or { from, count }"))
}

fn check_measures(
    source: &Source<'_>,
    measures: Option<Vec<String>>,
    mut known: Vec<String>,
    study: Option<&dyn Study>,
) -> Result<Vec<String>, ScenarioError> {
    let Some(measures) = measures else {
        return Ok(known.into_iter().filter(|name| !name.starts_with("waits.")).collect());
    };
    if study.is_none() {
        known.extend(probe::measures().map(|(name, _)| name));
    }
    for (index, name) in measures.iter().enumerate() {
        let field = format!("measures[{index}]");
        if !known.contains(name) {
            let what = match study {
                Some(study) => format!("{name} is not a measure of study {}", study.name()),
                None => format!("{name} is neither a figure of summary.json nor of a probe"),
            };
            let remedy = match nearest(name, known.iter().map(String::as_str)) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("give some of {}", known.join(", ")),
            };
            return Err(source.error(&field, what, remedy));
        }
        if measures[..index].contains(name) {
            return Err(source.error(&field, format!("{name} is listed twice"), "leave one out"));
        }
    }
    if measures.is_empty() {
        return Err(source.error("measures", "there is none", "give some, or leave the field out for all"));
    }
    Ok(measures)
}

fn check_plots(source: &Source<'_>, plan: &Plan, plots: Vec<PlotTable>) -> Result<Vec<PlotTable>, ScenarioError> {
    for (index, plot) in plots.iter().enumerate() {
        plan.check_plot(plot)
            .map_err(|(field, what, remedy)| source.error(&format!("plot[{index}].{field}"), what, remedy))?;
    }
    Ok(plots)
}

fn check_measured(source: &Source<'_>, plan: &Plan, field: &str, figure: &String) -> Result<(), ScenarioError> {
    if plan.measures.contains(figure) {
        return Ok(());
    }
    Err(source.error(field, format!("{figure} is not measured"), format!("give one of {}", plan.measures.join(", "))))
}

fn check_gains(source: &Source<'_>, plan: &Plan, gains: Vec<GainTable>) -> Result<Vec<GainTable>, ScenarioError> {
    for (index, GainTable { figure, over, .. }) in gains.iter().enumerate() {
        check_measured(source, plan, &format!("gain[{index}].figure"), figure)?;
        if plan.find(over).is_none() {
            let what = format!("{over} is not an axis of the plan");
            let axes: Vec<_> = plan.axes().collect();
            return Err(source.error(&format!("gain[{index}].over"), what, format!("give one of {}", axes.join(", "))));
        }
    }
    Ok(gains)
}

#[cfg(test)]
mod tests;
