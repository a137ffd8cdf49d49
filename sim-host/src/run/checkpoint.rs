use clap::Args;
use staya_console::say;
use staya_sim::checkpoint::{CheckpointInterval, Place};
use staya_sim::engine::Moment;
use staya_sim::record::Recorder;
use staya_sim::shown::Shown as _;
use std::path::PathBuf;
use std::time::Instant;

/// Options of checkpoints.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Checkpoints; docs/sweeps.md")]
pub struct CheckpointArgs {
    /// Write a checkpoint at this interval (600s, 10min, 2h of real time, or 1000ticks) and at
    /// Ctrl-C. It is beside the results folder, as FOLDER.checkpoint; the previous one is
    /// FOLDER.checkpoint.old.
    #[arg(long, value_name = "EVERY")]
    pub checkpoint: Option<CheckpointInterval>,
    /// Continue from a checkpoint of this scenario, with the same results as a run without a break.
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
}

pub struct Checkpoints {
    every: CheckpointInterval,
    place: Place,
    began: Instant,
    /// Seconds before the continuation here.
    before_seconds: f64,
    last: Instant,
}

impl Checkpoints {
    pub fn new(every: CheckpointInterval, place: Place, before_seconds: f64) -> Self {
        let now = Instant::now();
        Self { every, place, began: now, before_seconds, last: now }
    }

    /// Writes a due checkpoint, also at an early end. An error is reported, and the run continues.
    pub fn tick(&mut self, moment: &Moment<'_>, recorder: &mut Recorder, ends_early: bool) {
        let tick = moment.row.tick;
        let is_due = match self.every {
            CheckpointInterval::Ticks(ticks) => tick > 0 && tick.is_multiple_of(ticks),
            CheckpointInterval::Time(time) => self.last.elapsed() >= time,
        };
        let Some(run) = moment.run.filter(|_| is_due || ends_early) else {
            return;
        };
        let wall_seconds = self.before_seconds + self.began.elapsed().as_secs_f64();
        if let Err(error) = self.place.write(tick, wall_seconds, run, recorder) {
            say(&format!("cannot write the checkpoint of tick {tick}: {error}"));
        } else if ends_early {
            say(&format!("checkpoint at tick {tick}: {}", self.place.path().shown()));
        }
        self.last = Instant::now();
    }
}
