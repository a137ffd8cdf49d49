//! What a run makes besides its results: recordings, MCAP files, moving pictures, a page that looks on.

use anyhow::Result;
use clap::Args;
use serde::Serialize;
use staya_plot::movie::{self, Look};
use staya_sim::engine::Moment;
use staya_sim::record::{History, RobotRow, write_atomically};
use staya_sim::scenario::Scenario;
use staya_view::frame::{FrameData, Framer};
use staya_view::mcap::McapWriter;
use staya_view::recording::{RecordingError, RunRecorder};
use staya_view::scene::{Mode, Scene};
use staya_view::watch::Watcher;
use std::fs::File;
use std::path::{Path, PathBuf};

/// What to write besides.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Files besides the results; docs/recordings.md")]
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
}

/// The files under way, and the page.
pub struct Also<'a> {
    args: &'a AlsoArgs,
    scenario: &'a Scenario,
    recording: Option<RunRecorder<File>>,
    mcap: Option<Mcap>,
    page: Option<Watcher>,
}

/// An MCAP file, and the latest moment.
struct Mcap {
    writer: McapWriter<File>,
    framer: Framer,
    frame: FrameData,
    is_written: bool,
}

impl<'a> Also<'a> {
    /// Begins the files that are asked for.
    ///
    /// # Errors
    /// One cannot be written.
    pub fn begin(args: &'a AlsoArgs, scenario: &'a Scenario, page: Option<Watcher>) -> Result<Self> {
        let recording = match &args.record {
            Some(path) => Some(RunRecorder::new(create(path)?, path, scenario, args.record_every)?),
            None => None,
        };
        let mcap = match &args.mcap {
            Some(path) => Some(Mcap {
                writer: McapWriter::create(path, &Scene::new(scenario, Mode::Recording))?,
                framer: Framer::new(scenario),
                frame: FrameData::default(),
                is_written: true,
            }),
            None => None,
        };
        if let Some(path) = &args.gif {
            // Better now than after the run.
            write_atomically(path, b"")?;
        }
        Ok(Self { args, scenario, recording, mcap, page })
    }

    /// Whether anybody wants to know where robots are at this tick. Hears what pages say.
    pub fn wants_rows(&mut self) -> bool {
        self.recording.is_some() || self.mcap.is_some() || self.page.as_mut().is_some_and(Watcher::is_due)
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
        if let Some(Mcap { writer, framer, frame, is_written }) = &mut self.mcap {
            framer.fill(frame, moment, rows.iter().copied());
            *is_written = moment.row.tick.is_multiple_of(self.args.record_every);
            if *is_written {
                writer.frame(frame)?;
            }
        }
        if let Some(page) = &mut self.page {
            page.tick(moment, &mut rows.iter().copied());
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
    pub fn finish(self, summary: &impl Serialize, history: &History) -> Result<()> {
        if let Some(recording) = self.recording {
            recording.finish(summary)?;
        }
        if let Some(mut mcap) = self.mcap {
            if !mcap.is_written {
                mcap.writer.frame(&mcap.frame)?;
            }
            mcap.writer.finish()?;
        }
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
