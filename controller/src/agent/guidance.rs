//! What the agent asks of a guidance law.

use super::{KinematicState, Parameter, Surroundings, Wait, Waypoint};
use crate::body::Body;
use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::land::{FarLand, LandPatch};
use crate::neighbor::{Ages, Nearby, Neighbor, Tracker};
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Payload, RequestKind, TemplateAssignment};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Chooses where to go. An agent has one; each composes behaviours of the layer below.
///
/// Its type decides what its robot is told, where it can be sent and what it can be wrapped in, so that a robot that is wired wrong does not compile:
///
/// ```
/// # use staya_controller::{agent::*, grid::Cell, time::Instant};
/// # type Route = RouteGuidance<CELLS, VISITS>;
/// fn sound(grid: &mut RouteAgent, plane: &mut OrcaAgent, cell: OnGrid, free: InPlane<f32>, now: Instant) {
///     let (state, inbox) = (KinematicState::default(), &[]);
///     grid.assign_goal(Cell::new(9, 5));
///     let _ = grid.step(&Inputs { state, surroundings: cell, inbox }, now, &mut GridWorkspace::new());
///     plane.assign_waypoint(0, &Waypoint::fixed(Default::default()));
///     let _ = plane.step(&Inputs { state, surroundings: free, inbox }, now, &mut ());
/// }
/// fn law(law: CellFollower<f32, Route>) -> impl Guidance<f32> { law }
/// ```
///
/// Told of a grid where it moves by velocities, or the other way round:
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
///     let (state, inbox) = (KinematicState::default(), &[]);
///     let _ = grid.step(&Inputs { state, surroundings: free, inbox }, now, &mut GridWorkspace::new());
/// }
/// ```
///
/// Sent to a cell where it goes to waypoints, or the other way round:
///
/// ```compile_fail
/// # use staya_controller::{agent::*, grid::Cell};
/// fn send(plane: &mut OrcaAgent) { plane.assign_goal(Cell::new(9, 5)); }
/// ```
///
/// ```compile_fail
/// # use staya_controller::agent::*;
/// fn send(grid: &mut RouteAgent) { grid.assign_waypoint(0, &Waypoint::fixed(Default::default())); }
/// ```
///
/// From cell to cell by a law that knows none:
///
/// ```compile_fail
/// # use staya_controller::agent::*;
/// fn law(law: CellFollower<f32, WaypointGuidance<f32>>) -> impl Guidance<f32> { law }
/// ```
pub trait Guidance<S: Scalar>: Teamwork {
    /// What it must be told besides own state and radio: [`OnGrid`](super::OnGrid), [`InPlane`](super::InPlane) or
    /// [`InCells`](super::InCells).
    type Input<'a>: Surroundings<S>;

    /// Where it can be sent.
    type Destination: Destination;

    /// Scratch memory; holds nothing between calls, so that many robots can share one.
    type Workspace;

    /// What it tells others of its kind behind each beacon, and knows of them as [`Neighbor::payload`]; `()` for nothing, at no cost.
    type Payload: Payload;

    /// Chooses what to do next. Called when the robot has somewhere to go and is free to move.
    ///
    /// # Errors
    /// [`BadInput`] puts the robot into [`Mode::Fault`](crate::robot::Mode::Fault).
    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S, Self::Payload>,
        here: &Self::Input<'_>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput>;

    /// Whether a cell of the grid is what it goes to; where the type does not tell, it must say so.
    fn goes_to_cells(&self) -> bool {
        Self::Destination::IS_CELL
    }

    /// Whether it decides on velocities, not on moves from cell to cell.
    fn goes_by_velocity(&self) -> bool {
        true
    }

    /// Whether it knows where to go without a cell as its goal.
    fn has_own_goal(&self) -> bool {
        false
    }

    /// What follows those whom the robot sees; `None`: it knows of nobody but by radio. See [`NeighborTracking`](super::NeighborTracking).
    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        None
    }

    /// Takes a waypoint to go to, number `index` of those that the robot has; whether it was of use.
    fn assign_waypoint(&mut self, _index: u8, _waypoint: &Waypoint<S>) -> bool {
        false
    }

    /// What to tell others of its kind, asked when a beacon is due. Several robots hear it late, repeatedly or never, so it should be
    /// what holds now, not what has changed.
    fn payload(&mut self, _now: Instant) -> Self::Payload {
        Self::Payload::default()
    }

    /// What a parameter is now; `None` when it has no such one.
    fn parameter(&self, _parameter: Parameter) -> Option<S> {
        None
    }

    /// Changes a parameter; whether it has such one. `value` is within [`Parameter::range`].
    fn tune(&mut self, _parameter: Parameter, _value: S) -> bool {
        false
    }
}

/// What robots that travel together say to each other beyond beacons. A law that has no use for it takes the defaults:
/// `impl Teamwork for MyLaw {}`.
pub trait Teamwork {
    /// "Choose another direction" (A. V. Kuznetsov 2017, KUZ, section 7): excludes the last choice from the next one.
    fn redirect(&mut self) {}

    /// Whether somebody's request to stand holds at the decision that follows. Who follows nobody stands without the law's doing
    /// ([`Status::recovers`] goes on); a law in which others stand too takes note of it.
    fn note_stop(&mut self, _is_asked: bool) {}

    /// Takes a part of a formation template in; whether the part was of use. `is_anew`: its sender is
    /// another one than before, or has started anew.
    fn assign_template(&mut self, _part: &TemplateAssignment, _is_anew: bool) -> bool {
        false
    }

    /// From the top leader's goal to the own goal.
    fn goal_offset(&self) -> Cell {
        Cell::default()
    }

    /// Takes in what somebody says of the land.
    fn hear_land(&mut self, _patch: &LandPatch) {}

    /// What to tell others of the land, behind each beacon.
    fn say_land(&mut self, _now: Instant) -> Option<LandPatch> {
        None
    }

    /// Whether a full neighbour table must keep this robot.
    fn needs(&self, _id: RobotId) -> bool {
        false
    }
}

/// The functions of [`Teamwork`] in a law around another one, `$inside`, that does nothing of its own in them: `orders` those
/// about formations, `land` those about the land. A function that is forgotten in such a law is lost without a word
/// (`tests/wrapped.rs` looks).
macro_rules! pass_on {
    (orders: $self:ident => $inside:expr) => {
        fn redirect(&mut $self) {
            $inside.redirect();
        }

        fn note_stop(&mut $self, is_asked: bool) {
            $inside.note_stop(is_asked);
        }

        fn assign_template(&mut $self, part: &TemplateAssignment, is_anew: bool) -> bool {
            $inside.assign_template(part, is_anew)
        }

        fn goal_offset(&$self) -> Cell {
            $inside.goal_offset()
        }

        fn needs(&$self, id: RobotId) -> bool {
            $inside.needs(id)
        }
    };
    (land: $self:ident => $inside:expr) => {
        fn hear_land(&mut $self, patch: &LandPatch) {
            $inside.hear_land(patch);
        }

        fn say_land(&mut $self, now: Instant) -> Option<LandPatch> {
            $inside.say_land(now)
        }
    };
}
pub(super) use pass_on;

/// Where a guidance law can be sent: one of [`ToCells`], [`ToWaypoints`], [`Roams`] and [`ToAny`].
pub trait Destination {
    /// Whether it is a cell of the grid.
    const IS_CELL: bool;
}

/// To a cell of the grid: agents have [`Agent::assign_goal`](super::Agent::assign_goal).
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ToCells {}

/// To waypoints: agents have [`Agent::assign_waypoint`](super::Agent::assign_waypoint).
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ToWaypoints {}

/// Nowhere.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Roams {}

/// That is known only at run time: agents have [`Agent::assign`](super::Agent::assign), as all have.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ToAny {}

impl Destination for ToCells {
    const IS_CELL: bool = true;
}

impl Destination for ToWaypoints {
    const IS_CELL: bool = false;
}

impl Destination for Roams {
    const IS_CELL: bool = false;
}

impl Destination for ToAny {
    const IS_CELL: bool = false;
}

/// What any guidance law may know at a decision; `P` is its [`Guidance::Payload`].
#[derive(Clone, Copy, Debug)]
pub struct GuidanceInput<'a, S, P = ()> {
    /// Own number.
    pub id: RobotId,
    /// The moment of the decision.
    pub now: Instant,
    /// The time in which a robot crosses a cell of impassability 1.
    pub tick: Duration,
    /// Own state.
    pub state: KinematicState<S>,
    /// The cell to go to; for a law that has a goal of its own any cell.
    pub goal: Cell,
    /// Own body.
    pub body: Body<S>,
    /// Who is near by, nearest first; nobody for robots that move cell by cell.
    pub nearby: &'a [Nearby<S>],
    /// Who was heard, by rising number; nobody older than [`Ages::expire_after`].
    pub neighbors: &'a [Neighbor<S, P>],
    /// How old news may be.
    pub ages: Ages,
    /// What is known of the land beyond the window: see [`MapSharing`](super::MapSharing).
    pub land: Option<&'a dyn FarLand>,
}

impl<S: Scalar, P> GuidanceInput<'_, S, P> {
    /// Whether the body can go by velocities.
    ///
    /// # Errors
    /// [`BadInput`] when [`InPlane::max_speed_mps`](super::InPlane::max_speed_mps) says that it cannot move.
    pub fn can_go(&self) -> Result<(), BadInput> {
        if self.body.max_speed_mps > S::ZERO { Ok(()) } else { Err(BadInput) }
    }
}

impl<'a, S, P> GuidanceInput<'a, S, P> {
    /// A neighbour by its number. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId) -> Option<&'a Neighbor<S, P>> {
        let at = self.neighbors.binary_search_by_key(&id, |n| n.id).ok()?;
        self.neighbors.get(at)
    }
}

/// What a guidance law decided.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Decision<S> {
    /// What the robot would do with nobody in the way; what becomes of it is the supervisor's and the safety layer's matter.
    pub action: Action<S>,
    /// How it stands.
    pub status: Status,
    /// The cell that it really heads for: the goal, or near it if the goal is a wall.
    pub target: Cell,
    /// Whom the robot follows.
    pub leader: RobotId,
    /// Its place in the formation.
    pub slot: u8,
    /// What it asks of others.
    pub asks: Vec<Ask, 3>,
}

/// What to do until the next decision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action<S> {
    /// To stand.
    #[default]
    Stay,
    /// To take the first of these moves, best first, that leads into a free cell.
    Moves(Vec<Dir, 8>),
    /// To go.
    Velocity {
        /// How it would go with nobody in the way, m/s.
        wish_mps: Vec3<S>,
        /// The next place on its way that it goes to straight, relative to its own place, metres; `None` when it has
        /// none: then nobody coming nearer is a reason to swerve.
        way_m: Option<Vec3<S>>,
    },
    /// To leave the body alone: its motors are off, or somebody else steers ([`Mode::Passive`](crate::robot::Mode::Passive)).
    Release,
}

impl<S> Action<S> {
    /// The moves, if there are any.
    #[must_use]
    pub fn moves(&self) -> &[Dir] {
        match self {
            Self::Moves(moves) => moves,
            Self::Stay | Self::Velocity { .. } | Self::Release => &[],
        }
    }
}

/// How a robot stands to where it should be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// It is where it should be, or beside.
    pub is_at_goal: bool,
    /// It should stand and wait for this; [`Wait::Place`] if it is at its goal by standing beside it.
    pub waits_for: Option<Wait>,
    /// No exit of the window can be reached.
    pub is_stuck: bool,
    /// It heads for where its followers are off to, and so goes on though they ask it to stop.
    pub recovers: bool,
    /// It is too far from its place in the formation.
    pub is_off_place: bool,
    /// It was asked to make way, or its waypoint moves: it moves even if it has arrived or waits.
    pub makes_way: bool,
}

/// A request that a guidance law wants made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ask {
    /// To whom.
    pub to: RobotId,
    /// What for.
    pub kind: RequestKind,
}

/// An input without which the guidance law cannot decide is missing, or contradicts another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BadInput;

impl core::fmt::Display for BadInput {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("an input that the guidance law needs is missing or contradicts another one")
    }
}

impl core::error::Error for BadInput {}
