//! Fourteen scenes in which robots obstruct each other: [`Case`]. For similar scenes of the RVO2
//! library (plain ORCA with perfect state), the report gives the outcome there.

mod scene;

use super::{Conditions, gap, run};
use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, Maybe, check_runs};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use clap::ValueEnum;
use serde::Serialize;
use staya_controller::agent::SafetyKind;
use staya_sim::metrics::flock::FlockMeter;
use staya_sim::nearby::Space;
use staya_sim::scenario::Scenario;
use std::fmt::{Display, Formatter};

/// A scene of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Case {
    /// Four groups in the corners cross between four blocks.
    Blocks,
    /// Four groups meet where two roads cross.
    FourWays,
    /// Three groups meet where a road ends in another one.
    Tee,
    /// Two crowds at a door for one robot.
    Door,
    /// Two crowds at a wall with two doors for one robot each.
    Doors,
    /// A crowd passes a door to places among and beyond parked robots.
    ParkedDoor,
    /// Two groups in a corridor that is two robots wide.
    Corridor,
    /// A robot whose goal is behind a row of robots that have arrived.
    Parked,
    /// Robots of five sizes and three speeds on a circle.
    Mixed,
    /// Robots on a circle, and a vehicle that sends its position and does not give way.
    Intruder,
    /// Robots in a bag of walls deeper than their window, by routing.
    DeadEnd,
    /// Robots on a sphere with opposite goals.
    Sphere,
    /// Robots on a circle whose radio fails while they meet.
    Blackout,
    /// An alpha flock that passes between two balls.
    Flock,
}

impl Case {
    /// All cases.
    pub const ALL: [Self; 14] = [
        Self::Blocks,
        Self::FourWays,
        Self::Tee,
        Self::Door,
        Self::Doors,
        Self::ParkedDoor,
        Self::Corridor,
        Self::Parked,
        Self::Mixed,
        Self::Intruder,
        Self::DeadEnd,
        Self::Sphere,
        Self::Blackout,
        Self::Flock,
    ];

    /// Name in options and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::FourWays => "four_ways",
            Self::Tee => "tee",
            Self::Door => "door",
            Self::Doors => "doors",
            Self::ParkedDoor => "parked_door",
            Self::Corridor => "corridor",
            Self::Parked => "parked",
            Self::Mixed => "mixed",
            Self::Intruder => "intruder",
            Self::DeadEnd => "dead_end",
            Self::Sphere => "sphere",
            Self::Blackout => "blackout",
            Self::Flock => "flock",
        }
    }

    /// Default number of robots per group, or of all in cases without groups.
    #[must_use]
    pub const fn robots(self) -> u32 {
        match self {
            Self::Blocks | Self::Flock => 25,
            Self::FourWays => 5,
            Self::Tee => 7,
            Self::Door | Self::Doors => 20,
            Self::ParkedDoor => 10,
            Self::Corridor => 6,
            Self::Parked => 8,
            Self::Mixed | Self::Intruder | Self::Blackout => 20,
            Self::DeadEnd => 8,
            Self::Sphere => 32,
        }
    }

    const fn rvo2(self) -> &'static str {
        match self {
            Self::FourWays | Self::Tee => "20 of 20 in 87 to 95 s",
            Self::Door => "46 of 50 + 50, 53 of 100 + 100",
            Self::Parked => "9.3 s",
            Self::Mixed => "1.31 to 2.16 times, 357 overlaps",
            _ => "",
        }
    }
}

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Cases to run.
    pub cases: Vec<Case>,
    /// Robots per group, or of all in cases without groups; `None`: [`Case::robots`].
    pub robots: Option<u32>,
    /// Largest random displacement of a start along both axes, metres.
    pub noise_m: f64,
    /// Runs of each case.
    pub seeds: u32,
    /// The first seed.
    pub seed: u64,
    /// Time limit of a run, seconds.
    pub longest_s: f64,
    /// Duration of the radio failure in [`Case::Blackout`], seconds.
    pub blackout_s: f64,
    /// Scale factor of bodies, routes, walls, speeds, noise and radio range.
    pub size: f64,
    /// Conditions of all runs.
    pub conditions: Conditions,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            cases: Case::ALL.to_vec(),
            robots: None,
            noise_m: 0.02,
            seeds: 3,
            seed: 1,
            longest_s: 900.0,
            blackout_s: 1.0,
            size: 1.0,
            conditions: Conditions { range_m: 6.0, ..Conditions::default() },
        }
    }
}

/// Result of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Crossing {
    /// The case.
    pub case: Case,
    /// Seed of noise and losses.
    pub seed: u64,
    /// Robots with a goal.
    pub robots: usize,
    /// Robots at their goals at the end; in a flock, robots past the balls.
    pub arrived: usize,
    /// Seconds until the last robot arrived; `None` if not all did, and for a flock.
    pub last_s: Option<f64>,
    /// Largest ratio of travel time to free time (distance / speed) of a robot.
    pub time_ratio: Option<f64>,
    /// Overlaps between bodies and with walls, summed over ticks.
    pub overlaps: u64,
    /// Depth of the deepest overlap, metres; 0 without overlaps.
    pub deepest_m: f64,
    /// Overlaps with the intruder, summed over ticks.
    pub intruder_overlaps: u64,
    /// Smallest gap between two bodies, metres.
    pub least_gap_m: Option<f64>,
    /// Connected components of a flock at the end.
    pub parts: Option<usize>,
    /// Trace hash.
    #[serde(skip)]
    pub hash: u64,
}

impl Record for Crossing {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("robots", "robots that have a goal", &mut self.robots);
        each("arrived", "robots at their goals at the end; of a flock those past the balls", &mut self.arrived);
        each("last_s", "when the last one had arrived; empty: not all did, or a flock", &mut self.last_s);
        each("time_ratio", "the largest time of a robot over its own free time", &mut self.time_ratio);
        each("overlaps", "overlaps of bodies, and with walls, summed over ticks", &mut self.overlaps);
        each("deepest_m", "the deepest of them; 0: none", &mut self.deepest_m);
        each("intruder_overlaps", "overlaps with the intruder, summed over ticks", &mut self.intruder_overlaps);
        each("least_gap_m", "least gap between two bodies; empty: no robots met", &mut self.least_gap_m);
        each("parts", "connected parts of a flock at the end; empty: no flock", &mut self.parts);
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
    /// Scale factor, already applied to speed and noise.
    pub size: f64,
    /// All runs, by case and seed.
    pub runs: Vec<Crossing>,
}

impl Plan {
    fn crossing(&self, case: Case, seed: u64, may_continue: &dyn Fn() -> bool) -> Option<Crossing> {
        let scenario = self.scenario(case, seed);
        let (mut places, mut velocities, mut worst) = (Vec::new(), Vec::new(), 0.0_f64);
        let outcome = run(&scenario, may_continue, |robots| {
            (places, velocities) = robots.map(|robot| (robot.motion.position_m, robot.motion.velocity_mps)).unzip();
        })?;
        let clearance = outcome.clearance?;
        let mut times = self.conditions.arrivals_s(&outcome);
        let mut sent = has_goal(&scenario);
        times.retain(|_| sent.next().unwrap_or(true));
        for (time, free_s) in times.iter().zip(free_s(&scenario)) {
            if let Some(time) = time
                && free_s > 0.0
            {
                worst = worst.max(time / free_s);
            }
        }
        let last_s = times.iter().try_fold(0.0, |last: f64, time| Some(last.max((*time)?)));
        let (arrived, parts) = match case {
            Case::Flock => {
                let range_m = 1.2 * scene::SPACING_M;
                let measure = FlockMeter::<3>::new(scene::SPACING_M, range_m, Space::OPEN).look(&places, &velocities);
                (places.iter().filter(|[x, ..]| *x > 7.0).count(), measure.map(|measure| measure.components))
            }
            _ => (times.iter().flatten().count(), None),
        };
        Some(Crossing {
            case,
            seed,
            robots: times.len(),
            arrived,
            last_s,
            time_ratio: last_s.map(|_| worst),
            overlaps: clearance.overlaps + clearance.intrusions,
            deepest_m: (-clearance.bodies_m).max(-clearance.solids_m).max(0.0),
            intruder_overlaps: clearance.intruder_overlaps,
            least_gap_m: gap(clearance.bodies_m),
            parts,
            hash: outcome.trace_hash,
        })
    }
}

fn has_goal(scenario: &Scenario) -> impl Iterator<Item = bool> {
    scenario.plane.iter().flat_map(|plane| plane.starts.iter().map(|start| !start.places.is_empty()))
}

/// Without obstacles and other robots; 0 for a robot that starts at its goal.
fn free_s(scenario: &Scenario) -> impl Iterator<Item = f64> {
    let plane = scenario.plane.iter();
    plane.flat_map(|plane| {
        let sent = plane.starts.iter().enumerate().filter(|(_, start)| !start.places.is_empty());
        sent.map(|(index, start)| {
            let (mut way_m, mut from) = (0.0, start.position_m);
            for target in &start.places {
                way_m += crate::arena::distance_m(from, target.position_m);
                from = target.position_m;
            }
            if way_m > 0.1 { way_m / plane.group(index).cruise_mps } else { 0.0 }
        })
    })
}

impl Experiment for Plan {
    const NAME: &'static str = "crossing";
    const UNIT: &'static str = "runs";
    type Run = Crossing;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.seeds, "of each case")?;
        self.conditions.check(self.noise_m)?;
        ensure!(self.noise_m <= 0.05, "--noise {} is out of range: give 0 to 0.05, or robots overlap", self.noise_m);
        let safety = self.conditions.safety;
        ensure!(safety != SafetyKind::PushOut, "--safety push-out keeps no distance from walls; give another one");
        let robots = self.robots.unwrap_or(1);
        ensure!((1..=1000).contains(&robots), "--robots {robots} is out of range: give 1 to 1000");
        // More robots do not fit into the bag and the row of parked robots.
        let is_full = |case: &Case| matches!(case, Case::DeadEnd | Case::Parked) && robots > 30;
        ensure!(!self.cases.iter().any(is_full), "--robots {robots} find no room in dead_end or parked: give 1 to 30");
        ensure!((0.1..=10.0).contains(&self.size), "--size {} is out of range: give 0.1 to 10", self.size);
        let is_of_metres = |case: &Case| matches!(case, Case::DeadEnd | Case::Flock) && self.size != 1.0;
        ensure!(
            !self.cases.iter().any(is_of_metres),
            "--size: dead_end and flock have one size only; give other cases"
        );
        for (name, value) in [("--longest", self.longest_s), ("--blackout", self.blackout_s)] {
            ensure!((0.1..=1e6).contains(&value), "{name} {value} is out of range: give 0.1 to 1000000 seconds");
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.cases.len()
    }

    fn runs(&self) -> u32 {
        self.seeds
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self { cases, robots, noise_m, seeds: _, seed: _, longest_s, blackout_s, size, conditions } = self;
        let case = cases[point];
        let own: [(_, Value); 5] = [
            ("case", case.name().into()),
            ("robots_of_group", robots.unwrap_or(case.robots()).into()),
            ("size", (*size).into()),
            ("longest_s", (*longest_s).into()),
            ("blackout_s", (*blackout_s).into()),
        ];
        own.into_iter().chain(conditions.given(*noise_m)).collect()
    }

    fn seed(&self, _: usize, run: u32) -> u64 {
        self.seed + u64::from(run)
    }

    fn blank(&self, point: usize, run: u32) -> Crossing {
        Crossing {
            case: self.cases[point],
            seed: self.seed(point, run),
            robots: 0,
            arrived: 0,
            last_s: None,
            time_ratio: None,
            overlaps: 0,
            deepest_m: 0.0,
            intruder_overlaps: 0,
            least_gap_m: None,
            parts: None,
            hash: 0,
        }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Crossing>>> {
        jobs.each(|(): &mut (), point, run| {
            Ok(self.crossing(self.cases[point], self.seed(point, run), &|| jobs.may_continue()))
        })
    }

    fn report(&self, runs: &[Vec<Crossing>]) -> Report {
        Report { conditions: self.conditions, noise_m: self.noise_m, size: self.size, runs: runs.concat() }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        super::report::headline(f, "crossing", &self.conditions, self.noise_m)?;
        if self.size != 1.0 {
            writeln!(f, "lengths and speeds times {}", self.size)?;
        }
        writeln!(
            f,
            "case         seed  arrived  last (s)  time / free  overlaps  deepest (mm)  with intruder  parts  RVO2, in scenes of the kind"
        )?;
        for run in &self.runs {
            let parts = run.parts.map_or("-".to_owned(), |parts| parts.to_string());
            let line = format!(
                "{:<11}  {:4}  {:>7}  {:>8}  {:>11}  {:8}  {:12.1}  {:13}  {parts:>5}  {}",
                run.case.name(),
                run.seed,
                format!("{}/{}", run.arrived, run.robots),
                Maybe(run.last_s, 1),
                Maybe(run.time_ratio, 2),
                run.overlaps,
                run.deepest_m * 1000.0,
                run.intruder_overlaps,
                run.case.rvo2(),
            );
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}
