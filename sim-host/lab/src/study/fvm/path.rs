//! A path by descent on a functional voxel model of travel times (figure 1a).
//!
//! The model holds the travel time to the goal from each cell of natural land (KUZ), found by
//! Dijkstra's algorithm. The robot knows the model and the cells around its own: it enters the
//! neighbouring cell with the least sum of its crossing time and the model's travel time. A cell
//! that it has visited costs more with each visit, since errors of a coarse model may form pits.

use super::{Parameters, Values};
use staya_controller::grid::{Cell, Dir, Norm, UNIT};
use staya_fvm::{Function, Grid, build};
use staya_plot::canvas::{Anchor, Canvas, Stroke, Text};
use staya_plot::colour::{INK, PALETTE, WHITE};
use staya_plot::map::{FOOTER, Map};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::generate::{LandPlan, natural};
use staya_sim::terrain::optimal;
use staya_voxel::Model;

pub const MEASURES: &[(&str, &str)] = &[
    ("arrived", "1: the robot reached its goal"),
    ("loss_percent", "travel time of its path over that of the fastest route, percent; empty: it did not arrive"),
    ("revisits", "cells that it entered again"),
    ("model_bytes", "size of the model"),
];

const SIDE: u16 = 100;
const FROM: Cell = Cell::new(1, 1);
const TO: Cell = Cell::new(98, 98);
/// Ticks that each earlier visit of a cell adds.
const VISITED: f64 = 3.0;
/// Moves after which the robot gives up.
const MOST: usize = 20 * SIDE as usize;

/// A land, the model of its travel times, and the path on it.
pub struct Trip {
    land: Terrain,
    bytes: usize,
    path: Vec<Cell>,
    fastest: optimal::Route,
}

impl Trip {
    pub fn new(parameters: &Parameters, seed: u64) -> Result<Self, String> {
        let plan = LandPlan { width: SIDE, height: SIDE, classes: 9, seed };
        let land = natural(&plan, parameters.obstacles, Norm::Euclidean).map_err(|error| error.to_string())?;
        let fastest = optimal::route(&land, FROM, TO, Norm::Euclidean, true).ok_or("there is no route")?;
        let times = optimal::Planner::default().costs_to(&land, TO, Norm::Euclidean, true);
        let last = f64::from(SIDE - 1);
        let grid = Grid { extent: [[0.0, last]; 2], nodes: [parameters.nodes; 2] };
        let function = Function::new(move |at| interpolated(&times, at));
        let bytes = build(&function, &grid, parameters.depth).map_err(|error| error.to_string())?;
        let model = Model::<f32, 2>::from_bytes(&bytes).map_err(|error| error.to_string())?;
        let path = descend(&land, &model);
        Ok(Self { land, bytes: bytes.len(), path, fastest })
    }

    fn has_arrived(&self) -> bool {
        self.path.last() == Some(&TO)
    }

    /// Travel time, as [`optimal::Route::cost`].
    fn cost(&self) -> u64 {
        let moves = self.path.windows(2);
        moves.map(|pair| price(&self.land, pair[0], pair[1])).sum()
    }

    pub fn measure(&self) -> Values {
        let (cost, least) = (self.cost() as f64, self.fastest.cost as f64);
        let mut cells = self.path.clone();
        cells.sort_unstable_by_key(|cell| (cell.y, cell.x));
        cells.dedup();
        vec![
            ("arrived", Some(f64::from(u8::from(self.has_arrived())))),
            ("loss_percent", self.has_arrived().then(|| 100.0 * (cost / least - 1.0))),
            ("revisits", Some((self.path.len() - cells.len()) as f64)),
            ("model_bytes", Some(self.bytes as f64)),
        ]
    }

    /// Draws the land, the path by the model, and the fastest route.
    pub fn draw(&self, title: &str) -> Canvas {
        const WIDTH: f64 = 700.0;
        const LEFT: f64 = 20.0;
        const TOP: f64 = 100.0;
        let map = Map::of_scale(&self.land, [LEFT, TOP], WIDTH / f64::from(SIDE));
        let centre = |at: &Cell| map.place_cells([f64::from(at.x) + 0.5, f64::from(at.y) + 0.5]);
        let mut canvas = Canvas::new(WIDTH + 2.0 * LEFT, TOP + map.area[3] + FOOTER, title);
        canvas.text(Text { bold: true, ..Text::new([LEFT, 30.0], 13.0, Anchor::Start, title) });
        canvas.clip(Some(map.area));
        map.ground(&mut canvas);
        let ticks = |cost: u64| cost as f64 / f64::from(UNIT);
        let lost = if self.has_arrived() { "" } else { ", not arrived" };
        let lines = [
            (
                &self.fastest.cells,
                Stroke::new(PALETTE[0], 6.0),
                format!("fastest: {:.0} ticks", ticks(self.fastest.cost)),
            ),
            (
                &self.path,
                Stroke::new(PALETTE[1], 2.0),
                format!("by a model of {} bytes: {:.0} ticks{lost}", self.bytes, ticks(self.cost())),
            ),
        ];
        for (way, stroke, _) in &lines {
            let points: Vec<_> = way.iter().map(centre).collect();
            canvas.line(points.clone(), Stroke::new(WHITE, stroke.width + 2.5));
            canvas.line(points, *stroke);
        }
        for end in [FROM, TO] {
            canvas.circle(centre(&end), 5.0, Some(WHITE), Some(Stroke::new(INK, 2.0)));
        }
        canvas.clip(None);
        map.frame(&mut canvas);
        map.footer(&mut canvas, LEFT, LEFT + WIDTH);
        for ((_, stroke, text), y) in lines.into_iter().zip([56.0, 76.0]) {
            canvas.line(vec![[LEFT + 3.0, y], [LEFT + 28.0, y]], stroke);
            canvas.text(Text::new([LEFT + 38.0, y], 13.0, Anchor::Start, text).centred());
        }
        canvas
    }
}

/// Travel time of a move between adjacent cells: length times impassability of the entered cell.
fn price(land: &Terrain, from: Cell, to: Cell) -> u64 {
    let length = Dir::between(from, to).map_or(0, |dir| dir.length(Norm::Euclidean));
    u64::from(length) * u64::from(land.get(to))
}

const fn index(cell: Cell) -> usize {
    cell.y as usize * SIDE as usize + cell.x as usize
}

fn around(cell: Cell) -> impl Iterator<Item = Cell> {
    let side = 0..SIDE as i16;
    let cells = Dir::MOVES.into_iter().map(move |dir| cell + dir.offset());
    cells.filter(move |cell| side.contains(&cell.x) && side.contains(&cell.y))
}

/// Between the four cells around the point, in ticks; beyond the border as on it.
fn interpolated(times: &[u64], at: [f64; 2]) -> f64 {
    let last = f64::from(SIDE - 1);
    let [(x, on_x), (y, on_y)] = at.map(|along| {
        let along = along.clamp(0.0, last);
        let cell = libm::floor(along).min(last - 1.0);
        (cell as i16, along - cell)
    });
    let time = |dx: i16, dy: i16| times[index(Cell::new(x + dx, y + dy))] as f64 / f64::from(UNIT);
    let (south, north) = (time(0, 0) + (time(1, 0) - time(0, 0)) * on_x, time(0, 1) + (time(1, 1) - time(0, 1)) * on_x);
    south + (north - south) * on_y
}

fn descend(land: &Terrain, model: &Model<'_, f32, 2>) -> Vec<Cell> {
    let mut visits = vec![0_u32; usize::from(SIDE) * usize::from(SIDE)];
    let mut path = vec![FROM];
    let mut here = FROM;
    while here != TO && path.len() <= MOST {
        visits[index(here)] += 1;
        let score = |to: Cell| {
            let crossing = price(land, here, to) as f64 / f64::from(UNIT);
            if to == TO {
                return crossing;
            }
            let left =
                model.blend([f32::from(to.x), f32::from(to.y)]).map_or(f64::INFINITY, |local| local.value.into());
            crossing + left + VISITED * f64::from(visits[index(to)])
        };
        let Some(next) = around(here).min_by(|a, b| score(*a).total_cmp(&score(*b))) else { break };
        here = next;
        path.push(here);
    }
    path
}
