//! What a run makes besides its results: recordings, MCAP files, moving pictures, a page that looks on.

use anyhow::Result;
use clap::Args;
use serde::Serialize;
use staya_plot::movie::{self, Look};
use staya_record::recording::{RecordingError, RunRecorder};
use staya_sim::engine::Moment;
use staya_sim::record::{History, RobotRow, write_atomically};
use staya_sim::scenario::Scenario;
use std::fs::File;
use std::path::{Path, PathBuf};

/// What to write besides.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Files besides the results; docs/tour.md")]
pub struct AlsoArgs {
    /// Record the run for `staya page`: where everybody is, tick by tick. Each file is replaced.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Record the run as MCAP, for Foxglove, Lichtblick and Rerun.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Ticks from one recorded moment to the next, in both; the last tick is always recorded.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    record_every: u32,
    /// Draw the run as a moving picture.
    #[arg(long, value_name = "FILE")]
    gif: Option<PathBuf>,
    /// Its width in pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 640, value_parser = clap::value_parser!(u32).range(64..=1920))]
    gif_width: u32,
    /// Its length in seconds; pictures follow each other at most every 0.04 s.
    #[arg(long, value_name = "S", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=120))]
    gif_seconds: u32,
}

impl AlsoArgs {
    /// Whether there are files that hold nothing of what was before a checkpoint.
    pub const fn begins_anew(&self) -> bool {
        self.record.is_some() || self.mcap.is_some()
    }

    /// The MCAP file, and ticks from one of its moments to the next.
    pub fn mcap(&self) -> Option<(&Path, u32)> {
        self.mcap.as_deref().map(|path| (path, self.record_every))
    }
}

/// Looks at a run while it goes on.
pub trait Observer {
    /// Whether it wants the robots' lines of the next moment.
    fn is_due(&mut self) -> bool;

    /// Takes a moment, with the robots' lines.
    ///
    /// # Errors
    /// Its file cannot be written.
    fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()>;

    /// The run is over.
    ///
    /// # Errors
    /// Its file cannot be written.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// The files under way, and the observers.
pub struct Also<'a> {
    args: &'a AlsoArgs,
    scenario: &'a Scenario,
    recording: Option<RunRecorder<File>>,
    observers: Vec<Box<dyn Observer>>,
}

impl<'a> Also<'a> {
    /// Begins the files that are asked for.
    ///
    /// # Errors
    /// One cannot be written.
    pub fn begin(args: &'a AlsoArgs, scenario: &'a Scenario, observers: Vec<Box<dyn Observer>>) -> Result<Self> {
        let recording = match &args.record {
            Some(path) => Some(RunRecorder::new(create(path)?, path, scenario, args.record_every)?),
            None => None,
        };
        if let Some(path) = &args.gif {
            // Better now than after the run.
            write_atomically(path, b"")?;
        }
        Ok(Self { args, scenario, recording, observers })
    }

    /// Whether the robots' lines of this moment are wanted.
    pub fn wants_rows(&mut self) -> bool {
        // Every observer is asked: a page reads its messages then.
        let due = self.observers.iter_mut().map(|observer| observer.is_due()).filter(|is_due| *is_due).count();
        self.recording.is_some() || due > 0
    }

    /// What is written.
    pub fn paths(&self) -> impl Iterator<Item = PathBuf> {
        let AlsoArgs { record, mcap, gif, .. } = self.args;
        [record, mcap, gif].into_iter().flatten().cloned()
    }

    /// Takes a moment.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()> {
        if let Some(recording) = &mut self.recording {
            recording.tick(moment, rows.iter().copied())?;
        }
        self.observers.iter_mut().try_for_each(|observer| observer.tick(moment, rows))
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
    pub fn finish(self, summary: &impl Serialize, history: &History) -> Result<()> {
        if let Some(recording) = self.recording {
            recording.finish(summary)?;
        }
        self.observers.into_iter().try_for_each(Observer::finish)?;
        if let Some(path) = &self.args.gif {
            let look = Look { width: self.args.gif_width, seconds: self.args.gif_seconds };
            write_atomically(path, &movie::of_run(self.scenario, history, look)?)?;
        }
        Ok(())
    }
}

fn create(path: &Path) -> Result<File, RecordingError> {
    File::create(path).map_err(RecordingError::writing(path))
}
