//! One run of a plan.

use crate::sweep::plan::Plan;
use crate::sweep::row::{Outcome, Row};
use crate::sweep::value::Figure;
use staya_sim::engine::simulate;
use staya_sim::summary::Summary;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A completed run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// Record of the run.
    pub row: Row,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Reason for an impossible run.
    pub refusal: Option<String>,
}

/// Makes a run; `None` if `may_continue` stops it between two ticks.
pub fn perform(plan: &Plan, number: u64, may_continue: impl Fn() -> bool) -> Option<Finished> {
    let since = Instant::now();
    let simulated = simulated(plan, number, &mut |_| may_continue());
    let (outcome, figures, trace_hash, refusal) = match simulated {
        Ok((_, true)) => return None,
        Ok((summary, false)) => (Outcome::Done, chosen(plan, &summary), summary.trace_hash().to_owned(), None),
        Err(why) => (Outcome::Impossible, vec![Figure(None); plan.measures().len()], String::new(), Some(why)),
    };
    let row = Row { run: number, outcome, figures, trace_hash };
    Some(Finished { row, seconds: since.elapsed().as_secs_f64(), refusal })
}

/// The summary, and whether it was stopped early; `watch` is called after each tick.
fn simulated(plan: &Plan, number: u64, watch: &mut dyn FnMut(u32) -> bool) -> Result<(Summary, bool), String> {
    let scenario = plan.scenario(&plan.run(number)).map_err(|error| error.to_string())?;
    let mut is_cut = false;
    let outcome = simulate(&scenario, |moment, _| {
        is_cut = !watch(moment.row.tick);
        if is_cut { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let outcome = outcome.map_err(|error| format!("the robots cannot be placed: {error}"))?;
    Ok((Summary::new(&scenario, &outcome, Vec::new()), is_cut))
}

fn chosen(plan: &Plan, summary: &Summary) -> Vec<Figure> {
    let figures: BTreeMap<_, _> = summary.figures().into_iter().collect();
    plan.measures().iter().map(|name| Figure(figures.get(name).copied().flatten())).collect()
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
        let mut last = 0;
        let mut watch = |tick| {
            last = tick;
            since.elapsed() < TRY
        };
        let scenario = plan.scenario(&plan.run(number));
        let ticks = scenario.map_or(0, |scenario| scenario.ticks);
        let Ok((summary, is_cut)) = simulated(plan, number, &mut watch) else {
            continue;
        };
        let share = if is_cut { f64::from(ticks) / f64::from(last.max(1)) } else { 1.0 };
        is_whole &= !is_cut;
        seconds += since.elapsed().as_secs_f64() * share;
        let (figures, trace_hash) = (chosen(plan, &summary), summary.trace_hash().to_owned());
        let row = Row { run: number, outcome: Outcome::Done, figures, trace_hash };
        bytes += row.line(plan).len() as u64 + 1;
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
