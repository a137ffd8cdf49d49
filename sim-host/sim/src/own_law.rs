//! Laws of other crates beside those of Staya. Scenario files name the laws that a program adds
//! ([`add_law`]).

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use staya_controller::agent::{
    AnyMessage, AnyOrder, AnyPayload, AnyProtocol, AnySurroundings, BadInput, CellState, Decision, Goals, GridOrder,
    InAny, InCell, InCells, InPlane, Law, Motion, OnGrid, Radio, Report, Tools, View, Waypoint, WaypointOrder,
    dispatch,
};
use staya_controller::geom::{Position, Vec2};
use staya_controller::grid::{Cell, Dir};
use staya_controller::negotiation::{Moves, NegotiationGuidance, NegotiationInPlane};
use staya_controller::parameters::Parameters;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::time::Instant;
use std::any::type_name;
use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// A law of another crate. Its state is serialized in checkpoints.
pub trait OwnLaw:
    Law<f32, Protocol: InAny, Workspace: Default + Send + Sync>
    + Serialize
    + DeserializeOwned
    + Clone
    + fmt::Debug
    + Send
    + Sync
    + 'static
{
}

impl<L> OwnLaw for L where
    L: Law<f32, Protocol: InAny, Workspace: Default + Send + Sync>
        + Serialize
        + DeserializeOwned
        + Clone
        + fmt::Debug
        + Send
        + Sync
        + 'static
{
}

/// Any law of another crate.
#[derive(Debug)]
pub struct Own(Box<dyn Hosted>);

/// Reads the state of a law from a checkpoint.
type Read = fn(&[u8]) -> Option<Own>;

/// The laws that this process has made, by the names of their types.
static READERS: Mutex<Option<HashMap<&'static str, Read>>> = Mutex::new(None);

/// Makes a law with its default parameters.
type Make = fn() -> Own;

/// The laws that scenario files can name.
static NAMED: Mutex<BTreeMap<&'static str, Make>> = Mutex::new(BTreeMap::new());

/// The name of [`NegotiationGuidance`] and [`NegotiationInPlane`], which every program has.
pub(crate) const NEGOTIATION: &str = "negotiation";

/// Makes a law known to scenario files, as `law = "..."`, with its default parameters. A program
/// calls it before it reads scenarios: then files, sweeps, ranks, checkpoints and views have the
/// law. A law with the same name is replaced.
pub fn add_law<L: OwnLaw + Default>(name: &'static str) {
    NAMED.lock().unwrap_or_else(PoisonError::into_inner).insert(name, || Own::new(L::default()));
}

/// The laws that [`own`] knows, each with a sentence.
pub(crate) fn added() -> Vec<(&'static str, &'static str)> {
    let named = NAMED.lock().unwrap_or_else(PoisonError::into_inner);
    let of_the_program =
        named.keys().map(|name| (*name, "a law of this program")).filter(|(name, _)| *name != NEGOTIATION);
    let what = "each robot over land in cells, planned with the robots around it";
    [(NEGOTIATION, what)].into_iter().chain(of_the_program).collect()
}

/// A law that firmware does not have, for bodies with these moves, or in the plane with this
/// cruising speed; `None`: no law has this name.
pub(crate) fn own(name: &str, moves: Moves, cruise_mps: Option<f32>) -> Option<Own> {
    let named = NAMED.lock().unwrap_or_else(PoisonError::into_inner);
    match named.get(name) {
        Some(make) => Some(make()),
        None if name == NEGOTIATION => Some(match cruise_mps {
            Some(speed) => Own::new(NegotiationInPlane::<f32, 64>::new(speed)),
            None => Own::new(NegotiationGuidance::<64>::new(moves)),
        }),
        None => None,
    }
}

/// Where robots move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Site {
    /// From cell to cell.
    Cells,
    /// In the plane or in space.
    Plane,
    /// In the plane, over cells.
    PlaneOverCells,
}

impl Site {
    /// Surroundings of this kind.
    pub(crate) fn surroundings(self) -> AnySurroundings<'static, f32> {
        let grid = OnGrid { cell: CellState::default(), window: None };
        let plane = InPlane { max_speed_mps: 0.0, obstacles: &[] };
        let in_cell = InCell { offset_m: Vec2::ZERO, cell_m: 1.0 };
        match self {
            Self::Cells => AnySurroundings::OnGrid(grid),
            Self::Plane => AnySurroundings::InPlane(plane),
            Self::PlaneOverCells => AnySurroundings::InCells(InCells { grid, plane, in_cell }),
        }
    }
}

impl Own {
    /// Wraps a law.
    pub fn new<L: OwnLaw>(law: L) -> Self {
        let mut readers = READERS.lock().unwrap_or_else(PoisonError::into_inner);
        readers.get_or_insert_default().entry(type_name::<L>()).or_insert(read::<L>);
        Self(Box::new(Held { law, workspace: L::Workspace::default() }))
    }

    /// Whether the law can decide there.
    pub(crate) fn fits(&self, site: Site) -> bool {
        self.0.fits(&site.surroundings())
    }

    /// The bodies that it moves.
    pub(crate) fn motion(&self) -> Motion {
        if self.fits(Site::Plane) { Motion::Velocities } else { Motion::Cells }
    }

    /// The goals that it takes, as its answers to orders show.
    pub(crate) fn goals(&self) -> Goals {
        let first = WaypointOrder::first(Waypoint::fixed(Position::ORIGIN));
        let takes = |order: &AnyOrder| self.clone().0.order(order);
        if takes(&AnyOrder::Grid(GridOrder::Goal(Cell::new(1, 1)))) {
            Goals::Cell
        } else if takes(&AnyOrder::Waypoint(first)) {
            Goals::Waypoints
        } else {
            Goals::None
        }
    }

    /// Calls `visit` with each of its tables.
    pub(crate) fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.0.parameters(visit);
    }

    /// Whether it takes a second waypoint, behind the first.
    pub(crate) fn takes_ways(&self) -> bool {
        let mut law = self.clone();
        let first = WaypointOrder::first(Waypoint::fixed(Position::ORIGIN));
        let mut takes = |index| law.0.order(&AnyOrder::Waypoint(WaypointOrder { index, ..first }));
        takes(0) && takes(1)
    }

    /// A given row of a table whose values do not go together.
    pub(crate) fn contradiction(&mut self, is_given: &dyn Fn(&str) -> bool) -> Option<&'static str> {
        let mut wrong = None;
        self.tables(&mut |table| {
            if !table.is_sound() {
                let rows = || table.table().iter().map(|row| row.name);
                wrong = wrong.or_else(|| rows().find(|row| is_given(row)).or_else(|| rows().next()));
            }
        });
        wrong
    }
}

fn read<L: OwnLaw>(bytes: &[u8]) -> Option<Own> {
    postcard::from_bytes::<L>(bytes).ok().map(Own::new)
}

impl Clone for Own {
    fn clone(&self) -> Self {
        self.0.copy()
    }
}

/// The name of the type, and its state.
impl Serialize for Own {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.0.name(), self.0.state()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Own {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (name, state) = <(String, Vec<u8>)>::deserialize(deserializer)?;
        let readers = READERS.lock().unwrap_or_else(PoisonError::into_inner);
        let read = readers.as_ref().and_then(|readers| readers.get(name.as_str()).copied());
        drop(readers);
        read.and_then(|read| read(&state)).ok_or_else(|| serde::de::Error::custom("a law of another program"))
    }
}

struct Held<L: OwnLaw> {
    law: L,
    workspace: L::Workspace,
}

impl<L: OwnLaw> fmt::Debug for Held<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.law.fmt(f)
    }
}

trait Hosted: fmt::Debug + Send + Sync {
    fn copy(&self) -> Own;
    fn name(&self) -> &'static str;
    fn state(&self) -> Vec<u8>;
    fn fits(&self, here: &AnySurroundings<'_, f32>) -> bool;
    fn decide(
        &mut self,
        view: &View<'_, f32, AnyProtocol>,
        here: &AnySurroundings<'_, f32>,
        rng: &mut Rng,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> Result<Decision<f32>, BadInput>;
    fn payload(
        &mut self,
        here: &AnySurroundings<'_, f32>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload;
    fn receive_payload(&mut self, from: RobotId, payload: &AnyPayload, sent: Instant);
    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool;
    fn order(&mut self, order: &AnyOrder) -> bool;
    fn needs(&self, id: RobotId) -> bool;
    fn report(&self) -> Report;
    fn expects(&self, id: RobotId) -> Option<Cell>;
    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters));
}

impl<L: OwnLaw> Hosted for Held<L> {
    fn copy(&self) -> Own {
        Own::new(self.law.clone())
    }

    fn name(&self) -> &'static str {
        type_name::<L>()
    }

    fn state(&self) -> Vec<u8> {
        // Cannot fail: states have a length.
        postcard::to_allocvec(&self.law).unwrap_or_default()
    }

    fn fits(&self, here: &AnySurroundings<'_, f32>) -> bool {
        L::Surroundings::try_from(*here).is_ok()
    }

    fn decide(
        &mut self,
        view: &View<'_, f32, AnyProtocol>,
        here: &AnySurroundings<'_, f32>,
        rng: &mut Rng,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> Result<Decision<f32>, BadInput> {
        dispatch::decide(&mut self.law, view, here, (rng, radio), &mut self.workspace)
    }

    fn payload(
        &mut self,
        here: &AnySurroundings<'_, f32>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload {
        dispatch::payload(&mut self.law, here, heading, radio)
    }

    fn receive_payload(&mut self, from: RobotId, payload: &AnyPayload, sent: Instant) {
        dispatch::receive_payload(&mut self.law, from, payload, sent);
    }

    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool {
        dispatch::receive(&mut self.law, from, message, radio)
    }

    fn order(&mut self, order: &AnyOrder) -> bool {
        dispatch::order(&mut self.law, order)
    }

    fn needs(&self, id: RobotId) -> bool {
        self.law.needs(id)
    }

    fn report(&self) -> Report {
        self.law.report()
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        self.law.expects(id)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.law.parameters(visit);
    }
}

impl Law<f32> for Own {
    type Surroundings<'a> = AnySurroundings<'a, f32>;
    type Protocol = AnyProtocol;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, AnyProtocol>,
        here: &AnySurroundings<'_, f32>,
        tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let Tools { rng, mut radio, .. } = tools;
        self.0.decide(view, here, rng, &mut radio)
    }

    fn payload(
        &mut self,
        here: &AnySurroundings<'_, f32>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload {
        self.0.payload(here, heading, radio)
    }

    fn receive_payload(&mut self, from: RobotId, payload: &AnyPayload, sent: Instant) {
        self.0.receive_payload(from, payload, sent);
    }

    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool {
        self.0.receive(from, message, radio)
    }

    fn order(&mut self, order: &AnyOrder) -> bool {
        self.0.order(order)
    }

    fn needs(&self, id: RobotId) -> bool {
        self.0.needs(id)
    }

    fn report(&self) -> Report {
        self.0.report()
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        self.0.expects(id)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.0.parameters(visit);
    }
}

#[cfg(test)]
mod tests;
