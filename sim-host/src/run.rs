//! `staya run SCENARIO`: one run with its results and pictures.

mod checkpoint;
mod outputs;

use anyhow::{Result, anyhow};
use checkpoint::{CheckpointArgs, Checkpoints};
use clap::Args;
pub use outputs::Observer;
use outputs::{OutputArgs, RunOutputs};
use staya_console::say;
use staya_console::{Ended, Global, Progress, ScenarioArgs, Stop, WatchArgs, print, print_json};
use staya_plot::run_pictures;
use staya_record::recording::RecordingError;
use staya_sim::checkpoint::{Checkpoint, Place};
use staya_sim::engine::{Moment, Outcome, StartError, simulate, simulate_from};
use staya_sim::expected::Expected;
use staya_sim::record::{self, Files, History, Options, Recorder, Results, RobotRow, write_summary};
use staya_sim::remembered::Remembered;
use staya_sim::scenario::Scenario;
use staya_sim::shown::Shown as _;
use staya_sim::summary::Summary;
use staya_sim::terrain::ros;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Run a scenario.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct RunArgs {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Folder for the results; replaces the results of an earlier run once the new ones are
    /// complete [default: out/ and the scenario's name].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Do not write files that grow with the number of robots (trace.csv and the picture of paths);
    /// for swarms of a million.
    #[arg(long, conflicts_with = "gif")]
    no_trace: bool,
    #[command(flatten)]
    checkpoint: CheckpointArgs,
    #[command(flatten)]
    outputs: OutputArgs,
    #[command(flatten)]
    page: WatchArgs,
}

/// Creates the observers that the options of a run select.
pub type Observers<'a> = dyn Fn(&RunArgs, &Scenario, &mut Files) -> Result<Vec<Box<dyn Observer>>> + 'a;

impl RunArgs {
    /// Whether an option needs an observer of `staya-view`: an MCAP file or a live page.
    #[must_use]
    pub fn needs_view(&self) -> bool {
        self.mcap().is_some() || self.page.address().is_some()
    }

    /// Path of the MCAP file, and ticks between its moments.
    #[must_use]
    pub fn mcap(&self) -> Option<(&Path, u32)> {
        self.outputs.mcap()
    }

    /// Options of the live page.
    #[must_use]
    pub const fn watch(&self) -> &WatchArgs {
        &self.page
    }

    /// Runs the command without an MCAP file or a live page.
    ///
    /// # Errors
    /// See [`RunArgs::run_with`].
    pub fn run(&self, global: &Global) -> Result<Ended> {
        self.run_with(global, &|_, _, _| Ok(Vec::new()))
    }

    /// Runs the command with further observers.
    ///
    /// # Errors
    /// An unreadable or invalid scenario, or results that cannot be written.
    pub fn run_with(&self, global: &Global, observers: &Observers<'_>) -> Result<Ended> {
        let scenario = self.scenario.load()?;
        let out = self.out.clone().unwrap_or_else(|| Path::new("out").join(&scenario.name));
        let stop = Stop::on_ctrl_c()?;
        let from = self.checkpoint.from.as_ref().map(|path| Checkpoint::open(path, &scenario)).transpose()?;
        if let Some(from) = &from
            && self.outputs.is_recorded()
        {
            say(&format!("the files of --record and --mcap start after tick {}", from.tick()));
        }
        let before_seconds = from.as_ref().map_or(0.0, Checkpoint::wall_seconds);
        let mut files = Files::reading(&scenario.origin.files);
        files.claim(&out)?;
        let checkpoints = match self.checkpoint.checkpoint {
            Some(every) => {
                let place = Place::new(out.with_added_extension("checkpoint"), &scenario)?;
                place.files().iter().try_for_each(|path| files.claim(path))?;
                Some(Checkpoints::new(every, place, before_seconds))
            }
            None => None,
        };
        // The checkpoint that the run continues may be replaced by its own, but by nothing else.
        if let Some(from) = &self.checkpoint.from {
            files.reads(from);
        }
        let observers = observers(self, &scenario, &mut files)?;
        let outputs = RunOutputs::begin(&self.outputs, &scenario, &mut files, observers)?;
        let task =
            Task { scenario: &scenario, out: &out, keeps_robots: !self.no_trace, from, checkpoints, stop: &stop };
        let summary = run(task, outputs, global)?;
        if global.json {
            print_json(&summary)?;
        } else {
            print(&summary.table(&out))?;
        }
        Ok(Ended::by(&stop))
    }
}

/// Summary of a run without files.
pub fn summary(scenario: &Scenario, outcome: &Outcome) -> impl serde::Serialize + use<> {
    Summary::new(scenario, outcome, Vec::new())
}

struct Task<'a> {
    scenario: &'a Scenario,
    out: &'a Path,
    keeps_robots: bool,
    from: Option<Checkpoint>,
    checkpoints: Option<Checkpoints>,
    stop: &'a Stop,
}

/// Earlier results stay until the new ones are complete.
fn run(task: Task<'_>, outputs: RunOutputs<'_>, global: &Global) -> Result<Summary> {
    let out = task.out;
    let results = Results::begin(out)?;
    let mut incomplete = Vec::new();
    let whole = run_into(task, results.dir(), outputs, &mut incomplete, global).and_then(|summary| {
        write_summary(results.dir(), &summary)?;
        Ok(summary)
    });
    match whole {
        Ok(summary) => {
            results.finish()?;
            Ok(summary)
        }
        Err(error) if error.is::<record::Error>() || error.is::<RecordingError>() => {
            incomplete.push(results.keep());
            let kept: Vec<_> = incomplete.iter().map(|path| path.shown().to_string()).collect();
            let (kept, out) = (kept.join(", "), out.shown());
            let what = format!("{out} is unchanged; the incomplete results stay in {kept} until the next run");
            Err(anyhow!("{}; {what}", staya_console::in_one_line(&error)))
        }
        Err(error) => Err(error),
    }
}

/// Writes all but `summary.json`. `dir` later becomes the results folder.
fn run_into(
    task: Task<'_>,
    dir: &Path,
    mut outputs: RunOutputs<'_>,
    incomplete: &mut Vec<PathBuf>,
    global: &Global,
) -> Result<Summary> {
    let Task { scenario, out, keeps_robots, mut from, mut checkpoints, stop } = task;
    // A checkpoint without the robots' lines cannot continue them.
    let keeps_robots = keeps_robots && from.as_ref().is_none_or(Checkpoint::keeps_robots);
    let recorder = match &mut from {
        Some(from) => from.recorder(dir, keeps_robots)?,
        None => Recorder::new(dir, Options { keeps_robots, ..Options::default() })?,
    };
    let began = Instant::now();
    let done = simulate_recorded(scenario, recorder, &mut outputs, from.as_ref(), checkpoints.as_mut(), stop, global);
    let (outcome, history, merged) = match done {
        Ok(done) => done,
        Err(error) => {
            incomplete.extend(outputs.stop());
            return Err(error);
        }
    };
    let wall_seconds = from.map_or(0.0, |from| from.wall_seconds()) + began.elapsed().as_secs_f64();
    let names = ["summary.json", "series.csv", "series.schema.json", "trace.csv", "trace.schema.json"];
    let names = if keeps_robots { &names[..] } else { &names[..3] };
    let mut files: Vec<_> = names.iter().map(|name| out.join(name)).collect();
    if let Some(merged) = merged {
        ros::save(&merged.map(&scenario.land.terrain), &dir.join("map.yaml"))?;
        files.extend(["map.yaml", "map.pgm"].map(|name| out.join(name)));
    }
    let pictures = run_pictures(scenario, &history, dir)?;
    files.extend(pictures.iter().map(|file| out.join(file.strip_prefix(dir).unwrap_or(file))));
    files.extend(outputs.paths());
    let mut summary = Summary::new(scenario, &outcome, files);
    summary.version = staya_console::VERSION;
    summary.arrivals = summary.arrivals.filter(|_| keeps_robots);
    summary.wall_seconds = wall_seconds;
    summary.interrupted = stop.is_requested();
    outputs.finish(&summary, &history)?;
    Ok(summary)
}

fn simulate_recorded(
    scenario: &Scenario,
    mut recorder: Recorder,
    outputs: &mut RunOutputs<'_>,
    from: Option<&Checkpoint>,
    mut checkpoints: Option<&mut Checkpoints>,
    stop: &Stop,
    global: &Global,
) -> Result<(Outcome, History, Option<Remembered>)> {
    let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), global);
    let mut failed: Option<anyhow::Error> = None;
    let count = scenario.robots.len();
    let mut expected = Expected::new(scenario.ticks);
    let mut merged = Remembered::new(scenario);
    let mut watch = |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
        let robots = robots.inspect(|robot| expected.see(robot));
        let done = if !outputs.wants_rows() {
            recorder.tick(moment.row, robots).map_err(Into::into)
        } else {
            let rows: Vec<_> = robots.collect();
            let done = recorder.tick(moment.row, rows.iter().copied()).map_err(Into::into);
            done.and_then(|()| outputs.tick(moment, &rows))
        };
        if let Err(error) = done {
            failed = Some(error);
            return ControlFlow::Break(());
        }
        if let Some(merged) = &mut merged {
            merged.look(moment);
        }
        let Moment { arrived, waiting, .. } = *moment;
        progress.of(expected.ticks(moment.row.tick).into());
        progress.set(moment.row.tick.into(), || format!("ticks, {arrived} of {count} robots arrived, {waiting} wait"));
        let is_stopped = stop.is_requested();
        if let Some(checkpoints) = &mut checkpoints {
            checkpoints.tick(moment, &mut recorder, is_stopped);
        }
        if is_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = match from {
        None => simulate(scenario, watch)?,
        Some(from) => simulate_from(scenario, from.state(), &mut watch).map_err(|unable| match unable {
            StartError::State(error) => from.refused(error).into(),
            misplaced => anyhow!(misplaced),
        })?,
    };
    progress.finish();
    match failed {
        Some(error) => Err(error),
        None => Ok((outcome, recorder.finish()?, merged)),
    }
}
