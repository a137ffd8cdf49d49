//! Quality and cost of a formation of six robots (A. V. Kuznetsov 2017, KUZ, section 8, figure 6).
//!
//! Each run creates one natural landscape, which the six robots of figure 5 cross without
//! formation, in formation, and with other values of eps, packet loss and law. The complete
//! simulator runs: agents, packets over the radio, and bodies that block each other.

mod laws;
mod pictures;
mod report;

pub use laws::{Law, Published};
pub use report::{Journey, LawJourney, Point, Report, Variants};

use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::route::decimal;
use crate::sweep::Value;
use anyhow::{Result, anyhow, ensure};
use staya_console::options::{self, word};
use staya_controller::agent::{RouteSetup, TEMPLATE};
use staya_controller::formation::FormationParams;
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_controller::neighbor::PlausibilityLimits;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::route::{Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_controller::template::{Template, TemplateError};
use staya_papers::criteria::PublishedParams;
use staya_sim::engine::simulate;
use staya_sim::radio::RadioParams;
use staya_sim::scenario::{Formation, Robot, Scenario};
use staya_sim::terrain::generate::{self, Hills, natural_by};
use staya_sim::terrain::metrics::Metrics;
use staya_sim::terrain::{Terrain, TerrainError};
use staya_sim::world::{Misplaced, MoveRules};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const LANDSCAPES: u32 = 0x0045_0101;
/// For robots and radio.
const RUNS: u32 = 0x0045_0102;

/// Robots in the formation of figure 5.
pub const ROBOTS: usize = 6;
const EDGES: [(u16, u16); 7] = [(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5)];
/// Only beacons and messages depend on it.
const TICK_US: u32 = 1_000_000;

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of obstacles, one point of the figure each.
    pub obstacles: Vec<u32>,
    /// Landscapes per point, at least 1.
    pub runs: u32,
    /// Cells along each side, from [`Plan::least_size`] to 2000.
    pub size: u16,
    /// Classes of impassability l, at least 1.
    pub classes: u8,
    /// Interpretation of natural terrain.
    pub hills: Hills,
    /// Norm of the distance to an obstacle.
    pub hill_norm: Norm,
    /// Distance of adjacent robots in the formation, cells, 1 to 10.
    pub spacing: u8,
    /// Geodesic radius of the templates in the formation's graph (rho), 1 to 3.
    pub rho: u8,
    /// Parameters of routing.
    pub route: RouteParams,
    /// Parameters of the formation.
    pub formation: FormationParams,
    /// Effect of the costs on the order of moves.
    pub sharpness: Sharpness,
    /// Loss of packets, 0 to 1.
    pub loss: f64,
    /// Further values of eps.
    pub other_eps: Vec<u8>,
    /// Further losses, 0 to 1.
    pub other_losses: Vec<f64>,
    /// Further laws, each with all losses.
    pub other_laws: Vec<Law>,
    /// The paper's law among them.
    pub published: Published,
    /// Time limit of a run, ticks.
    pub ticks: u32,
    /// Seed; equal seeds give equal results. Parameters were tuned on seed 1.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            obstacles: vec![0, 10, 20, 40, 70, 100, 130],
            runs: 100,
            size: 100,
            classes: 9,
            hills: Hills::Even,
            hill_norm: Norm::Euclidean,
            spacing: 3,
            rho: 3,
            route: RouteParams::default(),
            formation: FormationParams::default(),
            sharpness: Sharpness::Greedy,
            loss: 0.0,
            other_eps: vec![1, 2, 3, 5],
            other_losses: vec![0.1, 0.3, 0.6],
            other_laws: vec![Law::Lookahead, Law::Loose, Law::Shared, Law::Unwaiting, Law::Paper],
            published: Published::default(),
            ticks: 10_000,
            seed: 2,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// Over a perfect radio.
    Alone,
    /// In formation.
    Together { eps: u8, loss: f64 },
    /// Under another law.
    Under { law: Law, loss: f64 },
}

/// Result of one crossing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossing {
    /// Configuration entropy S of the landscape.
    pub entropy: f64,
    /// Robots that reached their targets.
    pub arrived: usize,
    /// Arrival of the last robot, ticks; `None` if not all arrived.
    pub time_ticks: Option<f64>,
    /// Mean formation error per robot, cells, with the graph on the top leader.
    pub error: f64,
    /// Formation error with the graph at its best-fitting translation, cells.
    pub best_fit_error: f64,
    /// Mean graph distance.
    pub graph_distance: f64,
    /// Largest formation error per robot in a tick, cells; large if a robot strays.
    pub worst_error: f64,
    /// Robots inside walls or each other, summed over ticks.
    pub collisions: u64,
    /// Trace hash.
    pub hash: u64,
}

impl Record for Crossing {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("entropy", "configuration entropy S of the landscape", &mut self.entropy);
        each("arrived", "robots that reached their targets", &mut self.arrived);
        each("time_ticks", "when the last one arrived; empty: one did not", &mut self.time_ticks);
        each("error_cells", "formation error per robot, graph on the top leader; 0: no formation", &mut self.error);
        each(
            "best_fit_error_cells",
            "the same, graph placed by the best-fitting translation",
            &mut self.best_fit_error,
        );
        each("graph_distance", "mean graph distance", &mut self.graph_distance);
        each("worst_error_cells", "the largest error per robot of any tick", &mut self.worst_error);
        each("collisions", "robots in walls or in each other, summed over ticks", &mut self.collisions);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

/// Crossings of one landscape: without formation, as planned, other eps, other losses, other laws.
pub type Run = Vec<Crossing>;

impl Plan {
    fn graph(&self) -> Result<Formation> {
        self.graph_within(self.rho)
    }

    fn graph_within(&self, rho: u8) -> Result<Formation> {
        let spacing = i16::from(self.spacing);
        let places: Vec<Cell> =
            (0..ROBOTS as i16).map(|robot| Cell::new(-spacing * (robot % 3), -spacing * (robot / 3))).collect();
        let templates = (0..ROBOTS)
            .map(|own| Template::<TEMPLATE>::from_graph(&places, &EDGES, own, rho))
            .collect::<Result<_, TemplateError>>();
        Ok(Formation {
            templates: templates.map_err(|error: TemplateError| {
                anyhow!("templates of geodesic radius {rho}: {error:?}; give 1, 2 or 3")
            })?,
            places,
            edges: EDGES.to_vec(),
            first: 0,
        })
    }

    /// Smallest landscape with enough space for the formation at start and goal, cells.
    #[must_use]
    pub fn least_size(&self) -> u16 {
        2 * u16::from(self.spacing) + 4
    }

    fn ways(&self) -> impl Iterator<Item = Way> + '_ {
        let (own_eps, own_loss) = (self.formation.eps, self.loss);
        let own = Way::Together { eps: own_eps, loss: own_loss };
        let eps = self.other_eps.iter().map(move |&eps| Way::Together { eps, loss: own_loss });
        let losses = self.other_losses.iter().map(move |&loss| Way::Together { eps: own_eps, loss });
        let all_losses = move || [own_loss].into_iter().chain(self.other_losses.iter().copied());
        let laws = self.other_laws.iter().flat_map(move |&law| all_losses().map(move |loss| Way::Under { law, loss }));
        [Way::Alone, own].into_iter().chain(eps).chain(losses).chain(laws)
    }

    fn point(&self, point: usize) -> (u32, Way) {
        let ways: Vec<Way> = self.ways().collect();
        (self.obstacles[point / ways.len()], ways[point % ways.len()])
    }

    fn landscape_seed(&self, obstacles: u32, run: u32) -> u64 {
        Rng::keyed(self.seed, LANDSCAPES, obstacles, run).next_u64()
    }

    fn landscape(&self, obstacles: u32, run: u32) -> Result<Terrain, TerrainError> {
        let seed = self.landscape_seed(obstacles, run);
        let plan = generate::LandPlan { width: self.size, height: self.size, classes: self.classes, seed };
        natural_by(&plan, obstacles, self.hill_norm, self.hills)
    }

    /// The rearmost robot starts one cell from the south-west corner; the goal of robot 1 is one
    /// cell from the north-east corner.
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
            changes: Vec::new(),
            scouting: None,
            rules: MoveRules {
                norm: self.route.norm,
                corner_cutting: self.route.corner_cutting,
                ..MoveRules::default()
            },
            radio: RadioParams { range_m: f64::INFINITY, ..RadioParams::default() },
            robots: robots.collect(),
            plane: None,
            formations: graph.into_iter().collect(),
            parts: Vec::new(),
            route: RouteSetup { params: self.route, replan: Replan::EachCell, sharpness: self.sharpness },
            formation_params: self.formation,
            law: None,
            published: None,
            looks_ahead: false,
            sensing: None,
            faults: Vec::new(),
            key: None,
            key_remark: None,
            files: Vec::new(),
            keeping: None,
            interventions: Vec::new(),
            misnumbered: Vec::new(),
            plausibility: PlausibilityLimits::ANY,
            maps: None,
            attacks: Vec::new(),
            parameters: Default::default(),
        }
    }

    fn crossing(&self, graph: &Formation, (obstacles, way): (u32, Way), run: u32) -> Result<Crossing> {
        let terrain = self.landscape(obstacles, run)?;
        let seed = Rng::keyed(self.seed, RUNS, obstacles, run).next_u64();
        let formation = (way != Way::Alone).then(|| graph.clone());
        let mut scenario = self.scenario(terrain, formation, &graph.places, seed);
        match way {
            Way::Alone => {}
            Way::Together { eps, loss } => {
                scenario.formation_params.eps = eps;
                scenario.radio.loss = loss;
            }
            Way::Under { law, loss } => scenario = law.on(self, &scenario, loss)?,
        }
        let entropy = Metrics::of(&scenario.terrain).entropy;
        Ok(Crossing { entropy, ..cross(&scenario)? })
    }

    fn by_landscape(&self, runs: &[Vec<Crossing>]) -> Vec<Vec<Run>> {
        let all_ways = |ways: &[Vec<Crossing>]| {
            let least = ways.iter().map(Vec::len).min().unwrap_or(0);
            (0..least).map(|run| ways.iter().map(|way| way[run]).collect()).collect()
        };
        runs.chunks(self.ways().count()).map(all_ways).collect()
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "formation";
    const UNIT: &'static str = "crossings";
    type Run = Crossing;
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
        ensure!(self.published.rho > 0, "a geodesic radius rho of 0 for the paper's law; give 1, 2 or 3");
        self.graph_within(self.published.rho)?;
        for &obstacles in &self.obstacles {
            self.landscape(obstacles, 0)?;
        }
        Ok(())
    }

    fn points(&self) -> usize {
        self.obstacles.len() * self.ways().count()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self {
            obstacles: _,
            runs: _,
            size,
            classes,
            hills,
            hill_norm,
            spacing,
            rho,
            route,
            formation: _,
            sharpness,
            loss: _,
            other_eps: _,
            other_losses: _,
            other_laws: _,
            published,
            ticks,
            seed,
        } = self;
        let (obstacles, way) = self.point(point);
        let (is_formation, law, eps, loss) = match way {
            Way::Alone => (false, Law::Staya, self.formation.eps, 0.0),
            Way::Together { eps, loss } => (true, Law::Staya, eps, loss),
            Way::Under { law, loss } => (true, law, law.eps(self), loss),
        };
        let Published { params, rho: paper_rho } = *published;
        let PublishedParams { eps: _, gain: paper_gain, halt, resume, crowd, prediction: paper_prediction } = params;
        let FormationParams {
            eps: _,
            gain,
            halt_lag,
            resume_lag,
            lead,
            footprint,
            patience,
            closes_ranks,
            prediction,
            recovery,
        } = law.params(self);
        vec![
            ("obstacles", obstacles.into()),
            ("formation", is_formation.into()),
            ("law", law.name().into()),
            ("eps_cells", u32::from(eps).into()),
            ("loss", loss.into()),
            ("side_cells", u32::from(*size).into()),
            ("classes", u32::from(*classes).into()),
            ("hills", word(*hills).into()),
            ("hill_norm", word(*hill_norm).into()),
            ("spacing_cells", u32::from(*spacing).into()),
            ("rho", u32::from(*rho).into()),
            ("radius_cells", u32::from(route.radius).into()),
            ("a0", decimal(route.a0).into()),
            ("a1", decimal(route.a1).into()),
            ("a2", decimal(route.a2).into()),
            ("a3", decimal(route.a3).into()),
            ("lead_cells", u32::from(lead).into()),
            ("footprint", u32::from(footprint).into()),
            ("prediction", word(prediction).into()),
            ("recovery", word(recovery).into()),
            ("halt_cells", (f64::from(halt_lag) / f64::from(UNIT)).into()),
            ("resume_cells", (f64::from(resume_lag) / f64::from(UNIT)).into()),
            ("gain", decimal(gain).into()),
            ("patience", u32::from(patience).into()),
            ("closes_ranks", closes_ranks.into()),
            ("shuffle_ticks", options::shuffle_ticks(*sharpness).into()),
            ("paper_rho", u32::from(paper_rho).into()),
            ("paper_gain", decimal(paper_gain).into()),
            ("paper_halt_cells", (f64::from(halt) / f64::from(UNIT)).into()),
            ("paper_resume_cells", (f64::from(resume) / f64::from(UNIT)).into()),
            ("paper_crowd", u32::from(crowd).into()),
            ("paper_prediction", word(paper_prediction).into()),
            ("longest_ticks", (*ticks).into()),
            ("first_seed", seed.to_string().into()),
        ]
    }

    /// Seed of the landscape, for `staya terrain`; robots and radio depend on the first seed.
    fn seed(&self, point: usize, run: u32) -> u64 {
        self.landscape_seed(self.point(point).0, run)
    }

    fn blank(&self, _: usize, _: u32) -> Crossing {
        Crossing::default()
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Crossing>>> {
        let graph = self.graph()?;
        jobs.each(|(): &mut (), point, run| self.crossing(&graph, self.point(point), run).map(Some))
    }

    fn report(&self, runs: &[Vec<Crossing>]) -> Report {
        Report::of(self, &self.by_landscape(runs))
    }

    fn draw(&self, _: &[Vec<Crossing>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        Ok(report.draw(dir)?)
    }
}

fn cross(scenario: &Scenario) -> Result<Crossing, Misplaced> {
    let mut worst_error = 0.0_f64;
    let outcome = simulate(scenario, |moment, _| {
        // NaN without a formation, which `max` ignores.
        worst_error = worst_error.max(moment.row.formation_error_per_agent);
        ControlFlow::Continue(())
    })?;
    let last: Option<u64> = outcome.arrival_times.iter().copied().try_fold(0, |last, at| Some(at?.max(last)));
    let keeping = outcome.formation;
    Ok(Crossing {
        entropy: 0.0,
        arrived: outcome.arrived,
        time_ticks: last.map(|units| units as f64 / f64::from(UNIT)),
        error: keeping.map_or(0.0, |k| k.error_per_agent),
        best_fit_error: keeping.map_or(0.0, |k| k.best_fit_error_per_agent),
        graph_distance: keeping.map_or(0.0, |k| k.graph_distance),
        worst_error,
        collisions: outcome.collisions,
        hash: outcome.trace_hash,
    })
}

#[cfg(test)]
mod tests;
