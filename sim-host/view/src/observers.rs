use crate::mcap::McapWriter;
use crate::watch::Watcher;
use anyhow::Result;
use staya::run::{Observer, RunArgs};
use staya_record::frame::{FrameData, Framer};
use staya_record::scene::{Mode, Scene};
use staya_sim::engine::Moment;
use staya_sim::record::{Files, Output, RobotRow};
use staya_sim::scenario::Scenario;
use std::path::PathBuf;

/// Creates the observers for `--mcap` and `--view` of `staya run`.
///
/// # Errors
/// A file cannot be written, or the page's address is not available.
pub fn of_run(args: &RunArgs, scenario: &Scenario, files: &mut Files) -> Result<Vec<Box<dyn Observer>>> {
    let mut observers: Vec<Box<dyn Observer>> = Vec::new();
    if let Some((path, every)) = args.mcap() {
        let scene = Scene::new(scenario, Mode::Recording);
        observers.push(Box::new(Mcap {
            writer: McapWriter::new(files.create(path)?, path, &scene)?,
            framer: Framer::new(scenario),
            frame: FrameData::default(),
            every,
            is_written: true,
        }));
    }
    if let Some(watcher) = Watcher::by_options(args.watch(), scenario)? {
        observers.push(Box::new(Page(watcher)));
    }
    Ok(observers)
}

struct Mcap {
    writer: McapWriter<Output>,
    framer: Framer,
    frame: FrameData,
    every: u32,
    is_written: bool,
}

impl Observer for Mcap {
    fn is_due(&mut self) -> bool {
        true
    }

    fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()> {
        self.framer.fill(&mut self.frame, moment, rows.iter().copied());
        self.is_written = moment.row.tick.is_multiple_of(self.every);
        if self.is_written {
            self.writer.frame(&self.frame)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        if !self.is_written {
            self.writer.frame(&self.frame)?;
        }
        Ok(self.writer.finish()?.finish()?)
    }

    fn stop(self: Box<Self>) -> Option<PathBuf> {
        Some(self.writer.stop().keep())
    }
}

struct Page(Watcher);

impl Observer for Page {
    fn is_due(&mut self) -> bool {
        self.0.is_due()
    }

    fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()> {
        self.0.tick(moment, &mut rows.iter().copied());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        Ok(())
    }
}
