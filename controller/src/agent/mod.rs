//! The controller of one robot, which composes the behaviours. Start with [`Agent::step`].
//!
//! A step receives frames (`link`), decides (a [`Law`], then the [`crate::supervisor`]),
//! avoids collisions (a [`Safety`] layer) and sends frames. The type of a law determines its
//! surroundings ([`Law::Surroundings`]) and the orders that it takes ([`Protocol::Order`]):
//!
//! | law | surroundings | order | command |
//! | --- | --- | --- | --- |
//! | [`RouteGuidance`] | [`OnGrid`] | [cell] | [move] |
//! | [`FormationGuidance`] | [`OnGrid`] | [cell] | [move] |
//! | [`RouteGuidance`] in [`CellFollower`] | [`InCells`] | [cell] | [velocity] |
//! | [`FormationInPlane`] | [`InCells`] | [cell] | [velocity] |
//! | [`WaypointGuidance`], [`GoalFlockGuidance`] | [`InPlane`] | [waypoint] | [velocity] |
//! | [`LatticeGuidance`] | [`InPlane`] | [waypoint] or none: it flocks | [velocity] |
//! | [`BoidsGuidance`] | [`InPlane`] | none: it roams | [velocity] |
//! | [`External`]: the caller decides | [`AnySurroundings`] | any bytes | any |
//!
//! [cell]: GridOrder
//! [waypoint]: WaypointOrder
//! [move]: Command::Move
//! [velocity]: Command::Velocity
//!
//! Pass an input that the sensors have not delivered for some time as missing ([`OnGrid::window`],
//! [`InPlane::max_speed_mps`]): the robot then stops in [`Mode::Fault`]. The crate `staya-robot`
//! turns velocities into PWM, UART bytes into an inbox, and range readings into a window.
//!
//! A robot that moves cell by cell to a goal on the grid:
//!
//! ```
//! use staya_controller::agent::*;
//! use staya_controller::grid::{Cell, Window};
//! use staya_controller::route::RouteParams;
//! use staya_controller::time::{Duration, Instant};
//! use staya_controller::wire::Postcard;
//! use staya_controller::robot::RobotId;
//!
//! let tick = Duration::from_millis(100);
//! let config = AgentConfig::new(RobotId(3), 0.0, tick);
//! let law = RouteGuidance::new(RouteParams::default());
//! let mut agent = RouteAgent::new(&config, law, Unguarded, Postcard);
//! let mut workspace = GridWorkspace::new();
//! agent.order(&GridOrder::Goal(Cell::new(9, 5)));
//!
//! // Sensors and radio report flat terrain and no other robot.
//! let (land, mut cell, mut now) = ([1; 121], Cell::new(5, 5), Instant::from_micros(0));
//! for _ in 0..4 {
//!     let inputs = Inputs {
//!         state: KinematicState::default(),
//!         surroundings: OnGrid {
//!             cell: CellState { cell, busy: Duration::ZERO },
//!             window: Window::new(&land, cell - Cell::new(5, 5), 11, 11),
//!         },
//!         inbox: &[],
//!     };
//!     let out = agent.step(&inputs, now, &mut workspace);
//!     assert!(!out.outbox.is_empty(), "it says where it is");
//!     if let Command::Move(moves) = out.command {
//!         cell = cell + moves[0].offset();
//!     }
//!     now = now + tick;
//! }
//! assert_eq!(cell, Cell::new(9, 5));
//! ```
//!
//! A robot that moves by velocities, behind ORCA, to a waypoint two metres east:
//!
//! ```
//! use staya_controller::agent::*;
//! use staya_controller::geom::Position;
//! use staya_controller::neighbor::StalenessInflation;
//! use staya_controller::orca::AvoidParams;
//! use staya_controller::time::{Duration, Instant};
//! use staya_controller::wire::Postcard;
//! use staya_controller::robot::{Mode, RobotId};
//!
//! let tick = Duration::from_millis(50);
//! let config = AgentConfig::new(RobotId(3), 0.1, tick);
//! let inflation = StalenessInflation { growth_mps: 0.1, max_m: 0.2 };
//! let safety = OrcaSafety::new(AvoidParams::default(), inflation);
//! let mut agent = OrcaAgent::new(&config, WaypointGuidance::new(0.5, 0.02), safety, Postcard);
//! agent.order(&WaypointOrder::first(Waypoint::fixed(Position::from_mm([2000, 0, 0]))));
//!
//! let (mut state, mut now) = (KinematicState::default(), Instant::from_micros(0));
//! while agent.mode() != Mode::Arrived {
//!     let inputs = Inputs {
//!         state,
//!         surroundings: InPlane { max_speed_mps: 0.5, obstacles: &[] },
//!         inbox: &[],
//!     };
//!     let out = agent.step(&inputs, now, &mut ());
//!     // A body without inertia follows the command at once.
//!     if let Command::Velocity(velocity_mps) = out.command {
//!         state.velocity_mps = velocity_mps;
//!         state.position = state.position.moved(velocity_mps * 0.05).unwrap();
//!     }
//!     now = now + tick;
//! }
//! assert!(state.position.since::<f32>(Position::from_mm([2000, 0, 0])).norm() <= 0.02);
//! ```

mod config;
mod contact_loss;
mod duplicate_id;
mod io;
mod link;
mod parameter;
mod perception;
mod setup;
mod state;
mod step;
mod task;

#[cfg(all(test, feature = "auth"))]
mod tests;

pub use crate::law::{
    Action, AnySurroundings, Around, BadInput, CellFrame, CellState, Contradiction, Decision, Goals, InCell, InCells,
    InPlane, KinematicState, Known, Law, MakesLaw, MessageOf, Motion, OfAnotherLaw, OnGrid, OrderOf, Outgoing,
    PayloadOf, Progress, Protocol, Radio, Report, Scene, Settings, SettingsOfLaw, Surroundings, Tools, View, Wait,
    WrongTask,
};
pub use crate::laws::any::{Large, dispatch};
pub use crate::laws::any_protocol::{AnyMessage, AnyOrder, AnyPayload, AnyProtocol, InAny, OtherPayload, Raw};
pub use crate::laws::boids::{BoidsGuidance, BoidsSettings};
pub use crate::laws::cells::{
    CellFollower, FarMap, Grid, GridMessage, GridNeighbor, GridOrder, GridPayload, GridTask, GridWorkspace, KnownMap,
    MAX_TEMPLATE, OverCells, PartError, SharedMap, TEMPLATE_PART, TemplateAssembler, TemplatePart,
};
pub use crate::laws::external::{External, Incoming};
pub use crate::laws::formation::{FormationGuidance, FormationInPlane, FormationSettings};
pub use crate::laws::goal_flock::{GOALS, GoalFlockGuidance, GoalFlockSettings};
pub use crate::laws::guided::{Guided, Wish};
pub use crate::laws::lattice::{GAMMA_OF_TWO, LatticeGuidance, LatticeSettings};
pub use crate::laws::list::{AnyLaw, LawSettings};
pub use crate::laws::route::{RouteGuidance, RouteSettings};
pub use crate::laws::waypoint::{WAYPOINTS, Waypoint, WaypointGuidance, WaypointOrder, WaypointSettings, Waypoints};
pub use crate::safety::{
    AnyHalfPlanes, AnySafety, FlySafety, FlySettings, LayerSettings, MakesLayer, OrcaSafety, OrcaSettings,
    PushOutSafety, PushOutSettings, Safety, SafetyInput, TableSettings, Unguarded, UnguardedSettings,
};
pub use config::AgentConfig;
pub use contact_loss::ContactLossPolicy;
pub use io::{AnyInputs, Command, EVENTS, Event, ImplausibleCounts, Inputs, OUTBOX, Outputs, Refused};
pub use link::RELAYS;
pub use perception::{Perception, RadioOnly};
pub use setup::{AnyAgent, Setup, Task};

use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::robot::Mode;
use crate::scalar::Scalar;
use crate::supervisor::Situation;
use crate::wire::{Postcard, Wire};
use link::Link;
use serde::{Deserialize, Serialize};

/// Cells of a search in a window of radius 5 (A. V. Kuznetsov 2017, KUZ), with its border.
pub const CELLS: usize = 169;
/// Capacity of the neighbour table of an agent with default capacities.
pub const NEIGHBORS: usize = 16;
/// Number of cells whose visits an agent with default capacities remembers.
pub const VISITS: usize = 64;
/// Costs that a default agent learns: 2 KiB. With 0 it leaves dead ends along their walls.
pub const LEARNED: usize = 256;
/// Tiles in a default shared map: 128 x 128 cells, 3 KiB, and 6 KiB of stack in a decision.
pub const MAP_TILES: usize = 1024;
pub use crate::template::TEMPLATE;

/// Half-planes in a default safety layer: one per neighbour, and equally many for obstacles.
pub const HALF_PLANES: usize = 2 * NEIGHBORS;

/// An agent for a single robot on the grid, with default capacities.
pub type RouteAgent = Agent<f32, RouteGuidance<CELLS, VISITS, LEARNED>, NEIGHBORS>;
/// An agent for a robot in formation on the grid, with default capacities.
pub type FormationAgent = Agent<f32, FormationGuidance<CELLS, VISITS, TEMPLATE, LEARNED>, NEIGHBORS>;
/// An agent for a single robot in the plane behind ORCA, with default capacities.
pub type OrcaAgent = Agent<f32, WaypointGuidance<f32>, NEIGHBORS, OrcaSafety<f32, HALF_PLANES>>;

// Memory of firmware: a change of these sizes changes the memory map of every user.
#[cfg(not(feature = "host"))]
const BYTES: [usize; 4] =
    [size_of::<RouteAgent>(), size_of::<FormationAgent>(), size_of::<OrcaAgent>(), size_of::<GridWorkspace<CELLS>>()];
#[cfg(all(target_pointer_width = "32", not(feature = "host")))]
const _: () = assert!(BYTES[0] <= 4568 && BYTES[1] <= 4832 && BYTES[2] <= 1872 && BYTES[3] <= 2720);
#[cfg(all(target_pointer_width = "64", not(feature = "host")))]
const _: () = assert!(matches!(BYTES, [4592, 4864, 1888, 2720]));

/// The controller of one robot: law `L`, at most `N` known neighbours, safety layer `A`, wire
/// format `W`, perception `P`.
///
/// Bytes with default capacities; the build fails if one of them changes:
///
/// | type | 32-bit part | 64-bit host |
/// | --- | --- | --- |
/// | [`RouteAgent`], of which 2 KiB for learned costs | at most 4568 | 4592 |
/// | [`FormationAgent`], of which 2 KiB for learned costs | at most 4832 | 4864 |
/// | [`OrcaAgent`] | at most 1872 | 1888 |
/// | workspace, shared by all grid agents of a processor | at most 2720 | 2720 |
///
/// With the feature `host`, lists take only the memory of their entries.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(deserialize = "L: Deserialize<'de>, A: Deserialize<'de>, W: Deserialize<'de>, P: Deserialize<'de>"))]
pub struct Agent<S: Scalar, L: Law<S>, const N: usize, A = Unguarded, W = Postcard, P = RadioOnly> {
    config: AgentConfig<S>,
    law: L,
    safety: A,
    perception: P,
    link: Link<S, N, W, L::Protocol>,
    mode: Mode,
    /// Keys the random numbers of each decision.
    decisions: u32,
    last: Last,
    /// The last command of a body with a lag, m/s.
    commanded_mps: Vec3<S>,
}

/// State that the last step leaves to the next one.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Last {
    situation: Situation,
    cell: Cell,
    heading: Dir,
}

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire> Agent<S, L, N, A, W> {
    /// Creates a robot that has just started: idle, without a goal and without known neighbours.
    ///
    /// Use [`Unguarded`] where bodies cannot collide or may touch. All robots of a swarm must use
    /// the same `wire` format, for example [`Postcard`].
    #[must_use]
    pub const fn new(config: &AgentConfig<S>, law: L, safety: A, wire: W) -> Self {
        Self::with_perception(config, law, safety, wire, RadioOnly)
    }
}

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Creates a robot as [`Agent::new`] does, with a [`Tracker`](crate::neighbor::Tracker) of the
    /// robots that its sensors detect.
    #[must_use]
    pub const fn with_perception(config: &AgentConfig<S>, law: L, safety: A, wire: W, perception: P) -> Self {
        Self {
            config: *config,
            law,
            safety,
            perception,
            link: Link::new(config, wire),
            mode: Mode::Idle,
            decisions: 0,
            last: Last { situation: Situation::Idle, cell: Cell::new(0, 0), heading: Dir::Stay },
            commanded_mps: Vec3::ZERO,
        }
    }

    /// Puts the robot on a torus: it sees others at their nearest image. For simulated boids.
    #[cfg(feature = "host")]
    pub const fn set_torus(&mut self, torus: crate::geom::Torus<S>) {
        self.link.set_torus(torus);
    }
}
