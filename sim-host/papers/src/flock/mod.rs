//! The five simulations of R. Olfati-Saber 2006 ("Flocking for multi-agent dynamic systems", IEEE TAC 51(3), section
//! VIII), and how close a flock may be driven together ([`closing`]).
//!
//! Every robot is an agent of its own that knows what it hears: beacons over the simulated radio, from the tick before.
//! The paper's particles know everything at once. Spacing is d metres and a unit of the paper d / 7: any other size
//! gives the same with all lengths and speeds in proportion, but for millimetres in beacons and their limit of 32 m/s,
//! which the paper's own size meets in case A: robots that start 150 units out come in faster than that.
//!
//! **Parameters.** The paper tells no gains. Those here are what worked best of what was tried ([`Plan`] takes others):
//! (c_alpha, c_gamma) = (50, 1) in A, (10, 0.2) in C; (10, 200, 2) with obstacles, in D and E, behind a reference that moves at 3 units/s
//! (the paper's stands, with a velocity of 5 or 6: with it the parts of a split flock stay side by side for long). c2 = 2 sqrt(c1).
//! Starts are the paper's distributions (of B it tells
//! none: 20 units of deviation), drawn anew where two bodies would overlap. In space the attitude of a robot is the direction of its velocity, no more.

mod case;
pub mod closing;
mod pictures;
mod report;
mod watch;

pub use case::Case;
pub use report::{CaseReport, Report, RunReport};
pub use watch::Run;

use crate::experiment::rows::Jobs;
use crate::experiment::{Experiment, check_runs};
use crate::options::{self, word};
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use staya_controller::agent::SafetyKind;
use staya_sim::engine::simulate;
use staya_sweep::Value;
use std::path::{Path, PathBuf};
use watch::Watch;

/// How far ahead ORCA looks behind a flock, seconds: bodies without inertia need no more than some steps.
const HORIZON_S: f64 = 0.3;

/// What to do: the five flocking simulations of Olfati-Saber 2006 (section VIII), each robot an agent that hears packets only.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which simulations [default: all].
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
    // Long ones keep a flock from closing up: its robots come in faster than they may towards somebody who is d away, and
    // swerve.
    /// How far ahead ORCA looks.
    #[arg(long = "horizon", value_name = "SECONDS", default_value_t = HORIZON_S)]
    pub horizon_s: f64,
    /// Distance of neighbours in the lattice (d); bodies have a fourteenth of it as radius.
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
    /// Where the reference of D and E is.
    #[arg(long, value_enum, default_value = "moving")]
    pub reference: Reference,
    /// Loss of packets, 0 to 1.
    #[arg(long, default_value_t = 0.0)]
    pub loss: f64,
    /// Equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for rows and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-flock")]
    pub out: PathBuf,
}

impl Default for Plan {
    /// All five, as the paper has them.
    fn default() -> Self {
        options::defaults()
    }
}

/// Where the reference of D and E is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Reference {
    /// It goes ahead of the flock.
    Moving,
    /// It stands behind the obstacles, and has a velocity all the same (the paper's).
    Static,
}

impl Plan {
    fn run(&self, case: Case, number: u32) -> Result<Run> {
        let scenario = self.scenario(case, number)?;
        let mut watch = Watch::new(self, case, &scenario, number == 0);
        let outcome = simulate(&scenario, |moment, robots| {
            watch.look(moment.row.tick, robots);
            std::ops::ControlFlow::Continue(())
        })?;
        let mut run = watch.finish(outcome.trace_hash);
        run.verdict = report::verdict(self, case, &run);
        Ok(run)
    }
}

/// A spacing at which beacons tell places well enough, and speeds at all; a step at which the flock does not fly apart.
fn check_spacing_and_step(spacing_m: f64, step_s: f64) -> Result<()> {
    ensure!((0.1..=50.0).contains(&spacing_m), "a spacing of {spacing_m} m; it must be 0.1 to 50");
    ensure!((0.001..=0.1).contains(&step_s), "a step of {step_s} s; it must be 0.001 to 0.1");
    Ok(())
}

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
        for gain in [self.c_alpha, self.c_beta, self.c_gamma].into_iter().flatten() {
            ensure!((0.0..=1e6).contains(&gain), "a gain of {gain}; it must be 0 to 1,000,000");
        }
        ensure!((0.0..=1.0).contains(&self.loss), "a loss of {}; it must be between 0 and 1", self.loss);
        ensure!(self.safety != SafetyKind::PushOut, "push-out comes with the goal flock; give orca, fly or none");
        for &case in &self.cases {
            self.scenario(case, 0)?;
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.cases.len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        // By name, so that a new field is not forgotten.
        let Self {
            cases,
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
            reference,
            loss,
            seed,
            out: _,
        } = self;
        let case = cases[point];
        let setting = case.setting();
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
            ("static_reference", (*reference == Reference::Static).into()),
            ("loss", (*loss).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// That of the robots and the radio; starts are a function of the first seed and the run's number.
    fn seed(&self, point: usize, run: u32) -> u64 {
        self.run_seed(self.cases[point], run)
    }

    fn blank(&self, _: usize, _: u32) -> Run {
        Run::default()
    }

    /// Rows have no course of the measures, which pictures show: runs that were read of rows are made again for it.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Run>>> {
        let mut runs = jobs.each(|(): &mut (), point, run| self.run(self.cases[point], run).map(Some))?;
        for (&case, runs) in self.cases.iter().zip(&mut runs) {
            runs.par_iter_mut().enumerate().filter(|(_, run)| run.trace.is_empty()).try_for_each(|(number, run)| {
                let again = self.run(case, number as u32)?;
                ensure!(again.hash == run.hash, "run {number} of {} is not that of its row; begin --anew", case.name());
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
