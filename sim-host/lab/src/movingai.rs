//! The queries of a Moving AI benchmark (N. Sturtevant, "Benchmarks for Grid-Based Pathfinding",
//! IEEE TCIAIG 2012).
//!
//! With a window as large as the map, the controller must find the benchmark's optimal lengths.
//! With a small window, the experiment counts the robots that leave dead ends larger than the
//! window, by learned travel costs ([`Learning`]) and finally by following the wall. Maps too large
//! for the router's search are answered by the planner ([`optimal`]).

mod report;

pub use report::{Answer, Report};

use crate::experiment::Experiment;
use crate::experiment::rows::Jobs;
use crate::optimal;
use crate::route::decimal;
use crate::sweep::Value;
use crate::walk::{Task, Walker, holds};
use anyhow::{Context as _, Result, ensure};
use clap::ValueEnum;
use staya_console::options::word;
use staya_controller::digest::digest;
use staya_controller::grid::UNIT;
use staya_controller::route::{Replan, RouteParams};
use staya_sim::terrain::movingai::{Query, parse_map, parse_scen};
use staya_sim::terrain::{Terrain, read};
use std::path::{Path, PathBuf};

/// Largest search with its border: 255 x 255, the limit of 16-bit indices.
const CELLS: usize = 255 * 255;

/// Range of sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// This number of cells in each direction, at least 1.
    Radius(u8),
    /// The whole map.
    Map,
}

/// Capacity of the visit memory, 6 bytes per cell on the robot.
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
    /// Number of cells.
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

/// Number of learned costs, 8 bytes each on the robot.
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
    /// Number of cells.
    #[must_use]
    pub const fn cells(self) -> usize {
        match self {
            Self::None => 0,
            Self::Cells64 => 64,
            Self::Cells256 => 256,
        }
    }
}

/// Properties of the robots that answer the queries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Robots {
    /// Range of sight.
    pub sight: Sight,
    /// Size of the memory of visits.
    pub memory: Memory,
    /// Size of the memory of learned costs.
    pub learning: Learning,
    /// Parameters of routing; radius and moves are ignored ([`Robots::sight`], the benchmark's
    /// moves).
    pub params: RouteParams,
    /// Condition for a repeated search.
    pub replan: Replan,
}

impl Robots {
    /// Creates robots with the controller's defaults.
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

/// A map and its queries.
#[derive(Clone, Debug)]
pub struct Benchmark {
    /// File of the map.
    pub map: PathBuf,
    /// Terrain; swamp counts as ground, as in the benchmark.
    pub land: Terrain,
    /// Starts, goals and optimal lengths.
    pub queries: Vec<Query>,
}

impl Benchmark {
    /// Reads a scenario and its map, by default the file that the scenario names, in its folder.
    ///
    /// # Errors
    /// A file cannot be read, or the scenario has no queries or belongs to another map.
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

/// Queries, and robots that answer them.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Map and queries.
    pub benchmark: Benchmark,
    /// Properties of the robots.
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
        // A window beyond the map contains no more than the map.
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

#[cfg(test)]
mod tests;
