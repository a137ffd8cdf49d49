//! `staya run SCENARIO`: one run, its figures and its pictures.

mod also;

use crate::watch::WatchArgs;
use also::{Also, AlsoArgs};
use anyhow::{Context as _, Result, anyhow};
use clap::Args;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_plot::{motion_pictures, run_pictures};
use staya_sim::engine::{Moment, Outcome, simulate};
use staya_sim::record::{self, History, Options, Recorder, Results, RobotRow, write_summary};
use staya_sim::scenario::{Overrides, Scenario};
use staya_sim::summary::Summary;
use staya_view::recording::RecordingError;
use staya_view::watch::Watcher;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Which scenario, and what of it is otherwise.
#[derive(Args, Clone, Debug)]
pub struct ScenarioArgs {
    /// The scenario, a .toml file; scenarios/README.md lists the ones that come with Staya, and all fields.
    scenario: PathBuf,
    /// Seed of all random numbers, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// End after this many ticks, instead of the scenario's number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    ticks: Option<u32>,
}

impl ScenarioArgs {
    /// The file.
    pub fn path(&self) -> &Path {
        &self.scenario
    }

    /// What is otherwise than in the file.
    pub const fn overrides(&self) -> Overrides {
        Overrides { seed: self.seed, ticks: self.ticks }
    }

    /// Reads it.
    ///
    /// # Errors
    /// It cannot be read, or is wrong.
    pub fn load(&self) -> Result<Scenario> {
        let scenario = Scenario::load(&self.scenario, &self.overrides())?;
        for remark in scenario.remarks() {
            eprintln!("{remark}");
        }
        Ok(scenario)
    }
}

/// Run a scenario.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct RunArgs {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Folder for the results; those of an earlier run are replaced when the new ones are complete [default: out/ and the
    /// scenario's name].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    also: AlsoArgs,
    #[command(flatten)]
    page: WatchArgs,
}

impl RunArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A scenario that cannot be read or is wrong, results that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let scenario = self.scenario.load()?;
        let out = self.out.clone().unwrap_or_else(|| Path::new("out").join(&scenario.name));
        let stop = Stop::on_ctrl_c()?;
        let page = self.page.watcher(&scenario)?;
        let summary = run(&scenario, &out, &self.also, page, &stop, global)?;
        if global.json {
            print_json(&summary)?;
        } else {
            print(&summary.table(&out)?)?;
        }
        Ok(Ended::by(&stop))
    }
}

/// The figures of a run that left no files.
pub fn summary(scenario: &Scenario, outcome: &Outcome) -> impl serde::Serialize + use<> {
    Summary::new(scenario, outcome, Vec::new())
}

/// Runs a scenario and leaves everything about it in `out`; what was there before stays until all of it is written.
fn run(
    scenario: &Scenario,
    out: &Path,
    also: &AlsoArgs,
    page: Option<Watcher>,
    stop: &Stop,
    global: &Global,
) -> Result<Summary> {
    let also = Also::begin(also, scenario, page)?;
    let results = Results::begin(out)?;
    let whole = run_into(scenario, results.dir(), out, also, stop, global).and_then(|summary| {
        write_summary(results.dir(), &summary)?;
        Ok(summary)
    });
    match whole {
        Ok(summary) => {
            results.finish()?;
            Ok(summary)
        }
        Err(error) if error.is::<record::Error>() || error.is::<RecordingError>() => {
            let kept = results.keep();
            let (kept, out) = (kept.display(), out.display());
            let what =
                format!("{kept} keeps what was written until the next run into {out}, where nothing has changed");
            Err(anyhow!("{}; {what}", crate::in_one_line(&error)))
        }
        Err(error) => Err(error),
    }
}

/// The same in folder `dir`, which will be `out`; without `summary.json`.
fn run_into(
    scenario: &Scenario,
    dir: &Path,
    out: &Path,
    mut also: Also<'_>,
    stop: &Stop,
    global: &Global,
) -> Result<Summary> {
    let recorder = Recorder::new(dir, Options::default())?;
    let began = Instant::now();
    let (outcome, history) = simulate_recorded(scenario, recorder, &mut also, stop, global)?;
    let wall_seconds = began.elapsed().as_secs_f64();
    let edges: Vec<_> = match &scenario.formation {
        Some(formation) => {
            let id = |place: u16| u32::from(place) + 1;
            let edges = formation.edges.iter();
            edges.map(|&(a, b)| (id(a), id(b))).collect()
        }
        None => Vec::new(),
    };
    let names = ["summary.json", "series.csv", "series.schema.json", "trace.csv", "trace.schema.json"];
    let mut files: Vec<_> = names.iter().map(|name| out.join(name)).collect();
    let pictures = match &scenario.plane {
        None => run_pictures(&scenario.terrain, &history, &edges, dir)?,
        Some(setup) => motion_pictures(setup, &history, dir)?,
    };
    files.extend(pictures.iter().map(|file| out.join(file.strip_prefix(dir).unwrap_or(file))));
    files.extend(also.paths());
    let mut summary = Summary::new(scenario, &outcome, files);
    summary.wall_seconds = wall_seconds;
    summary.interrupted = stop.is_requested();
    also.finish(&summary, &history)?;
    Ok(summary)
}

fn simulate_recorded(
    scenario: &Scenario,
    mut recorder: Recorder,
    also: &mut Also<'_>,
    stop: &Stop,
    global: &Global,
) -> Result<(Outcome, History)> {
    let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), global);
    let mut failed: Option<anyhow::Error> = None;
    let count = scenario.robots.len();
    let watch = |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
        let done = if !also.wants_rows() {
            recorder.tick(moment.row, robots).map_err(Into::into)
        } else {
            let rows: Vec<_> = robots.collect();
            let done = recorder.tick(moment.row, rows.iter().copied()).map_err(Into::into);
            done.and_then(|()| also.tick(moment, &rows))
        };
        if let Err(error) = done {
            failed = Some(error);
            return ControlFlow::Break(());
        }
        let Moment { arrived, waiting, .. } = *moment;
        progress.set(moment.row.tick.into(), || format!("ticks, {arrived} of {count} robots arrived, {waiting} wait"));
        if stop.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = simulate(scenario, watch).context("the robots cannot be placed")?;
    progress.finish();
    match failed {
        Some(error) => {
            also.flush();
            Err(error)
        }
        None => Ok((outcome, recorder.finish()?)),
    }
}
