//! Routes of one robot that sees a part of the land (A. V. Kuznetsov 2017, KUZ, section 5, figures
//! 2 to 4), by the controller's router without agents and radio, over the fastest route on the
//! whole map. Land, robot, and parameters of routing are those of the scenario.
//!
//! The paper's robots learn no travel costs (`learned = 0`). With 256 cells of them, the path is
//! that of the scenario's robot in the engine.

mod automaton;

use super::walk::{self, Maker, Walks, maker, percent, whole};
use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured};
use crate::walk::{Task, Walk};
use staya_controller::grid::Cell;
use staya_controller::rand::Rng;
use staya_controller::route::RouteParams;
use staya_plot::canvas::{Anchor, Canvas, Stroke, Text};
use staya_plot::colour::{INK, PALETTE, WHITE};
use staya_plot::map::{FOOTER, Map};
use staya_sim::scenario::Scenario;
use staya_sim::table;
use staya_sim::terrain::metrics::{Metrics, obstacles_of_entropy};
use staya_sim::terrain::optimal;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const PARKED: u32 = 0x0045_0003;
const MOVES: u32 = 0x0045_0004;
const MAX_RADIUS: u8 = 126;

/// The study.
#[derive(Debug)]
pub struct Route;

table! {
    /// Parameters of a run.
    #[derive(Copy)]
    pub struct Parameters {
        /// Radius of the robot's window, cells, instead of the scenario's, which is at most 16.
        pub radius: Option<u8>;
        /// Visited cells that the robot remembers.
        pub visits: u32 = walk::VISITS;
        /// Cells with learned travel costs.
        pub learned: u32 = walk::LEARNED;
        /// Stationary robots in random cells, avoided with weight a1.
        pub parked: u32 = 0;
        /// Land by a cellular automaton instead of the scenario's, in the same ratio of classes:
        /// probability of an "extraordinary" class of a cell; at 1 cells are independent.
        pub extraordinary: Option<f64>, 0.0..=1.0, "";
    }
}

/// A checked run.
struct Trip {
    scenario: Scenario,
    params: RouteParams,
    parked: Vec<Cell>,
    maker: Maker,
}

impl Study for Route {
    fn name(&self) -> &'static str {
        "route"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("arrived", "1: the robot reached its goal"),
            ("loss_percent", "dT: travel time over that of the fastest route, percent; empty: it did not arrive"),
            ("length_percent", "dL: difference of the lengths of its path and the fastest route, percent"),
            ("excess_percent", "the same with its sign: negative if it crosses bad ground"),
            ("ticks", "its travel time; empty: it did not arrive"),
            ("least_ticks", "travel time of the fastest route"),
            ("length_cells", "length of its path"),
            ("least_cells", "length of the fastest route"),
            ("moves", "its moves"),
            ("entropy", "configuration entropy S of the land"),
            ("total_edge", "its total edge TE"),
            ("total_edge_density", "its total edge density TED"),
            ("obstacles_of_entropy", "N(S) by the paper's formula with its constant corrected"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn takes_scenario(&self) -> bool {
        true
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let trip = Trip::read(given)?;
        Ok(Box::new(move |_| Ok(trip.measured())))
    }

    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        Ok(Trip::read(given)?.drawn(title).write(stem)?)
    }
}

impl Trip {
    fn read(given: &Given<'_>) -> Result<Self, SweepError> {
        let Parameters { radius, visits, learned, parked, extraordinary } = given.parameters()?;
        let maker = maker(given, visits, learned)?;
        let mut scenario = given.scenario()?;
        if scenario.plane().is_some() || scenario.robots.len() != 1 {
            let what = "the scenario is not about one robot on the grid";
            return Err(given.error("radius", what, "name one whose robots.list has one element"));
        }
        let route = scenario.route();
        let radius = radius.unwrap_or(route.params.radius);
        if !(1..=MAX_RADIUS).contains(&radius) {
            let what = format!("a window of radius {radius} is out of range");
            return Err(given.error("radius", what, format!("give 1 to {MAX_RADIUS} cells")));
        }
        let cells = scenario.land.terrain.cells().len();
        if parked as usize > cells / 2 {
            let what = format!("{parked} parked robots on {cells} cells");
            return Err(given.error("parked", what, "take at most half of the cells"));
        }
        let params = RouteParams { radius, ..route.params };
        if let Some(probability) = extraordinary {
            let land = automaton::fill(&scenario.land.terrain, probability, given.seed);
            let land = land.map_err(|error| given.error("extraordinary", error.to_string(), "give other land"))?;
            let cell_m = scenario.land.terrain.cell_m;
            scenario.land.terrain = land;
            scenario.land.terrain.cell_m = cell_m;
        }
        let parked = park(&scenario, parked, given.seed);
        Ok(Self { scenario, params, parked, maker })
    }

    fn walk(&self) -> (Walk, Box<dyn Walks>, Option<optimal::Route>) {
        let Self { scenario, params, parked, maker } = self;
        let (land, from, to) = (&scenario.land.terrain, scenario.robots[0].start, scenario.robots[0].goal);
        let mut walker = maker();
        let order = (scenario.route().sharpness, &mut Rng::keyed(scenario.seed, MOVES, 0, 0));
        let walk = walker.walk(&Task { land, parked, from, to }, params, scenario.route().replan, order);
        (walk, walker, optimal::route(land, from, to, params.norm, params.corner_cutting))
    }

    fn measured(&self) -> Measured {
        let (walk, _, best) = self.walk();
        let best = best.map(|route| (route.cost as f64, route.length(self.params.norm) as f64));
        let is_there = |value: f64| walk.arrived.then_some(value);
        let excess = is_there(walk.length as f64).zip(best).map(|(ours, (_, best))| percent(ours, best));
        let Metrics { entropy, total_edge, total_edge_density, .. } = Metrics::of(&self.scenario.land.terrain);
        Measured::of([
            ("arrived", Some(f64::from(walk.arrived))),
            ("loss_percent", is_there(walk.cost as f64).zip(best).map(|(ours, (best, _))| percent(ours, best))),
            ("length_percent", excess.map(f64::abs)),
            ("excess_percent", excess),
            ("ticks", is_there(whole(walk.cost as f64))),
            ("least_ticks", best.map(|(cost, _)| whole(cost))),
            ("length_cells", Some(whole(walk.length as f64))),
            ("least_cells", best.map(|(_, length)| whole(length))),
            ("moves", Some(walk.moves as f64)),
            ("entropy", Some(entropy)),
            ("total_edge", Some(total_edge as f64)),
            ("total_edge_density", Some(total_edge_density)),
            ("obstacles_of_entropy", Some(obstacles_of_entropy(entropy))),
        ])
    }

    /// Draws the land, the robot's path with its window halfway, and the fastest route.
    fn drawn(&self, title: &str) -> Canvas {
        const SIDE: f64 = 700.0;
        const LEFT: f64 = 20.0;
        const TOP: f64 = 100.0;
        let (walk, walker, best) = self.walk();
        let land = &self.scenario.land.terrain;
        let map = Map::of_scale(land, [LEFT, TOP], SIDE / f64::from(land.width().max(land.height())));
        let (cell, area) = (map.cell, map.area);
        let centre = |at: &Cell| map.place_cells([f64::from(at.x) + 0.5, f64::from(at.y) + 0.5]);
        let mut canvas = Canvas::new(SIDE + 2.0 * LEFT, TOP + area[3] + FOOTER, title);
        canvas.text(Text { bold: true, ..Text::new([LEFT, 30.0], 13.0, Anchor::Start, title) });
        canvas.clip(Some(area));
        map.ground(&mut canvas);
        for at in &self.parked {
            canvas.circle(centre(at), cell * 0.4, Some(PALETTE[2]), None);
        }
        let length =
            |units: u64, cost: u64| format!("{:.0} ticks, {:.1} cells long", whole(cost as f64), whole(units as f64));
        let lost = if walk.arrived { "" } else { ", not arrived" };
        let ours = format!("by window: {}{lost}", length(walk.length, walk.cost));
        let fastest =
            best.as_ref().map(|route| format!("fastest: {}", length(route.length(self.params.norm), route.cost)));
        let best = best.map_or(Vec::new(), |route| route.cells);
        // The path is thinner, so that both are visible where they coincide.
        let lines = [
            (&best[..], Stroke::new(PALETTE[0], 6.0), fastest.unwrap_or_default()),
            (walker.path(), Stroke::new(PALETTE[1], 2.0), ours),
        ];
        for (way, stroke, _) in &lines {
            let points: Vec<_> = way.iter().map(centre).collect();
            canvas.line(points.clone(), Stroke::new(WHITE, stroke.width + 2.5));
            canvas.line(points, *stroke);
        }
        for end in [best.first(), best.last()].into_iter().flatten() {
            canvas.circle(centre(end), 5.0, Some(WHITE), Some(Stroke::new(INK, 2.0)));
        }
        let window = Stroke::new(PALETTE[1], 1.5);
        if let Some([x, y]) = walker.path().get(walker.path().len() / 2).map(centre) {
            let half = (f64::from(self.params.radius) + 0.5) * cell;
            canvas.rectangle([x - half, y - half, 2.0 * half, 2.0 * half], None, Some(window));
        }
        canvas.clip(None);
        map.frame(&mut canvas);
        map.footer(&mut canvas, LEFT, LEFT + SIDE);
        for ((_, stroke, text), y) in lines.into_iter().zip([56.0, 76.0]) {
            canvas.line(vec![[LEFT + 3.0, y], [LEFT + 28.0, y]], stroke);
            canvas.text(Text::new([LEFT + 38.0, y], 13.0, Anchor::Start, text).centred());
        }
        let middle = LEFT + SIDE / 2.0;
        canvas.rectangle([middle + 9.0, 50.0, 12.0, 12.0], None, Some(window));
        let side = 2 * u32::from(self.params.radius) + 1;
        let text = format!("its window halfway, {side} × {side} cells");
        canvas.text(Text::new([middle + 38.0, 56.0], 13.0, Anchor::Start, text).centred());
        if !self.parked.is_empty() {
            canvas.circle([middle + 15.0, 76.0], 5.0, Some(PALETTE[2]), None);
            canvas.text(Text::new([middle + 38.0, 76.0], 13.0, Anchor::Start, "parked robot").centred());
        }
        canvas
    }
}

/// Cells of parked robots, in ascending order.
fn park(scenario: &Scenario, count: u32, seed: u64) -> Vec<Cell> {
    let (land, robot) = (&scenario.land.terrain, &scenario.robots[0]);
    let mut rng = Rng::keyed(seed, PARKED, 0, 0);
    let mut cells = BTreeSet::new();
    while cells.len() < count as usize {
        let [x, y] = [land.width(), land.height()].map(|side| rng.below(side.into()) as i16);
        if ![robot.start, robot.goal].contains(&Cell::new(x, y)) {
            cells.insert(Cell::new(x, y));
        }
    }
    cells.into_iter().collect()
}

#[cfg(test)]
mod tests;
