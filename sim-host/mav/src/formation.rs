//! Orders that give a formation a new shape and goal. [`Shape`] builds a [`Graph`], `orders`
//! encodes it, and [`station::give`] sends the frames until every robot has confirmed them.
//!
//! Shapes face east; [`Graph::turned`] turns them. Robots get places in the order of their numbers,
//! the first in front, or with [`Graph::nearest`] nearby places.

mod nearest;
pub mod station;

use crate::framed::Frame;
use staya_controller::agent::{Grid, GridOrder, Protocol as _, TEMPLATE, TemplatePart};
use staya_controller::grid::{Cell, Dir};
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateError, rotated};
use staya_controller::wire::{Header, Message};
use staya_mavlink::wire::{MAX_ROBOT, encode};
use staya_sim::scenario::Source;
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
    /// [`GraphError`]: too few or too many robots, or places off any map or in one cell.
    pub fn graph(self, count: usize, spacing: i16) -> Result<Graph, GraphError> {
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

/// Why a formation is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GraphError {
    /// The number of robots is not 1 to 254.
    #[error("a formation of {0} robots is not possible; give 1 to {MAX_ROBOT}")]
    Count(usize),
    /// A place is outside the range of cells.
    #[error("robot {0} would be off any map: give a smaller spacing")]
    Far(usize),
    /// The first place is not the origin of places.
    #[error("the first place is not [0, 0]: give places in cells relative to robot 1, x forward, y to the left")]
    First,
    /// Two places are in one cell.
    #[error("places {0} and {1} would share a cell; give a larger spacing, or another heading")]
    Shared(usize, usize),
    /// An edge does not connect two robots.
    #[error("edges: [{0}, {1}] does not connect two robots of the formation; give two different numbers from 1 to {2}")]
    Edge(u32, u32, usize),
    /// A robot without a path of edges to robot 1.
    #[error("edges: robot {0} is not connected to robot 1; connect every robot to the formation")]
    Lost(usize),
    /// A robot has too many neighbours.
    #[error("robot {0} has more than {TEMPLATE} neighbours; give it fewer edges")]
    Neighbors(usize),
    /// The file is invalid.
    #[error("{0}")]
    File(String),
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
    fn new(places: &[(i32, i32)], edges: Vec<(u16, u16)>) -> Result<Self, GraphError> {
        if places.is_empty() || places.len() > usize::from(MAX_ROBOT) {
            return Err(GraphError::Count(places.len()));
        }
        let narrow = |v: i32| i16::try_from(v).ok().filter(|v| v.unsigned_abs() < 10_000);
        let cell = |(index, &(x, y)): (usize, &(i32, i32))| match (narrow(x), narrow(y)) {
            (Some(x), Some(y)) => Ok(Cell::new(x, y)),
            _ => Err(GraphError::Far(index + 1)),
        };
        let places = places.iter().enumerate().map(cell).collect::<Result<Vec<_>, _>>()?;
        let graph = Self { places, edges };
        graph.check_apart(&graph.places)?;
        match graph.unreached() {
            Some(lost) => Err(GraphError::Lost(lost + 1)),
            None => Ok(graph),
        }
    }

    /// Parses `places` and `edges` as in a scenario's `[robots.formation]`. Errors name `path`.
    ///
    /// # Errors
    /// [`GraphError`]: invalid text, or too many, too far, colliding or unconnected places.
    pub fn parse(text: &str, path: &Path) -> Result<Self, GraphError> {
        let file = Source::new(path, text).and_then(|source| source.read("scenarios/README.md"));
        let file: GraphFile = file.map_err(|error| GraphError::File(error.to_string()))?;
        if file.places.first() != Some(&[0, 0]) {
            return Err(GraphError::First);
        }
        let count = file.places.len();
        let mut edges = BTreeSet::new();
        for [a, b] in file.edges {
            let place = |id: u32| u16::try_from(id.checked_sub(1)?).ok().filter(|&place| usize::from(place) < count);
            match (place(a), place(b)) {
                (Some(a), Some(b)) if a != b => drop(edges.insert((a.min(b), a.max(b)))),
                _ => return Err(GraphError::Edge(a, b, count)),
            }
        }
        let places: Vec<_> = file.places.iter().map(|&[x, y]| (x, y)).collect();
        Self::new(&places, edges.into_iter().collect())
    }

    /// The formation turned from east to `heading`; `Stay` leaves it unchanged.
    ///
    /// # Errors
    /// [`GraphError::Shared`] if two places are in one cell after the turn.
    pub fn turned(&self, heading: Dir) -> Result<Self, GraphError> {
        let places: Vec<_> = self.places.iter().map(|&place| rotated(place, heading)).collect();
        self.check_apart(&places)?;
        Ok(Self { places, edges: self.edges.clone() })
    }

    /// Number of robots.
    #[must_use]
    pub fn robots(&self) -> usize {
        self.places.len()
    }

    fn check_apart(&self, places: &[Cell]) -> Result<(), GraphError> {
        for (index, place) in places.iter().enumerate() {
            if let Some(before) = places.iter().take(index).position(|other| other == place) {
                return Err(GraphError::Shared(before + 1, index + 1));
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

    fn templates(&self) -> Result<Vec<Template<TEMPLATE>>, GraphError> {
        let with = |rho| {
            let template =
                |own| Template::from_graph(&self.places, &self.edges, own, rho).map_err(|error| (own, error));
            (0..self.robots()).map(template).collect::<Result<Vec<_>, _>>()
        };
        let mut last = with(RADII[0]);
        for rho in &RADII[1..] {
            last = last.or_else(|_| with(*rho));
        }
        last.map_err(|(own, error)| match error {
            TemplateError::TooMany => GraphError::Neighbors(own + 1),
            TemplateError::NoSuchPlace | TemplateError::BadEdge => GraphError::Count(self.robots()),
        })
    }
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
/// [`GraphError`] if the robots and places differ in number, or a robot has too many neighbours.
pub(crate) fn orders(graph: &Graph, robots: &[u8], order: &Order) -> Result<Vec<Frame>, GraphError> {
    if robots.len() != graph.robots() {
        return Err(GraphError::Count(robots.len()));
    }
    let id = |place: usize| robots.get(place).map_or(RobotId::NONE, |&robot| RobotId(robot.into()));
    let mut messages = Vec::new();
    for (own, mut template) in graph.templates()?.into_iter().enumerate() {
        for entry in &mut template.entries {
            entry.id = id(entry.id.0 as usize - 1);
        }
        let parts = TemplatePart::split(order.version, template.slot, template.offset, &template.entries)
            .map_err(|_| GraphError::Neighbors(own + 1))?;
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
