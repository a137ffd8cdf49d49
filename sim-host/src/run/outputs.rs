use anyhow::Result;
use clap::Args;
use serde::Serialize;
use staya_console::file_ending;
use staya_plot::movie::{self, Look};
use staya_record::recording::RunRecorder;
use staya_sim::engine::Moment;
use staya_sim::record::{Error, Files, History, Output, RobotRow};
use staya_sim::scenario::Scenario;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Options of additional outputs.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Additional files; docs/tour.md")]
pub struct OutputArgs {
    /// Record positions in each tick, for `staya page`; replaces the file when it is complete.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Record the run as MCAP, for Foxglove, Lichtblick and Rerun.
    #[arg(long, value_name = "FILE", value_parser = |name: &str| file_ending(name, &["mcap"]))]
    mcap: Option<PathBuf>,
    /// Ticks between two recorded moments, in both files; the last tick is always recorded.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    record_every: u32,
    /// Draw the run as an animation.
    #[arg(long, value_name = "FILE", value_parser = |name: &str| file_ending(name, &["gif"]))]
    gif: Option<PathBuf>,
    /// Width of the animation, pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 640, value_parser = clap::value_parser!(u32).range(64..=1920))]
    gif_width: u32,
    /// Length of the animation in seconds; frames are at least 0.04 s apart.
    #[arg(long, value_name = "S", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=120))]
    gif_seconds: u32,
}

impl OutputArgs {
    pub const fn is_recorded(&self) -> bool {
        self.record.is_some() || self.mcap.is_some()
    }

    pub fn mcap(&self) -> Option<(&Path, u32)> {
        self.mcap.as_deref().map(|path| (path, self.record_every))
    }
}

/// Observes a run.
pub trait Observer {
    /// Whether the next moment needs the lines of robots.
    fn is_due(&mut self) -> bool;

    /// Handles a moment with the lines of robots.
    ///
    /// # Errors
    /// Its file cannot be written.
    fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()>;

    /// Ends with the run.
    ///
    /// # Errors
    /// Its file cannot be written.
    fn finish(self: Box<Self>) -> Result<()>;

    /// Ends with a run that failed. Returns its incomplete file.
    fn stop(self: Box<Self>) -> Option<PathBuf> {
        None
    }
}

/// Open files and observers.
pub struct RunOutputs<'a> {
    args: &'a OutputArgs,
    scenario: &'a Scenario,
    recording: Option<RunRecorder<Output>>,
    gif: Option<Output>,
    observers: Vec<Box<dyn Observer>>,
}

impl<'a> RunOutputs<'a> {
    /// A path that cannot be written fails before the run.
    pub fn begin(
        args: &'a OutputArgs,
        scenario: &'a Scenario,
        files: &mut Files,
        observers: Vec<Box<dyn Observer>>,
    ) -> Result<Self> {
        let recording = match &args.record {
            Some(path) => Some(RunRecorder::new(files.create(path)?, path, scenario, args.record_every)?),
            None => None,
        };
        let gif = args.gif.as_ref().map(|path| files.create(path)).transpose()?;
        Ok(Self { args, scenario, recording, gif, observers })
    }

    pub fn wants_rows(&mut self) -> bool {
        // Every observer is asked, since pages read their messages in this call.
        let due = self.observers.iter_mut().map(|observer| observer.is_due()).filter(|is_due| *is_due).count();
        self.recording.is_some() || due > 0
    }

    pub fn paths(&self) -> impl Iterator<Item = PathBuf> {
        let OutputArgs { record, mcap, gif, .. } = self.args;
        [record, mcap, gif].into_iter().flatten().cloned()
    }

    pub fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> Result<()> {
        if let Some(recording) = &mut self.recording {
            recording.tick(moment, rows.iter().copied())?;
        }
        self.observers.iter_mut().try_for_each(|observer| observer.tick(moment, rows))
    }

    /// Ends after an error. Returns the incomplete files.
    pub fn stop(self) -> Vec<PathBuf> {
        let recording = self.recording.map(|recording| recording.stop().keep());
        recording.into_iter().chain(self.observers.into_iter().filter_map(Observer::stop)).collect()
    }

    pub fn finish(self, summary: &impl Serialize, history: &History) -> Result<()> {
        if let Some(recording) = self.recording {
            recording.finish(summary)?.finish()?;
        }
        self.observers.into_iter().try_for_each(Observer::finish)?;
        if let Some(mut gif) = self.gif {
            let look = Look { width: self.args.gif_width, seconds: self.args.gif_seconds };
            let movie = movie::of_run(self.scenario, history, look)?;
            gif.write_all(&movie).map_err(Error::new("write", gif.path()))?;
            gif.finish()?;
        }
        Ok(())
    }
}
