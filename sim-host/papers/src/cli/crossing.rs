//! `staya experiment swap` and `staya experiment doorway`.

use super::results::Work;
use crate::crossing::{Conditions, doorway, swap};
use anyhow::{Context as _, Result, bail};
use clap::{Args, ValueEnum};
use staya_console::{Ended, Global, Stop};
use staya_plot::flock::Sheet;
use staya_sim::record::{self, prepare_dir};
use staya_sim::scenario::SafetyName;
use std::path::{Path, PathBuf};

/// What keeps robots apart.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SafetyArg {
    Orca,
    #[value(name = "template_2k")]
    Template2k,
    #[value(name = "template_8k")]
    Template8k,
    #[value(name = "template_16k")]
    Template16k,
    #[value(name = "template_64k")]
    Template64k,
    None,
}

impl From<SafetyArg> for SafetyName {
    fn from(safety: SafetyArg) -> Self {
        match safety {
            SafetyArg::Orca => Self::Orca,
            SafetyArg::Template2k => Self::Template2k,
            SafetyArg::Template8k => Self::Template8k,
            SafetyArg::Template16k => Self::Template16k,
            SafetyArg::Template64k => Self::Template64k,
            SafetyArg::None => Self::None,
        }
    }
}

/// What both experiments understand.
#[derive(Args, Clone, Debug)]
struct Common {
    /// Move each start at random by up to this along both axes, metres.
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    noise: f64,
    /// Runs per point, with consecutive seeds.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: u32,
    /// The first seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Time from one decision to the next, seconds.
    #[arg(long, value_name = "S", default_value_t = 0.05)]
    step: f64,
    /// Highest speed, m/s.
    #[arg(long, value_name = "M/S", default_value_t = 0.5)]
    speed: f64,
    /// How far the radio reaches, metres [default: 3 for swap, 6 for doorway].
    #[arg(long, value_name = "M")]
    range: Option<f64>,
    /// Share of packets lost, 0 to 1.
    #[arg(long, value_name = "P", default_value_t = 0.0)]
    loss: f64,
    /// What keeps robots apart.
    #[arg(long, value_enum, default_value = "orca")]
    safety: SafetyArg,
    /// Folder for the pictures [default: out/swap, out/doorway].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Common {
    fn conditions(&self, range_m: f64) -> Result<Conditions> {
        let range_m = self.range.unwrap_or(range_m);
        for (name, value, low, high) in [
            ("--noise", self.noise, 0.0, 100.0),
            ("--step", self.step, 0.001, 10.0),
            ("--speed", self.speed, 0.01, 32.0),
            ("--range", range_m, 0.0, 1e6),
            ("--loss", self.loss, 0.0, 1.0),
        ] {
            if !(low..=high).contains(&value) {
                bail!("{name} {value} is out of range: give {low} to {high}");
            }
        }
        Ok(Conditions {
            step_s: self.step,
            speed_mps: self.speed,
            range_m,
            loss: self.loss,
            safety: self.safety.into(),
        })
    }

    fn out(&self, name: &str) -> PathBuf {
        let default = || Path::new("out").join(name);
        self.out.clone().unwrap_or_else(default)
    }
}

/// Robots on a circle, each bound for the opposite side: who arrives, how late, how near they come.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct SwapArgs {
    /// Numbers of robots: single numbers and ranges, as in "4,6,8" or "2..64".
    #[arg(long, value_name = "LIST", default_value = "2..64", value_parser = numbers)]
    robots: Numbers,
    /// Radius of the circle, metres [default: 0.1 per robot, at least 2].
    #[arg(long, value_name = "M")]
    circle: Option<f64>,
    /// End a run after this many times the free time.
    #[arg(long, value_name = "N", default_value_t = 6.0)]
    patience: f64,
    #[command(flatten)]
    common: Common,
}

/// Two crowds pass one gap in opposite directions: who passes, in what order, how near they come.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct DoorwayArgs {
    /// Widths of the gap, metres.
    #[arg(long, value_name = "M,M,...", value_delimiter = ',', default_values_t = [0.7, 0.8, 1.0, 1.3, 2.0])]
    widths: Vec<f64>,
    /// Robots on each side; their radius is 0.3 m.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1000))]
    robots: u32,
    /// End a run after this many seconds.
    #[arg(long, value_name = "S", default_value_t = 900.0)]
    longest: f64,
    #[command(flatten)]
    common: Common,
}

/// Numbers of robots.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Numbers(Vec<u32>);

/// Reads numbers and spans.
fn numbers(text: &str) -> Result<Numbers, String> {
    let wrong = || format!("\"{text}\": give numbers and spans of them, as in 4,6,8 or 2..64");
    let number = |word: &str| match word.trim().parse() {
        Ok(number @ 1..=100_000) => Ok(number),
        _ => Err(wrong()),
    };
    let mut all = Vec::new();
    for part in text.split(',') {
        match part.split_once("..") {
            None => all.push(number(part)?),
            Some((from, to)) => {
                let (from, to) = (number(from)?, number(to)?);
                if from > to {
                    return Err(wrong());
                }
                all.extend(from..=to);
            }
        }
    }
    all.sort_unstable();
    all.dedup();
    Ok(Numbers(all))
}

fn write(sheet: &Sheet, stem: &Path) -> Result<Vec<PathBuf>, record::Error> {
    sheet.draw().write(stem)
}

impl SwapArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, pictures that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let plan = swap::Plan {
            robots: self.robots.0.clone(),
            circle_m: self.circle,
            noise_m: self.common.noise,
            seeds: self.common.seeds,
            seed: self.common.seed,
            patience: self.patience,
            conditions: self.common.conditions(3.0)?,
        };
        if !(0.1..=1000.0).contains(&self.patience) {
            bail!(
                "--patience {} is out of range: give 0.1 to 1000",
                self.patience
            );
        }
        if self
            .circle
            .is_some_and(|circle| !(0.01..=1e5).contains(&circle))
        {
            bail!("--circle is out of range: give 0.01 to 100000 metres");
        }
        let out = self.common.out("swap");
        prepare_dir(&out).context("pictures have no place")?;
        let stop = Stop::on_ctrl_c()?;
        let work = Work::new("runs", plan.total(), &out);
        let run = |told: &(dyn Fn(usize) -> bool + Sync)| anyhow::Ok(plan.run(told));
        let (report, mut course) = work.carry_out(global, &stop, run, |r| r.runs.len())?;
        if report.rows.len() > 1 {
            course
                .pictures
                .extend(report.chart().write(&out.join("times"))?);
        }
        // Of all that can be told apart in a picture, the largest.
        let drawn = report
            .rows
            .iter()
            .rev()
            .map(|row| row.robots)
            .find(|&n| n <= 100);
        if let Some(robots) = drawn.filter(|_| !stop.is_requested()) {
            course
                .pictures
                .extend(write(&plan.picture(robots), &out.join("swap"))?);
        }
        course.tell(&report, |report| Ok(report.to_string()), global)?;
        Ok(Ended::by(&stop))
    }
}

impl DoorwayArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, pictures that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        for width in &self.widths {
            if !(0.0..=50.0).contains(width) {
                bail!("--widths {width} is out of range: give 0 to 50 metres");
            }
        }
        if !(0.1..=1e6).contains(&self.longest) {
            bail!(
                "--longest {} is out of range: give 0.1 to 1000000 seconds",
                self.longest
            );
        }
        let plan = doorway::Plan {
            widths_m: self.widths.clone(),
            robots: self.robots,
            noise_m: self.common.noise,
            seeds: self.common.seeds,
            seed: self.common.seed,
            longest_s: self.longest,
            conditions: self.common.conditions(6.0)?,
        };
        let out = self.common.out("doorway");
        prepare_dir(&out).context("pictures have no place")?;
        let stop = Stop::on_ctrl_c()?;
        let work = Work::new("runs", plan.total(), &out);
        let run = |told: &(dyn Fn(usize) -> bool + Sync)| anyhow::Ok(plan.run(told));
        let (report, mut course) = work.carry_out(global, &stop, run, |r| r.runs.len())?;
        if let Some(run) = report.runs.first().filter(|_| !stop.is_requested()) {
            course
                .pictures
                .extend(write(&plan.picture(run.width_m), &out.join("doorway"))?);
        }
        course.tell(&report, |report| Ok(report.to_string()), global)?;
        Ok(Ended::by(&stop))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_spans_are_read_in_any_order() {
        assert_eq!(numbers("8,2..4, 3"), Ok(Numbers(vec![2, 3, 4, 8])));
        for bad in ["", "0", "4..2", "..", "a", "1,", "-3", "2..1000000"] {
            assert!(numbers(bad).is_err(), "{bad}");
        }
    }
}
