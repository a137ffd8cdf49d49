//! `staya-mpi run SCENARIO`: the results of `staya run`, computed by several processes.

use crate::link::Link;
use anyhow::{Result, anyhow};
use clap::Args;
use serde::Serialize;
use staya_console::say;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_mpi::ranks::{Ended as RunEnded, Exchange as _, RankError, Sharing, Traffic, check, remark, simulate_on};
use staya_plot::run_pictures;
use staya_sim::checkpoint::{Checkpoint, CheckpointInterval, Place};
use staya_sim::engine::{Moment, Watch, agents};
use staya_sim::record::{History, Options, Recorder, Results, RobotRow, write_summary};
use staya_sim::scenario::{Overrides, Scenario, Setting};
use staya_sim::shown::Shown as _;
use staya_sim::summary::Summary;
use std::fmt::{Display, Formatter, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A scenario and its outputs.
#[derive(Args, Clone, Debug)]
pub struct RunArgs {
    /// Scenario, a .toml file that every rank can read.
    scenario: PathBuf,
    /// Seed of all random numbers, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Override a scenario field, for example radio.loss=0.3 or plane.orca.horizon_s=3; may be
    /// repeated.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    settings: Vec<Setting>,
    /// Stop after this many ticks, instead of the scenario's number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    ticks: Option<u32>,
    /// Folder for the results, written by rank 0 [default: out/ and the scenario's name].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write a checkpoint at this interval (600s, 10min, 2h of real time, or 1000ticks) and when
    /// stopped, as `staya run --checkpoint` does, to FOLDER.checkpoint.
    #[arg(long, value_name = "EVERY")]
    checkpoint: Option<CheckpointInterval>,
    /// Continue from a checkpoint of this scenario, written by `staya run` or any number of ranks;
    /// every rank reads it.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Write no trace.csv and no pictures, so that rank 0 does not receive each robot in each tick.
    #[arg(long)]
    no_trace: bool,
}

#[derive(Debug, Serialize)]
struct Sent {
    rank: usize,
    /// Processor time without MPI, which computes while it waits, seconds; null if unknown.
    busy_seconds: Option<f64>,
    #[serde(flatten)]
    traffic: Traffic,
}

#[derive(Debug, Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    ranks: &'a [Sent],
}

/// An error that rank 0 has already printed, so that all ranks end in order.
#[derive(Debug)]
pub struct Agreed;

impl Display for Agreed {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str("see the message of rank 0")
    }
}

impl std::error::Error for Agreed {}

impl RunArgs {
    fn load(&self, link: &mut Link) -> Result<(Scenario, Option<Checkpoint>)> {
        let overrides = Overrides { seed: self.seed, ticks: self.ticks };
        let loaded = Scenario::load_with(&self.scenario, &overrides, &self.settings).map_err(anyhow::Error::from);
        let loaded = loaded.and_then(|scenario| {
            check(&scenario, link.ranks())?;
            let from = self.from.as_ref().map(|path| Checkpoint::open(path, &scenario)).transpose()?;
            Ok((scenario, from))
        });
        let own = loaded.as_ref().err().map_or(String::new(), |error| format!("{error:#}"));
        let said = link.gather(own.into_bytes())?;
        let wrong = said.iter().enumerate().find(|(_, said)| !said.is_empty());
        let wrong = wrong.map(|(rank, said)| (rank, String::from_utf8_lossy(said)));
        match (wrong, loaded) {
            (None, Ok(loaded)) => return Ok(loaded),
            (Some((0, said)), _) if link.rank() == 0 => say(&format!("staya-mpi: {said}")),
            (Some((rank, said)), _) if link.rank() == 0 => say(&format!("staya-mpi: rank {rank}: {said}")),
            _ => {}
        }
        // The first rank that ends makes mpirun end all, so all wait until the message is printed.
        link.gather(Vec::new())?;
        Err(Agreed.into())
    }

    pub fn run(&self, global: &Global, mut link: Link, stop: &Stop) -> Result<Ended> {
        let (scenario, from) = self.load(&mut link)?;
        if link.rank() > 0 {
            self.simulate(&scenario, from.as_ref(), &mut link, &mut |_, _| ControlFlow::Continue(()))?;
            link.gather(busy_seconds().unwrap_or(f64::NAN).to_le_bytes().to_vec())?;
            return Ok(Ended::by(stop));
        }
        if let Some(remark) = remark(&scenario) {
            say(&remark);
        }
        let out = self.out.clone().unwrap_or_else(|| Path::new("out").join(&scenario.name));
        let results = Results::begin(&out)?;
        match self.record(&scenario, from, [results.dir(), &out], link, stop, global) {
            Ok((summary, sent)) => {
                results.finish()?;
                if global.json {
                    print_json(&Report { summary: &summary, ranks: &sent })?;
                } else {
                    print(&format!("{}{}", summary.table(&out), table(&sent)?))?;
                }
                Ok(Ended::by(stop))
            }
            Err(error) => {
                let kept = results.keep();
                let (kept, out) = (kept.shown(), out.shown());
                Err(anyhow!(
                    "{error:#}; {out} is unchanged; {kept} has the incomplete results until the next run into {out}"
                ))
            }
        }
    }

    fn simulate(
        &self,
        scenario: &Scenario,
        from: Option<&Checkpoint>,
        link: &mut Link,
        watch: &mut Watch<'_>,
    ) -> Result<RunEnded> {
        let sharing = Sharing { records: !self.no_trace, checkpoints: self.checkpoint, ..Sharing::default() };
        let state = from.map(Checkpoint::state);
        simulate_on(scenario, agents(scenario), state, link, &sharing, watch).map_err(|error| match (error, from) {
            (RankError::Restore(error), Some(from)) => from.refused(error).into(),
            (error, _) => error.into(),
        })
    }

    fn record(
        &self,
        scenario: &Scenario,
        mut from: Option<Checkpoint>,
        [dir, out]: [&Path; 2],
        mut link: Link,
        stop: &Stop,
        global: &Global,
    ) -> Result<(Summary, Vec<Sent>)> {
        let mut recorder = match &mut from {
            Some(from) => from.recorder(dir, !self.no_trace)?,
            None => Recorder::new(dir, Options { keeps_robots: !self.no_trace, ..Options::default() })?,
        };
        let before_seconds = from.as_ref().map_or(0.0, Checkpoint::wall_seconds);
        let place = self.checkpoint.map(|_| Place::new(out.with_added_extension("checkpoint"), scenario));
        let place = place.transpose()?;
        let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), global);
        let (count, began) = (scenario.robots.len(), Instant::now());
        let mut failed = None;
        let mut watch = |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
            if let Err(error) = recorder.tick(moment.row, robots) {
                failed.get_or_insert(error);
                return ControlFlow::Break(());
            }
            let tick = moment.row.tick;
            if let Some((run, place)) = moment.run.zip(place.as_ref())
                && let Err(error) =
                    place.write(tick, before_seconds + began.elapsed().as_secs_f64(), run, &mut recorder)
            {
                say(&format!("cannot write the checkpoint of tick {tick}: {error}"));
            }
            let Moment { arrived, waiting, .. } = *moment;
            progress.set(tick.into(), || format!("ticks, {arrived} of {count} robots arrived, {waiting} wait"));
            if stop.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let ended = self.simulate(scenario, from.as_ref(), &mut link, &mut watch);
        progress.finish();
        let wall_seconds = before_seconds + began.elapsed().as_secs_f64();
        // Partial results are kept after an error.
        let history = recorder.finish();
        if let Some(error) = failed {
            return Err(error.into());
        }
        let RunEnded { outcome, traffic } = ended?;
        let busy = link.gather(busy_seconds().unwrap_or(f64::NAN).to_le_bytes().to_vec())?;
        let files = self.files(scenario, &history?, dir, out)?;
        let mut summary = Summary::new(scenario, &outcome, files);
        summary.version = env!("CARGO_PKG_VERSION");
        summary.arrivals = summary.arrivals.filter(|_| !self.no_trace);
        summary.wall_seconds = wall_seconds;
        summary.interrupted = stop.is_requested();
        write_summary(dir, &summary)?;
        let busy =
            busy.into_iter().map(|bytes| bytes.try_into().map(f64::from_le_bytes).ok().filter(|s| s.is_finite()));
        let sent = traffic.into_iter().zip(busy).enumerate();
        let sent = sent.map(|(rank, (traffic, busy_seconds))| Sent { rank, busy_seconds, traffic });
        Ok((summary, sent.collect()))
    }

    fn files(&self, scenario: &Scenario, history: &History, dir: &Path, out: &Path) -> Result<Vec<PathBuf>> {
        let mut files = ["summary.json", "series.csv", "series.schema.json"].map(|name| out.join(name)).to_vec();
        let trace = ["trace.csv", "trace.schema.json"];
        if !dir.join("trace.csv").exists() {
            return Ok(files);
        }
        files.extend(trace.map(|name| out.join(name)));
        let pictures = run_pictures(scenario, history, dir)?;
        files.extend(pictures.iter().map(|file| out.join(file.strip_prefix(dir).unwrap_or(file))));
        Ok(files)
    }
}

/// Processor time of all threads but the first, which belongs to MPI.
fn busy_seconds() -> Option<f64> {
    let own = std::process::id().to_string();
    let threads = std::fs::read_dir("/proc/self/task").ok()?.flatten();
    let times = threads.filter(|thread| thread.file_name().to_str() != Some(&own)).map(|thread| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    });
    Some(times.sum::<Option<f64>>()? / 1e9)
}

fn table(sent: &[Sent]) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let ticks = sent.first().map_or(1, |sent| sent.traffic.ticks.max(1)) as f64;
    writeln!(text, "{} ranks, bytes sent per tick: mean and largest over ranks", sent.len())?;
    let mut line = |name: &str, of: fn(&Traffic) -> u64| {
        let each = sent.iter().map(|sent| of(&sent.traffic));
        let (mean, most) = (each.clone().sum::<u64>() as f64 / sent.len() as f64, each.max().unwrap_or(0) as f64);
        writeln!(text, "  {name:<22}{:.0}, {:.0}", mean / ticks, most / ticks)
    };
    line("to neighbours", |traffic| traffic.halo)?;
    line("robots that moved", |traffic| traffic.moved)?;
    line("to all", |traffic| traffic.told)?;
    line("to rank 0", |traffic| traffic.recorded)?;
    if let Some(busy) = sent.iter().map(|sent| sent.busy_seconds).collect::<Option<Vec<_>>>() {
        let (sum, most) = busy.iter().fold((0.0, 0.0_f64), |(sum, most), s| (sum + s, most.max(*s)));
        writeln!(text, "  {:<22}{:.2} s, {most:.2} s, without waiting", "processor time", sum / sent.len() as f64)?;
    }
    let moved: u64 = sent.iter().map(|sent| sent.traffic.moved_robots).sum();
    let (rounds, cuts) = sent.first().map_or((0, 0), |sent| (sent.traffic.rounds, sent.traffic.cuts));
    writeln!(
        text,
        "  robots moved to another rank {moved} times; {rounds} extra rounds of moves; {cuts} new divisions"
    )?;
    Ok(text)
}
