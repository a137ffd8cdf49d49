//! `staya experiment swap`, `doorway` and `crossing`.

use crate::crossing::{Conditions, cases, doorway, swap};
use clap::Args;
use staya_console::options;
use staya_controller::agent::SafetyKind;
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Debug)]
struct Runs {
    /// The first seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Time between two decisions, seconds.
    #[arg(long, value_name = "S", default_value_t = 0.05)]
    step: f64,
    /// Highest speed, m/s.
    #[arg(long, value_name = "M/S", default_value_t = 0.5)]
    speed: f64,
    /// Range of the radio, metres [default: 3 for swap, else 6].
    #[arg(long, value_name = "M")]
    range: Option<f64>,
    /// Share of packets lost, 0 to 1.
    #[arg(long, value_name = "P", default_value_t = 0.0)]
    loss: f64,
    /// Safety layer; on a sphere it is always ORCA in space.
    #[arg(long, default_value = "orca", value_parser = options::crossing_safety())]
    safety: SafetyKind,
}

impl Runs {
    fn conditions(&self, range_m: f64) -> Conditions {
        Conditions {
            step_s: self.step,
            speed_mps: self.speed,
            range_m: self.range.unwrap_or(range_m),
            loss: self.loss,
            safety: self.safety,
        }
    }
}

#[derive(Args, Clone, Debug)]
struct Common {
    /// Largest random displacement of each start along both axes, metres.
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    noise: f64,
    /// Runs per point, with consecutive seeds.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: u32,
    #[command(flatten)]
    runs: Runs,
    /// Folder for rows and pictures [default: out/swap, out/doorway].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Common {
    fn out(&self, name: &str) -> PathBuf {
        let default = || Path::new("out").join(name);
        self.out.clone().unwrap_or_else(default)
    }
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct SwapArgs {
    /// Numbers of robots: single numbers and ranges, as in "4,6,8" or "2..64".
    #[arg(long, value_name = "LIST", default_value = "2..64", value_parser = numbers)]
    robots: Numbers,
    /// Radius of the circle, metres [default: 0.1 per robot, at least 2].
    #[arg(long, value_name = "M")]
    circle: Option<f64>,
    /// Time limit of a run in multiples of the free time.
    #[arg(long, value_name = "N", default_value_t = 6.0)]
    patience: f64,
    #[command(flatten)]
    common: Common,
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct DoorwayArgs {
    /// Widths of the gap, metres.
    #[arg(long, value_name = "M,M,...", value_delimiter = ',', default_values_t = [0.7, 0.8, 1.0, 1.3, 2.0])]
    widths: Vec<f64>,
    /// Robots on each side; their radius is 0.3 m.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1000))]
    robots: u32,
    /// Time limit of a run, seconds.
    #[arg(long, value_name = "S", default_value_t = 900.0)]
    longest: f64,
    #[command(flatten)]
    common: Common,
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct CrossingArgs {
    /// Cases to run [default: all].
    #[arg(long = "case", value_enum, value_delimiter = ',')]
    cases: Vec<cases::Case>,
    /// Robots per group, or of all in cases without groups [default: each case's own].
    #[arg(long, value_name = "N")]
    robots: Option<u32>,
    /// Time limit of a run, seconds.
    #[arg(long, value_name = "S", default_value_t = 900.0)]
    longest: f64,
    /// Duration of the radio failure in the case "blackout", seconds.
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    blackout: f64,
    /// Scale factor of bodies, routes, walls, speeds, noise and radio range.
    #[arg(long, value_name = "N", default_value_t = 1.0)]
    size: f64,
    /// Largest random displacement of each start along both axes, metres.
    #[arg(long, value_name = "M", default_value_t = 0.02)]
    noise: f64,
    /// Runs of each case, with consecutive seeds.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: u32,
    #[command(flatten)]
    runs: Runs,
    /// Folder for the rows.
    #[arg(long, value_name = "DIR", default_value = "out/crossing")]
    pub out: PathBuf,
}

impl CrossingArgs {
    pub fn plan(&self) -> cases::Plan {
        cases::Plan {
            cases: if self.cases.is_empty() { cases::Case::ALL.to_vec() } else { self.cases.clone() },
            robots: self.robots,
            noise_m: self.noise,
            seeds: self.seeds,
            seed: self.runs.seed,
            longest_s: self.longest,
            blackout_s: self.blackout,
            size: self.size,
            conditions: self.runs.conditions(6.0),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Numbers(Vec<u32>);

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

impl SwapArgs {
    pub fn plan(&self) -> swap::Plan {
        swap::Plan {
            robots: self.robots.0.clone(),
            circle_m: self.circle,
            noise_m: self.common.noise,
            seeds: self.common.seeds,
            seed: self.common.runs.seed,
            patience: self.patience,
            conditions: self.common.runs.conditions(3.0),
        }
    }

    pub fn out(&self) -> PathBuf {
        self.common.out("swap")
    }
}

impl DoorwayArgs {
    pub fn plan(&self) -> doorway::Plan {
        doorway::Plan {
            widths_m: self.widths.clone(),
            robots: self.robots,
            noise_m: self.common.noise,
            seeds: self.common.seeds,
            seed: self.common.runs.seed,
            longest_s: self.longest,
            conditions: self.common.runs.conditions(6.0),
        }
    }

    pub fn out(&self) -> PathBuf {
        self.common.out("doorway")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_ranges_are_parsed_in_any_order() {
        assert_eq!(numbers("8,2..4, 3"), Ok(Numbers(vec![2, 3, 4, 8])));
        for bad in ["", "0", "4..2", "..", "a", "1,", "-3", "2..1000000"] {
            assert!(numbers(bad).is_err(), "{bad}");
        }
    }
}
