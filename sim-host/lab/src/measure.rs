//! Measures and pictures of a run.

use crate::error::SweepError;
use crate::probe::{self, Kind, Probe};
use staya_plot::{motion_sheet, run_pictures};
use staya_sim::engine;
use staya_sim::record::{Error, Options, Recorder, make_dir, write_atomically};
use staya_sim::scenario::Scenario;
use staya_sim::summary::Summary;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Called after each tick or step with its number; returns whether the run may continue.
pub type Watch<'a> = dyn Fn(u32) -> bool + Sync + 'a;

/// A run whose fields are checked.
pub type Job = Box<dyn FnOnce(&Watch<'_>) -> Result<Measured, String>>;

/// Results of a run.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Values by the names of measures.
    pub values: BTreeMap<String, Option<f64>>,
    /// Trace hash, 16 hex digits; empty if there was no simulation.
    pub trace_hash: String,
    /// Whether the run was stopped early.
    pub is_cut: bool,
}

impl Measured {
    /// Values without a trace.
    pub fn of<'a>(values: impl IntoIterator<Item = (&'a str, Option<f64>)>) -> Self {
        let values = values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        Self { values, ..Self::default() }
    }
}

/// A run of a scenario by the engine.
pub fn by_engine(scenario: Scenario, measures: &[String]) -> Job {
    let measures = measures.to_vec();
    Box::new(move |watch| measure(&scenario, &measures, watch, &|each| simulate(&scenario, each)))
}

/// Simulates a scenario, passing each moment to the callback.
pub type Simulator<'a> = dyn Fn(&mut engine::Watch<'_>) -> Result<engine::Outcome, String> + 'a;

/// Measures a run of a scenario by its summary and the probes that `measures` need.
///
/// # Errors
/// Those of the simulator.
pub fn measure(
    scenario: &Scenario,
    measures: &[String],
    watch: &Watch<'_>,
    simulator: &Simulator<'_>,
) -> Result<Measured, String> {
    let mut probes = probes(scenario, measures);
    let (mut is_cut, mut rows) = (false, Vec::new());
    let outcome = simulator(&mut |moment, robots| {
        is_cut = !watch(moment.row.tick);
        if is_cut {
            return ControlFlow::Break(());
        }
        if !probes.is_empty() {
            rows.clear();
            rows.extend(robots);
        }
        // All of them see the tick, also after one that ends the run.
        let mut course = ControlFlow::Continue(());
        for (_, probe) in &mut probes {
            if probe.tick(moment, &rows).is_break() {
                course = ControlFlow::Break(());
            }
        }
        course
    })?;
    let summary = Summary::new(scenario, &outcome, Vec::new());
    let mut values: BTreeMap<_, _> = summary.figures().into_iter().collect();
    for (kind, probe) in &probes {
        let names = kind.measures.iter().map(|(measure, _)| format!("{}.{measure}", kind.name));
        values.extend(names.zip(probe.values(scenario, &outcome)));
    }
    Ok(Measured { values, trace_hash: summary.trace_hash().to_owned(), is_cut })
}

/// Draws a run of a scenario into files that begin with `stem`: moments in the plane or ways on the
/// grid, and the charts of probes. An impossible run gives no files.
///
/// # Errors
/// A file cannot be written.
pub fn draw(
    scenario: &Scenario,
    measures: &[String],
    simulator: &Simulator<'_>,
    title: &str,
    stem: &Path,
) -> Result<Vec<PathBuf>, SweepError> {
    let mut recorder = Recorder::in_memory(Options::default());
    let mut probes = probes(scenario, measures);
    let mut rows = Vec::new();
    let outcome = simulator(&mut |moment, robots| {
        rows.clear();
        rows.extend(robots);
        for (_, probe) in &mut probes {
            let _ = probe.tick(moment, &rows);
        }
        match recorder.tick(moment.row, &mut rows.iter().copied()) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    });
    let Some(history) = outcome.ok().and_then(|_| recorder.finish().ok()) else { return Ok(Vec::new()) };
    let mut files = match scenario.plane() {
        None => run_pictures(scenario, &history, stem)?,
        Some(_) => motion_sheet(title, scenario, &history).draw().write(stem)?,
    };
    for (kind, probe) in &probes {
        let name = stem.file_name().unwrap_or_default().to_string_lossy();
        let own = stem.with_file_name(format!("{name}-{}", kind.name));
        if let Some(panels) = probe.charts(title) {
            files.extend(panels.draw().write(&own)?);
        }
        if let Some(table) = probe.table() {
            files.push(write_table(&own, &table)?);
        }
    }
    Ok(files)
}

/// Writes a CSV file whose name begins with `stem`, which may contain dots.
///
/// # Errors
/// The file cannot be written.
pub fn write_table(stem: &Path, text: &str) -> Result<PathBuf, Error> {
    let path = stem.with_file_name(format!("{}.csv", stem.file_name().unwrap_or_default().display()));
    make_dir(path.parent().unwrap_or(Path::new("")))?;
    write_atomically(&path, text.as_bytes())?;
    Ok(path)
}

/// Simulates a scenario by the engine, in its number format; a [`Simulator`].
///
/// # Errors
/// See [`staya_numbers::simulate`].
pub fn simulate(scenario: &Scenario, each: &mut engine::Watch<'_>) -> Result<engine::Outcome, String> {
    staya_numbers::simulate(scenario, each)
}

fn probes(scenario: &Scenario, measures: &[String]) -> Vec<(Kind, Box<dyn Probe>)> {
    let is_used = |kind: &Kind| {
        let prefix = format!("{}.", kind.name);
        measures.iter().any(|name| name.starts_with(&prefix))
    };
    probe::KINDS.into_iter().filter(is_used).map(|kind| (kind, (kind.new)(scenario))).collect()
}
