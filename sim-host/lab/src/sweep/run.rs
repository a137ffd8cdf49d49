//! One run of a plan.

use crate::sweep::plan::Plan;
use crate::sweep::probe::{self, Kind};
use crate::sweep::row::{Finished, Outcome, Row};
use crate::sweep::value::Figure;
use staya_plot::flock::Sheet;
use staya_plot::motion_sheet;
use staya_sim::engine::simulate;
use staya_sim::record::{Options, Recorder};
use staya_sim::summary::Summary;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Makes a run; `None` if `may_continue` stops it between two ticks.
pub fn perform(plan: &Plan, number: u64, may_continue: impl Fn() -> bool) -> Option<Finished> {
    let since = Instant::now();
    let simulated = simulated(plan, number, &mut |_| may_continue());
    let (outcome, figures, trace_hash, refusal) = match simulated {
        Ok((_, true)) => return None,
        Ok((measured, false)) => (Outcome::Done, measured.figures, measured.trace_hash, None),
        Err(why) => (Outcome::Impossible, vec![Figure(None); plan.measures().len()], String::new(), Some(why)),
    };
    let row = Row { run: number, outcome, figures, trace_hash };
    Some(Finished { row, seconds: since.elapsed().as_secs_f64(), refusal })
}

struct Measured {
    /// In the order of the plan.
    figures: Vec<Figure>,
    trace_hash: String,
}

/// The measures, and whether the run was stopped early; `watch` is called after each tick.
fn simulated(plan: &Plan, number: u64, watch: &mut dyn FnMut(u32) -> bool) -> Result<(Measured, bool), String> {
    let scenario = plan.scenario(&plan.run(number)).map_err(|error| error.to_string())?;
    let is_used = |kind: &Kind| {
        let prefix = format!("{}.", kind.name);
        plan.measures().iter().any(|name| name.starts_with(&prefix))
    };
    let kinds = probe::KINDS.into_iter().filter(is_used);
    let mut probes: Vec<_> = kinds.map(|kind| (kind, (kind.new)(&scenario))).collect();
    let (mut is_cut, mut rows) = (false, Vec::new());
    let outcome = simulate(&scenario, |moment, robots| {
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
    });
    let outcome = outcome.map_err(|error| format!("the robots cannot be placed: {error}"))?;
    let summary = Summary::new(&scenario, &outcome, Vec::new());
    let mut known: BTreeMap<_, _> = summary.figures().into_iter().collect();
    for (kind, probe) in &probes {
        let names = kind.measures.iter().map(|(measure, _)| format!("{}.{measure}", kind.name));
        known.extend(names.zip(probe.values(&scenario, &outcome)));
    }
    let figures = plan.measures().iter().map(|name| Figure(known.get(name).copied().flatten())).collect();
    Ok((Measured { figures, trace_hash: summary.trace_hash().to_owned() }, is_cut))
}

/// Moments of a run of a scenario in the plane; `None` on the grid, or if the run is impossible.
pub fn picture(plan: &Plan, number: u64) -> Option<Sheet> {
    let scenario = plan.scenario(&plan.run(number)).ok()?;
    let setup = scenario.plane.as_ref()?;
    let mut recorder = Recorder::in_memory(Options::default());
    let outcome = simulate(&scenario, |moment, robots| match recorder.tick(moment.row, robots) {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    });
    let history = outcome.ok().and_then(|_| recorder.finish().ok())?;
    let values: Vec<_> =
        plan.axes().zip(plan.values_of(number)).map(|(axis, value)| format!("{axis} = {value}")).collect();
    let title = format!("{}: {}, seed {}", plan.name, values.join(", "), scenario.seed);
    Some(motion_sheet(
        &title,
        setup,
        scenario.plane.as_ref().filter(|plane| plane.has_terrain).map(|_| &scenario.terrain),
        &history,
    ))
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
        let Ok((measured, is_cut)) = simulated(plan, number, &mut watch) else {
            continue;
        };
        let share = if is_cut { f64::from(ticks) / f64::from(last.max(1)) } else { 1.0 };
        is_whole &= !is_cut;
        seconds += since.elapsed().as_secs_f64() * share;
        let Measured { figures, trace_hash } = measured;
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
