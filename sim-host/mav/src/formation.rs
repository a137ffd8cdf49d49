//! Orders that give a formation a new shape and goal. [`Shape`] builds a [`Graph`], `orders`
//! encodes it, and [`station::give`] sends the frames until every robot has confirmed them.
//!
//! Shapes face east; [`Graph::turned`] turns them. Robots get places in the order of their numbers,
//! the first in front, or with [`Graph::nearest`] nearby places.

mod nearest;
pub mod station;

use crate::framed::Frame;
use anyhow::{Context as _, Error, Result, anyhow, bail, ensure};
use staya_controller::agent::{Grid, GridOrder, Protocol as _, TEMPLATE, TemplatePart};
use staya_controller::grid::{Cell, Dir};
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, rotated};
use staya_controller::wire::{Header, Message};
use staya_mavlink::wire::{MAX_ROBOT, encode};
use staya_sim::scenario::Source;
use staya_sim::shown::Shown as _;
use staya_sim::table;
use std::collections::BTreeSet;
use std::path::Path;

/// System id of the ground station.
pub const STATION: u8 = 255;
/// Radii of a robot's knowledge of its formation, as in scenarios; the largest that fits is used.
const RADII: [u8; 3] = [3, 2, 1];

/// A formation for any number of robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Side by side, robot 1 in the middle.
    Line,
    /// One behind the other.
    Column,
    /// A V with robot 1 at its tip.
    Wedge,
    /// A square of rows, robot 1 in front on the left.
    Grid,
    /// A ring, robot 1 in front.
    Circle,
}

impl Shape {
    /// All shapes with their names.
    pub const NAMES: [(&str, Self); 5] = [
        ("line", Self::Line),
        ("column", Self::Column),
        ("wedge", Self::Wedge),
        ("grid", Self::Grid),
        ("circle", Self::Circle),
    ];

    /// The shape with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(own, _)| *own == name).map(|(_, shape)| shape)
    }

    /// Builds the formation of `count` robots whose neighbours are `spacing` cells apart.
    ///
    /// # Errors
    /// Too few or too many robots, or places off any map or in one cell.
    pub fn graph(self, count: usize, spacing: i16) -> Result<Graph> {
        let robots = i32::try_from(count).unwrap_or(i32::MAX).min(i32::from(MAX_ROBOT) + 1);
        let step = i32::from(spacing);
        let flank = |index: i32| (index + 1) / 2 * if index % 2 == 1 { 1 } else { -1 };
        let columns = (1..=robots).find(|side| side * side >= robots).unwrap_or(1);
        let turn = std::f64::consts::TAU / f64::from(robots.max(1));
        let radius = f64::from(step) / (2.0 * libm::sin(turn / 2.0).max(1e-3));
        let place = |index: i32| match self {
            Self::Line => (0, flank(index) * step),
            Self::Column => (-index * step, 0),
            Self::Wedge => ((index + 1) / 2 * -step, flank(index) * step),
            Self::Grid => (index / columns * -step, index % columns * -step),
            Self::Circle if robots == 1 => (0, 0),
            Self::Circle => {
                let at = turn * f64::from(index);
                let cells = |x: f64| libm::round(radius * x) as i32;
                (cells(libm::cos(at) - 1.0), cells(libm::sin(at)))
            }
        };
        let joins = |a: i32, b: i32| match self {
            Self::Column => b == a + 1,
            Self::Line | Self::Wedge => b == a + 2 || (a == 0 && b == 1),
            Self::Grid => b == a + columns || (b == a + 1 && b % columns != 0),
            Self::Circle => b == a + 1 || (robots > 2 && a == 0 && b == robots - 1),
        };
        let places = (0..robots).map(place).collect::<Vec<_>>();
        let pairs = (0..robots).flat_map(|a| (a + 1..robots).map(move |b| (a, b)));
        let edges = pairs.filter(|&(a, b)| joins(a, b)).map(|(a, b)| (a as u16, b as u16)).collect();
        Graph::new(&places, edges)
    }
}

/// A formation: places in cells, and pairs of places that are neighbours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    places: Vec<Cell>,
    edges: Vec<(u16, u16)>,
}

table! {
    /// A formation's file.
    pub struct GraphFile {
        /// Cell of each robot relative to the first.
        pub places: Vec<[i32; 2]>;
        /// Pairs of robot numbers that are neighbours.
        pub edges: Vec<[u32; 2]>;
    }
}

impl Graph {
    fn new(places: &[(i32, i32)], edges: Vec<(u16, u16)>) -> Result<Self> {
        let count = places.len();
        ensure!(
            (1..=usize::from(MAX_ROBOT)).contains(&count),
            "a formation of {count} robots is not possible; give 1 to {MAX_ROBOT}"
        );
        let narrow = |v: i32| i16::try_from(v).ok().filter(|v| v.unsigned_abs() < 10_000);
        let cell = |(robot, &(x, y)): (usize, &(i32, i32))| match (narrow(x), narrow(y)) {
            (Some(x), Some(y)) => Ok(Cell::new(x, y)),
            _ => bail!("robot {robot} would be off any map: give a smaller spacing"),
        };
        let graph = Self { places: (1..).zip(places).map(cell).collect::<Result<_>>()?, edges };
        graph.check_apart()?;
        if let Some(lost) = graph.unreached() {
            bail!("edges: robot {} is not connected to robot 1; connect every robot to the formation", lost + 1);
        }
        Ok(graph)
    }

    /// Parses `places` and `edges` as in a scenario's `[robots.formation]`. Errors name `path`.
    ///
    /// # Errors
    /// Invalid text, or too many, too far, colliding or unconnected places.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let file = Source::new(path, text)?.read("scenarios/README.md")?;
        Self::of_file(file).with_context(|| path.shown().to_string())
    }

    fn of_file(GraphFile { places, edges: pairs }: GraphFile) -> Result<Self> {
        ensure!(
            places.first() == Some(&[0, 0]),
            "the first place is not [0, 0]: give places in cells relative to robot 1, x forward, y to the left"
        );
        let count = places.len();
        let mut edges = BTreeSet::new();
        for [a, b] in pairs {
            let place = |id: u32| u16::try_from(id.checked_sub(1)?).ok().filter(|&place| usize::from(place) < count);
            match (place(a), place(b)) {
                (Some(a), Some(b)) if a != b => drop(edges.insert((a.min(b), a.max(b)))),
                _ => bail!(
                    "edges: [{a}, {b}] does not connect two robots of the formation; give two different numbers from \
                     1 to {count}"
                ),
            }
        }
        let places: Vec<_> = places.iter().map(|&[x, y]| (x, y)).collect();
        Self::new(&places, edges.into_iter().collect())
    }

    /// The formation turned from east to `heading`; `Stay` leaves it unchanged.
    ///
    /// # Errors
    /// Two places are in one cell after the turn.
    pub fn turned(&self, heading: Dir) -> Result<Self> {
        let places = self.places.iter().map(|&place| rotated(place, heading)).collect();
        let turned = Self { places, edges: self.edges.clone() };
        turned.check_apart().map(|()| turned)
    }

    /// Number of robots.
    #[must_use]
    pub fn robots(&self) -> usize {
        self.places.len()
    }

    fn check_apart(&self) -> Result<()> {
        for (index, place) in self.places.iter().enumerate() {
            if let Some(before) = self.places[..index].iter().position(|other| other == place) {
                let (a, b) = (before + 1, index + 1);
                bail!("places {a} and {b} would share a cell; give a larger spacing, or another heading");
            }
        }
        Ok(())
    }

    fn unreached(&self) -> Option<usize> {
        let mut reached = vec![false; self.places.len()];
        *reached.first_mut()? = true;
        for _ in 1..reached.len() {
            for &(a, b) in &self.edges {
                let (a, b) = (usize::from(a), usize::from(b));
                let either = reached[a] || reached[b];
                (reached[a], reached[b]) = (either, either);
            }
        }
        reached.iter().position(|is_reached| !is_reached)
    }

    fn templates(&self) -> Result<Vec<Template<TEMPLATE>>> {
        let with = |rho| {
            let template =
                |own| Template::from_graph(&self.places, &self.edges, own, rho).map_err(|error| (own, error));
            (0..self.robots()).map(template).collect::<Result<Vec<_>, _>>()
        };
        let mut last = with(RADII[0]);
        for rho in &RADII[1..] {
            last = last.or_else(|_| with(*rho));
        }
        // Places and edges were validated, so the error is a full template.
        last.map_err(|(own, _)| too_many_neighbors(own))
    }
}

fn too_many_neighbors(own: usize) -> Error {
    anyhow!("robot {} has more than {TEMPLATE} neighbours; give it fewer edges", own + 1)
}

/// The goal of a formation, and the identity of the order.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// Goal cell of place [0, 0]; `None` keeps the robots' present goal.
    pub goal: Option<Cell>,
    /// Whether the goal is a broadcast; otherwise it is addressed to each robot of the formation.
    pub to_all: bool,
    /// Boot counter of the ground station.
    pub boot: u8,
    /// Version of the order since the boot.
    pub version: u8,
}

/// Encodes the orders for `robots` (sorted): the parts of each template, then the goal.
///
/// # Errors
/// A robot has too many neighbours.
pub(crate) fn orders(graph: &Graph, robots: &[u8], order: &Order) -> Result<Vec<Frame>> {
    let id = |place: usize| robots.get(place).map_or(RobotId::NONE, |&robot| RobotId(robot.into()));
    let mut messages = Vec::new();
    for (own, mut template) in graph.templates()?.into_iter().enumerate() {
        for entry in &mut template.entries {
            entry.id = id(entry.id.0 as usize - 1);
        }
        let parts = TemplatePart::split(order.version, template.slot, template.offset, &template.entries)
            .map_err(|_| too_many_neighbors(own))?;
        messages.extend(parts.filter_map(|part| {
            Grid::order(id(own), order.version, &GridOrder::Template { part, is_restarted: false })
        }));
    }
    let target = order.goal.zip(graph.places.first()).map(|(goal, &first)| goal + first);
    let to = if order.to_all { vec![RobotId::NONE] } else { (0..robots.len()).map(id).collect() };
    messages.extend(target.iter().flat_map(|&target| {
        to.iter().filter_map(move |&to| Grid::order(to, order.version, &GridOrder::FormationGoal(target)))
    }));
    let frame = |(sequence, message): (u16, &Message)| {
        let header = Header { boot: order.boot, sender: RobotId(STATION.into()), sequence };
        let mut frame = Frame::new();
        encode(header, message, &mut frame).ok().map(|_| frame)
    };
    Ok((0..).zip(&messages).filter_map(frame).collect())
}

#[cfg(test)]
mod tests;
