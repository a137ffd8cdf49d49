//! The queries of a Moving AI benchmark (N. Sturtevant, "Benchmarks for Grid-Based Pathfinding",
//! IEEE TCIAIG 2012). A run answers all of them.
//!
//! With a window as large as the map, the controller must find the benchmark's optimal lengths.
//! With a small window, the study counts the robots that leave dead ends larger than the window, by
//! learned travel costs and finally by following the wall. Maps too large for the router's search
//! are answered by the planner ([`optimal`]).

use super::walk::{self, CELLS, Maker, Walks, maker, percent, whole};
use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch, write_table};
use crate::walk::{Task, holds};
use rayon::prelude::*;
use staya_controller::cost::Gain;
use staya_controller::rand::Rng;
use staya_controller::route::{ExitRule, Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_sim::shown::Shown as _;
use staya_sim::table;
use staya_sim::terrain::movingai::{Query, parse_map, parse_scen};
use staya_sim::terrain::optimal;
use staya_sim::terrain::{Terrain, read};
use staya_stats::Summary;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The study.
#[derive(Debug)]
pub struct MovingAi;

table! {
    /// Parameters of a run.
    pub struct Parameters {
        /// The benchmark's queries.
        pub scen: PathBuf;
        /// Default: the file that the scenario names, in its folder.
        pub map: Option<PathBuf>;
        /// Radius of the robot's window, cells; 0: the whole map.
        pub radius: u8 = 5;
        /// Visited cells that the robot remembers, 6 bytes each.
        pub visits: u32 = walk::VISITS;
        /// Cells with learned travel costs, 8 bytes each.
        pub learned: u32 = walk::LEARNED;
        /// Which border cells of the window end a route: `"best"` or `"ray"`.
        pub exit: ExitRule = ExitRule::default();
        /// When to plan: `"each_cell"` or `"until_changed"`.
        pub replan: Replan = Replan::default();
        /// Weight of travel time, 0 to 4095.
        pub a0: Option<f64>, 0.0..=4095.0, "";
        /// Extra ticks for a cell that another robot occupies, 0 to 4095.
        pub a1: Option<f64>, 0.0..=4095.0, "";
        /// Ticks per earlier visit of a cell, 0 to 4095.
        pub a2: Option<f64>, 0.0..=4095.0, "";
        /// Ticks per cell of distance from the exit to the goal, 0 to 4095.
        pub a3: Option<f64>, 0.0..=4095.0, "";
    }
}

/// Result of one query; lengths in cells.
#[derive(Clone, Copy, Debug)]
struct Answer {
    optimal: f64,
    arrived: bool,
    length: f64,
    /// Shortest route by the router with the whole map in its window.
    priced: Option<f64>,
}

#[derive(Debug)]
struct Benchmark {
    land: Terrain,
    queries: Vec<Query>,
    params: RouteParams,
    replan: Replan,
    sees_map: bool,
    maker: Maker,
}

impl Study for MovingAi {
    fn name(&self) -> &'static str {
        "movingai"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("queries", "queries of the benchmark"),
            ("arrived", "robots that reached their goal"),
            ("loss_percent", "length of a path over the optimal one, mean over robots that arrived"),
            ("median_percent", "its median"),
            ("least_percent", "the smallest"),
            ("most_percent", "the largest"),
            ("price_error_percent", "largest deviation of routes on the whole map from the optimal lengths"),
            ("without_route", "queries without a route on the whole map; empty: the robots do not see all of it"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let benchmark = benchmark(given)?;
        Ok(Box::new(move |watch| Ok(measured(&benchmark, &answers(&benchmark, watch)))))
    }

    /// Writes a table with a row per query instead of a picture.
    fn draw(&self, given: &Given<'_>, _: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let benchmark = benchmark(given)?;
        let mut text =
            "query,start_x,start_y,goal_x,goal_y,optimal_cells,arrived,length_cells,priced_cells\n".to_owned();
        for ((number, query), answer) in (1..).zip(&benchmark.queries).zip(answers(&benchmark, &|_| true)) {
            let ([start, goal], Answer { optimal, arrived, length, priced }) = ([query.start, query.goal], answer);
            let ends = format!("{},{},{},{}", start.x, start.y, goal.x, goal.y);
            let priced = priced.map_or(String::new(), |cells| cells.to_string());
            let _ = writeln!(text, "{number},{ends},{optimal},{},{length},{priced}", u8::from(arrived));
        }
        Ok(vec![write_table(stem, &text)?])
    }
}

fn benchmark(given: &Given<'_>) -> Result<Benchmark, SweepError> {
    let parameters: Parameters = given.parameters()?;
    let scen = given.source.file(&parameters.scen);
    let wrong = |what: String, remedy: &str| SweepError::new(scen.shown(), what, remedy);
    let queries = parse_scen(&read(&scen)?, &scen)?;
    let Some(first) = queries.first() else {
        return Err(wrong("no queries".to_owned(), "each line after the first one is a query"));
    };
    let beside = scen.with_file_name(Path::new(&first.map).file_name().unwrap_or_default());
    let map = parameters.map.as_ref().map_or(beside, |map| given.source.file(map));
    if parameters.map.is_none() && !map.is_file() {
        let what = format!("its map {} is not beside it ({} does not exist)", first.map, map.shown());
        return Err(wrong(what, "put it there, or name it by study.map"));
    }
    let land = parse_map(&read(&map)?, &map, 1)?;
    let (width, height, name) = (land.width(), land.height(), map.shown());
    for (query, number) in queries.iter().zip(1..) {
        if (query.width, query.height) != (width, height) {
            let [w, h] = [query.width, query.height];
            let what = format!("query {number} is for a map of {w} x {h} cells, but {name} has {width} x {height}");
            return Err(wrong(what, "name the right one by study.map"));
        }
        if !land.is_passable(query.start) || !land.is_passable(query.goal) {
            let what = format!("query {number} starts or ends in a wall of {name}");
            return Err(wrong(what, "name the right map by study.map"));
        }
    }
    let sees_map = parameters.radius == 0;
    // A window beyond the map contains no more than the map.
    if parameters.radius > 126 && !holds(CELLS, &land) {
        let what = format!("a map of {width} x {height} cells is more than the controller can see at once");
        return Err(given.error("radius", what, "give at most 126, or 0 for the whole map"));
    }
    let default = RouteParams::default();
    let gain = |value: Option<f64>, usual: Gain| {
        value.map_or(usual, |value| Gain::from_sixteenths(libm::round(value * 16.0) as u16))
    };
    let params = RouteParams {
        radius: if sees_map { u8::MAX } else { parameters.radius },
        exit: parameters.exit,
        a0: gain(parameters.a0, default.a0),
        a1: gain(parameters.a1, default.a1),
        a2: gain(parameters.a2, default.a2),
        a3: gain(parameters.a3, default.a3),
        ..default
    };
    let maker = maker(given, parameters.visits, parameters.learned)?;
    Ok(Benchmark { land, queries, params, replan: parameters.replan, sees_map, maker })
}

fn answers(benchmark: &Benchmark, watch: &Watch<'_>) -> Vec<Answer> {
    let Benchmark { land, queries, params, replan, sees_map, maker } = benchmark;
    let answer = |walker: &mut Box<dyn Walks>, (number, query): (usize, &Query)| {
        if !watch(number as u32) {
            return None;
        }
        let (from, to, optimal) = (query.start, query.goal, query.optimal_length);
        if *sees_map && !holds(CELLS, land) {
            let route = optimal::route(land, from, to, params.norm, params.corner_cutting);
            return Some(Answer {
                optimal,
                arrived: route.is_some(),
                length: route.as_ref().map_or(0.0, |route| whole(route.length(params.norm) as f64)),
                priced: route.map(|route| whole(route.cost as f64)),
            });
        }
        let order = (Sharpness::Greedy, &mut Rng::new(0));
        let walk = walker.walk(&Task { land, parked: &[], from, to }, params, *replan, order);
        let priced = if *sees_map { walker.price(land, params, from, to) } else { None };
        let length = whole(walk.length as f64);
        Some(Answer { optimal, arrived: walk.arrived, length, priced: priced.map(whole) })
    };
    queries.par_iter().enumerate().with_min_len(8).map_init(maker, answer).while_some().collect()
}

fn measured(benchmark: &Benchmark, answers: &[Answer]) -> Measured {
    let losses = answers.iter().filter(|answer| answer.arrived).map(|answer| percent(answer.length, answer.optimal));
    let losses: Vec<f64> = losses.collect();
    let loss = Summary::of(&losses);
    let errors = answers.iter().filter_map(|answer| Some(percent(answer.priced?, answer.optimal).abs()));
    let without = answers.iter().filter(|answer| answer.priced.is_none()).count() as f64;
    let values = [
        ("queries", Some(benchmark.queries.len() as f64)),
        ("arrived", Some(losses.len() as f64)),
        ("loss_percent", loss.map(|loss| loss.mean)),
        ("median_percent", loss.map(|loss| loss.median)),
        ("least_percent", loss.map(|loss| loss.min)),
        ("most_percent", loss.map(|loss| loss.max)),
        ("price_error_percent", errors.reduce(f64::max)),
        ("without_route", benchmark.sees_map.then_some(without)),
    ];
    Measured { is_cut: answers.len() < benchmark.queries.len(), ..Measured::of(values) }
}

#[cfg(test)]
mod tests;
