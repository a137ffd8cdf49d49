//! `staya page` makes one HTML file of a run.

use anyhow::{Context as _, Result, anyhow};
use clap::Args;
use serde::Serialize;
use staya_console::{Ended, Global, Progress, ScenarioArgs, Stop, print, print_json};
use staya_record::page;
use staya_record::recording::{Reader, RecordingError, RunRecorder};
use staya_sim::engine::{Moment, simulate};
use staya_sim::file::{MAP, read, read_remedy};
use staya_sim::record::{Error, Files, RobotRow};
use staya_sim::scenario::Scenario;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Make one HTML file of a run, for any browser, without server or network.
#[derive(Args, Clone, Debug)]
pub struct PageArgs {
    /// Scenario (.toml), which is run, or a recording made with `staya run --record`.
    #[command(flatten)]
    source: ScenarioArgs,
    /// Output file.
    #[arg(long, value_name = "FILE", default_value = "page.html")]
    out: PathBuf,
    /// For a scenario: ticks between two recorded moments.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
}

/// Output of `--json`.
#[derive(Debug, Serialize)]
struct Made {
    page: PathBuf,
    bytes: usize,
    recording_bytes: usize,
    first_tick: u32,
    last_tick: u32,
}

impl PageArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// An unreadable or invalid scenario or recording, or a page that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let path = self.source.path();
        let stop = Stop::on_ctrl_c()?;
        let is_scenario = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        let (bytes, mut output) = match is_scenario {
            true => {
                let scenario = self.source.load()?;
                let output = Files::reading(&scenario.files).create(&self.out)?;
                (recorded(&scenario, self.every, &stop, global)?, output)
            }
            false => {
                let output = Files::reading([path]).create(&self.out)?;
                let error = |error| anyhow!("{}: {error}; {}", path.display(), read_remedy(&error));
                (read(path, MAP).map_err(error)?, output)
            }
        };
        let mut reader = Reader::new(std::io::Cursor::new(&bytes), path)?;
        reader.scene()?;
        let (first_tick, last_tick) =
            reader.ticks().with_context(|| format!("{} has no frames; record the run again", path.display()))?;
        let page = page::with_recording(&bytes)?;
        output.write_all(page.as_bytes()).map_err(Error::new("write", &self.out))?;
        output.finish()?;
        let made =
            Made { page: self.out.clone(), bytes: page.len(), recording_bytes: bytes.len(), first_tick, last_tick };
        if global.json {
            print_json(&made)?;
        } else {
            let size = made.bytes as f64 / 1e6;
            print(&format!("{}: {size:.2} MB, ticks {first_tick} to {last_tick}\n", self.out.display()))?;
        }
        Ok(Ended::by(&stop))
    }
}

fn recorded(scenario: &Scenario, every: u32, stop: &Stop, global: &Global) -> Result<Vec<u8>> {
    let mut recorder = RunRecorder::new(Vec::new(), Path::new(&scenario.name), scenario, every)?;
    let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), global);
    let mut failed: Option<RecordingError> = None;
    let watch = |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
        failed = recorder.tick(moment, robots).err();
        progress.set(moment.row.tick.into(), || "ticks".to_owned());
        if failed.is_some() || stop.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = simulate(scenario, watch).context("the robots cannot be placed; change their starts")?;
    progress.finish();
    if let Some(error) = failed {
        return Err(error.into());
    }
    let summary = crate::run::summary(scenario, &outcome);
    Ok(recorder.finish(&summary)?)
}
