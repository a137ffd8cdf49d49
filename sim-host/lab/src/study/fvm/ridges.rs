//! Routes by the ridges of a function (figure 1b), which a functional voxel model shows.
//!
//! The function is the distance to the nearest of round obstacles and the walls of a square room,
//! by an R-function; the model's local planes are all that is used of it. A ridge lies between two
//! neighbouring voxels if their gradients differ and their planes fall away from each other: away
//! from ridges this function is level or hollow. A route rises from its start to a ridge, follows
//! ridges, and falls to its goal. Among routes the one with the largest least distance is taken.

use super::{Parameters, Values};
use staya_controller::rand::Rng;
use staya_fvm::{Function, Grid, System, build, shape};
use staya_plot::canvas::{Anchor, Canvas, Stroke, Text};
use staya_plot::colour::{INK, MUTED, PALETTE, WHITE};
use staya_voxel::Model;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, VecDeque};

pub const MEASURES: &[(&str, &str)] = &[
    ("route", "1: ridges lead from the start to the goal"),
    ("separated", "share of the obstacles, the walls being one, that ridges separate from all others"),
    ("width", "least distance to obstacles on the best route by ridges, over that of the best of all ways"),
    ("clearance_m", "that least distance, metres"),
    ("ridge_share", "share of the free nodes that are on ridges"),
];

const ROOM: u32 = 0x0046_0303;
const SIDE_M: f64 = 10.0;
/// Start and goal, in opposite corners.
const ENDS_M: [[f64; 2]; 2] = [[0.7, 0.7], [SIDE_M - 0.7, SIDE_M - 0.7]];
const RADII_M: [f64; 2] = [0.3, 0.9];
/// Least gap between obstacles, and to walls, start and goal: two steps of the coarsest model.
const GAP_M: f64 = 0.6;
/// Least difference of the gradients on both sides of a ridge.
const TURN: f64 = 0.15;

type Disc = ([f64; 2], f64);

/// A room with its model's nodes, and the best route.
pub struct Room {
    discs: Vec<Disc>,
    nodes: usize,
    value: Vec<f64>,
    is_ridge: Vec<bool>,
    route: Option<Vec<usize>>,
    /// Least distances of the best route and of the best of all ways, metres.
    width_m: [Option<f64>; 2],
}

/// Discs with gaps, at random places.
fn discs(count: u32, seed: u64) -> Result<Vec<Disc>, String> {
    let mut discs: Vec<Disc> = Vec::new();
    let apart = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2]| libm::hypot(ax - bx, ay - by);
    for number in 0..1_000_000 {
        if discs.len() as u32 == count {
            return Ok(discs);
        }
        let mut rng = Rng::keyed(seed, ROOM, number, 0);
        let mut between = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let radius = between(RADII_M[0], RADII_M[1]);
        let edge = radius + GAP_M;
        let center = [between(edge, SIDE_M - edge), between(edge, SIDE_M - edge)];
        let is_free = ENDS_M.iter().all(|&end| apart(center, end) >= edge)
            && discs.iter().all(|&(other, its)| apart(center, other) >= edge + its);
        if is_free {
            discs.push((center, radius));
        }
    }
    Err(format!("{count} obstacles have no place; give fewer"))
}

/// Distance to the nearest obstacle or wall, positive where there is none.
fn free(discs: &[Disc]) -> Function<2> {
    let walls = Function::new(|[x, y]: [f64; 2]| x.min(y).min(SIDE_M - x).min(SIDE_M - y));
    discs.iter().fold(walls, |all, &(center, radius)| all.and(!shape::circle(center, radius), System::R1))
}

impl Room {
    pub fn new(parameters: &Parameters, seed: u64) -> Result<Self, String> {
        let discs = discs(parameters.obstacles, seed)?;
        let grid = Grid { extent: [[0.0, SIDE_M]; 2], nodes: [parameters.nodes; 2] };
        let bytes = build(&free(&discs), &grid, parameters.depth).map_err(|error| error.to_string())?;
        let model = Model::<f64, 2>::from_bytes(&bytes).map_err(|error| error.to_string())?;
        let nodes = usize::from(parameters.nodes);
        let (mut value, mut gradient) = (Vec::new(), Vec::new());
        for node in 0..nodes * nodes {
            let local = model.nearest(place(nodes, node)).ok_or("the model is not defined in the room")?;
            value.push(local.value);
            gradient.push(local.gradient);
        }
        let is_ridge = ridges(nodes, &value, &gradient);
        let mut room = Self { discs, nodes, value, is_ridge, route: None, width_m: [None; 2] };
        let ends = ENDS_M.map(|end| room.nearest_node(end));
        let mut may = room.is_ridge.clone();
        for end in ends {
            room.rise(end, &mut may);
        }
        let route = room.widest(ends, &|node| may[node]);
        let least = |route: &Vec<usize>| route.iter().map(|&node| room.value[node]).fold(f64::INFINITY, f64::min);
        let all = room.widest(ends, &|node| room.value[node] > 0.0);
        room.width_m = [route.as_ref().map(least), all.as_ref().map(least)];
        room.route = route;
        Ok(room)
    }

    fn nearest_node(&self, at: [f64; 2]) -> usize {
        let [x, y] = at.map(|along| libm::round(along / SIDE_M * (self.nodes - 1) as f64) as usize);
        y * self.nodes + x
    }

    /// Marks the nodes on the way uphill to a ridge.
    fn rise(&self, mut node: usize, may: &mut [bool]) {
        while !may[node] {
            may[node] = true;
            let next = around(self.nodes, node).max_by(|a, b| self.value[*a].total_cmp(&self.value[*b]));
            match next.filter(|&next| self.value[next] > self.value[node]) {
                Some(next) => node = next,
                None => return,
            }
        }
    }

    /// The way over permitted nodes whose least value is the largest.
    fn widest(&self, [from, to]: [usize; 2], may: &dyn Fn(usize) -> bool) -> Option<Vec<usize>> {
        let mut before = vec![None; self.value.len()];
        let mut is_done = vec![false; self.value.len()];
        let mut open = BinaryHeap::from([Open { width: self.value[from], node: from, before: from }]);
        while let Some(Open { width, node, before: last }) = open.pop() {
            if std::mem::replace(&mut is_done[node], true) {
                continue;
            }
            before[node] = Some(last);
            if node == to {
                let mut way = vec![to];
                while let Some(last) = before[way[way.len() - 1]].filter(|&last| last != way[way.len() - 1]) {
                    way.push(last);
                }
                way.reverse();
                return Some(way);
            }
            for next in around(self.nodes, node).filter(|&next| may(next) && !is_done[next]) {
                open.push(Open { width: width.min(self.value[next]), node: next, before: node });
            }
        }
        None
    }

    /// The obstacle that a node is in: a disc, or after them the walls.
    fn obstacle(&self, node: usize) -> Option<usize> {
        if self.value[node] > 0.0 {
            return None;
        }
        let [x, y] = place(self.nodes, node);
        let inside = |(center, radius): &Disc| radius - libm::hypot(x - center[0], y - center[1]);
        let nearest = self.discs.iter().map(inside).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let walls = x.min(y).min(SIDE_M - x).min(SIDE_M - y);
        Some(nearest.filter(|(_, depth)| *depth > -walls).map_or(self.discs.len(), |(index, _)| index))
    }

    /// Share of the obstacles from which no way over the sides of voxels leads to another one
    /// without a ridge.
    fn separated(&self) -> f64 {
        let of: Vec<_> = (0..self.value.len()).map(|node| self.obstacle(node)).collect();
        let is_alone = |own: usize| {
            let mut seen = vec![false; of.len()];
            let mut open: VecDeque<usize> = (0..of.len()).filter(|&node| of[node] == Some(own)).collect();
            while let Some(node) = open.pop_front() {
                for next in beside(self.nodes, node) {
                    if of[next].is_some_and(|other| other != own) {
                        return false;
                    }
                    if !self.is_ridge[next] && !std::mem::replace(&mut seen[next], true) {
                        open.push_back(next);
                    }
                }
            }
            true
        };
        let all = self.discs.len() + 1;
        (0..all).filter(|&own| is_alone(own)).count() as f64 / all as f64
    }

    pub fn measure(&self) -> Values {
        let [route, all] = self.width_m;
        let free = self.value.iter().filter(|value| **value > 0.0).count();
        let ridge = self.is_ridge.iter().filter(|is_ridge| **is_ridge).count();
        vec![
            ("route", Some(f64::from(u8::from(self.route.is_some())))),
            ("separated", Some(self.separated())),
            ("width", route.zip(all).map(|(route, all)| route / all)),
            ("clearance_m", route),
            ("ridge_share", Some(ridge as f64 / free.max(1) as f64)),
        ]
    }

    /// Draws the obstacles, the ridges and the best route.
    pub fn draw(&self, title: &str) -> Canvas {
        const WIDTH: f64 = 640.0;
        const LEFT: f64 = 20.0;
        const TOP: f64 = 80.0;
        let scale = WIDTH / SIDE_M;
        let at = |[x, y]: [f64; 2]| [LEFT + x * scale, TOP + WIDTH - y * scale];
        let mut canvas = Canvas::new(WIDTH + 2.0 * LEFT, TOP + WIDTH + LEFT, title);
        canvas.text(Text { bold: true, ..Text::new([LEFT, 30.0], 13.0, Anchor::Start, title) });
        let found = match self.width_m[0] {
            Some(width) => format!("ridges; the route with the largest least distance: {width:.2} m"),
            None => "ridges; they lead to no route".to_owned(),
        };
        canvas.text(Text::new([LEFT, 56.0], 13.0, Anchor::Start, found).muted());
        for &(center, radius) in &self.discs {
            canvas.circle(at(center), radius * scale, Some(WHITE.towards(INK, 0.25)), None);
        }
        let dot = 0.3 * scale * SIDE_M / (self.nodes - 1) as f64;
        for node in (0..self.value.len()).filter(|&node| self.is_ridge[node]) {
            canvas.circle(at(place(self.nodes, node)), dot, Some(PALETTE[0]), None);
        }
        if let Some(route) = &self.route {
            let points = route.iter().map(|&node| at(place(self.nodes, node))).collect();
            canvas.line(points, Stroke::new(PALETTE[1], 3.0));
        }
        for end in ENDS_M {
            canvas.circle(at(end), 5.0, Some(WHITE), Some(Stroke::new(INK, 2.0)));
        }
        canvas.rectangle([LEFT, TOP, WIDTH, WIDTH], None, Some(Stroke::new(MUTED, 1.0)));
        canvas
    }
}

struct Open {
    width: f64,
    node: usize,
    before: usize,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of equally wide nodes the first in the room comes first.
        self.width.total_cmp(&other.width).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

fn place(nodes: usize, node: usize) -> [f64; 2] {
    [node % nodes, node / nodes].map(|index| index as f64 * SIDE_M / (nodes - 1) as f64)
}

/// The nodes at a node's sides.
fn beside(nodes: usize, node: usize) -> impl Iterator<Item = usize> {
    around(nodes, node).filter(move |&other| other % nodes == node % nodes || other / nodes == node / nodes)
}

/// The eight nodes around a node, fewer at the walls.
fn around(nodes: usize, node: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (node % nodes, node / nodes);
    let near = move |at: usize| at.saturating_sub(1)..=(at + 1).min(nodes - 1);
    near(y).flat_map(move |y| near(x).map(move |x| y * nodes + x)).filter(move |&other| other != node)
}

fn ridges(nodes: usize, value: &[f64], gradient: &[[f64; 2]]) -> Vec<bool> {
    let mut is_ridge = vec![false; value.len()];
    for node in 0..value.len() {
        for (axis, next) in [(0, node + 1), (1, node + nodes)] {
            let is_last = if axis == 0 { node % nodes + 1 == nodes } else { next >= value.len() };
            if is_last || value[node] <= 0.0 || value[next] <= 0.0 {
                continue;
            }
            let [ax, ay] = gradient[node];
            let [bx, by] = gradient[next];
            let falls_away = gradient[node][axis] > gradient[next][axis];
            if falls_away && libm::hypot(ax - bx, ay - by) > TURN {
                is_ridge[if value[next] > value[node] { next } else { node }] = true;
            }
        }
    }
    is_ridge
}
