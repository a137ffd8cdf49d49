//! The queries of a Moving AI benchmark (N. Sturtevant, "Benchmarks for Grid-Based Pathfinding", IEEE TCIAIG 2012).
//!
//! With a window as large as the map the controller must find the optimal lengths that the benchmark states; with a
//! small one the question is how many robots get out of the dead ends that they cannot see, and how late. What gets them out
//! is what they learn of the costs of ways, as far as they can remember it ([`Learning`]), and at last the wall. A map
//! that is too large for the router's search is answered by the planner ([`optimal`]).

use crate::experiment::Experiment;
use crate::experiment::rows::{Each, Jobs, Record};
use crate::optimal;
use crate::options::word;
use crate::route::decimal;
use crate::walk::{Task, Walker, holds};
use anyhow::{Context as _, Result, ensure};
use clap::ValueEnum;
use serde::Serialize;
use staya_controller::digest::digest;
use staya_controller::grid::UNIT;
use staya_controller::route::{Replan, RouteParams};
use staya_sim::terrain::movingai::{Query, parse_map, parse_scen};
use staya_sim::terrain::{Terrain, read};
use staya_stats::Summary;
use staya_sweep::Value;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// Cells of the largest search, border included: 255 x 255, as many as 16-bit numbers can tell apart.
const CELLS: usize = 255 * 255;

/// How far the robot sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// So many cells in each direction, 1 or more.
    Radius(u8),
    /// All of the map.
    Map,
}

/// How many cells the robot's visit memory holds: 6 bytes each on the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the numbers say it")]
pub enum Memory {
    #[value(name = "16")]
    Cells16,
    #[default]
    #[value(name = "64")]
    Cells64,
    #[value(name = "256")]
    Cells256,
    #[value(name = "1024")]
    Cells1024,
}

impl Memory {
    /// The number of cells.
    #[must_use]
    pub const fn cells(self) -> usize {
        match self {
            Self::Cells16 => 16,
            Self::Cells64 => 64,
            Self::Cells256 => 256,
            Self::Cells1024 => 1024,
        }
    }
}

/// How many costs the robot learns: 8 bytes each on the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the numbers say it")]
pub enum Learning {
    #[value(name = "0")]
    None,
    #[value(name = "64")]
    Cells64,
    #[default]
    #[value(name = "256")]
    Cells256,
}

impl Learning {
    /// The number of cells.
    #[must_use]
    pub const fn cells(self) -> usize {
        match self {
            Self::None => 0,
            Self::Cells64 => 64,
            Self::Cells256 => 256,
        }
    }
}

/// The robots that answer the queries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Robots {
    /// How far they see.
    pub sight: Sight,
    /// How much they remember of their way.
    pub memory: Memory,
    /// How much they learn of the costs of ways.
    pub learning: Learning,
    /// What they take ways to cost. Radius and moves do not count: [`Robots::sight`] is the radius, and moves
    /// are those of the benchmark (diagonals are sqrt 2 long and cut no corners).
    pub params: RouteParams,
    /// When they search anew.
    pub replan: Replan,
}

impl Robots {
    /// Robots with the controller's defaults.
    #[must_use]
    pub fn new(sight: Sight) -> Self {
        Self {
            sight,
            memory: Memory::default(),
            learning: Learning::default(),
            params: RouteParams::default(),
            replan: Replan::default(),
        }
    }
}

/// A map and what to do on it.
#[derive(Clone, Debug)]
pub struct Benchmark {
    /// The map's file.
    pub map: PathBuf,
    /// The land; swamp is ground, as the benchmark has it.
    pub land: Terrain,
    /// Starts, goals and optimal lengths.
    pub queries: Vec<Query>,
}

impl Benchmark {
    /// Reads a scenario and its map, by default the one beside it that it names.
    ///
    /// # Errors
    /// A file that cannot be read, a scenario without queries or for another map; naming file and remedy.
    pub fn load(scen: &Path, map: Option<&Path>) -> Result<Self> {
        let at = scen.display();
        let queries = parse_scen(&read(scen)?, scen)?;
        let first =
            queries.first().with_context(|| format!("{at}: no queries; each line after the first one is a query"))?;
        let beside = scen.with_file_name(Path::new(&first.map).file_name().unwrap_or_default());
        let map = map.map_or(beside.clone(), Path::to_owned);
        ensure!(
            map != beside || map.is_file(),
            "{at}: its map {} is not beside it ({} does not exist); put it there, or name it by --map",
            first.map,
            map.display()
        );
        let land = parse_map(&read(&map)?, &map, 1)?;
        let name = map.display();
        let (width, height) = (land.width(), land.height());
        for (query, number) in queries.iter().zip(1..) {
            ensure!(
                (query.width, query.height) == (width, height),
                "{at}: query {number} is for a map of {} x {} cells, but {name} has {width} x {height}; \
                 name the right one by --map",
                query.width,
                query.height
            );
            ensure!(
                land.is_passable(query.start) && land.is_passable(query.goal),
                "{at}: query {number} starts or ends in a wall of {name}; name the right map by --map"
            );
        }
        Ok(Self { map, land, queries })
    }
}

/// What to do: a benchmark's queries, answered by robots.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Map and queries.
    pub benchmark: Benchmark,
    /// Who answers them.
    pub robots: Robots,
}

impl Plan {
    fn params(&self) -> RouteParams {
        let default = RouteParams::default();
        RouteParams {
            radius: match self.robots.sight {
                Sight::Radius(radius) => radius,
                Sight::Map => u8::MAX,
            },
            norm: default.norm,
            corner_cutting: default.corner_cutting,
            ..self.robots.params
        }
    }

    /// The answer of a planner that sees all of a map that is too large for the router's search.
    fn planned(&self, query: &Query) -> Answer {
        let RouteParams { norm, corner_cutting, .. } = self.params();
        let route = optimal::route(&self.benchmark.land, query.start, query.goal, norm, corner_cutting);
        Answer {
            optimal_cells: query.optimal_length,
            arrived: route.is_some(),
            length_cells: route.as_ref().map_or(0.0, |route| cells(route.length(norm) as f64)),
            priced_cells: route.map(|route| cells(route.cost as f64)),
        }
    }

    fn answers<const M: usize>(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Answer>>> {
        match self.robots.learning {
            Learning::None => self.answer::<M, 0>(jobs),
            Learning::Cells64 => self.answer::<M, 64>(jobs),
            Learning::Cells256 => self.answer::<M, 256>(jobs),
        }
    }

    fn answer<const M: usize, const L: usize>(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Answer>>> {
        let (land, robots, params) = (&self.benchmark.land, &self.robots, self.params());
        jobs.each(|walker: &mut Walker<CELLS, M, L>, index, _| {
            let query = &self.benchmark.queries[index];
            if robots.sight == Sight::Map && !holds(CELLS, land) {
                return Ok(Some(self.planned(query)));
            }
            let task = Task { land, parked: &[], from: query.start, to: query.goal };
            let walk = walker.walk(&task, &params, robots.replan);
            let priced = match robots.sight {
                Sight::Map => walker.price(land, &params, query.start, query.goal),
                Sight::Radius(_) => None,
            };
            Ok(Some(Answer {
                optimal_cells: query.optimal_length,
                arrived: walk.arrived,
                length_cells: cells(walk.length as f64),
                priced_cells: priced.map(cells),
            }))
        })
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "movingai";
    const UNIT: &'static str = "queries";
    type Run = Answer;
    type Report = Report;

    fn check(&self) -> Result<()> {
        let land = &self.benchmark.land;
        // A window that reaches beyond the map holds no more than the map.
        let sees_all = self.robots.sight != Sight::Map && self.params().radius > 126;
        ensure!(
            holds(CELLS, land) || !sees_all,
            "a map of {} x {} cells is more than the controller can see at once: no side over 256, and at most \
             {CELLS} cells with a border of one around them; choose a smaller radius, or \"map\"",
            land.width(),
            land.height()
        );
        Ok(())
    }

    fn points(&self) -> usize {
        self.benchmark.queries.len()
    }

    fn runs(&self) -> u32 {
        1
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Benchmark { map, land, queries } = &self.benchmark;
        let Robots { sight, memory, learning, params: _, replan } = self.robots;
        let RouteParams { radius, exit, norm, corner_cutting, a0, a1, a2, a3 } = self.params();
        let query = &queries[point];
        let mut given: Vec<(_, Value)> = vec![
            ("query", (point as u32 + 1).into()),
            ("map", map.file_name().unwrap_or_default().to_string_lossy().into_owned().into()),
            ("land", format!("{:016x}", digest(land.cells())).into()),
        ];
        let [start, goal] = [query.start, query.goal].map(|at| [at.x, at.y].map(|c| Value::Whole(c.into())));
        given.extend(["start_x", "start_y"].into_iter().zip(start));
        given.extend(["goal_x", "goal_y"].into_iter().zip(goal));
        given.extend([
            ("optimal_cells", query.optimal_length.into()),
            ("radius_cells", if sight == Sight::Map { "map".into() } else { u32::from(radius).into() }),
            ("visits", (memory.cells() as u32).into()),
            ("learned", (learning.cells() as u32).into()),
            ("exit", word(exit).into()),
            ("replan", word(replan).into()),
            ("norm", word(norm).into()),
            ("corner_cutting", corner_cutting.into()),
        ]);
        given.extend([("a0", a0), ("a1", a1), ("a2", a2), ("a3", a3)].map(|(name, a)| (name, decimal(a).into())));
        given
    }

    /// Nothing is drawn.
    fn seed(&self, _: usize, _: u32) -> u64 {
        0
    }

    fn blank(&self, point: usize, _: u32) -> Answer {
        let optimal_cells = self.benchmark.queries[point].optimal_length;
        Answer { optimal_cells, arrived: false, length_cells: 0.0, priced_cells: None }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Answer>>> {
        match self.robots.memory {
            Memory::Cells16 => self.answers::<16>(jobs),
            Memory::Cells64 => self.answers::<64>(jobs),
            Memory::Cells256 => self.answers::<256>(jobs),
            Memory::Cells1024 => self.answers::<1024>(jobs),
        }
    }

    fn report(&self, answers: &[Vec<Answer>]) -> Report {
        Report::of(&self.benchmark, &self.robots, &answers.concat())
    }
}

fn cells(units: f64) -> f64 {
    units / f64::from(UNIT)
}

/// What one query gave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The optimal length that the benchmark states, cells.
    pub optimal_cells: f64,
    /// Whether the robot reached the goal.
    pub arrived: bool,
    /// Length of its way, cells; where it did not arrive, until it gave up.
    pub length_cells: f64,
    /// What the router with the whole map in its window took the shortest way to be at the start, cells; `None`
    /// if it found none, or sees only a part.
    pub priced_cells: Option<f64>,
}

impl Record for Answer {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("arrived", "1: the robot reached the goal", &mut self.arrived);
        each("length_cells", "length of its way, or of what it went until it gave up", &mut self.length_cells);
        each("priced_cells", "the shortest way as the router took it to be; empty: none", &mut self.priced_cells);
    }
}

impl Answer {
    /// By how much the way is longer than the optimal one, percent of it.
    #[must_use]
    pub fn loss_percent(&self) -> f64 {
        percent(self.length_cells, self.optimal_cells)
    }

    /// By how much the router's price is off the optimal length, percent of it; `None` without a price.
    #[must_use]
    pub fn price_error_percent(&self) -> Option<f64> {
        Some(percent(self.priced_cells?, self.optimal_cells))
    }
}

fn percent(ours: f64, optimal: f64) -> f64 {
    if ours == optimal {
        return 0.0;
    }
    100.0 * (ours - optimal) / optimal
}

/// The numbers of a benchmark, ready to be printed.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Always `movingai`.
    pub experiment: &'static str,
    /// The map's file.
    pub map: PathBuf,
    /// Columns of the map.
    pub width: u16,
    /// Rows of the map.
    pub height: u16,
    /// Window radius in cells; `null`: the whole map.
    pub radius: Option<u8>,
    /// Cells of the visit memory.
    pub visits: usize,
    /// Cells of the learned costs.
    pub learned: usize,
    /// Queries in the scenario.
    pub queries: usize,
    /// Queries answered, fewer after an early end.
    pub answered: usize,
    /// Robots that reached their goal.
    pub arrived: usize,
    /// Length above the optimal one in percent of it, over the robots that arrived.
    pub loss_percent: Option<Summary>,
    /// With the whole map in the window: the largest deviation, either way, of the router's price from the optimal
    /// length, percent of it.
    pub worst_price_error_percent: Option<f64>,
    /// With the whole map in the window: queries for which the router knows no way.
    pub without_price: Option<usize>,
}

impl Report {
    /// The statistics of the answers.
    #[must_use]
    pub fn of(benchmark: &Benchmark, robots: &Robots, answers: &[Answer]) -> Self {
        let losses: Vec<f64> = answers.iter().filter(|answer| answer.arrived).map(Answer::loss_percent).collect();
        let errors = answers.iter().filter_map(Answer::price_error_percent);
        let whole = robots.sight == Sight::Map;
        Self {
            experiment: "movingai",
            map: benchmark.map.clone(),
            width: benchmark.land.width(),
            height: benchmark.land.height(),
            radius: match robots.sight {
                Sight::Radius(radius) => Some(radius),
                Sight::Map => None,
            },
            visits: robots.memory.cells(),
            learned: robots.learning.cells(),
            queries: benchmark.queries.len(),
            answered: answers.len(),
            arrived: losses.len(),
            loss_percent: Summary::of(&losses),
            worst_price_error_percent: errors.map(f64::abs).reduce(f64::max),
            without_price: whole.then(|| answers.iter().filter(|answer| answer.priced_cells.is_none()).count()),
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (width, height) = (self.width, self.height);
        writeln!(f, "{} ({width} x {height} cells)", self.map.display())?;
        let radius = self.radius.map_or_else(|| String::from("the whole map"), |r| format!("radius {r}"));
        writeln!(f, "  window                {radius}")?;
        writeln!(f, "  visit memory          {} cells", self.visits)?;
        writeln!(f, "  learned costs         {} cells", self.learned)?;
        let (answered, queries) = (self.answered, self.queries);
        writeln!(f, "  queries answered      {answered} of {queries}")?;
        writeln!(f, "  arrived               {}", self.arrived)?;
        if let Some(loss) = &self.loss_percent {
            writeln!(
                f,
                "  longer than optimal   {:.2} % on average, median {:.2} %, at most {:.2} %",
                loss.mean, loss.median, loss.max
            )?;
        }
        if let Some(error) = self.worst_price_error_percent {
            writeln!(f, "  optimal lengths       met within {error:.4} % for every query with a way")?;
        }
        if let Some(without @ 1..) = self.without_price {
            writeln!(f, "  no way found          {without}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::grid::{BLOCKED, Cell};

    const MAP: &str = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n...S\n";

    /// Writes map and scenario; `rows` are the queries without bucket and map.
    fn files(rows: &[&str]) -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().unwrap();
        let scen = dir.path().join("a.map.scen");
        let queries: String = rows.iter().map(|row| format!("0\tmaps/x/a.map\t{}\n", row.replace(' ', "\t"))).collect();
        std::fs::write(&scen, format!("version 1\n{queries}")).unwrap();
        std::fs::write(dir.path().join("a.map"), MAP).unwrap();
        (dir, scen)
    }

    fn report(rows: &[&str], sight: Sight) -> Report {
        let (_dir, scen) = files(rows);
        let benchmark = Benchmark::load(&scen, None).unwrap();
        let robots = Robots::new(sight);
        Plan { benchmark, robots }.measure().unwrap()
    }

    #[test]
    fn right_lengths_are_met_and_wrong_ones_show() {
        // Around the wall without cutting its corners; over swamp at the price of ground; not at all.
        let right = ["4 3 0 0 3 2 5", "4 3 0 2 3 2 3", "4 3 2 2 2 2 0"];
        let good = report(&right, Sight::Map);
        assert_eq!((good.answered, good.arrived, good.without_price), (3, 3, Some(0)));
        assert!(good.worst_price_error_percent.unwrap() < 1e-9);
        assert_eq!(good.loss_percent.unwrap().max, 0.0);
        for wrong in ["4 3 0 0 3 2 4.9", "4 3 0 0 3 2 5.1", "4 3 2 2 2 2 1"] {
            let bad = report(&[wrong], Sight::Map);
            assert!(bad.worst_price_error_percent.unwrap() > 1.0, "{wrong}");
        }
        let near = report(&right, Sight::Radius(1));
        assert_eq!(near.worst_price_error_percent, None);
        assert_eq!(near.without_price, None);
    }

    #[test]
    fn files_that_do_not_belong_together_are_named() {
        let message = |scen: &Path, map: Option<&Path>| Benchmark::load(scen, map).unwrap_err().to_string();
        let (dir, scen) = files(&["4 3 0 0 3 2 5", "4 4 0 0 3 2 5"]);
        let size = message(&scen, None);
        assert!(size.contains("query 2 is for a map of 4 x 4"), "{size}");
        let (_dir, walled) = files(&["4 3 0 0 1 1 5"]);
        assert!(message(&walled, None).contains("query 1 starts or ends in a wall"));
        let (_dir, empty) = files(&[]);
        assert!(message(&empty, None).contains("no queries"));
        std::fs::remove_file(dir.path().join("a.map")).unwrap();
        let missing = message(&scen, None);
        assert!(missing.contains("maps/x/a.map is not beside it"), "{missing}");
        assert!(message(&dir.path().join("none.scen"), None).contains("none.scen"));
        let other = dir.path().join("other.map");
        assert!(message(&scen, Some(&other)).contains("other.map"));
    }

    #[test]
    fn a_map_too_large_for_the_search_is_planned_at_the_optimal_length() {
        // A wall with a gap at its eastern end, far from the straight way.
        let mut land = Terrain::flat(300, 260);
        (0..299).for_each(|x| land.set(Cell::new(x, 100), BLOCKED));
        let [start, goal] = [Cell::new(298, 0), Cell::new(298, 200)];
        // Diagonally before the gap and behind it, cutting no corner.
        let optimal_length = 198.0 + 2.0 * std::f64::consts::SQRT_2;
        let query = Query { bucket: 0, map: "a.map".into(), width: 300, height: 260, start, goal, optimal_length };
        let benchmark = Benchmark { map: "a.map".into(), land, queries: vec![query] };
        let report = Plan { benchmark, robots: Robots::new(Sight::Map) }.measure().unwrap();
        assert_eq!((report.arrived, report.without_price), (1, Some(0)));
        assert!(report.worst_price_error_percent.unwrap() < 0.01, "{report}");
    }

    #[test]
    fn land_too_large_to_be_seen_at_once_is_refused() {
        let benchmark =
            |width, height| Benchmark { map: "a.map".into(), land: Terrain::flat(width, height), queries: vec![] };
        let answer = |width, height, sight| {
            let (benchmark, robots) = (benchmark(width, height), Robots::new(sight));
            Plan { benchmark, robots }.carry_out(|_| true).map_err(|error| error.to_string())
        };
        assert!(answer(253, 253, Sight::Map).is_ok());
        assert!(answer(256, 250, Sight::Map).is_ok());
        assert!(answer(512, 512, Sight::Map).is_ok());
        assert!(answer(1000, 1000, Sight::Radius(126)).is_ok());
        for (width, height) in [(254, 253), (257, 10)] {
            let error = answer(width, height, Sight::Radius(127)).unwrap_err();
            assert!(error.contains("choose a smaller radius"), "{error}");
        }
    }
}
