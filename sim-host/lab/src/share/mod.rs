//! Benefit of maps shared between robots.
//!
//! Each run creates one natural landscape (A. V. Kuznetsov 2017, KUZ, section 5) and sends a group
//! of robots across it, without sharing and with shared maps ([`staya_controller::land`]) at each
//! packet loss. The complete simulator runs: agents, packets over the radio, and bodies that block
//! each other. The loss of a robot is its travel time compared with the fastest route on the whole
//! map, as in [`crate::route`]. The benefit depends on the routes within the group: see [`Starts`].

mod report;

pub use report::{Outlook, Point, Report};

use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::optimal::Planner;
use crate::route::decimal;
use crate::sweep::Value;
use anyhow::{Context as _, Result, ensure};
use clap::ValueEnum;
use serde::Serialize;
use staya_console::options::word;
use staya_controller::agent::RouteSetup;
use staya_controller::formation::FormationParams;
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_controller::land::MapParams;
use staya_controller::neighbor::PlausibilityLimits;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::route::{Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_sim::engine::{Outcome, simulate};
use staya_sim::radio::RadioParams;
use staya_sim::scenario::{Fault, Robot, Scenario};
use staya_sim::terrain::generate::{self, Hills, natural_by};
use staya_sim::terrain::{Terrain, TerrainError};
use staya_sim::world::MoveRules;
use std::ops::ControlFlow;

const LANDSCAPES: u32 = 0x0045_0201;
/// For robots and radio.
const RUNS: u32 = 0x0045_0202;
const PLACES: u32 = 0x0045_0203;

/// Only beacons depend on it.
const TICK_US: u32 = 1_000_000;
const TICKS: u32 = 20_000;
/// Distance in a group that starts together, cells.
const SPACING: i16 = 3;

/// Starts and goals of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Starts {
    /// Random places, at least half the land apart.
    #[default]
    Anywhere,
    /// Opposite corners, all at once: robots see the same land at the same time.
    Together,
    /// Like `Together`, with departures one after the other.
    InTurn,
}

impl Starts {
    /// Name in options and rows.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Anywhere => "anywhere",
            Self::Together => "together",
            Self::InTurn => "in-turn",
        }
    }
}

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of obstacles.
    pub obstacles: Vec<u32>,
    /// Robots per group, 1 to 100.
    pub groups: Vec<u32>,
    /// Arrangements of starts and goals.
    pub starts: Vec<Starts>,
    /// Packet losses at which maps are shared, 0 to 1.
    pub losses: Vec<f64>,
    /// Landscapes per point, at least 1.
    pub runs: u32,
    /// Cells along each side, 40 to 500.
    pub size: u16,
    /// Classes of impassability.
    pub classes: u8,
    /// Interpretation of natural terrain.
    pub hills: Hills,
    /// Norm of the distance to an obstacle.
    pub hill_norm: Norm,
    /// Ticks between two departures with [`Starts::InTurn`].
    pub interval: u32,
    /// Parameters of routing.
    pub route: RouteParams,
    /// Seed; equal seeds give equal results. Shared maps were developed on seed 1.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            obstacles: vec![70, 100, 130, 160],
            groups: vec![6, 20],
            starts: vec![Starts::Anywhere, Starts::Together, Starts::InTurn],
            losses: vec![0.0, 0.3, 0.6],
            runs: 50,
            size: 100,
            classes: 9,
            hills: Hills::Even,
            hill_norm: Norm::Euclidean,
            interval: 100,
            route: RouteParams::default(),
            seed: 3,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    pub obstacles: u32,
    pub group: u32,
    pub starts: Starts,
    pub shared: Option<f64>,
}

/// Result of one group on one landscape.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trip {
    /// Robots that arrived.
    pub arrived: u32,
    /// Mean excess of travel times over those of the fastest routes, percent.
    pub loss_percent: f64,
    /// Excess of the first robot, percent; `None` if it did not arrive.
    pub first_percent: Option<f64>,
    /// Excess of the last robot, percent; `None` if it did not arrive.
    pub last_percent: Option<f64>,
    /// Packets sent: beacons and shared maps.
    pub packets: u64,
    /// Overlapping robots, summed over ticks.
    pub collisions: u64,
    /// Trace hash.
    pub hash: u64,
}

impl Record for Trip {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("arrived", "robots that arrived", &mut self.arrived);
        each("loss_percent", "mean of their travel times above the fastest routes, percent", &mut self.loss_percent);
        each("first_percent", "the same of robot 1", &mut self.first_percent);
        each("last_percent", "the same of the last robot", &mut self.last_percent);
        each("packets", "packets sent", &mut self.packets);
        each("collisions", "robots in each other, summed over ticks", &mut self.collisions);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

impl Plan {
    pub(crate) fn cases(&self) -> Vec<Case> {
        let shared: Vec<Option<f64>> = [None].into_iter().chain(self.losses.iter().copied().map(Some)).collect();
        let mut cases = Vec::new();
        for &starts in &self.starts {
            for &group in &self.groups {
                for &obstacles in &self.obstacles {
                    cases.extend(shared.iter().map(|&shared| Case { obstacles, group, starts, shared }));
                }
            }
        }
        cases
    }

    fn landscape_seed(&self, obstacles: u32, run: u32) -> u64 {
        Rng::keyed(self.seed, LANDSCAPES, obstacles, run).next_u64()
    }

    fn landscape(&self, obstacles: u32, run: u32) -> Result<Terrain, TerrainError> {
        let seed = self.landscape_seed(obstacles, run);
        let plan = generate::LandPlan { width: self.size, height: self.size, classes: self.classes, seed };
        natural_by(&plan, obstacles, self.hill_norm, self.hills)
    }

    fn places(&self, case: Case, run: u32) -> Vec<(Cell, Cell)> {
        let last = self.size.cast_signed() - 2;
        if case.starts != Starts::Anywhere {
            let columns = if case.group > 6 { 5 } else { 3 };
            let rows = (case.group as i16 - 1) / columns;
            let far = last - SPACING * rows.max(columns - 1);
            let place = |robot: i16| Cell::new(SPACING * (robot % columns), SPACING * (robot / columns));
            return (0..case.group as i16)
                .map(|robot| (Cell::new(1, 1) + place(robot), Cell::new(far, far) + place(robot)))
                .collect();
        }
        let mut rng = Rng::keyed(self.seed, PLACES, case.obstacles, run);
        let mut places: Vec<(Cell, Cell)> = Vec::new();
        while places.len() < case.group as usize {
            let mut side = || rng.below(last as u32) as i16 + 1;
            let (start, goal) = (Cell::new(side(), side()), Cell::new(side(), side()));
            let is_free = places.iter().all(|&(s, g)| s != start && g != goal);
            if is_free && start.chebyshev(goal) >= u32::from(self.size) / 2 {
                places.push((start, goal));
            }
        }
        places
    }

    fn scenario(&self, case: Case, run: u32) -> Result<Scenario> {
        let places = self.places(case, run);
        let robots: Vec<Robot> =
            (1..).zip(&places).map(|(id, &(start, goal))| Robot { id: RobotId(id), start, goal }).collect();
        let waits = |robot: &&Robot| case.starts == Starts::InTurn && robot.id.0 > 1;
        let faults = robots.iter().filter(waits).map(|robot| Fault {
            robot: robot.id,
            from_tick: 0,
            to_tick: self.departure(case, robot.id),
        });
        let faults = faults.collect();
        let seed = Rng::keyed(self.seed, RUNS, case.obstacles, run).next_u64();
        let scenario = scenario(self.landscape(case.obstacles, run)?, robots, self.route, case.shared, seed);
        Ok(Scenario { faults, ..scenario })
    }

    fn departure(&self, case: Case, robot: RobotId) -> u32 {
        if case.starts == Starts::InTurn { (robot.0 - 1) * self.interval } else { 0 }
    }

    fn trip(&self, planner: &mut Planner, case: Case, run: u32) -> Result<Trip> {
        let scenario = self.scenario(case, run)?;
        let outcome = simulate(&scenario, |_, _| ControlFlow::Continue(()))?;
        let rules = scenario.rules;
        let fastest = scenario.robots.iter().map(|robot| {
            let route = planner.route(&scenario.terrain, robot.start, robot.goal, rules.norm, rules.corner_cutting);
            let cost = route.context("natural land has a way between any two cells")?.cost;
            Ok((self.departure(case, robot.id), cost as f64))
        });
        Ok(Trip::of(&outcome, &fastest.collect::<Result<Vec<_>>>()?))
    }
}

impl Trip {
    /// `fastest`: departure tick, and travel time of the fastest route, [`UNIT`]ths of a tick.
    pub(crate) fn of(outcome: &Outcome, fastest: &[(u32, f64)]) -> Self {
        let over = |(&at, &(departure, fastest)): (&Option<u64>, &(u32, f64))| {
            let since = u64::from(departure) * u64::from(UNIT);
            at.map(|at| 100.0 * (at.saturating_sub(since) as f64 / fastest - 1.0))
        };
        let losses: Vec<Option<f64>> = outcome.arrival_times.iter().zip(fastest).map(over).collect();
        let arrived: Vec<f64> = losses.iter().copied().flatten().collect();
        Self {
            arrived: arrived.len() as u32,
            loss_percent: staya_stats::mean(&arrived).unwrap_or(0.0),
            first_percent: losses.first().copied().flatten(),
            last_percent: losses.last().copied().flatten(),
            packets: outcome.packets.sent,
            collisions: outcome.collisions,
            hash: outcome.trace_hash,
        }
    }
}

/// `shared`: packet loss at which robots share maps.
pub(crate) fn scenario(
    terrain: Terrain,
    robots: Vec<Robot>,
    route: RouteParams,
    shared: Option<f64>,
    seed: u64,
) -> Scenario {
    Scenario {
        name: String::from("share"),
        seed,
        ticks: TICKS,
        tick_us: TICK_US,
        terrain,
        changes: Vec::new(),
        scouting: None,
        rules: MoveRules { norm: route.norm, corner_cutting: route.corner_cutting, ..MoveRules::default() },
        radio: RadioParams { range_m: f64::INFINITY, loss: shared.unwrap_or(0.0), ..RadioParams::default() },
        faults: Vec::new(),
        robots,
        plane: None,
        formations: Vec::new(),
        parts: Vec::new(),
        route: RouteSetup { params: route, replan: Replan::EachCell, sharpness: Sharpness::Greedy },
        maps: shared.map(|_| MapParams::default()),
        formation_params: FormationParams::default(),
        law: None,
        published: None,
        looks_ahead: false,
        sensing: None,
        key: None,
        key_remark: None,
        files: Vec::new(),
        keeping: None,
        interventions: Vec::new(),
        misnumbered: Vec::new(),
        plausibility: PlausibilityLimits::ANY,
        attacks: Vec::new(),
        parameters: Default::default(),
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "share";
    const UNIT: &'static str = "groups";
    type Run = Trip;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "landscapes per point")?;
        let size = self.size;
        ensure!((40..=500).contains(&size), "a landscape of {size} x {size} cells; its side must be 40..=500");
        ensure!(!self.obstacles.is_empty(), "no landscapes; give one number of obstacles or more");
        ensure!(
            !self.groups.is_empty() && !self.starts.is_empty(),
            "no groups; give --group and --starts one value or more"
        );
        for group in &self.groups {
            // A block of a large group has five columns.
            let most = 5 * (u32::from(size) / 6);
            ensure!((1..=100.min(most)).contains(group), "a group of {group} robots; it must be 1..={}", 100.min(most));
        }
        for loss in &self.losses {
            ensure!((0.0..=1.0).contains(loss), "a loss of {loss}; it must be between 0 and 1");
        }
        let radius = self.route.radius;
        ensure!((1..=16).contains(&radius), "a window of radius {radius}; it must be 1..=16");
        ensure!(self.interval <= 1000, "robots that set out {} ticks apart; give 1000 or less", self.interval);
        for &obstacles in &self.obstacles {
            self.landscape(obstacles, 0)?;
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.cases().len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self {
            obstacles: _,
            groups: _,
            starts: _,
            losses: _,
            runs: _,
            size,
            classes,
            hills,
            hill_norm,
            interval,
            route,
            seed,
        } = self;
        let case = self.cases()[point];
        vec![
            ("starts", case.starts.name().into()),
            ("robots", case.group.into()),
            ("obstacles", case.obstacles.into()),
            ("shared", case.shared.is_some().into()),
            ("loss", case.shared.unwrap_or(0.0).into()),
            ("side_cells", u32::from(*size).into()),
            ("classes", u32::from(*classes).into()),
            ("hills", word(*hills).into()),
            ("hill_norm", word(*hill_norm).into()),
            ("interval_ticks", (*interval).into()),
            ("radius_cells", u32::from(route.radius).into()),
            ("a0", decimal(route.a0).into()),
            ("a1", decimal(route.a1).into()),
            ("a2", decimal(route.a2).into()),
            ("a3", decimal(route.a3).into()),
            ("norm", word(route.norm).into()),
            ("corner_cutting", route.corner_cutting.into()),
            ("exit", word(route.exit).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// Seed of the landscape, for `staya terrain`; other random numbers depend on the first seed.
    fn seed(&self, point: usize, run: u32) -> u64 {
        self.landscape_seed(self.cases()[point].obstacles, run)
    }

    fn blank(&self, _: usize, _: u32) -> Trip {
        Trip { first_percent: Some(0.0), last_percent: Some(0.0), ..Trip::default() }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Trip>>> {
        let cases = self.cases();
        jobs.each(|planner: &mut Planner, point, run| self.trip(planner, cases[point], run).map(Some))
    }

    fn report(&self, runs: &[Vec<Trip>]) -> Report {
        Report::of(self, runs)
    }
}

#[cfg(test)]
mod tests;
