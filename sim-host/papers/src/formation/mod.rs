//! How well do six robots keep formation, and what does it cost? (A. V. Kuznetsov 2017, KUZ, section 8, figure 6.)
//!
//! Each run makes one natural landscape and sends the six robots of figure 5 across it several times: each for
//! itself, then in formation with the plan's parameters, then with other values of eps and with a lossy radio. Robots
//! run the whole simulator: the controller's agents, packets over the radio, bodies that get in each other's way.

mod pictures;
mod report;

pub use report::{Journey, Point, Report, Variants};

use crate::experiment::{Experiment, GoesOn, by_point, check_runs};
use anyhow::{Result, anyhow, ensure};
use staya_controller::agent::{RouteSetup, TEMPLATE};
use staya_controller::formation::FormationParams;
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_controller::neighbor::Claims;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::route::{Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_controller::template::{Template, TemplateError};
use staya_sim::engine::simulate;
use staya_sim::radio::RadioParams;
use staya_sim::scenario::{Formation, Robot, Scenario};
use staya_sim::terrain::generate::{self, natural};
use staya_sim::terrain::{Terrain, TerrainError};
use staya_sim::world::{Misplaced, MoveRules};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Purpose of the random numbers that give each run its landscape.
const LANDSCAPES: u32 = 0x0045_0101;
/// Purpose of the random numbers that give each run its seed for robots and radio.
const RUNS: u32 = 0x0045_0102;

/// Robots in the formation of figure 5.
pub const ROBOTS: usize = 6;
/// Its graph: rows 1 2 3 and 4 5 6.
const EDGES: [(u16, u16); 7] = [(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5)];
/// Seconds per tick; only beacons and requests know of it.
const TICK_US: u32 = 1_000_000;

/// What to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of obstacles, one point of the figure each.
    pub obstacles: Vec<u32>,
    /// Landscapes per point, 1 or more.
    pub runs: u32,
    /// Cells along each side, [`Plan::least_size`] or more, at most 2000.
    pub size: u16,
    /// Classes of impassability l, 1 or more.
    pub classes: u8,
    /// Norm of the distance to an obstacle.
    pub hill_norm: Norm,
    /// Cells from one robot of the formation to the next, 1 to 10.
    pub spacing: u8,
    /// Geodesic radius of the templates in the formation's graph (rho), 1 to 3.
    pub rho: u8,
    /// How robots find their ways.
    pub route: RouteParams,
    /// How they keep the formation.
    pub formation: FormationParams,
    /// How strictly the order of moves follows their costs.
    pub sharpness: Sharpness,
    /// Loss of packets, 0 to 1.
    pub loss: f64,
    /// Other values of eps to try.
    pub other_eps: Vec<u8>,
    /// Other losses to try, 0 to 1.
    pub other_losses: Vec<f64>,
    /// Ticks after which a run is given up.
    pub ticks: u32,
    /// Equal seeds give equal results.
    pub seed: u64,
}

impl Default for Plan {
    /// KUZ section 8: 100 x 100 cells, nine classes.
    fn default() -> Self {
        Self {
            obstacles: vec![0, 10, 20, 40, 70, 100, 130],
            runs: 100,
            size: 100,
            classes: 9,
            hill_norm: Norm::Euclidean,
            spacing: 3,
            rho: 3,
            route: RouteParams::default(),
            formation: FormationParams::default(),
            sharpness: Sharpness::Greedy,
            loss: 0.0,
            other_eps: vec![1, 2, 3, 5],
            other_losses: vec![0.1, 0.3, 0.6],
            ticks: 10_000,
            seed: 1,
        }
    }
}

/// How the six cross a landscape.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// Each for itself over a perfect radio.
    Alone,
    /// In formation.
    Together { eps: u8, loss: f64 },
}

/// What one crossing gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Robots that reached their targets.
    pub arrived: usize,
    /// When the last one arrived, ticks; `None` when one did not.
    pub time_ticks: Option<f64>,
    /// Formation error per robot, cells: mean over robots and ticks, graph placed on the top leader.
    pub error: f64,
    /// The same with the graph placed by the best-fitting translation.
    pub best_fit_error: f64,
    /// Mean graph distance.
    pub graph_distance: f64,
    /// The largest formation error per robot of any tick: tells a runaway.
    pub worst_error: f64,
    /// Robots in walls or in each other, summed over ticks.
    pub collisions: u64,
}

/// What one landscape gave: the crossings in the order of `Plan::ways`.
pub type Run = Vec<Crossing>;

impl Plan {
    /// The formation of figure 5 with the plan's spacing, robot 1 in front: rows run west, columns south.
    ///
    /// # Errors
    /// A radius rho without a template.
    fn graph(&self) -> Result<Formation> {
        let spacing = i16::from(self.spacing);
        let places: Vec<Cell> =
            (0..ROBOTS as i16).map(|robot| Cell::new(-spacing * (robot % 3), -spacing * (robot / 3))).collect();
        let templates = (0..ROBOTS)
            .map(|own| Template::<TEMPLATE>::from_graph(&places, &EDGES, own, self.rho))
            .collect::<Result<_, TemplateError>>();
        let rho = self.rho;
        Ok(Formation {
            templates: templates.map_err(|error: TemplateError| {
                anyhow!("templates of geodesic radius {rho}: {error:?}; give 1, 2 or 3")
            })?,
            places,
            edges: EDGES.to_vec(),
        })
    }

    /// The smallest landscape in which the formation can start and arrive.
    #[must_use]
    pub fn least_size(&self) -> u16 {
        2 * u16::from(self.spacing) + 4
    }

    /// How the six cross each landscape: alone, as planned, with other eps, with other losses.
    fn ways(&self) -> impl Iterator<Item = Way> + '_ {
        let (own_eps, own_loss) = (self.formation.eps, self.loss);
        let own = Way::Together { eps: own_eps, loss: own_loss };
        let eps = self.other_eps.iter().map(move |&eps| Way::Together { eps, loss: own_loss });
        let losses = self.other_losses.iter().map(move |&loss| Way::Together { eps: own_eps, loss });
        [Way::Alone, own].into_iter().chain(eps).chain(losses)
    }

    /// The landscape of a run: a function of seed, obstacles and number of the run.
    fn landscape(&self, obstacles: u32, run: u32) -> Result<Terrain, TerrainError> {
        let plan = generate::LandPlan {
            width: self.size,
            height: self.size,
            classes: self.classes,
            seed: Rng::keyed(self.seed, LANDSCAPES, obstacles, run).next_u64(),
        };
        natural(&plan, obstacles, self.hill_norm)
    }

    /// The six on a landscape. The rearmost start one cell from the south-west corner; robot 1 goes to the cell that lies
    /// one from the north-east corner.
    fn scenario(&self, terrain: Terrain, graph: Option<Formation>, places: &[Cell], seed: u64) -> Scenario {
        let spacing = i16::from(self.spacing);
        let start = Cell::new(2 * spacing + 1, spacing + 1);
        let last = (self.size - 2).cast_signed();
        let robots = (1..).zip(places).map(|(id, &place)| Robot {
            id: RobotId(id),
            start: start + place,
            goal: Cell::new(last, last) + place,
        });
        Scenario {
            name: String::from("formation"),
            seed,
            ticks: self.ticks,
            tick_us: TICK_US,
            terrain,
            rules: MoveRules { norm: self.route.norm, corner_cutting: self.route.corner_cutting },
            radio: RadioParams { range_m: f64::INFINITY, ..RadioParams::default() },
            robots: robots.collect(),
            plane: None,
            formation: graph,
            route: RouteSetup { params: self.route, replan: Replan::EachCell, sharpness: self.sharpness },
            formation_params: self.formation,
            faults: Vec::new(),
            key: None,
            key_remark: None,
            keeping: None,
            interventions: Vec::new(),
            misnumbered: Vec::new(),
            claims: Claims::ANY,
            attacks: Vec::new(),
        }
    }

    fn run(&self, graph: &Formation, obstacles: u32, run: u32) -> Result<Run> {
        let terrain = self.landscape(obstacles, run)?;
        let seed = Rng::keyed(self.seed, RUNS, obstacles, run).next_u64();
        let scenario = |graph: Option<Formation>, places| self.scenario(terrain.clone(), graph, places, seed);
        let alone = scenario(None, &graph.places);
        let mut together = scenario(Some(graph.clone()), &graph.places);
        self.ways()
            .map(|way| match way {
                Way::Alone => cross(&alone),
                Way::Together { eps, loss } => {
                    together.formation_params.eps = eps;
                    together.radio.loss = loss;
                    cross(&together)
                }
            })
            .map(|crossing| Ok(crossing?))
            .collect()
    }
}

impl Experiment for Plan {
    const UNIT: &'static str = "landscapes";
    type Run = Run;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "landscapes per point")?;
        ensure!(!self.obstacles.is_empty(), "no landscapes; give one number of obstacles or more");
        ensure!(self.ticks > 0, "0 ticks; give the robots time to arrive, about 10000");
        ensure!((1..=10).contains(&self.spacing), "a spacing of {} cells; it must be 1..=10", self.spacing);
        let radius = self.route.radius;
        ensure!((1..=16).contains(&radius), "a window of radius {radius}; it must be 1..=16");
        let (size, least) = (self.size, self.least_size());
        ensure!(
            (least..=2000).contains(&size),
            "a landscape of {size} x {size} cells; its side must be {least}..=2000"
        );
        for loss in [self.loss].iter().chain(&self.other_losses) {
            ensure!((0.0..=1.0).contains(loss), "a loss of {loss}; it must be between 0 and 1");
        }
        ensure!(self.rho > 0, "a geodesic radius rho of 0; give 1, 2 or 3");
        self.graph()?;
        for &obstacles in &self.obstacles {
            self.landscape(obstacles, 0)?;
        }
        Ok(())
    }

    fn total(&self) -> usize {
        self.obstacles.len() * self.runs as usize
    }

    fn perform(&self, goes_on: &GoesOn<'_>) -> Result<Vec<Vec<Run>>> {
        let graph = self.graph()?;
        by_point(self.obstacles.len(), self.runs, 8, goes_on, |(): &mut (), point, run| {
            self.run(&graph, self.obstacles[point], run)
        })
    }

    fn report(&self, runs: &[Vec<Run>]) -> Report {
        Report::of(self, runs)
    }

    fn draw(&self, _: &[Vec<Run>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        Ok(report.draw(dir)?)
    }
}

/// Runs a scenario to its end and measures it.
fn cross(scenario: &Scenario) -> Result<Crossing, Misplaced> {
    let mut worst_error = 0.0_f64;
    let outcome = simulate(scenario, |moment, _| {
        // NaN without a formation; `max` passes over it.
        worst_error = worst_error.max(moment.row.formation_error_per_agent);
        ControlFlow::Continue(())
    })?;
    let last: Option<u64> = outcome.arrival_times.iter().copied().try_fold(0, |last, at| Some(at?.max(last)));
    let keeping = outcome.formation;
    Ok(Crossing {
        arrived: outcome.arrived,
        time_ticks: last.map(|units| units as f64 / f64::from(UNIT)),
        error: keeping.map_or(0.0, |k| k.error_per_agent),
        best_fit_error: keeping.map_or(0.0, |k| k.best_fit_error_per_agent),
        graph_distance: keeping.map_or(0.0, |k| k.graph_distance),
        worst_error,
        collisions: outcome.collisions,
    })
}

#[cfg(test)]
mod tests;
