//! The goal flock of V. E. Pavlovsky and V. V. Pavlovsky ("Mathematical model of a two-dimensional
//! homogeneous flock of robots", PAV): 225 robots, three goals, and group order over K1 / K2 and
//! R_nbh.
//!
//! Robots start at random in a square, move to the middle of the goals, and draw one of the goals
//! there. As in the paper, each robot knows all robots within R_nbh ([`Knowledge::All`]), and
//! push-out keeps them apart. With `--knows packets` they are agents with sixteen neighbours each,
//! behind any safety layer. The paper varies K1 from 0 to 150 at R_MinDist = 10 and R_nbh = 40, but
//! gives neither K2, K3 nor distances: here K2 = 50, K3 = 100, goals are 614 to 950 m away, and
//! robots move at 10 m/s.
//!
//! **Measures of group order** are averaged over the way to the middle, until a tenth of the robots
//! were there, because robots part from then on:
//!
//! - company: number of other robots within four R_MinDist of a robot
//! - share of the robots in the largest group (linked within two R_MinDist)
//! - polarisation: length of the mean direction
//! - spread: radius of the crowd (root mean square) divided by that at its start
//!
//! A robot has gathered once its distance to the middle was at most 1.5 times the radius of the
//! lattice of the robots that go to one goal.
//!
//! **Reference.** Robots with K2 = 0 are independent, and their company is an effect of the start
//! and of the common goal. Each point is therefore compared with the one with K2 = 0 and all else
//! equal. The difference in company rises with K2 and R_nbh and vanishes if K1 far exceeds K2, as
//! the paper states, for any knowledge and any safety layer.
//!
//! **Unsuitable measure.** From a dense start (`--start-side 2`) robots are one group without any
//! K2 (share of the largest group: 0.99). There, K2 draws them into local clumps, so a larger K2
//! splits the group.

mod direct;
mod pictures;
mod report;
mod scene;
mod setting;
mod threshold;
pub mod tune;
mod watch;

pub use report::{Point, Report};
pub use setting::{Knowledge, Setting};
pub use threshold::Threshold;
pub use watch::Run;

use crate::arena::Arena;
use crate::experiment::rows::Jobs;
use crate::experiment::{Experiment, check_runs};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use clap::Args;
use scene::Scene;
use staya_console::options::{self, word};
use staya_controller::agent::{GuidanceSetup, SafetyKind};
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::{Evasion, Model, PushOutParams};
use staya_controller::rand::Rng;
use staya_sim::engine::simulate;
use staya_sim::scenario::{Order, Scenario};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use watch::Watch;

/// First random number stream: starts, then draws of goals, obstacles, and places of goals.
const STARTS: u32 = 0x0047_0101;

/// The goal flock of Pavlovsky and Pavlovsky: group order over K1 / K2 and R_nbh. All lists are
/// crossed with each other.
#[derive(Args, Clone, Debug, PartialEq)]
#[command(allow_negative_numbers = true)]
pub struct Plan {
    /// Gains of the attraction to the goal.
    #[arg(long, value_name = "K1,...", value_delimiter = ',', default_value = "0,5,15,30,50,100,150")]
    pub k1: Vec<f64>,
    /// Gains of the attraction to the middle of the neighbours; 0: independent robots.
    #[arg(long, value_name = "K2,...", value_delimiter = ',', default_value = "0,50")]
    pub k2: Vec<f64>,
    /// Gains of the repulsion from robots that are too near.
    #[arg(long, value_name = "K3,...", value_delimiter = ',', default_value = "100")]
    pub k3: Vec<f64>,
    /// Range of sight (R_nbh), at least two smallest distances.
    #[arg(long = "neighborhood", value_name = "METRES,...", value_delimiter = ',', default_value = "20,40,80")]
    pub neighborhoods_m: Vec<f64>,
    /// Smallest distance of robots (R_MinDist); the radius of bodies is 0.3 R_MinDist.
    #[arg(long = "min-distance", value_name = "METRES", default_value_t = 10.0)]
    pub min_distance_m: f64,
    /// Numbers of robots.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "225")]
    pub robots: Vec<u32>,
    /// Numbers of goals, 1 to 4.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "3")]
    pub goals: Vec<u32>,
    /// Draw other places of the goals in each run.
    #[arg(long)]
    pub random_goals: bool,
    /// Speeds of all goals, to the north.
    #[arg(long = "goal-speed", value_name = "MPS,...", value_delimiter = ',', default_value = "0")]
    pub goal_speeds_mps: Vec<f64>,
    /// Move the first goal after a quarter of the time, by an operator's order.
    #[arg(long = "move-goal")]
    pub moves_goal: bool,
    /// Sides of the square of the starts, in R_MinDist per root of the robots; 2: one group.
    #[arg(long = "start-side", value_name = "SIDE,...", value_delimiter = ',', default_value = "4")]
    pub start_sides: Vec<f64>,
    /// Numbers of round obstacles, at random between the start and the goals.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "0")]
    pub obstacles: Vec<u32>,
    /// Knowledge of the robots about each other.
    #[arg(
        long,
        value_name = "WORD,...",
        value_delimiter = ',',
        default_value = "all",
        value_parser = setting::knowledge()
    )]
    pub knows: Vec<Knowledge>,
    /// Safety layers behind the flock; without one, robots overlap around the goals.
    #[arg(
        long = "safety",
        value_name = "WORD,...",
        value_delimiter = ',',
        default_value = "push-out",
        value_parser = options::safety()
    )]
    pub safeties: Vec<SafetyKind>,
    /// Models of push-out.
    #[arg(
        long = "model",
        value_name = "WORD,...",
        value_delimiter = ',',
        default_value = "radial",
        value_parser = options::model()
    )]
    pub models: Vec<Model>,
    /// Number of robots that push-out evades at once.
    #[arg(
        long = "evasion",
        value_name = "WORD,...",
        value_delimiter = ',',
        default_value = "multiple",
        value_parser = options::evasion()
    )]
    pub evasions: Vec<Evasion>,
    /// Runs per point, with different starts.
    #[arg(long = "seeds", default_value_t = 1)]
    pub runs: u32,
    /// Length of each run.
    #[arg(long, default_value_t = 240.0)]
    pub seconds: f64,
    /// Length of a tick.
    #[arg(long = "step", value_name = "SECONDS", default_value_t = 0.1)]
    pub step_s: f64,
    /// Seed; equal seeds give equal results. Start, gains and measures were chosen on seed 1.
    #[arg(long, default_value_t = 11)]
    pub seed: u64,
    /// Folder for rows and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-goals")]
    pub out: PathBuf,
}

impl Default for Plan {
    fn default() -> Self {
        options::defaults()
    }
}

impl Plan {
    /// Radius of a body, metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        0.3 * self.min_distance_m
    }

    /// One R_MinDist per second.
    fn speed_mps(&self) -> f64 {
        self.min_distance_m
    }

    fn run_seed(&self, run: u32) -> u64 {
        Rng::keyed(self.seed, STARTS + 1, run, 0).next_u64()
    }

    fn scenario(&self, setting: &Setting, scene: &Scene, run: u32) -> Scenario {
        let (unit, speed_mps, seed) = (self.min_distance_m, self.speed_mps(), self.run_seed(run));
        let params = setting.params(unit, speed_mps);
        let arena = Arena {
            name: "goals",
            seed,
            step_s: self.step_s,
            seconds: self.seconds,
            radius_m: self.radius_m(),
            max_speed_mps: speed_mps,
            range_m: setting.neighborhood_m,
            loss: 0.0,
            sight_m: 2.0 * unit,
            guidance: GuidanceSetup::GoalFlock { params, arrival_m: (setting.arrival() * unit) as f32, seed },
            safety: setting.safety,
            orca: AvoidParams { margin_m: (unit / 50.0) as f32, ..AvoidParams::default() },
            push_out: PushOutParams {
                model: setting.model,
                evasion: setting.evasion,
                // One step more than the bodies need.
                min_distance_m: (2.0 * self.radius_m() + speed_mps * self.step_s) as f32,
            },
            solids: scene.solids.clone(),
        };
        let mut setup = arena.setup(scene.starts.clone());
        setup.orders.extend(scene.order().map(|(tick, target)| Order { tick, index: 0, target }));
        arena.scenario(setup)
    }

    fn run(&self, setting: &Setting, number: u32, draws: bool) -> Result<Run> {
        let scene = Scene::new(self, setting, number)?;
        let mut watch = Watch::new(self, setting, &scene, draws);
        if setting.knows != Knowledge::Packets {
            let hash = direct::run(self, setting, &scene, self.run_seed(number), &mut watch)?;
            return Ok(watch.finish(hash));
        }
        let outcome = simulate(&self.scenario(setting, &scene, number), |moment, robots| {
            let motions = robots.map(|robot| robot.motion);
            let two = |[x, y, _]: [f64; 3]| [x, y];
            let (places_m, velocities_mps) =
                motions.map(|motion| (two(motion.position_m), two(motion.velocity_mps))).unzip();
            watch.look(moment.row.tick, places_m, velocities_mps);
            ControlFlow::Continue(())
        })?;
        Ok(watch.finish(outcome.trace_hash))
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "goals";
    const UNIT: &'static str = "runs";
    type Run = Run;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "of each point")?;
        let steps = self.seconds / self.step_s;
        ensure!((1.0..=1e6).contains(&steps), "{} s; a run has 1 to 1,000,000 steps", self.seconds);
        self.check_settings()?;
        let mut scenes: Vec<Setting> = Vec::new();
        for setting in self.settings() {
            if !scenes.contains(&setting.scene()) {
                Scene::new(self, &setting, 0)?;
                scenes.push(setting.scene());
            }
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.settings().len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let mut given = self.settings()[point].given();
        given.extend(self.common());
        given
    }

    /// Seed of the robots' draws; starts are a function of the first seed and the run's number.
    fn seed(&self, _: usize, run: u32) -> u64 {
        self.run_seed(run)
    }

    fn blank(&self, _: usize, _: u32) -> Run {
        Run::default()
    }

    /// Rows do not contain moments for pictures, so the drawn runs are repeated.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Run>>> {
        let settings = self.settings();
        let mut runs = jobs.each(|(): &mut (), point, run| self.run(&settings[point], run, false).map(Some))?;
        for point in pictures::drawn(&settings) {
            if let Some(first) = runs[point].first_mut().filter(|_| jobs.may_continue()) {
                let again = self.run(&settings[point], 0, true)?;
                ensure!(again.hash == first.hash, "a run is not that of its row; begin --restart");
                *first = again;
            }
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

impl Plan {
    fn common(&self) -> Vec<(&'static str, Value)> {
        vec![
            ("min_distance_m", self.min_distance_m.into()),
            ("random_goals", Value::Truth(self.random_goals)),
            ("moves_goal", Value::Truth(self.moves_goal)),
            ("seconds", self.seconds.into()),
            ("step_s", self.step_s.into()),
            ("first_seed", self.seed.to_string().into()),
        ]
    }
}

impl Setting {
    /// Parameters for rows and reports.
    #[must_use]
    pub fn given(&self) -> Vec<(&'static str, Value)> {
        let Self {
            k1,
            k2,
            k3,
            neighborhood_m,
            robots,
            goals,
            goal_speed_mps,
            obstacles,
            start_side,
            knows,
            safety,
            model,
            evasion,
        } = *self;
        vec![
            ("k1", k1.into()),
            ("k2", k2.into()),
            ("k3", k3.into()),
            ("neighborhood_m", neighborhood_m.into()),
            ("robots", robots.into()),
            ("goals", goals.into()),
            ("goal_speed_mps", goal_speed_mps.into()),
            ("obstacles", obstacles.into()),
            ("start_side", start_side.into()),
            ("knows", word(knows).into()),
            ("safety", word(safety).into()),
            ("model", word(model).into()),
            ("evasion", word(evasion).into()),
        ]
    }
}

#[cfg(test)]
mod tests;
