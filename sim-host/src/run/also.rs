//! Files that grow beside a run's results: recordings.

use anyhow::Result;
use clap::Args;
use serde::Serialize;
use staya_sim::engine::Moment;
use staya_sim::record::{History, RobotRow};
use staya_sim::scenario::Scenario;
use staya_view::frame::{FrameData, Framer};
use staya_view::recording::Writer;
use staya_view::scene::{Mode, Scene};
use std::fs::File;
use std::path::PathBuf;

/// What to write besides.
#[derive(Args, Clone, Debug)]
pub struct AlsoArgs {
    /// Also record the run for `staya page`: where everybody is at each tick. A file of that name is replaced.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Ticks from one recorded moment to the next; the last tick is always recorded.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    record_every: u32,
}

/// The files under way.
pub struct Also<'a> {
    args: &'a AlsoArgs,
    framer: Framer,
    /// The latest moment.
    frame: FrameData,
    /// It has been written.
    is_written: bool,
    recording: Option<Writer<File>>,
}

impl<'a> Also<'a> {
    /// Begins the files that are asked for.
    ///
    /// # Errors
    /// One cannot be written.
    pub fn begin(args: &'a AlsoArgs, scenario: &'a Scenario) -> Result<Self> {
        let begin = |path: &PathBuf| Writer::create(path, &Scene::new(scenario, Mode::Recording));
        Ok(Self {
            args,
            framer: Framer::new(scenario),
            frame: FrameData::default(),
            is_written: true,
            recording: args.record.as_ref().map(begin).transpose()?,
        })
    }

    /// Whether there is nothing to do at each tick.
    pub const fn is_idle(&self) -> bool {
        self.recording.is_none()
    }

    /// What is written.
    pub fn paths(&self) -> impl Iterator<Item = PathBuf> {
        self.args.record.clone().into_iter()
    }

    /// Takes a moment.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()> {
        self.framer.fill(&mut self.frame, moment, rows.iter().copied());
        self.is_written = false;
        if moment.row.tick.is_multiple_of(self.args.record_every) { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<()> {
        self.is_written = true;
        if let Some(recording) = &mut self.recording {
            recording.frame(&self.frame)?;
        }
        Ok(())
    }

    /// Writes what is in memory when something else went wrong; best effort.
    pub fn flush(&mut self) {
        if let Some(recording) = &mut self.recording {
            let _ = recording.flush();
        }
    }

    /// Completes the files.
    ///
    /// # Errors
    /// One cannot be written.
    pub fn finish(mut self, summary: &impl Serialize, _history: &History) -> Result<()> {
        if !self.is_written {
            self.write()?;
        }
        if let Some(recording) = self.recording {
            recording.finish(&[(); 0], summary)?;
        }
        Ok(())
    }
}
