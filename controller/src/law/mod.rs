//! The interface between the agent and its law, which chooses where the robot goes.

mod progress;
mod protocol;
mod settings;
mod surroundings;
mod wait;

pub use progress::Progress;
pub(crate) use protocol::Queued;
pub use protocol::{OfAnotherLaw, Outgoing, Protocol, Radio};
pub(crate) use settings::settings;
pub use settings::{Around, Contradiction, Goals, MakesLaw, Motion, Settings, SettingsOfLaw};
pub use surroundings::{
    AnySurroundings, CellFrame, CellState, InCell, InCells, InPlane, KinematicState, OnGrid, Surroundings,
};
pub use wait::Wait;

use crate::body::Body;
use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::neighbor::{Ages, Nearby, Neighbor};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use core::ops::Deref;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The payload of a law.
pub type PayloadOf<L, S> = <<L as Law<S>>::Protocol as Protocol>::Payload;
/// The messages of a law.
pub type MessageOf<L, S> = <<L as Law<S>>::Protocol as Protocol>::Message;
/// The orders of a law.
pub type OrderOf<L, S> = <<L as Law<S>>::Protocol as Protocol>::Order;

/// Chooses where the robot goes. Built-in laws and laws of other crates implement the same trait.
///
/// The associated types of a law determine its surroundings and its orders, so that a wrong
/// combination does not compile:
///
/// ```
/// # use staya_controller::{agent::*, grid::Cell, time::Instant};
/// # type Route = RouteGuidance<CELLS, VISITS>;
/// # fn workspace() -> GridWorkspace<CELLS> { GridWorkspace::new() }
/// fn on_grid(agent: &mut RouteAgent, surroundings: OnGrid, now: Instant) {
///     let (state, inbox) = (KinematicState::default(), &[]);
///     agent.order(&GridOrder::Goal(Cell::new(9, 5)));
///     let _ = agent.step(&Inputs { state, surroundings, inbox }, now, &mut workspace());
/// }
/// fn in_plane(agent: &mut OrcaAgent, surroundings: InPlane<f32>, now: Instant) {
///     let (state, inbox) = (KinematicState::default(), &[]);
///     agent.order(&WaypointOrder::first(Waypoint::fixed(Default::default())));
///     let _ = agent.step(&Inputs { state, surroundings, inbox }, now, &mut ());
/// }
/// fn law(law: CellFollower<f32, Route>) -> impl Law<f32> { law }
/// ```
///
/// Surroundings of the grid for a law that moves by velocities, or the reverse:
///
/// ```compile_fail
/// # use staya_controller::{agent::*, time::Instant};
/// fn step(plane: &mut OrcaAgent, cell: OnGrid, now: Instant) {
///     let (state, inbox) = (KinematicState::default(), &[]);
///     let _ = plane.step(&Inputs { state, surroundings: cell, inbox }, now, &mut ());
/// }
/// ```
///
/// ```compile_fail
/// # use staya_controller::{agent::*, time::Instant};
/// fn step(grid: &mut RouteAgent, free: InPlane<f32>, now: Instant) {
///     let inputs = Inputs { state: KinematicState::default(), surroundings: free, inbox: &[] };
///     let _ = grid.step(&inputs, now, &mut GridWorkspace::new());
/// }
/// ```
///
/// A cell as the goal of a law with waypoints, or the reverse:
///
/// ```compile_fail
/// # use staya_controller::{agent::*, grid::Cell};
/// fn send(plane: &mut OrcaAgent) { plane.order(&GridOrder::Goal(Cell::new(9, 5))); }
/// ```
///
/// ```compile_fail
/// # use staya_controller::agent::*;
/// fn send(grid: &mut RouteAgent, to: Waypoint<f32>) { grid.order(&WaypointOrder::first(to)); }
/// ```
///
/// A follower of cells around a law without cells:
///
/// ```compile_fail
/// # use staya_controller::agent::*;
/// fn law(law: CellFollower<f32, WaypointGuidance<f32>>) -> impl Law<f32> { law }
/// ```
pub trait Law<S: Scalar>: Sized {
    /// The input besides the robot's state and the radio:
    /// [`OnGrid`](OnGrid), [`InPlane`](InPlane), [`InCells`](InCells).
    type Surroundings<'a>: Surroundings<S> + TryFrom<AnySurroundings<'a, S>>;

    /// The vocabulary of robots with this law, and of an operator; `()` for none.
    type Protocol: Protocol;

    /// Scratch memory without state between calls; one can serve all robots.
    type Workspace;

    /// Decides on the next action. Called in each step in which the body is free to move. Without
    /// a goal the progress is [`Progress::Idle`].
    ///
    /// # Errors
    /// [`BadInput`] puts the robot into [`Mode::Fault`](crate::robot::Mode::Fault).
    fn decide(
        &mut self,
        view: &View<'_, S, Self::Protocol>,
        here: &Self::Surroundings<'_>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput>;

    /// Returns the payload of a beacon that is due. `heading`: the move under way or intended.
    /// A broadcast sent here follows the beacon.
    fn payload(
        &mut self,
        _here: &Self::Surroundings<'_>,
        _heading: Dir,
        _radio: &mut Radio<'_, Self::Protocol>,
    ) -> PayloadOf<Self, S> {
        Default::default()
    }

    /// Receives the payload of a new beacon, sent at `sent`, from a robot with this protocol: also
    /// from one for which the table of neighbours has no room.
    fn receive_payload(&mut self, _from: RobotId, _payload: &PayloadOf<Self, S>, _sent: Instant) {}

    /// Receives a message of another robot. Returns whether the law takes it: then it is
    /// acknowledged, and its repeats do not come. Sends after all messages of the inbox.
    fn receive(
        &mut self,
        _from: RobotId,
        _message: &MessageOf<Self, S>,
        _radio: &mut Radio<'_, Self::Protocol>,
    ) -> bool {
        false
    }

    /// Receives an order. Returns whether the law takes it; one that it does not take comes again.
    fn order(&mut self, _order: &OrderOf<Self, S>) -> bool {
        false
    }

    /// Returns whether a full neighbour table must keep this robot.
    fn needs(&self, _id: RobotId) -> bool {
        false
    }

    /// Returns what beacons and displays show of it.
    fn report(&self) -> Report {
        Report::default()
    }

    /// Where its last decision puts a robot, itself or another one, at the end of the step; for
    /// displays.
    fn expects(&self, _id: RobotId) -> Option<Cell> {
        None
    }

    /// Calls `visit` with each of its tables of parameters.
    fn parameters(&mut self, _visit: &mut dyn FnMut(&mut dyn Parameters)) {}
}

/// The knowledge of a law at a decision, without its surroundings and the other robots' words.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a, S> {
    /// Own id.
    pub id: RobotId,
    /// Time of the decision.
    pub now: Instant,
    /// Time in which a robot crosses a cell of impassability 1.
    pub tick: Duration,
    /// Own position and velocity; with a lag, those of the point ahead that is steered.
    pub state: KinematicState<S>,
    /// Position in `state` minus that of the body, metres; zero without a lag.
    pub ahead_m: Vec3<S>,
    /// Time constant with which bodies follow their commands, seconds.
    pub lag_s: S,
    /// Own body.
    pub body: Body<S>,
    /// Nearby robots, nearest first; empty for robots that move cell by cell.
    pub nearby: &'a [Nearby<S>],
    /// Age limits of neighbour states.
    pub ages: Ages,
    /// The cell that an operator sends it to instead of its goal.
    pub sent_to: Option<Cell>,
    /// Where cells lie in the world; `None` cell by cell and without cells.
    pub cells: Option<CellFrame>,
}

/// The knowledge of a law at a decision, without its surroundings: the [`Scene`], and the robots
/// with their payloads in protocol `P`.
pub struct View<'a, S, P: Protocol = ()> {
    /// The part that does not depend on the protocol.
    pub scene: Scene<'a, S>,
    /// Known robots in ascending order of ids, none older than [`Ages::expire_after`].
    pub known: &'a dyn Known<S, P::Payload>,
}

impl<'a, S, P: Protocol> Deref for View<'a, S, P> {
    type Target = Scene<'a, S>;

    fn deref(&self) -> &Scene<'a, S> {
        &self.scene
    }
}

impl<S: Copy, P: Protocol> Clone for View<'_, S, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Copy, P: Protocol> Copy for View<'_, S, P> {}

impl<'a, S: Copy, P: Protocol> View<'a, S, P> {
    /// The known robots in the order of ids, each with its payload if its law has this protocol.
    pub fn neighbors(&self) -> impl Iterator<Item = Neighbor<S, P::Payload>> + Clone + use<'a, S, P> {
        let known = self.known;
        (0..known.count()).map_while(|index| known.at(index))
    }

    /// One of them. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId) -> Option<Neighbor<S, P::Payload>> {
        self.known.find(id)
    }

    /// The robots whose law has this protocol, with their payloads.
    pub fn peers(&self) -> impl Iterator<Item = (Neighbor<S, P::Payload>, P::Payload)> + Clone + use<'a, S, P> {
        self.neighbors().filter_map(|neighbor| Some((neighbor, neighbor.payload?)))
    }

    /// The same view for a law with another protocol that gets its robots from `known`.
    pub const fn with<Q: Protocol>(&self, known: &'a dyn Known<S, Q::Payload>) -> View<'a, S, Q> {
        View { scene: self.scene, known }
    }
}

impl<S: Scalar> Scene<'_, S> {
    /// Checks that the body can move by velocities.
    ///
    /// # Errors
    /// [`BadInput`] if [`InPlane::max_speed_mps`](InPlane::max_speed_mps) is 0 or less.
    pub fn can_move(&self) -> Result<(), BadInput> {
        if self.body.max_speed_mps > S::ZERO { Ok(()) } else { Err(BadInput) }
    }
}

/// The known robots with payloads `P`, in ascending order of ids.
pub trait Known<S, P> {
    /// Their number.
    fn count(&self) -> usize;
    /// The robot at a place of the order.
    fn at(&self, index: usize) -> Option<Neighbor<S, P>>;
    /// The robot with this id. O(log N).
    fn find(&self, id: RobotId) -> Option<Neighbor<S, P>>;
}

impl<S: Copy, P: Copy> Known<S, P> for &[Neighbor<S, P>] {
    fn count(&self) -> usize {
        self.len()
    }

    fn at(&self, index: usize) -> Option<Neighbor<S, P>> {
        self.get(index).copied()
    }

    fn find(&self, id: RobotId) -> Option<Neighbor<S, P>> {
        let at = self.binary_search_by_key(&id, |neighbor| neighbor.id).ok()?;
        self.at(at)
    }
}

/// The tools of a law at a decision.
#[derive(Debug)]
pub struct Tools<'t, S: Scalar, L: Law<S>> {
    /// Random numbers of this robot and decision.
    pub rng: &'t mut Rng,
    /// Sends messages.
    pub radio: Radio<'t, L::Protocol>,
    /// Scratch memory.
    pub workspace: &'t mut L::Workspace,
}

/// The part of a law that beacons and displays show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// The cell of its goal; `None` without a goal on the grid.
    pub goal: Option<Cell>,
    /// The cell that it heads for: the goal, or a cell near it if the goal is impassable.
    pub target: Option<Cell>,
    /// The robot that it follows.
    pub leader: RobotId,
    /// Its place in the formation.
    pub slot: u8,
    /// Until when another robot asked it to stop. The agent stops a robot that has no leader, as
    /// [`Progress`] says, unless it makes way.
    pub stopped_until: Option<Instant>,
}

impl Report {
    /// Nothing to show.
    pub(crate) const NONE: Self =
        Self { goal: None, target: None, leader: RobotId::NONE, slot: 0, stopped_until: None };
}

/// The decision of a guidance law.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Decision<S> {
    /// The intended action; the supervisor and the safety layer may change it.
    pub action: Action<S>,
    /// Progress towards the goal.
    pub progress: Progress,
    /// It carries out the action although it has arrived, waits or was asked to stop: it makes way,
    /// or its goal moves.
    pub makes_way: bool,
    /// The motion is agreed with the robots that share the law's protocol: the safety layer leaves
    /// them to the limit of gaps.
    #[serde(skip)]
    pub is_agreed: bool,
}

impl<S> Decision<S> {
    /// An action with the progress.
    pub const fn new(action: Action<S>, progress: Progress) -> Self {
        Self { action, progress, makes_way: false, is_agreed: false }
    }

    /// The decision of a robot without a goal.
    pub const fn idle() -> Self {
        Self::new(Action::Stay, Progress::Idle)
    }
}

/// The action until the next decision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action<S> {
    /// Stand still.
    #[default]
    Stay,
    /// Take the first of these moves, best first, that leads into a free cell.
    Moves(Vec<Dir, 8>),
    /// Move with a velocity.
    Velocity {
        /// The desired velocity without regard to collisions, m/s.
        wish_mps: Vec3<S>,
        /// Offset of the point that it heads straight for, metres; `None` not to swerve for others.
        way_m: Option<Vec3<S>>,
    },
    /// Release control: the motors are off, or another controller steers
    /// ([`Mode::Passive`](crate::robot::Mode::Passive)).
    Release,
}

impl<S> Action<S> {
    /// Returns the moves; empty for other actions.
    #[must_use]
    pub fn moves(&self) -> &[Dir] {
        match self {
            Self::Moves(moves) => moves,
            Self::Stay | Self::Velocity { .. } | Self::Release => &[],
        }
    }
}

/// A required input of the guidance law is missing or contradicts another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BadInput;

impl core::fmt::Display for BadInput {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("an input that the guidance law needs is missing or contradicts another one")
    }
}

impl core::error::Error for BadInput {}

/// The law has another kind of goal, or moves by other means. The previous task continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WrongTask;

impl core::fmt::Display for WrongTask {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the guidance law has no use for the task")
    }
}

impl core::error::Error for WrongTask {}
