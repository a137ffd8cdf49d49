//! When a run writes checkpoints, and where.

use clap::Args;
use staya_sim::checkpoint::{Every, Place};
use staya_sim::engine::Moment;
use staya_sim::record::Recorder;
use std::path::PathBuf;
use std::time::Instant;

/// Whether to write checkpoints, and whether to go on from one.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Checkpoints; docs/sweeps.md")]
pub struct CheckpointArgs {
    /// Write all that it takes to go on with this run beside the folder of results, as FOLDER.checkpoint, the one before it as
    /// FOLDER.checkpoint.old: so often (600s, 10min, 2h of real time, or 1000ticks), and at Ctrl-C.
    #[arg(long, value_name = "EVERY")]
    pub checkpoint: Option<Every>,
    /// Go on from a checkpoint of this scenario, to the results of a run without a break.
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
}

/// The checkpoints of a run.
pub struct Checkpoints {
    every: Every,
    place: Place,
    began: Instant,
    /// Of the run before it went on here.
    before_seconds: f64,
    last: Instant,
}

impl Checkpoints {
    /// Of a run that begins now, and has taken some seconds before.
    pub fn new(every: Every, place: Place, before_seconds: f64) -> Self {
        let now = Instant::now();
        Self { every, place, began: now, before_seconds, last: now }
    }

    /// Writes one if it is due, or the run ends early. What cannot be written is told; the run goes on.
    pub fn tick(&mut self, moment: &Moment<'_>, recorder: &mut Recorder, ends_early: bool) {
        let tick = moment.row.tick;
        let is_due = match self.every {
            Every::Ticks(ticks) => tick > 0 && tick.is_multiple_of(ticks),
            Every::Time(time) => self.last.elapsed() >= time,
        };
        let Some(run) = moment.run.filter(|_| is_due || ends_early) else {
            return;
        };
        let wall_seconds = self.before_seconds + self.began.elapsed().as_secs_f64();
        if let Err(error) = self.place.write(tick, wall_seconds, run, recorder) {
            eprintln!("no checkpoint at tick {tick}: {error}");
        } else if ends_early {
            eprintln!("checkpoint at tick {tick}: {}", self.place.path().display());
        }
        self.last = Instant::now();
    }
}
