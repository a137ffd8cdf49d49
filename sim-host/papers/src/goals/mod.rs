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
//! **What they show.** Order falls where K2 outweighs K1 and a small R_nbh lets the crowd break up. That the group is lost
//! where K1 is far above K2, as the paper says, they hardly show: who has one goal in common goes one way.

mod pictures;
mod report;
mod watch;

pub use report::{Point, Report};

use super::arena::{Arena, starts, ticks, uniform};
use super::{MAX_RUNS, in_parallel};
use staya_controller::flock::goal::GoalParams;
use staya_controller::push_out::{Evasion, Model, PushOutParams};
use staya_controller::rand::Rng;
use staya_sim::engine::simulate;
use staya_sim::scenario::{GuidanceName, Order, SafetyName, Scenario, Target};
use staya_sim::world::Misplaced;
use std::ops::ControlFlow;
use watch::{Run, Watch};

/// Purpose of the random numbers that give each run its starts.
const STARTS: u32 = 0x0047_0101;
/// Where the goals are, in R_MinDist.
const GOALS: [[f64; 2]; 3] = [[85.0, 0.0], [62.5, 25.0], [62.5, -25.0]];
/// Side of the square in which robots start, in R_MinDist and per root of their number.
const START_SIDE: f64 = 2.0;
/// Where the first goal goes when it moves, in R_MinDist.
const MOVED: [f64; 2] = [90.0, 20.0];

/// What to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Gains on the goal (K1), any finite number.
    pub k1: Vec<f64>,
    /// Gain on the middle of the neighbours (K2).
    pub k2: f64,
    /// Gain on robots that are too near (K3).
    pub k3: f64,
    /// Neighbourhoods (R_nbh), metres, 2 R_MinDist or more.
    pub neighborhoods_m: Vec<f64>,
    /// Least distance (R_MinDist), metres, 0.1 to 100. Bodies have 0.3 of it as radius.
    pub min_distance_m: f64,
    /// Robots, 2 to 2000.
    pub robots: u32,
    /// Runs of each point, 1 or more.
    pub runs: u32,
    /// What is behind the flock.
    pub safety: SafetyName,
    /// For [`SafetyName::PushOut`]: what becomes of a step, and how many are evaded at once.
    pub push_out: (Model, Evasion),
    /// Length of a run, seconds.
    pub seconds: f64,
    /// Length of a tick, seconds, 0.001 to 1.
    pub step_s: f64,
    /// Whether the operator moves the first goal after a quarter of the time, when robots are under way.
    pub moves_goal: bool,
    /// Equal seeds give equal results.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            k1: vec![0.0, 5.0, 15.0, 30.0, 50.0, 100.0, 150.0],
            k2: 50.0,
            k3: 100.0,
            neighborhoods_m: vec![20.0, 40.0],
            min_distance_m: 10.0,
            robots: 225,
            runs: 1,
            safety: SafetyName::Orca,
            push_out: (Model::Radial, Evasion::Multiple),
            seconds: 240.0,
            step_s: 0.1,
            moves_goal: false,
            seed: 1,
        }
    }
}

/// Why a plan cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// Nothing to look at.
    #[error("0 runs; make 1 or more of each point")]
    NoRuns,
    /// Their results would not fit the memory.
    #[error("{0} runs; make at most {MAX_RUNS}")]
    Runs(u32),
    /// Nothing to run.
    #[error("no points; give one K1 and one neighbourhood or more")]
    NoPoints,
    /// No flock, or no room.
    #[error("{0} robots; give 2 to 2000")]
    Robots(u32),
    /// No gain.
    #[error("a gain of {0}; give a number within +-1,000,000")]
    Gain(f64),
    /// Robots see nobody whom they should keep off.
    #[error(
        "a neighbourhood of {neighborhood_m} m; it must be {least_m} (two least distances) to 100,000"
    )]
    Neighborhood {
        /// Wanted, metres.
        neighborhood_m: f64,
        /// The least one, metres.
        least_m: f64,
    },
    /// Beacons would not tell it, or speeds.
    #[error("a least distance of {0} m; it must be 0.1 to 30")]
    MinDistance(f64),
    /// Robots would go farther in a step than they should be apart.
    #[error("a step of {0} s; it must be 0.001 to 0.5")]
    Step(f64),
    /// No time, or too much memory for what is measured.
    #[error("{0} s; a run has 1 to 1,000,000 steps")]
    Time(f64),
    /// The robots cannot start.
    #[error(transparent)]
    Start(#[from] Misplaced),
}

/// What was done so far.
#[derive(Clone, Debug)]
pub struct Results {
    plan: Plan,
    /// Point after point within each number of a run.
    runs: Vec<Run>,
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

    /// Runs in all.
    #[must_use]
    pub fn total(&self) -> usize {
        self.points().len() * self.runs as usize
    }

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
        if self.points().is_empty() {
            return Err(PlanError::NoPoints);
        }
        if !(2..=2000).contains(&self.robots) {
            return Err(PlanError::Robots(self.robots));
        }
        let gains = self.k1.iter().chain([&self.k2, &self.k3]);
        for gain in gains {
            if !(-1e6..=1e6).contains(gain) {
                return Err(PlanError::Gain(*gain));
            }
        }
        if !(0.1..=30.0).contains(&self.min_distance_m) {
            return Err(PlanError::MinDistance(self.min_distance_m));
        }
        let least_m = 2.0 * self.min_distance_m;
        for &neighborhood_m in &self.neighborhoods_m {
            if !(least_m..=1e5).contains(&neighborhood_m) {
                return Err(PlanError::Neighborhood {
                    neighborhood_m,
                    least_m,
                });
            }
        }
        if !(0.001..=0.5).contains(&self.step_s) {
            return Err(PlanError::Step(self.step_s));
        }
        if !(1.0..=1e6).contains(&(self.seconds / self.step_s)) {
            return Err(PlanError::Time(self.seconds));
        }
        self.scenario(0.0, least_m, 0)?;
        Ok(())
    }

    fn scenario(&self, k1: f64, neighborhood_m: f64, run: u32) -> Result<Scenario, PlanError> {
        let targets = self.goals_m().map(|position_m| Target {
            position_m,
            velocity_mps: [0.0; 3],
        });
        let side = START_SIDE * self.min_distance_m * libm::sqrt(f64::from(self.robots)) / 2.0;
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
        .ok_or(PlanError::Robots(self.robots))?;
        let speed_mps = self.speed_mps();
        let arena = Arena {
            name: "goals",
            seed: Rng::keyed(self.seed, STARTS + 1, run, 0).next_u64(),
            step_s: self.step_s,
            seconds: self.seconds,
            radius_m: self.radius_m(),
            max_speed_mps: speed_mps,
            range_m: neighborhood_m,
            loss: 0.0,
            sight_m: 2.0 * self.min_distance_m,
            guidance: GuidanceName::GoalFlock,
            safety: self.safety,
            solids: Vec::new(),
        };
        let mut setup = arena.setup(starts);
        let params = GoalParams {
            goal_gain: k1 as f32,
            center_gain: self.k2 as f32,
            repulsion_gain: self.k3 as f32,
            neighborhood_m: neighborhood_m as f32,
            ..GoalParams::new(self.min_distance_m as f32, speed_mps as f32)
        };
        setup.goal_flock = (params, self.arrival_m() as f32);
        // Beacons are a step old.
        setup.orca.margin_m = (self.min_distance_m / 50.0) as f32;
        let (model, evasion) = self.push_out;
        setup.push_out = PushOutParams {
            model,
            evasion,
            // A step more than bodies need.
            min_distance_m: (2.0 * self.radius_m() + speed_mps * self.step_s) as f32,
        };
        if self.moves_goal {
            setup.orders.push(Order {
                tick: self.moves_at(),
                index: 0,
                target: Target {
                    position_m: self.moved_m(),
                    velocity_mps: [0.0; 3],
                },
            });
        }
        Ok(arena.scenario(setup))
    }

    fn run(&self, (k1, neighborhood_m): (f64, f64), number: u32) -> Result<Run, PlanError> {
        let scenario = self.scenario(k1, neighborhood_m, number)?;
        let mut watch = Watch::new(self, &scenario, number == 0);
        let outcome = simulate(&scenario, |moment, robots| {
            watch.look(moment.row.tick, robots);
            ControlFlow::Continue(())
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
        let points = self.points();
        let runs = in_parallel(self.total(), 1, progress, |(): &mut (), job| {
            self.run(points[job % points.len()], (job / points.len()) as u32)
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
