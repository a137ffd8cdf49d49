//! The five simulations of R. Olfati-Saber 2006 (OLF, "Flocking for multi-agent dynamic systems",
//! IEEE TAC 51(3), section VIII), two others, and flocks driven at each other ([`closing`]).
//!
//! Every robot is an agent that knows others only from beacons of the previous tick; the paper's
//! particles have perfect knowledge. With a spacing of d metres, the paper's unit is d / 7. Results
//! are proportional to the spacing within two limits of beacons: positions are rounded to
//! millimetres, and speeds end at 32 m/s. At the paper's size, case A reaches this limit: robots
//! that start 150 units away would come in faster.
//!
//! **Parameters.** The paper gives no gains; the defaults are the best of those tried:
//!
//! - (c_alpha, c_gamma) = (50, 1) in A and (10, 0.2) in C, with c2 = 2 sqrt(c1).
//! - (10, 200, 2) with obstacles, in D and E, and a reference that moves at 3 units/s. With the
//!   paper's static reference (a fixed place, a velocity of 5 or 6), the parts of a split flock
//!   stay apart. `--reference resting` is a static reference whose velocity fades behind it.
//! - `--takes-turns`: a robot does not push towards robots nearer to the reference; its constants,
//!   d and 0.8 d, were tuned on other starts.
//!
//! Starts follow the paper's distributions (for B, which has none, a deviation of 20 units),
//! without overlaps. In space, a robot's attitude is that of its velocity, as in the paper
//! (`metrics::flock::attitude`).

mod case;
pub mod closing;
mod ideal;
mod pictures;
mod report;
mod watch;

pub use case::Case;
pub use report::{CaseReport, Report, RunReport};
pub use watch::Run;

use crate::experiment::rows::Jobs;
use crate::experiment::{Experiment, check_runs};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde::Serialize;
use staya_console::options::{self, word};
use staya_controller::agent::SafetyKind;
use staya_sim::engine::simulate;
use std::path::{Path, PathBuf};
use watch::Watch;

/// Bodies without inertia need only some steps.
const HORIZON_S: f64 = 0.3;

const GAP: f64 = 8.0 / 7.0;

/// The five flocking simulations of Olfati-Saber 2006 (section VIII), with agents.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Plan {
    /// Cases [default: the paper's five].
    #[arg(
        long = "case",
        value_enum,
        value_delimiter = ',',
        default_value = "free,fragment,rendezvous3d,split,squeeze",
        hide_default_value = true
    )]
    pub cases: Vec<Case>,
    /// Runs of each, with different starts.
    #[arg(long = "seeds", default_value_t = 10)]
    pub runs: u32,
    /// Number of robots, instead of the paper's.
    #[arg(long)]
    pub robots: Option<u32>,
    /// Safety layer behind the flock; in space "orca" means "fly".
    #[arg(long, default_value = "none", value_parser = options::safety())]
    pub safety: SafetyKind,
    // A long horizon keeps a flock from closing up: robots approach at distance d faster than ORCA
    // permits.
    /// Horizon of ORCA.
    #[arg(long = "horizon", value_name = "SECONDS", default_value_t = HORIZON_S)]
    pub horizon_s: f64,
    /// Distance of neighbours in the lattice (d); the radius of bodies is d / 14.
    #[arg(long = "spacing", value_name = "METRES", default_value_t = 7.0)]
    pub spacing_m: f64,
    /// Length of a tick.
    #[arg(long = "step", value_name = "SECONDS", default_value_t = 0.03)]
    pub step_s: f64,
    /// Length of each run, instead of the case's own.
    #[arg(long)]
    pub seconds: Option<f64>,
    /// Gain c1 on other robots, instead of the case's own.
    #[arg(long, value_name = "C1")]
    pub c_alpha: Option<f64>,
    /// Gain c1 on obstacles, instead of the case's own.
    #[arg(long, value_name = "C1")]
    pub c_beta: Option<f64>,
    /// Gain c1 on the reference, instead of the case's own.
    #[arg(long, value_name = "C1")]
    pub c_gamma: Option<f64>,
    /// Gain c2 on other robots' velocities, instead of 2 sqrt(c1).
    #[arg(long, value_name = "C2")]
    pub c2_alpha: Option<f64>,
    /// Gain c2 on the reference's velocity, instead of 2 sqrt(c1).
    #[arg(long, value_name = "C2")]
    pub c2_gamma: Option<f64>,
    /// Distance from obstacles over spacing (d' / d), instead of the case's own.
    #[arg(long, value_name = "RATIO")]
    pub obstacle_ratio: Option<f64>,
    /// References of cases with obstacles, one line of the table each.
    #[arg(long = "reference", value_enum, value_delimiter = ',', default_value = "moving,static")]
    pub references: Vec<Reference>,
    /// Distance behind a resting reference over which its velocity fades.
    #[arg(long, value_name = "SPACINGS", default_value_t = 10.0)]
    pub rest: f64,
    /// Do not push towards robots nearer to the reference (algorithm 3 only; not in the paper).
    #[arg(long)]
    pub takes_turns: bool,
    /// Width of the gap in case "gap".
    #[arg(long = "gap", value_name = "SPACINGS", default_value_t = GAP)]
    pub gap: f64,
    /// Particles as in the paper instead of agents: perfect knowledge, doubles, no speed limit.
    #[arg(long, conflicts_with_all = ["safety", "horizon_s", "loss"])]
    pub ideal: bool,
    /// Number of nearest particles that each ideal particle knows.
    #[arg(long, value_name = "N", requires = "ideal")]
    pub nearest: Option<usize>,
    /// Speed limit of ideal particles, in the paper's units.
    #[arg(long, value_name = "SPEED", requires = "ideal")]
    pub fastest: Option<f64>,
    /// Loss of packets, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    pub loss: f64,
    /// Seed; equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for rows and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-flock")]
    pub out: PathBuf,
}

impl Default for Plan {
    fn default() -> Self {
        options::defaults()
    }
}

/// Reference of cases with obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Reference {
    /// Moves ahead of the flock.
    Moving,
    /// Stands behind the obstacles and has a velocity nevertheless, as in the paper.
    Static,
    /// Stands behind the obstacles; its velocity fades behind it, so that the flock comes to rest.
    Resting,
}

impl Reference {
    /// Name in options and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Moving => "moving",
            Self::Static => "static",
            Self::Resting => "resting",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Point {
    case: Case,
    reference: Option<Reference>,
}

impl Point {
    fn name(self) -> String {
        match self.reference {
            Some(reference @ (Reference::Static | Reference::Resting)) => {
                format!("{}-{}", self.case.name(), reference.name())
            }
            _ => self.case.name().to_owned(),
        }
    }
}

impl Plan {
    fn lines(&self) -> Vec<Point> {
        let of = |&case: &Case| {
            let references: Vec<Option<Reference>> =
                if case.has_balls() { self.references.iter().copied().map(Some).collect() } else { vec![None] };
            references.into_iter().map(move |reference| Point { case, reference })
        };
        self.cases.iter().flat_map(of).collect()
    }

    fn run(&self, point: Point, number: u32) -> Result<Run> {
        let scenario = self.scenario(point, number)?;
        let mut watch = Watch::new(self, point.case, &scenario, number == 0);
        let hash = if self.ideal {
            ideal::simulate(self, &scenario, |tick, places, velocities| watch.see(tick, places, velocities))?
        } else {
            simulate(&scenario, |moment, robots| {
                watch.look(moment.row.tick, robots);
                std::ops::ControlFlow::Continue(())
            })?
            .trace_hash
        };
        let mut run = watch.finish(hash);
        run.verdict = report::verdict(self, point.case, &run);
        Ok(run)
    }
}

/// Beacons must represent positions and speeds; the flock must be stable with this step.
fn check_spacing_and_step(spacing_m: f64, step_s: f64) -> Result<()> {
    ensure!((0.1..=50.0).contains(&spacing_m), "a spacing of {spacing_m} m; it must be 0.1 to 50");
    ensure!((0.001..=0.1).contains(&step_s), "a step of {step_s} s; it must be 0.001 to 0.1");
    Ok(())
}

const COURSES: &str = "courses";

impl Experiment for Plan {
    const NAME: &'static str = "flock";
    const UNIT: &'static str = "runs";
    type Run = Run;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "of each case")?;
        ensure!(!self.cases.is_empty(), "no cases; give one or more");
        if let Some(robots) = self.robots {
            ensure!((2..=2000).contains(&robots), "{robots} robots; give 2 to 2000");
        }
        check_spacing_and_step(self.spacing_m, self.step_s)?;
        ensure!((0.01..=60.0).contains(&self.horizon_s), "a horizon of {} s; it must be 0.01 to 60", self.horizon_s);
        if let Some(seconds) = self.seconds {
            ensure!((1.0..=1e6).contains(&(seconds / self.step_s)), "{seconds} s; a run has 1 to 1,000,000 steps");
        }
        for gain in [self.c_alpha, self.c_beta, self.c_gamma, self.c2_alpha, self.c2_gamma].into_iter().flatten() {
            ensure!((0.0..=1e6).contains(&gain), "a gain of {gain}; it must be 0 to 1,000,000");
        }
        ensure!((0.0..=1.0).contains(&self.loss), "a loss of {}; it must be between 0 and 1", self.loss);
        ensure!(self.safety != SafetyKind::PushOut, "push-out comes with the goal flock; give orca, fly or none");
        ensure!(!self.references.is_empty(), "no references; give one or more");
        ensure!((0.1..=1e6).contains(&self.rest), "a rest of {} spacings; it must be 0.1 to 1,000,000", self.rest);
        if let Some(ratio) = self.obstacle_ratio {
            ensure!((0.01..=4.0).contains(&ratio), "an obstacle ratio of {ratio}; it must be 0.01 to 4");
        }
        ensure!((0.1..=10.0).contains(&self.gap), "a gap of {} spacings; it must be 0.1 to 10", self.gap);
        if let Some(fastest) = self.fastest {
            ensure!(fastest > 0.0, "a fastest speed of {fastest}; it must be above 0");
        }
        for point in self.lines() {
            self.scenario(point, 0)?;
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.lines().len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self {
            cases: _,
            runs: _,
            robots,
            safety,
            horizon_s,
            spacing_m,
            step_s,
            seconds,
            c_alpha: _,
            c_beta: _,
            c_gamma: _,
            c2_alpha,
            c2_gamma,
            obstacle_ratio: _,
            references: _,
            rest,
            takes_turns,
            gap,
            ideal,
            nearest,
            fastest,
            loss,
            seed,
            out: _,
        } = self;
        let Point { case, reference } = self.lines()[point];
        let setting = case.setting();
        let given = |value: Option<f64>| value.map_or_else(|| "".into(), Value::from);
        let [c_alpha, c_beta, c_gamma] = self.gains(case).map(Value::from);
        vec![
            ("case", case.name().into()),
            ("robots", robots.unwrap_or(setting.robots).into()),
            ("safety", word(*safety).into()),
            ("horizon_s", (*horizon_s).into()),
            ("spacing_m", (*spacing_m).into()),
            ("step_s", (*step_s).into()),
            ("seconds", seconds.unwrap_or(setting.seconds).into()),
            ("c_alpha", c_alpha),
            ("c_beta", c_beta),
            ("c_gamma", c_gamma),
            ("c2_alpha", given(*c2_alpha)),
            ("c2_gamma", given(*c2_gamma)),
            ("obstacle_ratio", self.obstacle_ratio(case).into()),
            ("reference", reference.map_or("", Reference::name).into()),
            ("rest", (*rest).into()),
            ("takes_turns", (*takes_turns).into()),
            ("gap", (*gap).into()),
            ("ideal", (*ideal).into()),
            ("nearest", given(nearest.map(|n| n as f64))),
            ("fastest", given(*fastest)),
            ("loss", (*loss).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// Seed of robots and radio; starts are a function of the first seed and the run's number.
    fn seed(&self, point: usize, run: u32) -> u64 {
        self.run_seed(self.lines()[point].case, run)
    }

    fn blank(&self, _: usize, _: u32) -> Run {
        Run::default()
    }

    /// Rows do not contain time series for pictures, so each run stores its own next to the rows; a
    /// run known from its row is repeated only if that file is missing.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Run>>> {
        let lines = self.lines();
        let file = |point: usize, run: usize| {
            jobs.folder().map(|out| out.join(COURSES).join(format!("{point}-{run}.postcard")))
        };
        let mut runs = jobs.each(|(): &mut (), point, number| {
            let run = self.run(lines[point], number)?;
            file(point, number as usize).map_or(Ok(()), |file| run.keep(&file))?;
            Ok(Some(run))
        })?;
        for (index, (point, runs)) in lines.iter().zip(&mut runs).enumerate() {
            runs.par_iter_mut().enumerate().filter(|(_, run)| run.trace.is_empty()).try_for_each(|(number, run)| {
                if let Some(kept) = file(index, number).and_then(|file| Run::kept(&file, run.hash)) {
                    *run = kept;
                    return Ok(());
                }
                let again = self.run(*point, number as u32)?;
                ensure!(
                    again.hash == run.hash,
                    "run {number} of {} is not that of its row; begin --restart",
                    point.name()
                );
                *run = again;
                Ok(())
            })?;
        }
        Ok(runs)
    }

    fn report(&self, runs: &[Vec<Run>]) -> Report {
        Report::of(self, runs)
    }

    fn draw(&self, _: &[Vec<Run>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        Ok(report.draw(dir)?)
    }
}

#[cfg(test)]
mod tests;
