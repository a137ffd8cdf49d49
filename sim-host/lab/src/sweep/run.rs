//! One run of a plan.

use crate::error::SweepError;
use crate::measure::{self, Measured, Watch, simulate};
use crate::sweep::plan::Plan;
use crate::sweep::row::{Finished, Outcome, Row};
use crate::sweep::value::Figure;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

fn row(measured: &Measured, plan: &Plan, number: u64) -> Row {
    let figure = |name: &String| Figure(measured.values.get(name).copied().flatten());
    let figures = plan.measures().iter().map(figure).collect();
    Row { run: number, outcome: Outcome::Done, figures, trace_hash: measured.trace_hash.clone() }
}

/// Makes a run; `None` if `may_continue` stops it between two ticks.
pub fn perform(plan: &Plan, number: u64, may_continue: impl Fn() -> bool + Sync) -> Option<Finished> {
    let since = Instant::now();
    let (row, refusal) = match measured(plan, number, &|_| may_continue()) {
        Ok(measured) if measured.is_cut => return None,
        Ok(measured) => (row(&measured, plan, number), None),
        Err(why) => (Row { outcome: Outcome::Impossible, ..row(&Measured::default(), plan, number) }, Some(why)),
    };
    Some(Finished { row, seconds: since.elapsed().as_secs_f64(), refusal })
}

fn measured(plan: &Plan, number: u64, watch: &Watch<'_>) -> Result<Measured, String> {
    plan.job(&plan.run(number)).map_err(|error| error.to_string())?(watch)
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
            measure::draw(&scenario, plan.measures(), &|each| simulate(&scenario, each), &title, stem)
        }
    }
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
        bytes += row(&measured, plan, number).line(plan).len() as u64 + 1;
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
