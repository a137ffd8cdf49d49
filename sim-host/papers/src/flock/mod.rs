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
pub(super) use report::safety_name;
pub use report::{CaseReport, Report, RunReport};

use super::{MAX_RUNS, in_parallel};
use staya_sim::engine::simulate;
use staya_sim::scenario::SafetyName;
use staya_sim::world::Misplaced;
use watch::{Run, Watch};

/// How far ahead ORCA looks behind a flock, seconds: bodies without inertia need no more than some steps.
const HORIZON_S: f64 = 0.3;

/// What to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which simulations.
    pub cases: Vec<Case>,
    /// Runs of each, 1 or more.
    pub runs: u32,
    /// Robots, 2 to 2000; `None`: as many as the paper's.
    pub robots: Option<u32>,
    /// What is behind the flock; [`SafetyName::Orca`] means [`SafetyName::Fly`] in space.
    pub safety: SafetyName,
    /// How far ahead ORCA looks, seconds, 0.01 to 60. Long ones keep a flock from closing up: its robots come in faster than
    /// they may towards somebody who is d away, and swerve.
    pub horizon_s: f64,
    /// Distance of neighbours in the lattice (d), metres, 0.1 to 50.
    pub spacing_m: f64,
    /// Length of a tick, seconds, 0.001 to 0.1. The paper's are 0.01 to 0.03.
    pub step_s: f64,
    /// How long each run is, seconds; `None`: the case's own.
    pub seconds: Option<f64>,
    /// c1 of alpha-, beta- and gamma-agents instead of the case's own, 0 or more.
    pub gains: [Option<f64>; 3],
    /// Whether the reference of D and E is the paper's, which stands and has a velocity all the same.
    pub is_static: bool,
    /// Loss of packets, 0 to 1.
    pub loss: f64,
    /// Equal seeds give equal results.
    pub seed: u64,
}

impl Default for Plan {
    /// All five, as the paper has them.
    fn default() -> Self {
        Self {
            cases: Case::ALL.to_vec(),
            runs: 10,
            robots: None,
            safety: SafetyName::None,
            horizon_s: HORIZON_S,
            spacing_m: 7.0,
            step_s: 0.03,
            seconds: None,
            gains: [None; 3],
            is_static: false,
            loss: 0.0,
            seed: 1,
        }
    }
}

/// Why a plan cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// Nothing to look at.
    #[error("0 runs; make 1 or more of each case")]
    NoRuns,
    /// Their results would not fit the memory.
    #[error("{0} runs; make at most {MAX_RUNS}")]
    Runs(u32),
    /// Nothing to run.
    #[error("no cases; give one or more")]
    NoCases,
    /// No flock, or no room.
    #[error("{0} robots; give 2 to 2000, and a spacing at which they find room")]
    Robots(u32),
    /// Beacons would not tell places well enough, or speeds at all.
    #[error("a spacing of {0} m; it must be 0.1 to 50")]
    Spacing(f64),
    /// No robot decides so often, or the flock flies apart.
    #[error("a step of {0} s; it must be 0.001 to 0.1")]
    Step(f64),
    /// ORCA would see nothing, or everything.
    #[error("a horizon of {0} s; it must be 0.01 to 60")]
    Horizon(f64),
    /// No time, or too much memory for what is measured.
    #[error("{0} s; a run has 1 to 1,000,000 steps")]
    Time(f64),
    /// No gain.
    #[error("a gain of {0}; it must be 0 to 1,000,000")]
    Gain(f64),
    /// No probability.
    #[error("a loss of {0}; it must be between 0 and 1")]
    Loss(f64),
    /// Nobody meets, or beacons cannot tell it.
    #[error("a closing speed of {speed} d/s; it must be more than 0 and at most {fastest:.2}")]
    Speed {
        /// Wanted.
        speed: f64,
        /// For this spacing.
        fastest: f64,
    },
    /// Another experiment's.
    #[error("push-out comes with the goal flock; give orca, fly or none")]
    PushOut,
    /// The robots cannot start.
    #[error(transparent)]
    Start(#[from] Misplaced),
}

/// What was done so far.
#[derive(Clone, Debug)]
pub struct Results {
    plan: Plan,
    /// Case after case within each number of a run.
    runs: Vec<Run>,
}

impl Plan {
    /// Whether the plan can be carried out.
    ///
    /// # Errors
    /// [`PlanError`]
    pub fn check(&self) -> Result<(), PlanError> {
        match self.runs {
            0 => return Err(PlanError::NoRuns),
            runs if runs > MAX_RUNS => return Err(PlanError::Runs(runs)),
            _ => {}
        }
        if self.cases.is_empty() {
            return Err(PlanError::NoCases);
        }
        if let Some(robots) = self.robots.filter(|robots| !(2..=2000).contains(robots)) {
            return Err(PlanError::Robots(robots));
        }
        if !(0.1..=50.0).contains(&self.spacing_m) {
            return Err(PlanError::Spacing(self.spacing_m));
        }
        if !(0.001..=0.1).contains(&self.step_s) {
            return Err(PlanError::Step(self.step_s));
        }
        if !(0.01..=60.0).contains(&self.horizon_s) {
            return Err(PlanError::Horizon(self.horizon_s));
        }
        if let Some(seconds) = self.seconds {
            let steps = seconds / self.step_s;
            if !(1.0..=1e6).contains(&steps) {
                return Err(PlanError::Time(seconds));
            }
        }
        let gains = self.gains.iter().flatten();
        for gain in gains {
            if !(0.0..=1e6).contains(gain) {
                return Err(PlanError::Gain(*gain));
            }
        }
        if !(0.0..=1.0).contains(&self.loss) {
            return Err(PlanError::Loss(self.loss));
        }
        if self.safety == SafetyName::PushOut {
            return Err(PlanError::PushOut);
        }
        for &case in &self.cases {
            self.scenario(case, 0)?;
        }
        Ok(())
    }

    /// Runs in all.
    #[must_use]
    pub fn total(&self) -> usize {
        self.cases.len() * self.runs as usize
    }

    fn run(&self, case: Case, number: u32) -> Result<Run, PlanError> {
        let scenario = self.scenario(case, number)?;
        let mut watch = Watch::new(self, case, &scenario, number == 0);
        let outcome = simulate(&scenario, |moment, robots| {
            watch.look(moment.row.tick, robots);
            std::ops::ControlFlow::Continue(())
        })?;
        Ok(watch.finish(outcome.trace_hash))
    }

    /// Does everything, in parallel. `progress` is told how many runs are done; when it answers `false`, what is done so
    /// far is returned.
    ///
    /// # Errors
    /// [`PlanError`]
    pub fn carry_out(&self, progress: impl FnMut(usize) -> bool) -> Result<Results, PlanError> {
        self.check()?;
        let cases = self.cases.len();
        let runs = in_parallel(self.total(), 1, progress, |(): &mut (), job| {
            self.run(self.cases[job % cases], (job / cases) as u32)
        })?;
        Ok(Results {
            plan: self.clone(),
            runs,
        })
    }
}

impl Results {
    /// Runs done.
    #[must_use]
    pub fn done(&self) -> usize {
        self.runs.len()
    }
}

#[cfg(test)]
mod tests;
