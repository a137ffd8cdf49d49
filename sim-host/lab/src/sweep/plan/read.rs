//! Reads the file of a plan and checks it.

use super::accept::{Acceptance, Choice};
use super::fit::Fit;
use super::reference::Reference;
use super::table::{Files, GainTable, HistogramTable, PlanFile, PlotTable, SeedRange, Seeds};
use super::{Base, Changes, LIST, MOST, Plan, axes, check};
use crate::error::SweepError;
use crate::probe;
use crate::study::{self, Study};
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::{Read as _, ScenarioError, Source, nearest};
use std::path::Path;

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
        let all_seeds = seeds.len();
        let seeds = changes.seeds(seeds, file.seeds.as_ref());
        let mut plan = Self {
            name: file.name,
            title: file.title,
            path: path.to_owned(),
            study,
            bases,
            axes,
            groups,
            set,
            has_few_seeds: seeds.len() < all_seeds,
            seeds,
            measures: Vec::new(),
            plots: Vec::new(),
            pictures: Vec::new(),
            histograms: Vec::new(),
            gains: Vec::new(),
            reference: None,
            accept: Vec::new(),
            fits: Vec::new(),
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
            for (index, fit) in file.fit.into_iter().enumerate() {
                plan.fits.push(Fit::read(&plan, fit, &source, &format!("fit[{index}]"))?);
            }
        }
        plan.fingerprint = plan.digest();
        Ok(plan)
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
