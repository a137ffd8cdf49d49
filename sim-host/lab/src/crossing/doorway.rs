//! Two crowds that pass a gap in a wall in opposite directions.

use super::{Conditions, gap, picture, run};
use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use serde::Serialize;
use staya_controller::rand::Rng;
use staya_plot::flock::Sheet;
use staya_sim::record::RobotRow;
use staya_sim::scenario::{PlaneSetup, Scenario, Start, Target};
use staya_sim::world::plane::Solid;
use std::path::{Path, PathBuf};

/// Radius of a robot, metres.
pub const RADIUS_M: f64 = 0.3;
/// Along and across the crowd: another robot can pass between robots that have arrived.
const SPACING_M: [f64; 2] = [1.2, 1.6];
/// From the wall to the first column, so that robots at their goals do not block the door.
const FRONT_M: f64 = 2.5;
const ROW: u32 = 4;
/// Half the length: too long to go around.
const WALL_M: f64 = 50.0;

const NOISE: u32 = 0x0045_0001;

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Widths of the gap, metres.
    pub widths_m: Vec<f64>,
    /// Robots on each side.
    pub robots: u32,
    /// Largest random displacement of a start along both axes, metres.
    pub noise_m: f64,
    /// Runs of each width.
    pub seeds: u32,
    /// The first seed.
    pub seed: u64,
    /// Time limit of a run, seconds.
    pub longest_s: f64,
    /// Conditions of all runs.
    pub conditions: Conditions,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            widths_m: vec![0.7, 0.8, 1.0, 1.3, 2.0],
            robots: 20,
            noise_m: 0.0,
            seeds: 1,
            seed: 1,
            longest_s: 900.0,
            conditions: Conditions { range_m: 6.0, ..Conditions::default() },
        }
    }
}

/// Result of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Passage {
    /// Width of the gap, metres.
    pub width_m: f64,
    /// Seed of noise and losses.
    pub seed: u64,
    /// Robots of both crowds.
    pub robots: usize,
    /// Robots at their goals at the end.
    pub arrived: usize,
    /// Robots past the wall or at their goals at the end, from the west and from the east.
    pub through: [usize; 2],
    /// Seconds until the last robot arrived; `None` if not all did.
    pub last_s: Option<f64>,
    /// Last arrival divided by the longest free time (distance / speed).
    pub time_ratio: Option<f64>,
    /// Changes of direction in the gap; 1 if one crowd passes after the other.
    pub turns: u32,
    /// Smallest gap between two bodies, metres.
    pub least_gap_m: Option<f64>,
    /// Smallest gap between a body and the wall, metres.
    pub least_wall_gap_m: Option<f64>,
    /// Overlaps between bodies and with the wall, summed over ticks.
    pub overlaps: u64,
    /// Trace hash.
    #[serde(skip)]
    pub hash: u64,
}

impl Record for Passage {
    fn figures(&mut self, each: &mut Each<'_>) {
        let [west, east] = &mut self.through;
        each("robots", "robots on both sides together", &mut self.robots);
        each("arrived", "robots at their goals at the end", &mut self.arrived);
        each("through_from_west", "robots from the west that passed", west);
        each("through_from_east", "robots from the east that passed", east);
        each("last_s", "when the last one had arrived; empty: not all did", &mut self.last_s);
        each("time_ratio", "last arrival over the longest free time", &mut self.time_ratio);
        each("turns", "changes of direction in the gap", &mut self.turns);
        each("least_gap_m", "least gap between two bodies; empty: no robots met", &mut self.least_gap_m);
        each("least_wall_gap_m", "least gap between a body and the wall", &mut self.least_wall_gap_m);
        each("overlaps", "overlaps of bodies, and with the wall, summed over ticks", &mut self.overlaps);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

/// Results of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Conditions of all runs.
    pub conditions: Conditions,
    /// Noise of the starts, metres.
    pub noise_m: f64,
    /// All runs, by width and seed.
    pub runs: Vec<Passage>,
}

impl Plan {
    /// Builds the scenario of one run: odd robot ids start in the west, even ones in the east.
    #[must_use]
    pub fn scenario(&self, width_m: f64, seed: u64) -> Scenario {
        let starts = (0..2 * self.robots)
            .map(|index| {
                let (number, side) = (index >> 1, if index & 1 == 0 { -1.0 } else { 1.0 });
                let rows = self.robots.div_ceil(ROW);
                let place = |number: u32| {
                    let x = FRONT_M + f64::from(number % ROW) * SPACING_M[0];
                    let row = f64::from(number / ROW) - f64::from(rows - 1) / 2.0;
                    [x, row * SPACING_M[1]]
                };
                let [x, y] = place(number);
                // The front robot has the rearmost goal, so that it does not block others.
                let [goal_x, goal_y] = place(self.robots - 1 - number);
                let mut rng = Rng::keyed(seed, NOISE, index, 0);
                let mut noise = || (f64::from(rng.below(20_001)) / 1e4 - 1.0) * self.noise_m;
                Start {
                    position_m: [side * x + noise(), y + noise(), 0.0],
                    velocity_mps: [0.0; 3],
                    places: vec![Target { position_m: [-side * goal_x, goal_y, 0.0], velocity_mps: [0.0; 3] }],
                    group: None,
                }
            })
            .collect();
        let half = width_m / 2.0;
        let mut setup = PlaneSetup::new(self.conditions.group(RADIUS_M, 0.1), starts);
        setup.solids = vec![Solid::Wall([[0.0, -WALL_M], [0.0, -half]]), Solid::Wall([[0.0, half], [0.0, WALL_M]])];
        self.conditions.scenario("doorway", seed, self.longest_s, setup)
    }

    fn passage(&self, width_m: f64, seed: u64, may_continue: &dyn Fn() -> bool) -> Option<Passage> {
        let scenario = self.scenario(width_m, seed);
        let setup = scenario.plane.as_ref()?;
        let mut flow = Flow::new(setup.starts.iter().map(|start| start.position_m[0]));
        let outcome = run(&scenario, may_continue, |robots| flow.see(robots))?;
        let clearance = outcome.clearance?;
        let times = self.conditions.arrivals_s(&outcome);
        let arrived = times.iter().flatten().count();
        let last = times.iter().flatten().copied().fold(0.0, f64::max);
        let way = |start: &Start| {
            let [from, to] = [start.position_m, start.places[0].position_m];
            let [x, y] = [from[0] - to[0], from[1] - to[1]];
            (x * x + y * y).sqrt()
        };
        let free_m = setup.starts.iter().map(way).fold(0.0, f64::max);
        let is_complete = arrived == times.len();
        Some(Passage {
            width_m,
            seed,
            robots: times.len(),
            arrived,
            through: flow.through(),
            last_s: is_complete.then_some(last),
            time_ratio: is_complete.then_some(last / (free_m / self.conditions.speed_mps)),
            turns: flow.turns,
            least_gap_m: gap(clearance.bodies_m),
            least_wall_gap_m: gap(clearance.solids_m),
            overlaps: clearance.overlaps + clearance.intrusions,
            hash: outcome.trace_hash,
        })
    }

    /// Draws four moments of the first run with this width.
    #[must_use]
    pub fn picture(&self, width_m: f64) -> Sheet {
        let title = format!("{0} and {0} robots, a door of {width_m} m, seed {1}", self.robots, self.seed);
        picture(&title, &self.scenario(width_m, self.seed))
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "doorway";
    const UNIT: &'static str = "runs";
    type Run = Passage;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.seeds, "of each point")?;
        self.conditions.check(self.noise_m)?;
        for width in &self.widths_m {
            ensure!((0.0..=50.0).contains(width), "--widths {width} is out of range: give 0 to 50 metres");
        }
        let longest = self.longest_s;
        ensure!((0.1..=1e6).contains(&longest), "--longest {longest} is out of range: give 0.1 to 1000000 seconds");
        Ok(())
    }

    fn points(&self) -> usize {
        self.widths_m.len()
    }

    fn runs(&self) -> u32 {
        self.seeds
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self { widths_m, robots, noise_m, seeds: _, seed: _, longest_s, conditions } = self;
        let own: [(_, Value); 3] = [
            ("width_m", widths_m[point].into()),
            ("robots_per_side", (*robots).into()),
            ("longest_s", (*longest_s).into()),
        ];
        own.into_iter().chain(conditions.given(*noise_m)).collect()
    }

    fn seed(&self, _: usize, run: u32) -> u64 {
        self.seed + u64::from(run)
    }

    fn blank(&self, point: usize, run: u32) -> Passage {
        Passage { width_m: self.widths_m[point], seed: self.seed(point, run), ..Passage::default() }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Passage>>> {
        jobs.each(|(): &mut (), point, run| {
            Ok(self.passage(self.widths_m[point], self.seed(point, run), &|| jobs.may_continue()))
        })
    }

    fn report(&self, runs: &[Vec<Passage>]) -> Report {
        Report { conditions: self.conditions, noise_m: self.noise_m, runs: runs.concat() }
    }

    fn draw(&self, _: &[Vec<Passage>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        let widths_m = if report.runs.len() == self.total() { &self.widths_m[..] } else { &[] };
        let mut pictures = Vec::new();
        for &width_m in widths_m {
            pictures.extend(self.picture(width_m).draw().write(&dir.join(format!("doorway-{width_m}m")))?);
        }
        Ok(pictures)
    }
}

struct Flow {
    sides: Vec<f64>,
    crossed: Vec<bool>,
    last: f64,
    turns: u32,
}

impl Flow {
    fn new(xs: impl Iterator<Item = f64>) -> Self {
        let sides: Vec<f64> = xs.map(f64::signum).collect();
        Self { crossed: vec![false; sides.len()], sides, last: 0.0, turns: 0 }
    }

    fn see(&mut self, robots: &mut dyn Iterator<Item = RobotRow>) {
        for (robot, row) in robots.enumerate() {
            let x = row.motion.position_m[0];
            let side = self.sides[robot];
            // Beyond the line by a radius, so that a robot pushed back and forth counts once.
            let is_over = x * side < -RADIUS_M;
            if is_over && !self.crossed[robot] {
                self.crossed[robot] = true;
                self.turns += u32::from(self.last != 0.0 && self.last != side);
                self.last = side;
            }
        }
    }

    fn through(&self) -> [usize; 2] {
        let count = |from: f64| {
            let mine = self.sides.iter().zip(&self.crossed);
            mine.filter(|&(&side, &crossed)| side == from && crossed).count()
        };
        [count(-1.0), count(1.0)]
    }
}
