//! One run of a plan.

use crate::study::{Job, Watch};
use crate::sweep::SweepError;
use crate::sweep::plan::Plan;
use crate::sweep::probe::{self, Kind, Probe};
use crate::sweep::row::{Finished, Outcome, Row};
use crate::sweep::value::Figure;
use staya_plot::{motion_sheet, run_pictures};
use staya_sim::engine;
use staya_sim::record::{Error, Options, Recorder, make_dir, write_atomically};
use staya_sim::scenario::Scenario;
use staya_sim::summary::Summary;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

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

    fn row(&self, plan: &Plan, number: u64) -> Row {
        let figure = |name: &String| Figure(self.values.get(name).copied().flatten());
        let figures = plan.measures().iter().map(figure).collect();
        Row { run: number, outcome: Outcome::Done, figures, trace_hash: self.trace_hash.clone() }
    }
}

/// Makes a run; `None` if `may_continue` stops it between two ticks.
pub fn perform(plan: &Plan, number: u64, may_continue: impl Fn() -> bool + Sync) -> Option<Finished> {
    let since = Instant::now();
    let (row, refusal) = match measured(plan, number, &|_| may_continue()) {
        Ok(measured) if measured.is_cut => return None,
        Ok(measured) => (measured.row(plan, number), None),
        Err(why) => (Row { outcome: Outcome::Impossible, ..Measured::default().row(plan, number) }, Some(why)),
    };
    Some(Finished { row, seconds: since.elapsed().as_secs_f64(), refusal })
}

fn measured(plan: &Plan, number: u64, watch: &Watch<'_>) -> Result<Measured, String> {
    plan.job(&plan.run(number)).map_err(|error| error.to_string())?(watch)
}

/// A run of a scenario by the engine.
pub fn job(scenario: Scenario, measures: &[String]) -> Job {
    let measures = measures.to_vec();
    Box::new(move |watch| measure(&scenario, &measures, watch, &|each| by_engine(&scenario, each)))
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

/// Draws a run into files that begin with `stem`: moments in the plane, ways on the grid, or what
/// its study draws, and the charts of probes. An impossible run gives no files.
///
/// # Errors
/// A file cannot be written.
pub fn draw(plan: &Plan, number: u64, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
    let run = plan.run(number);
    let given = plan.given(&run)?;
    let values: Vec<_> = plan.axes().zip(&run.values).map(|(axis, value)| format!("{axis} = {value}")).collect();
    let title = format!("{}: {}, seed {}", plan.name, values.join(", "), run.seed);
    match plan.study() {
        Some(study) => study.draw(&given, &title, stem),
        None => {
            let scenario = given.scenario()?;
            draw_by(&scenario, plan.measures(), &|each| by_engine(&scenario, each), &title, stem)
        }
    }
}

/// Draws a run of a scenario like [`draw`].
///
/// # Errors
/// A file cannot be written.
pub fn draw_by(
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
    let mut files = match &scenario.plane {
        None => {
            run_pictures(&scenario.terrain, &scenario.changing_cells(), &history, &scenario.numbered_edges(), stem)?
        }
        Some(setup) => {
            let land = setup.has_terrain.then_some(&scenario.terrain);
            motion_sheet(title, setup, land, &history).draw().write(stem)?
        }
    };
    for (kind, probe) in &probes {
        let name = stem.file_name().unwrap_or_default().to_string_lossy();
        let own = stem.with_file_name(format!("{name}-{}", kind.name));
        if let Some(panels) = probe.charts(title) {
            files.extend(panels.write(&own)?);
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

fn by_engine(scenario: &Scenario, each: &mut engine::Watch<'_>) -> Result<engine::Outcome, String> {
    engine::simulate_with(scenario, None, each).map_err(|error| format!("the robots cannot be placed: {error}"))
}

fn probes(scenario: &Scenario, measures: &[String]) -> Vec<(Kind, Box<dyn Probe>)> {
    let is_used = |kind: &Kind| {
        let prefix = format!("{}.", kind.name);
        measures.iter().any(|name| name.starts_with(&prefix))
    };
    probe::KINDS.into_iter().filter(is_used).map(|kind| (kind, (kind.new)(scenario))).collect()
}

/// Estimated cost of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// Number of runs.
    pub runs: u64,
    /// Runs made for the estimate.
    pub tried: usize,
    /// Processor time, seconds.
    pub seconds: f64,
    /// Whether every tried run reached its last tick.
    pub is_whole: bool,
    /// Size of all rows, bytes.
    pub bytes: u64,
}

const TRY: Duration = Duration::from_secs(2);

/// Tries the first, the middle and the last run, for at most two seconds each.
#[must_use]
pub fn estimate(plan: &Plan) -> Estimate {
    let runs = plan.runs();
    let mut tried = vec![0, runs / 2, runs - 1];
    tried.dedup();
    let (mut seconds, mut bytes, mut is_whole) = (0.0, 0, true);
    for &number in &tried {
        let since = Instant::now();
        let last = AtomicU32::new(0);
        let watch = |tick| {
            last.store(tick, Ordering::Relaxed);
            since.elapsed() < TRY
        };
        let Ok(measured) = measured(plan, number, &watch) else {
            continue;
        };
        let ticks =
            plan.given(&plan.run(number)).and_then(|given| given.scenario()).map_or(0, |scenario| scenario.ticks);
        let share = if measured.is_cut { f64::from(ticks) / f64::from(last.into_inner().max(1)) } else { 1.0 };
        is_whole &= !measured.is_cut;
        seconds += since.elapsed().as_secs_f64() * share;
        bytes += measured.row(plan, number).line(plan).len() as u64 + 1;
    }
    let count = tried.len() as u64;
    Estimate {
        runs,
        tried: tried.len(),
        seconds: seconds / count as f64 * runs as f64,
        is_whole,
        bytes: bytes * runs / count,
    }
}
