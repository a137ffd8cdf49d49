//! `staya page` makes one HTML file of a run.

use anyhow::{Context as _, Result, anyhow};
use clap::Args;
use serde::Serialize;
use staya_console::{Ended, Global, Progress, ScenarioArgs, Stop, print, print_json};
use staya_record::claims::claims;
use staya_record::mind::{self, Events};
use staya_record::page;
use staya_record::recording::{Reader, RunRecorder};
use staya_record::scene::{Mode, Scene, description};
use staya_sim::engine::operated;
use staya_sim::file::{MAP, read, read_remedy};
use staya_sim::record::{Error, Files};
use staya_sim::scenario::{Scenario, text_with};
use staya_sim::shown::Shown as _;
use std::io::Write as _;
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
    /// For a scenario: robots whose knowledge, links and permitted velocities the page contains.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    minds: Vec<u32>,
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
                let scene = Scene {
                    minds: self.minds(&scenario)?,
                    claims: claims(path).unwrap_or_default(),
                    description: description(&text_with(path, self.source.settings())?),
                    ..Scene::new(&scenario, Mode::Recording)
                };
                let output = Files::reading(&scenario.origin.files).create(&self.out)?;
                (recorded(&scenario, scene, self.every, &stop, global)?, output)
            }
            false if !self.minds.is_empty() => {
                let path = path.shown();
                return Err(anyhow!("--minds: the recording {path} has no minds; give its scenario (.toml) instead"));
            }
            false => {
                let output = Files::reading([path]).create(&self.out)?;
                let error = |error| anyhow!("{}: {error}; {}", path.shown(), read_remedy(&error));
                (read(path, MAP).map_err(error)?, output)
            }
        };
        let mut reader = Reader::new(std::io::Cursor::new(&bytes), path)?;
        reader.scene()?;
        let (first_tick, last_tick) =
            reader.ticks().with_context(|| format!("{} has no frames; record the run again", path.shown()))?;
        let page = page::with_recording(&bytes)?;
        output.write_all(page.as_bytes()).map_err(Error::new("write", &self.out))?;
        output.finish()?;
        let made =
            Made { page: self.out.clone(), bytes: page.len(), recording_bytes: bytes.len(), first_tick, last_tick };
        if global.json {
            print_json(&made)?;
        } else {
            let size = made.bytes as f64 / 1e6;
            print(&format!("{}: {size:.2} MB, ticks {first_tick} to {last_tick}\n", self.out.shown()))?;
        }
        Ok(Ended::by(&stop))
    }

    /// Indices of the robots of `--minds`.
    fn minds(&self, scenario: &Scenario) -> Result<Vec<usize>> {
        let ids: Vec<u32> = scenario.robots.iter().map(|robot| robot.id.0).collect();
        let index = |id: &u32| {
            let range = ids.first().zip(ids.last());
            let (first, last) = range.unwrap_or((&0, &0));
            let name = &scenario.name;
            let error = || anyhow!("--minds {id}: {name} has no robot {id}; its robots have numbers {first} to {last}");
            ids.binary_search(id).map_err(|_| error())
        };
        let mut minds = self.minds.iter().map(index).collect::<Result<Vec<usize>>>()?;
        minds.sort_unstable();
        minds.dedup();
        Ok(minds)
    }
}

fn recorded(scenario: &Scenario, scene: Scene, every: u32, stop: &Stop, global: &Global) -> Result<Vec<u8>> {
    let (minds, origin_m) = (scene.minds.clone(), scene.origin_m);
    let mut recorder = RunRecorder::of(scene, Vec::new(), Path::new(&scenario.name), scenario, every)?;
    let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), global);
    let mut engine = operated(scenario)?;
    engine.log_receptions(!minds.is_empty());
    let (mut events, mut tick) = (Events::default(), 0);
    loop {
        let mut done = Ok(());
        engine.show(&mut |moment, robots| done = recorder.tick(moment, robots));
        done?;
        for &index in &minds {
            events.add(&engine, index, tick);
            recorder.mind(mind::recorded(&engine, scenario, origin_m, &events, (tick, index)));
        }
        progress.set(tick.into(), || "ticks".to_owned());
        if engine.is_over() || tick >= scenario.ticks || stop.is_requested() {
            break;
        }
        engine.step();
        tick += 1;
    }
    progress.finish();
    let summary = crate::run::summary(scenario, &engine.outcome());
    Ok(recorder.finish(&summary)?)
}
