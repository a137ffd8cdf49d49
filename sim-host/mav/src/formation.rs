//! Another shape and another goal for a formation that is under way: what each robot has to be told. [`Shape`] gives a [`Graph`],
//! [`orders`] the frames, [`station::give`] sends them and waits until every robot has said that it has its own.
//!
//! Shapes look east, as the scenarios' do; [`Graph::turned`] turns them. Robots have places by rising numbers, the first one in
//! front, unless [`Graph::nearest`] gives each one that is near.

mod nearest;
pub mod station;

use serde::Deserialize;
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::{Cell, Dir};
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateError, rotated};
use staya_controller::wire::{GoalAssignment, Header, Message, TemplateAssignment};
use staya_mavlink::frame::MAX_FRAME_LEN;
use staya_mavlink::wire::{MAX_ROBOT, encode};
use std::collections::BTreeSet;

/// The ground station's number.
pub const STATION: u8 = 255;
/// Usual radii of what a robot knows of its formation: the largest one that fits is taken, as in scenarios.
const RADII: [u8; 3] = [3, 2, 1];

/// A formation for any number of robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Side by side, robot 1 in the middle.
    Line,
    /// One behind the other.
    Column,
    /// A V whose point is robot 1.
    Wedge,
    /// Rows of as many as there are rows, or one more; robot 1 in front on the left.
    Grid,
    /// A ring, robot 1 in front.
    Circle,
}

impl Shape {
    /// All of them, each with its name.
    pub const NAMES: [(&str, Self); 5] = [
        ("line", Self::Line),
        ("column", Self::Column),
        ("wedge", Self::Wedge),
        ("grid", Self::Grid),
        ("circle", Self::Circle),
    ];

    /// The shape of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(own, _)| *own == name).map(|(_, shape)| shape)
    }

    /// The places of `count` robots whose neighbours stand `spacing` cells apart, and who is whose neighbour.
    ///
    /// # Errors
    /// Too few or too many robots, or a spacing that takes them off any map or into one cell: see [`GraphError`].
    pub fn graph(self, count: usize, spacing: i16) -> Result<Graph, GraphError> {
        let robots = i32::try_from(count).unwrap_or(i32::MAX).min(i32::from(MAX_ROBOT) + 1);
        let step = i32::from(spacing);
        // The second to the left, the third to the right, and so on outwards.
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

/// A formation: places in cells, and pairs of them that are neighbours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    places: Vec<Cell>,
    edges: Vec<(u16, u16)>,
}

/// Why there is no formation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GraphError {
    /// Numbers of robots are 1 to 254.
    #[error("a formation of {0} robots: MAVLink tells 1 to {MAX_ROBOT} apart")]
    Count(usize),
    /// A place beyond all cells.
    #[error("robot {0} would be off any map: give a smaller spacing")]
    Far(usize),
    /// Robot 1 is what places are measured from.
    #[error(
        "the first place is not [0, 0]: places are cells from robot 1's, x in the direction of travel, y to the left of it"
    )]
    First,
    /// Two robots in one cell.
    #[error("places {0} and {1} would share a cell: give a larger spacing, or another heading")]
    Shared(usize, usize),
    /// A pair of numbers that joins nobody.
    #[error("edges: [{0}, {1}] joins no two robots of the formation: give two different numbers from 1 to {2}")]
    Edge(u32, u32, usize),
    /// Somebody who is joined to nobody.
    #[error("edges: none leads from robot 1 to robot {0}: join every robot to the formation")]
    Lost(usize),
    /// More neighbours than a robot has room for.
    #[error("robot {0} has more than {TEMPLATE} neighbours, for which a robot has room: give it fewer edges")]
    Neighbors(usize),
    /// A file that is none.
    #[error("{0}; a formation's file has `places = [[0, 0], [-3, 3]]` and `edges = [[1, 2]]`")]
    File(String),
}

/// As in a scenario's `[robots.formation]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GraphFile {
    places: Vec<[i32; 2]>,
    edges: Vec<[u32; 2]>,
}

impl Graph {
    /// Places relative to the first one, and pairs of indices into them. O(places * edges).
    ///
    /// # Errors
    /// Too few or too many robots, places that are too far, or taken twice.
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

    /// Reads a file's text: `places` and `edges` as in a scenario's `[robots.formation]`.
    ///
    /// # Errors
    /// It is no such file, or its robots are too many, too far, on one place, or not joined: see [`GraphError`].
    pub fn parse(text: &str) -> Result<Self, GraphError> {
        let file: GraphFile = toml::from_str(text).map_err(|error| GraphError::File(error.to_string()))?;
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

    /// The same formation looking elsewhere than east; `Stay`: east.
    ///
    /// # Errors
    /// Places that would share a cell after the turn.
    pub fn turned(&self, heading: Dir) -> Result<Self, GraphError> {
        let places: Vec<_> = self.places.iter().map(|&place| rotated(place, heading)).collect();
        self.check_apart(&places)?;
        Ok(Self { places, edges: self.edges.clone() })
    }

    /// How many robots it is for.
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

    /// The first place that no edges join to the first one.
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

/// What is to be told, and as whose order.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// The cell for the place in front, [0, 0]; `None`: robots go where they were going anyway.
    pub goal: Option<Cell>,
    /// Whether the goal is said to everybody at once, or to each robot of the formation by itself: others are there.
    pub to_all: bool,
    /// Tells this start of the ground station from others.
    pub boot: u8,
    /// Counts orders of this start.
    pub version: u8,
}

/// The frames that make `robots`, by rising numbers, this formation: parts of a template for each, then the goal. O(robots * edges).
///
/// # Errors
/// Another number of robots than of places, or robots that have more neighbours than they have room for.
pub fn orders(graph: &Graph, robots: &[u8], order: &Order) -> Result<Vec<Vec<u8>>, GraphError> {
    if robots.len() != graph.robots() {
        return Err(GraphError::Count(robots.len()));
    }
    let id = |place: usize| robots.get(place).map_or(RobotId::NOBODY, |&robot| RobotId(robot.into()));
    let mut messages = Vec::new();
    for (own, mut template) in graph.templates()?.into_iter().enumerate() {
        for entry in &mut template.entries {
            // A graph numbers its places from 1.
            entry.id = id(entry.id.0 as usize - 1);
        }
        let parts =
            TemplateAssignment::split(id(own), order.version, template.slot, template.offset, &template.entries)
                .map_err(|_| GraphError::Neighbors(own + 1))?;
        messages.extend(parts.map(Message::Template));
    }
    // Robots go to their places beside the first robot's, which need not be the one in front.
    let target = order.goal.zip(graph.places.first()).map(|(goal, &first)| goal + first);
    let to = if order.to_all { vec![RobotId::NOBODY] } else { (0..robots.len()).map(id).collect() };
    messages.extend(target.iter().flat_map(|&target| {
        to.iter().map(move |&to| Message::Goal(GoalAssignment { to, version: order.version, target }))
    }));
    let frame = |(sequence, message): (u16, &Message)| {
        let header = Header { boot: order.boot, sender: RobotId(STATION.into()), sequence };
        let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
        // Every message fits into the longest frame, and every number is one of MAVLink's.
        encode(header, message, &mut frame).ok().map(|_| frame.to_vec())
    };
    Ok((0..).zip(&messages).filter_map(frame).collect())
}

#[cfg(test)]
mod tests;
