//! The goal flock of V. E. Pavlovsky and V. V. Pavlovsky ("Mathematical model of a two-dimensional homogeneous flock of
//! robots"): 225 robots, three goals, and how much of a group they are over K1 / K2 and R_nbh.
//!
//! Robots start at random in a square, go to the middle of the goals together, and there each draws one of them. Every robot
//! is an agent that hears packets; it knows its sixteen nearest neighbours within R_nbh, where the paper's
//! know all. The paper sweeps K1 from 0 to 150 at R_MinDist = 10 and R_nbh = 40 and tells neither K2 nor K3, nor distances:
//! here K2 = 50 and K3 = 100, goals are 670 to 850 m away, robots go at 10 m/s.
//!
//! **Group order as numbers**, all over the way to the middle (until half of the robots were there): polarisation (length of the
//! mean direction), the share of robots in the largest group (linked within two R_MinDist), and the crowd's radius (root mean
//! square) over that of its start. A robot has gathered once it was within [`Plan::arrival_m`] of the middle.
//!
//! **What they show.** From a dense start (`--start-side 2`) order falls where K2 outweighs K1 and a small R_nbh lets the
//! crowd break up. That the group is lost where K1 is far above K2, as the paper says, they hardly show: who starts as one
//! group and has one goal in common goes one way, whatever K2 is. `--start-side 4` draws places farther apart than the
//! groups' links, so that a group has yet to form.

mod land;
mod pictures;
mod report;
mod watch;

pub use report::{Point, Report};
pub use watch::Run;

use crate::arena::{Arena, starts, ticks, uniform};
use crate::experiment::rows::Jobs;
use crate::experiment::{Experiment, check_runs};
use crate::options::{self, word};
use anyhow::{Context as _, Result, ensure};
use clap::Args;
use staya_controller::agent::{GuidanceSetup, SafetyKind};
use staya_controller::flock::goal::GoalParams;
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::{Evasion, Model, PushOutParams};
use staya_controller::rand::Rng;
use staya_sim::engine::simulate;
use staya_sim::scenario::{Order, Scenario, Target};
use staya_sweep::Value;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use watch::Watch;

/// Purpose of the random numbers that give each run its starts.
const STARTS: u32 = 0x0047_0101;
/// Where the goals are, in R_MinDist.
const GOALS: [[f64; 2]; 3] = [[85.0, 0.0], [62.5, 25.0], [62.5, -25.0]];
/// Where the first goal goes when it moves, in R_MinDist.
const MOVED: [f64; 2] = [90.0, 20.0];

/// What to do: the goal flock of Pavlovsky and Pavlovsky, 225 robots and three goals, group order over K1 / K2 and R_nbh.
#[derive(Args, Clone, Debug, PartialEq)]
#[command(allow_negative_numbers = true)]
pub struct Plan {
    /// Gains of the pull to the goal.
    #[arg(long, value_name = "K1,...", value_delimiter = ',', default_value = "0,5,15,30,50,100,150")]
    pub k1: Vec<f64>,
    /// Gain of the pull to the middle of the neighbours.
    #[arg(long, default_value_t = 50.0)]
    pub k2: f64,
    /// Gain of the push away from robots that are too near.
    #[arg(long, default_value_t = 100.0)]
    pub k3: f64,
    /// How far neighbours are seen (R_nbh), two least distances or more; the nearest sixteen count.
    #[arg(long = "neighborhood", value_name = "METRES,...", value_delimiter = ',', default_value = "20,40")]
    pub neighborhoods_m: Vec<f64>,
    /// Least distance of robots (R_MinDist); bodies have 0.3 of it as radius.
    #[arg(long = "min-distance", value_name = "METRES", default_value_t = 10.0)]
    pub min_distance_m: f64,
    /// Number of robots.
    #[arg(long, default_value_t = 225)]
    pub robots: u32,
    /// Side of the square in which robots start at random, in R_MinDist and per root of their number. At 2 they are one
    /// group from the start.
    #[arg(long, default_value_t = 2.0)]
    pub start_side: f64,
    /// Round obstacles at random between the start and the goals.
    #[arg(long, default_value_t = 0)]
    pub obstacles: u32,
    /// Runs per point, with different starts.
    #[arg(long = "seeds", default_value_t = 1)]
    pub runs: u32,
    /// Safety layer behind the flock; with none, robots overlap where they crowd around the goals.
    #[arg(long, default_value = "orca", value_parser = options::safety())]
    pub safety: SafetyKind,
    /// What push-out makes of a step.
    #[arg(long, default_value = "radial", value_parser = options::model())]
    pub model: Model,
    /// How many robots push-out evades at once.
    #[arg(long, default_value = "multiple", value_parser = options::evasion())]
    pub evasion: Evasion,
    /// Length of each run.
    #[arg(long, default_value_t = 240.0)]
    pub seconds: f64,
    /// Length of a tick.
    #[arg(long = "step", value_name = "SECONDS", default_value_t = 0.1)]
    pub step_s: f64,
    /// The operator moves the first goal after a quarter of the time.
    #[arg(long = "move-goal")]
    pub moves_goal: bool,
    /// Equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
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

    /// How near to the middle, or to a goal, counts as being there: half as wide again as the lattice of the robots that
    /// go to one goal.
    #[must_use]
    pub fn arrival_m(&self) -> f64 {
        let each = f64::from(self.robots) / 3.0;
        let lattice_m = libm::sqrt(each * libm::sqrt(3.0) / (2.0 * std::f64::consts::PI));
        1.5 * self.min_distance_m * lattice_m.max(2.0)
    }

    /// Half of the side of the square in which robots start, metres.
    fn start_half_m(&self) -> f64 {
        self.start_side * self.min_distance_m * libm::sqrt(f64::from(self.robots)) / 2.0
    }

    /// Speed of the robots, m/s: R_MinDist in a second.
    fn speed_mps(&self) -> f64 {
        self.min_distance_m
    }

    /// The goals, metres.
    fn goals_m(&self) -> [[f64; 3]; 3] {
        GOALS.map(|[x, y]| [x * self.min_distance_m, y * self.min_distance_m, 0.0])
    }

    /// The tick in which the first one moves.
    fn moves_at(&self) -> u32 {
        ticks(self.seconds / 4.0, self.step_s)
    }

    /// The goals after a tick.
    fn goals_at(&self, tick: u32) -> [[f64; 3]; 3] {
        let mut goals_m = self.goals_m();
        if self.moves_goal && tick > self.moves_at() {
            goals_m[0] = self.moved_m();
        }
        goals_m
    }

    /// Where the first one is moved to, metres.
    fn moved_m(&self) -> [f64; 3] {
        let [x, y] = MOVED.map(|c| c * self.min_distance_m);
        [x, y, 0.0]
    }

    /// K1 and R_nbh of each point.
    fn points(&self) -> Vec<(f64, f64)> {
        let over_k1 = |&nbh: &f64| self.k1.iter().map(move |&k1| (k1, nbh));
        self.neighborhoods_m.iter().flat_map(over_k1).collect()
    }

    /// The seed of a run's scenario.
    fn run_seed(&self, run: u32) -> u64 {
        Rng::keyed(self.seed, STARTS + 1, run, 0).next_u64()
    }

    fn scenario(&self, k1: f64, neighborhood_m: f64, run: u32) -> Result<Scenario> {
        let targets = self.goals_m().map(|position_m| Target { position_m, velocity_mps: [0.0; 3] });
        let side = self.start_half_m();
        let starts = starts(
            self.robots,
            self.min_distance_m,
            &targets,
            |robot| Rng::keyed(self.seed, STARTS, run, robot),
            |rng| {
                let place = [uniform(rng, -side, side), uniform(rng, -side, side), 0.0];
                (place, [0.0; 3])
            },
        )
        .with_context(|| format!("{} robots find no room; give fewer", self.robots))?;
        let speed_mps = self.speed_mps();
        let params = GoalParams {
            goal_gain: k1 as f32,
            center_gain: self.k2 as f32,
            repulsion_gain: self.k3 as f32,
            neighborhood_m: neighborhood_m as f32,
            ..GoalParams::new(self.min_distance_m as f32, speed_mps as f32)
        };
        let seed = self.run_seed(run);
        let arena = Arena {
            name: "goals",
            seed,
            step_s: self.step_s,
            seconds: self.seconds,
            radius_m: self.radius_m(),
            max_speed_mps: speed_mps,
            range_m: neighborhood_m,
            loss: 0.0,
            sight_m: 2.0 * self.min_distance_m,
            guidance: GuidanceSetup::GoalFlock { params, arrival_m: self.arrival_m() as f32, seed },
            safety: self.safety,
            // Beacons are a step old.
            orca: AvoidParams { margin_m: (self.min_distance_m / 50.0) as f32, ..AvoidParams::default() },
            push_out: PushOutParams {
                model: self.model,
                evasion: self.evasion,
                // A step more than bodies need.
                min_distance_m: (2.0 * self.radius_m() + speed_mps * self.step_s) as f32,
            },
            solids: self.solids(run)?,
        };
        let mut setup = arena.setup(starts);
        if self.moves_goal {
            setup.orders.push(Order {
                tick: self.moves_at(),
                index: 0,
                target: Target { position_m: self.moved_m(), velocity_mps: [0.0; 3] },
            });
        }
        Ok(arena.scenario(setup))
    }

    fn run(&self, (k1, neighborhood_m): (f64, f64), number: u32) -> Result<Run> {
        let scenario = self.scenario(k1, neighborhood_m, number)?;
        let mut watch = Watch::new(self, &scenario, number == 0);
        let outcome = simulate(&scenario, |moment, robots| {
            watch.look(moment.row.tick, robots);
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
        ensure!(!self.points().is_empty(), "no points; give one K1 and one neighbourhood or more");
        ensure!((2..=2000).contains(&self.robots), "{} robots; give 2 to 2000", self.robots);
        for gain in self.k1.iter().chain([&self.k2, &self.k3]) {
            ensure!((-1e6..=1e6).contains(gain), "a gain of {gain}; give a number within +-1,000,000");
        }
        let side = self.start_side;
        ensure!((1.2..=20.0).contains(&side), "a start side of {side}; it must be 1.2 to 20");
        let distance_m = self.min_distance_m;
        ensure!((0.1..=30.0).contains(&distance_m), "a least distance of {distance_m} m; it must be 0.1 to 30");
        let least_m = 2.0 * distance_m;
        for wide_m in &self.neighborhoods_m {
            ensure!(
                (least_m..=1e5).contains(wide_m),
                "a neighbourhood of {wide_m} m; it must be {least_m} (two least distances) to 100,000"
            );
        }
        ensure!((0.001..=0.5).contains(&self.step_s), "a step of {} s; it must be 0.001 to 0.5", self.step_s);
        let steps = self.seconds / self.step_s;
        ensure!((1.0..=1e6).contains(&steps), "{} s; a run has 1 to 1,000,000 steps", self.seconds);
        self.scenario(0.0, least_m, 0)?;
        Ok(())
    }

    fn points(&self) -> usize {
        self.points().len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        // By name, so that a new field is not forgotten.
        let Self {
            k1: _,
            k2,
            k3,
            neighborhoods_m: _,
            min_distance_m,
            robots,
            start_side,
            obstacles,
            runs: _,
            safety,
            model,
            evasion,
            seconds,
            step_s,
            moves_goal,
            seed,
            out: _,
        } = self;
        let (k1, neighborhood_m) = self.points()[point];
        vec![
            ("k1", k1.into()),
            ("neighborhood_m", neighborhood_m.into()),
            ("k2", (*k2).into()),
            ("k3", (*k3).into()),
            ("min_distance_m", (*min_distance_m).into()),
            ("robots", (*robots).into()),
            ("start_side", (*start_side).into()),
            ("obstacles", (*obstacles).into()),
            ("safety", word(*safety).into()),
            ("model", word(*model).into()),
            ("evasion", word(*evasion).into()),
            ("seconds", (*seconds).into()),
            ("step_s", (*step_s).into()),
            ("moves_goal", (*moves_goal).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// That of the robots' draws; starts are a function of the first seed and the run's number.
    fn seed(&self, _: usize, run: u32) -> u64 {
        self.run_seed(run)
    }

    fn blank(&self, _: usize, _: u32) -> Run {
        Run::default()
    }

    /// Rows have no moments to draw: where the first run of a point was read of a row, it is made again for them.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Run>>> {
        let points = self.points();
        let mut runs = jobs.each(|(): &mut (), point, run| self.run(points[point], run).map(Some))?;
        for (&point, runs) in points.iter().zip(&mut runs) {
            if let Some(first) = runs.first_mut().filter(|first| first.frames.is_empty()) {
                let again = self.run(point, 0)?;
                ensure!(again.hash == first.hash, "a run is not that of its row; begin --anew");
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

#[cfg(test)]
mod tests;
