//! When a run writes checkpoints, and where.

use clap::Args;
use staya_sim::checkpoint::Place;
use staya_sim::engine::Moment;
use staya_sim::record::Recorder;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::{Duration, Instant};

/// Whether to write checkpoints, and whether to go on from one.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Checkpoints; docs/checkpoints.md")]
pub struct CheckpointArgs {
    /// Write all that it takes to go on with this run beside the folder of results, as FOLDER.checkpoint, the one before it as
    /// FOLDER.checkpoint.old: so often (600s, 10min, 2h of real time, or 1000ticks), and at Ctrl-C.
    #[arg(long, value_name = "EVERY")]
    pub checkpoint: Option<Every>,
    /// Go on from a checkpoint of this scenario, to the results of a run without a break.
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
}

/// How often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Every {
    /// Of real time.
    Time(Duration),
    /// Ticks.
    Ticks(u32),
}

impl FromStr for Every {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
        let (number, unit) = text.split_at(end);
        let seconds = match unit.trim() {
            "s" => 1,
            "min" => 60,
            "h" => 3600,
            "ticks" => 0,
            _ => return Err("give a number and its unit: 600s, 10min, 2h or 1000ticks".to_owned()),
        };
        let number: u32 = number.parse().map_err(|_| "give a whole number, such as 600s or 1000ticks".to_owned())?;
        match (number, seconds) {
            (0, _) => Err("give 1 or more".to_owned()),
            (ticks, 0) => Ok(Self::Ticks(ticks)),
            (number, seconds) => Ok(Self::Time(Duration::from_secs(u64::from(number) * seconds))),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn how_often_has_a_unit() {
        let seconds = |seconds| Ok(Every::Time(Duration::from_secs(seconds)));
        assert_eq!("600s".parse(), seconds(600));
        assert_eq!("10min".parse(), seconds(600));
        assert_eq!("2h".parse(), seconds(7200));
        assert_eq!("1000ticks".parse(), Ok(Every::Ticks(1000)));
        for wrong in ["", "600", "s", "-1s", "0s", "0ticks", "1.5h", "99999999999s", "5 days"] {
            assert!(wrong.parse::<Every>().is_err(), "{wrong}");
        }
    }
}
