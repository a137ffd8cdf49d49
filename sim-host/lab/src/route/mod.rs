//! Quality of routes with a limited window (A. V. Kuznetsov 2017, KUZ, section 5, figures 2 to 4).
//!
//! Each run creates one landscape and sends one robot from (1, 1) to (size - 2, size - 2) with the
//! controller's [`Router`](staya_controller::route::Router). Its travel time (eqs. 6 and 7) and the
//! length of its path are compared with those of the globally fastest route.
//!
//! Effect of the coefficients on time loss dT and length loss dL, on natural terrain of 40 to 160
//! obstacles with r = 5 (`--sweep a0,a1,a2,a3`):
//!
//! - a0 and a3 act by their ratio, because a2 hardly matters. The best a3 is 3 a0, near the time
//!   that a cell takes on a good route: dT 16..26 %, dL 3..6 %. At 2 a0, dT is 0..6 and dL 1..5
//!   points higher. At a0, robots wander (dT 70 % and more; up to 8 % never arrive), and without a3
//!   hardly any arrives. At 6 a0, dT is 2..9 points higher, and only at 12 a0 does the robot move
//!   nearly straight (dT 37..58 %, dL 5..13 %).
//! - a1 has no effect on a single robot. Among 500 parked robots (`--parked`), a1 = 2 lowers dT by
//!   about 0.5 points compared with 0, and larger values gain nothing; dL does not change.
//! - a2 has no effect on dT and dL, but without it 6 to 20 % of the robots circle forever; 1/2
//!   suffices.

mod coefficient;
mod pictures;
mod report;

pub use coefficient::Coefficient;
pub use report::{Arrivals, Loss, Means, Point, Report, Response, decimal};

use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::optimal::Planner;
use crate::sweep::Value;
use crate::walk::{Task, Walk, Walker};
use anyhow::{Result, ensure};
use staya_console::options::{shuffle_ticks, word};
use staya_controller::cost::Gain;
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_controller::rand::Rng;
use staya_controller::route::{Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_sim::terrain::generate::{self, Hills, natural_by, uniform};
use staya_sim::terrain::metrics::Metrics;
use staya_sim::terrain::{Terrain, TerrainError};
use std::path::{Path, PathBuf};

const LANDSCAPES: u32 = 0x0045_0001;
const ORDER: u32 = 0x0045_0002;
const MOVES: u32 = 0x0045_0004;
const PARKED: u32 = 0x0045_0003;

/// Obstacles of KUZ figure 4.
const SHOWN: u32 = 130;

/// Largest window radius, cells.
pub const MAX_RADIUS: u8 = 31;
/// Largest window with its border.
pub(crate) const CELLS: usize = {
    let side = 2 * MAX_RADIUS as usize + 3;
    side * side
};
/// Permitted sides of a landscape, cells: start and target are different cells inside it.
pub const SIZES: std::ops::RangeInclusive<u16> = 4..=2000;

/// A family of random landscapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Land {
    /// Hills of mud around this number of cells of the worst class (KUZ figures 3, 7a and 7b).
    Natural(u32),
    /// The cells of a natural landscape with this number of obstacles in random order: equal
    /// entropy S, but no hills, so it is comparable with natural terrain point by point.
    ///
    /// KUZ figure 2 plots "uniformly random" landscapes over N(S), the number of obstacles by
    /// entropy. Their classes do not have equal shares (figure 7c: S = 1.85; equal shares have ln 9
    /// = 2.20), and the paper does not give the shares.
    Shuffled(u32),
    /// Any class in each cell with equal probability: the highest entropy.
    Uniform,
}

impl Land {
    /// Number of obstacles; `None` for uniform land.
    #[must_use]
    pub const fn obstacles(self) -> Option<u32> {
        match self {
            Self::Natural(obstacles) | Self::Shuffled(obstacles) => Some(obstacles),
            Self::Uniform => None,
        }
    }

    /// Name of the family.
    #[must_use]
    pub const fn family(self) -> &'static str {
        match self {
            Self::Natural(_) => "natural",
            Self::Shuffled(_) => "shuffled",
            Self::Uniform => "uniform",
        }
    }
}

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Families of landscapes, one point of the figures each.
    pub lands: Vec<Land>,
    /// Landscapes per point, at least 1.
    pub runs: u32,
    /// Cells along each side, within [`SIZES`].
    pub size: u16,
    /// Classes of impassability l, at least 1.
    pub classes: u8,
    /// Interpretation of natural terrain.
    pub hills: Hills,
    /// Norm of the distance to an obstacle in natural terrain.
    pub hill_norm: Norm,
    /// Stationary robots in random cells, which only a1 affects; 0 in the paper.
    pub parked: u32,
    /// Seed; equal seeds give equal results. Parameters were tuned on seed 1.
    pub seed: u64,
    /// Parameters of routing.
    pub params: RouteParams,
    /// Condition for a repeated search.
    pub replan: Replan,
    /// Effect of the costs on the order of moves; the paper draws the order at random.
    pub sharpness: Sharpness,
    /// Other values of coefficients on the same landscapes, one at a time.
    pub sweep: Vec<(Coefficient, Gain)>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            lands: [10, 40, 70, 100, 130, 160].map(Land::Natural).to_vec(),
            runs: 1000,
            size: 100,
            classes: 9,
            hills: Hills::Even,
            hill_norm: Norm::Euclidean,
            parked: 0,
            seed: 2,
            params: RouteParams::default(),
            replan: Replan::EachCell,
            sharpness: Sharpness::Greedy,
            sweep: Vec::new(),
        }
    }
}

/// Result of one landscape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Configuration entropy S of the landscape.
    pub entropy: f64,
    /// Total edge TE of the landscape.
    pub total_edge: u64,
    /// Travel time of the fastest route, [`UNIT`]ths of a tick.
    pub optimal_cost: u64,
    /// Length of the fastest route, [`UNIT`]ths of a cell.
    pub optimal_length: u64,
    /// Paths with the plan's parameters, then with each value of the sweep.
    pub walks: Vec<Walk>,
}

impl Record for Run {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("entropy", "configuration entropy S of the landscape", &mut self.entropy);
        each("total_edge", "total edge TE of the landscape", &mut self.total_edge);
        each("optimal_cost", "travel time of the fastest route, 70ths of a tick", &mut self.optimal_cost);
        each("optimal_length", "length of the fastest route, 70ths of a cell", &mut self.optimal_length);
        for walk in &mut self.walks {
            each("arrived", "1: the robot reached its target", &mut walk.arrived);
            each("cost", "travel time of the robot, 70ths of a tick", &mut walk.cost);
            each("length", "length of its way, 70ths of a cell", &mut walk.length);
            each("moves", "its moves", &mut walk.moves);
        }
    }
}

/// One landscape with both paths across it.
#[derive(Clone, Debug)]
pub struct Example {
    /// Family of the landscape.
    pub family: Land,
    /// Radius of the robot's window, cells.
    pub radius: u8,
    /// The terrain.
    pub land: Terrain,
    /// Cells of the robot's path.
    pub way: Vec<Cell>,
    /// Cells of the fastest route.
    pub optimal: Vec<Cell>,
    /// Cells of parked robots.
    pub parked: Vec<Cell>,
    /// Results of the run.
    pub run: Run,
}

#[derive(Debug, Default)]
struct Scratch {
    walker: Walker<CELLS>,
    planner: Planner,
}

impl Plan {
    /// Start of the robot.
    #[must_use]
    pub const fn start(&self) -> Cell {
        Cell::new(1, 1)
    }

    /// Target of the robot.
    #[must_use]
    pub const fn target(&self) -> Cell {
        let last = self.size.saturating_sub(2).cast_signed();
        Cell::new(last, last)
    }

    fn variants(&self) -> impl Iterator<Item = RouteParams> + '_ {
        let sweep = self.sweep.iter().map(|(coefficient, value)| coefficient.set(self.params, *value));
        std::iter::once(self.params).chain(sweep)
    }

    fn point(&self, point: usize) -> (Land, RouteParams) {
        let variants: Vec<RouteParams> = self.variants().collect();
        (self.lands[point / variants.len()], variants[point % variants.len()])
    }

    fn by_land(&self, runs: &[Vec<Run>]) -> Vec<Vec<Run>> {
        let all_walks = |variants: &[Vec<Run>]| {
            let least = variants.iter().map(Vec::len).min().unwrap_or(0);
            let of = |run: usize| Run {
                walks: variants.iter().flat_map(|runs| runs[run].walks.clone()).collect(),
                ..variants[0][run].clone()
            };
            (0..least).map(of).collect()
        };
        runs.chunks(self.variants().count()).map(all_walks).collect()
    }

    fn landscape_seed(&self, land: Land, run: u32) -> u64 {
        Rng::keyed(self.seed, LANDSCAPES, land.obstacles().unwrap_or(u32::MAX), run).next_u64()
    }

    /// Creates the landscape of a run.
    ///
    /// # Errors
    /// There are more obstacles than cells, or no classes.
    pub fn landscape(&self, land: Land, run: u32) -> Result<Terrain, TerrainError> {
        let key = land.obstacles().unwrap_or(u32::MAX);
        let plan = generate::LandPlan {
            width: self.size,
            height: self.size,
            classes: self.classes,
            seed: self.landscape_seed(land, run),
        };
        match land {
            Land::Uniform => uniform(&plan),
            Land::Natural(obstacles) => natural_by(&plan, obstacles, self.hill_norm, self.hills),
            Land::Shuffled(obstacles) => {
                let mut cells = natural_by(&plan, obstacles, self.hill_norm, self.hills)?.cells().to_vec();
                let mut rng = Rng::keyed(self.seed, ORDER, key, run);
                for last in (1..cells.len()).rev() {
                    cells.swap(last, rng.below(last as u32 + 1) as usize);
                }
                Terrain::from_cells(self.size, self.size, cells)
            }
        }
    }

    fn parked(&self, land: Land, run: u32) -> Vec<Cell> {
        let key = land.obstacles().unwrap_or(u32::MAX);
        let mut rng = Rng::keyed(self.seed, PARKED, key, run);
        let mut cells = std::collections::BTreeSet::new();
        while cells.len() < self.parked as usize {
            let mut side = || rng.below(u32::from(self.size)) as i16;
            let cell = Cell::new(side(), side());
            if cell != self.start() && cell != self.target() {
                cells.insert(cell);
            }
        }
        cells.into_iter().collect()
    }

    fn run_one(
        &self,
        scratch: &mut Scratch,
        (land, params): (Land, RouteParams),
        run: u32,
    ) -> Result<Run, TerrainError> {
        let terrain = self.landscape(land, run)?;
        let parked = self.parked(land, run);
        Ok(self.run_on(scratch, &terrain, &parked, (&params, self.landscape_seed(land, run))).0)
    }

    fn run_on(
        &self,
        Scratch { walker, planner }: &mut Scratch,
        land: &Terrain,
        parked: &[Cell],
        (params, seed): (&RouteParams, u64),
    ) -> (Run, Vec<Cell>) {
        let (from, to) = (self.start(), self.target());
        let RouteParams { norm, corner_cutting, .. } = *params;
        let metrics = Metrics::of(land);
        // Random land has no walls.
        let optimal = planner.route(land, from, to, norm, corner_cutting);
        let (optimal_cost, optimal_length, cells) =
            optimal.map_or((0, 0, Vec::new()), |route| (route.cost, route.length(norm), route.cells));
        let task = Task { land, parked, from, to };
        let run = Run {
            entropy: metrics.entropy,
            total_edge: metrics.total_edge,
            optimal_cost,
            optimal_length,
            walks: vec![walker.walk_shuffled(
                &task,
                params,
                self.replan,
                self.sharpness,
                &mut Rng::keyed(seed, MOVES, 0, 0),
            )],
        };
        (run, cells)
    }

    /// Repeats the run with the median time loss on the land nearest to 130 obstacles, as in the
    /// paper's figure; `None` without runs.
    ///
    /// # Errors
    /// A landscape cannot be created.
    pub fn example(&self, runs: &[Vec<Run>]) -> Result<Option<Example>, TerrainError> {
        let plan = Self { sweep: Vec::new(), ..self.clone() };
        let runs = &self.by_land(runs);
        let off = |land: Land| land.obstacles().map_or(u32::MAX, |n| n.abs_diff(SHOWN));
        let by_land = plan.lands.iter().zip(runs);
        let filled = by_land.filter(|(_, runs)| !runs.is_empty());
        let Some((family, runs)) = filled.min_by_key(|(land, _)| off(**land)) else {
            return Ok(None);
        };
        let loss = |run: &usize| {
            let run = &runs[*run];
            run.walks[0].cost as f64 / run.optimal_cost as f64
        };
        let mut order: Vec<usize> = (0..runs.len()).collect();
        order.sort_by(|a, b| loss(a).total_cmp(&loss(b)));
        let number = order[order.len() / 2] as u32;
        let land = plan.landscape(*family, number)?;
        let parked = plan.parked(*family, number);
        let mut scratch = Scratch::default();
        let (run, optimal) =
            plan.run_on(&mut scratch, &land, &parked, (&plan.params, plan.landscape_seed(*family, number)));
        Ok(Some(Example {
            family: *family,
            radius: plan.params.radius,
            land,
            way: scratch.walker.path().to_vec(),
            optimal,
            parked,
            run,
        }))
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "route";
    const UNIT: &'static str = "routes";
    type Run = Run;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "landscapes per point")?;
        ensure!(!self.lands.is_empty(), "no landscapes; give one number of obstacles or more");
        let (size, least, most) = (self.size, SIZES.start(), SIZES.end());
        ensure!(SIZES.contains(&size), "a landscape of {size} x {size} cells; its side must be {least}..={most}");
        let radius = self.params.radius;
        ensure!((1..=MAX_RADIUS).contains(&radius), "a window of radius {radius}; it must be 1..={MAX_RADIUS}");
        let (parked, cells) = (self.parked, u32::from(size) * u32::from(size));
        ensure!(parked <= cells / 2, "{parked} parked robots on {cells} cells; at most half of the cells can be taken");
        // The first landscape shows whether the family can be created.
        for land in &self.lands {
            self.landscape(*land, 0)?;
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.lands.len() * self.variants().count()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self {
            lands: _,
            runs: _,
            size,
            classes,
            hills,
            hill_norm,
            parked,
            seed,
            params: _,
            replan,
            sharpness,
            sweep: _,
        } = self;
        let (land, RouteParams { radius, exit, norm, corner_cutting, a0, a1, a2, a3 }) = self.point(point);
        vec![
            ("land", land.family().into()),
            ("obstacles", land.obstacles().map_or(Value::from("-"), Value::from)),
            ("side_cells", u32::from(*size).into()),
            ("classes", u32::from(*classes).into()),
            ("hills", word(*hills).into()),
            ("hill_norm", word(*hill_norm).into()),
            ("parked", (*parked).into()),
            ("radius_cells", u32::from(radius).into()),
            ("exit", word(exit).into()),
            ("replan", word(*replan).into()),
            ("norm", word(norm).into()),
            ("corner_cutting", corner_cutting.into()),
            ("a0", decimal(a0).into()),
            ("a1", decimal(a1).into()),
            ("a2", decimal(a2).into()),
            ("a3", decimal(a3).into()),
            ("shuffle_ticks", shuffle_ticks(*sharpness).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// Seed of the landscape, for `staya terrain`; other random numbers depend on the first seed.
    fn seed(&self, point: usize, run: u32) -> u64 {
        self.landscape_seed(self.point(point).0, run)
    }

    fn blank(&self, _: usize, _: u32) -> Run {
        Run { walks: vec![Walk::default()], ..Run::default() }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Run>>> {
        jobs.each(|scratch, point, run| Ok(Some(self.run_one(scratch, self.point(point), run)?)))
    }

    fn report(&self, runs: &[Vec<Run>]) -> Report {
        Report::of(self, &self.by_land(runs))
    }

    fn draw(&self, runs: &[Vec<Run>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        match self.example(runs)? {
            Some(example) => Ok(report.draw(&example, dir)?),
            None => Ok(Vec::new()),
        }
    }
}

/// Converts a travel time in [`UNIT`]ths to ticks.
#[must_use]
pub fn ticks(cost: u64) -> f64 {
    cost as f64 / f64::from(UNIT)
}

#[cfg(test)]
mod tests;
