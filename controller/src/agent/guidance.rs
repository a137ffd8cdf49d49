//! The interface between the agent and its guidance law.

use super::{KinematicState, Surroundings, Wait, Waypoint};
use crate::body::Body;
use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::land::{FarLand, LandPatch};
use crate::neighbor::{Ages, Nearby, Neighbor, Tracker};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Payload, RequestKind, TemplateAssignment};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Chooses where to go. An agent has one law, which composes behaviours of the layer below.
///
/// The associated types of a law determine its inputs, its kinds of goal and the laws that can wrap
/// it, so that a wrong combination does not compile:
///
/// ```
/// # use staya_controller::{agent::*, grid::Cell, time::Instant};
/// # type Route = RouteGuidance<CELLS, VISITS>;
/// # fn workspace() -> GridWorkspace<CELLS> { GridWorkspace::new() }
/// fn on_grid(agent: &mut RouteAgent, surroundings: OnGrid, now: Instant) {
///     let (state, inbox) = (KinematicState::default(), &[]);
///     agent.assign_goal(Cell::new(9, 5));
///     let _ = agent.step(&Inputs { state, surroundings, inbox }, now, &mut workspace());
/// }
/// fn in_plane(agent: &mut OrcaAgent, surroundings: InPlane<f32>, now: Instant) {
///     let (state, inbox) = (KinematicState::default(), &[]);
///     agent.assign_waypoint(0, &Waypoint::fixed(Default::default()));
///     let _ = agent.step(&Inputs { state, surroundings, inbox }, now, &mut ());
/// }
/// fn law(law: CellFollower<f32, Route>) -> impl Guidance<f32> { law }
/// ```
///
/// Grid inputs for a law that moves by velocities, or the reverse:
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
/// fn send(plane: &mut OrcaAgent) { plane.assign_goal(Cell::new(9, 5)); }
/// ```
///
/// ```compile_fail
/// # use staya_controller::agent::*;
/// fn send(grid: &mut RouteAgent, to: &Waypoint<f32>) { grid.assign_waypoint(0, to); }
/// ```
///
/// A follower of cells around a law without cells:
///
/// ```compile_fail
/// # use staya_controller::agent::*;
/// fn law(law: CellFollower<f32, WaypointGuidance<f32>>) -> impl Guidance<f32> { law }
/// ```
pub trait Guidance<S: Scalar>: Teamwork {
    /// Its surroundings: [`OnGrid`](super::OnGrid), [`InPlane`](super::InPlane),
    /// [`InCells`](super::InCells).
    type Input<'a>: Surroundings<S>;

    /// The kind of goal.
    type Destination: Destination;

    /// Scratch memory without state between calls; one can serve all robots.
    type Workspace;

    /// Data for robots with the same law, sent after each beacon and received as
    /// [`Neighbor::payload`]; `()` for none, at no cost.
    type Payload: Payload;

    /// Decides on the next action. Called when the robot has a goal and is free to move.
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

    /// Returns whether its goal is a cell. Override this if
    /// [`Self::Destination`](Guidance::Destination) does not determine it.
    fn goes_to_cells(&self) -> bool {
        Self::Destination::IS_CELL
    }

    /// Returns whether it decides on velocities instead of moves between cells.
    fn goes_by_velocity(&self) -> bool {
        true
    }

    /// Returns whether it has a goal other than an assigned cell.
    fn has_own_goal(&self) -> bool {
        false
    }

    /// Returns the [tracker](super::NeighborTracking) of detected robots, if any.
    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        None
    }

    /// Sets waypoint `index`. Returns whether it was accepted.
    fn assign_waypoint(&mut self, _index: u8, _waypoint: &Waypoint<S>) -> bool {
        false
    }

    /// Returns the payload when a beacon is due: a state rather than a change, since receivers may
    /// get it late, repeatedly or never.
    fn payload(&mut self, _now: Instant) -> Self::Payload {
        Self::Payload::default()
    }

    /// Calls `visit` with each of its tables of parameters.
    fn parameters(&mut self, _visit: &mut dyn FnMut(&mut dyn Parameters)) {}
}

/// Messages between robots that travel together, in addition to beacons; all are optional.
pub trait Teamwork {
    /// Handles a request to choose another direction (A. V. Kuznetsov 2017, KUZ, section 7):
    /// excludes the last choice from the next decision.
    fn redirect(&mut self) {}

    /// Reports before a decision whether a stop request is active. The agent stops a robot without
    /// a leader itself, unless [`Status::recovers`]; laws that stop other robots store the flag.
    fn note_stop(&mut self, _is_asked: bool) {}

    /// Handles a part of a formation template; returns whether it was accepted. The flag reports
    /// that the sender changed or restarted.
    fn assign_template(&mut self, _part: &TemplateAssignment, _is_restarted: bool) -> bool {
        false
    }

    /// Returns the cell difference from the top leader's goal to the own goal.
    fn goal_offset(&self) -> Cell {
        Cell::default()
    }

    /// Merges a patch of another robot's map.
    fn hear_land(&mut self, _patch: &LandPatch) {}

    /// Returns the patch of the own map to send after a beacon.
    fn say_land(&mut self, _now: Instant) -> Option<LandPatch> {
        None
    }

    /// Returns whether a full neighbour table must keep this robot.
    fn needs(&self, _id: RobotId) -> bool {
        false
    }
}

/// Forwards [`Teamwork`] to the law `$inside`: `orders` for formations, `land` for maps. A missing
/// function would silently use its default (`tests/wrapped.rs` checks this).
macro_rules! pass_on {
    (orders: $self:ident => $inside:expr) => {
        fn redirect(&mut $self) {
            $inside.redirect();
        }

        fn note_stop(&mut $self, is_asked: bool) {
            $inside.note_stop(is_asked);
        }

        fn assign_template(&mut $self, part: &TemplateAssignment, is_restarted: bool) -> bool {
            $inside.assign_template(part, is_restarted)
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

/// The kind of goal of a guidance law: [`ToCells`], [`ToWaypoints`], [`Roams`] or [`ToAny`].
pub trait Destination {
    /// Whether the goal is a cell of the grid.
    const IS_CELL: bool;
}

/// A cell of the grid, set by [`Agent::assign_goal`](super::Agent::assign_goal).
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ToCells {}

/// Waypoints, set by [`Agent::assign_waypoint`](super::Agent::assign_waypoint).
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ToWaypoints {}

/// No goal.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Roams {}

/// A kind of goal chosen at run time, set by [`Agent::assign`](super::Agent::assign).
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

/// Inputs of a decision that are common to all guidance laws.
#[derive(Clone, Copy, Debug)]
pub struct GuidanceInput<'a, S, P = ()> {
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
    /// The goal cell; any cell for a law that has another kind of goal.
    pub goal: Cell,
    /// Own body.
    pub body: Body<S>,
    /// Nearby robots, nearest first; empty for robots that move cell by cell.
    pub nearby: &'a [Nearby<S>],
    /// Known robots in ascending order of ids, none older than [`Ages::expire_after`].
    pub neighbors: &'a [Neighbor<S, P>],
    /// Age limits of neighbour states.
    pub ages: Ages,
    /// Terrain beyond the window, from a [shared map](super::MapSharing).
    pub land: Option<&'a dyn FarLand>,
}

impl<S: Scalar, P> GuidanceInput<'_, S, P> {
    /// Checks that the body can move by velocities.
    ///
    /// # Errors
    /// [`BadInput`] if [`InPlane::max_speed_mps`](super::InPlane::max_speed_mps) is 0 or less.
    pub fn can_go(&self) -> Result<(), BadInput> {
        if self.body.max_speed_mps > S::ZERO { Ok(()) } else { Err(BadInput) }
    }
}

impl<'a, S, P> GuidanceInput<'a, S, P> {
    /// Returns a neighbour by its id. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId) -> Option<&'a Neighbor<S, P>> {
        let at = self.neighbors.binary_search_by_key(&id, |n| n.id).ok()?;
        self.neighbors.get(at)
    }
}

/// The decision of a guidance law.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Decision<S> {
    /// The intended action; the supervisor and the safety layer may change it.
    pub action: Action<S>,
    /// Progress towards the goal.
    pub status: Status,
    /// The cell that it heads for: the goal, or a cell near it if the goal is impassable.
    pub target: Cell,
    /// The robot that this one follows.
    pub leader: RobotId,
    /// Its place in the formation.
    pub slot: u8,
    /// Requests to other robots.
    pub asks: Vec<Ask, 3>,
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

/// The state of a robot relative to its goal and its formation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// It is at its goal, or beside its occupied goal.
    pub is_at_goal: bool,
    /// The reason to stand and wait; [`Wait::GoalTaken`] beside an occupied goal.
    pub waits_for: Option<Wait>,
    /// No exit of the window is reachable.
    pub is_stuck: bool,
    /// It heads for scattered followers, and therefore ignores their stop requests.
    pub recovers: bool,
    /// It is too far from its place in the formation.
    pub is_off_place: bool,
    /// It moves although it arrived or waits: it makes way, or its waypoint moves.
    pub makes_way: bool,
}

/// A request that a guidance law sends to another robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ask {
    /// The receiver.
    pub to: RobotId,
    /// The kind of the request.
    pub kind: RequestKind,
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
