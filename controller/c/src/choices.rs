//! Enums for C. Fields have them as integers, since C may write any number there.

use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{Event, Wait};
use staya_controller::lattice::Algorithm;
use staya_controller::push_out::Model;
use staya_controller::robot::Mode;

/// Guidance law: how a robot moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaLaw {
    /// Straight to its waypoint at `speed_mps`, until it is within `tolerance_m`.
    Waypoint = 0,
    /// The alpha flock (R. Olfati-Saber 2006): equal distances; waypoint 0, if any, is followed.
    Lattice = 1,
    /// The goal flock (V. E. and V. V. Pavlovsky): to the waypoints' middle, then each to one.
    GoalFlock = 2,
    /// Boids (V. A. Starovoitova 2018): constant speed, only headings change.
    Boids = 3,
    /// A route across land in cells (A. V. Kuznetsov 2017), with velocities as commands.
    Route = 4,
    /// A formation across land in cells, with velocities as commands.
    Formation = 5,
    /// A route across land in cells, with moves from cell to cell as commands.
    RouteOnGrid = 6,
    /// A formation across land in cells, with moves from cell to cell as commands.
    FormationOnGrid = 7,
    /// A law of your own: `staya_decide` gives the decision of each step.
    External = 8,
}

/// The action that a law of your own decides on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaAction {
    /// Stand without a goal: STAYA_MODE_IDLE.
    Idle = 0,
    /// Stand.
    Stay = 1,
    /// Move with `velocity_mps`.
    Velocity = 2,
    /// Take the first of `moves` that leads into a free cell; only for moves from cell to cell.
    Moves = 3,
}

/// Safety layer: how a robot keeps clear of others. Robots that move from cell to cell have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaSafety {
    /// No safety layer.
    None = 0,
    /// ORCA in the plane.
    Orca = 1,
    /// ORCA in the plane with half-planes from a table of 2 KiB.
    OrcaTable = 2,
    /// ORCA in space, for flying robots.
    Fly = 3,
    /// Push-out: considers only the present positions of others.
    PushOut = 4,
}

/// Wire format; the same for all robots of a swarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaWire {
    /// The controller's own frames of at most 60 bytes, each followed by a zero byte.
    Postcard = 0,
    /// MAVLink 2 frames with Staya's dialect, `controller/mavlink/messages/staya.xml`.
    Mavlink = 1,
    /// Like STAYA_WIRE_POSTCARD, with an authentication code (needs `key`) and replay protection.
    Sealed = 2,
}

/// The command to the body until the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaCommand {
    /// Stop.
    Hold = 0,
    /// Take the first of `moves` whose cell is free and passable; stop if none is.
    Move = 1,
    /// Move with `velocity_mps`.
    Velocity = 2,
}

/// The overall activity of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaMode {
    /// No goal yet.
    Idle = 0,
    /// Taking its place in the formation.
    Forming = 1,
    /// Moving to its goal.
    Cruise = 2,
    /// Stopped, because another robot asked it to or because no route is open.
    Hold = 3,
    /// At its target.
    Arrived = 4,
    /// Stopped, because own input is missing or wrong.
    Fault = 5,
    /// Not steered by its agent.
    Passive = 6,
}

/// Why a robot with a goal does not get closer to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaWait {
    /// It does not wait.
    Nothing = 0,
    /// Its leader or its followers have not arrived yet.
    Team = 1,
    /// Another robot asked it to stop.
    Stopped = 2,
    /// Only land or walls block its route.
    Route = 3,
    /// It does not know where others are, since it does not receive them.
    Radio = 4,
    /// Others go first through a narrow place, such as a door.
    Turn = 5,
    /// Other robots are in its way.
    Robots = 6,
    /// Another robot occupies its goal; it has arrived beside it.
    GoalTaken = 7,
}

/// A move from a cell: compass directions, as in `moves` and `heading`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaDir {
    /// (1, 0)
    East = 0,
    /// (1, 1)
    NorthEast = 1,
    /// (0, 1)
    North = 2,
    /// (-1, 1)
    NorthWest = 3,
    /// (-1, 0)
    West = 4,
    /// (-1, -1)
    SouthWest = 5,
    /// (0, -1)
    South = 6,
    /// (1, -1)
    SouthEast = 7,
    /// (0, 0)
    Stay = 8,
}

/// An event in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaEventKind {
    /// The robot's mode changed: `before`, `after` (StayaMode).
    ModeChanged = 0,
    /// No exit of the window can be reached.
    NoRoute = 1,
    /// The target lay in an impassable cell and was moved: `before_xy`, `after_xy`.
    TargetMoved = 2,
    /// `robot` did not acknowledge a message of the law in time.
    MessageExpired = 3,
    /// `robot` became known.
    NeighborFound = 4,
    /// `robot` was silent for too long.
    NeighborLost = 5,
    /// The table was full and `robot` was dropped from it.
    NeighborEvicted = 6,
    /// `robot` has restarted.
    NeighborRebooted = 7,
    /// No robot is received any more.
    ContactLost = 8,
    /// Two robots have the number `robot`.
    DuplicateId = 9,
    /// A beacon of `robot` is implausible; `after`: 0 number, 1 radius, 2 speed, 3 position.
    Implausible = 10,
    /// The robot stopped sending: its counters are used up, and it needs a new key.
    Muted = 11,
}

/// The shape of a static obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaShape {
    /// A vertical wall without thickness from (`x_m`, `y_m`) to (`x2_m`, `y2_m`).
    Wall = 0,
    /// A ball, in the plane a disc, around (`x_m`, `y_m`, `z_m`) with the radius `size_m`.
    Ball = 1,
    /// A half-space: everything behind a plane. Its normal (`x_m`, `y_m`, `z_m`) has length 1 and
    /// points away from the obstacle; the robot is `size_m` in front of it.
    Plane = 2,
}

/// The active terms of the alpha flock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaLatticeTerms {
    /// Only the other robots.
    Others = 1,
    /// Also the reference, with a pull that grows without bound.
    Reference = 2,
    /// Also obstacles; the pull of the reference is bounded.
    All = 3,
}

/// How push-out changes a step that leads too near.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaPushOutModel {
    /// The step slides along the border and becomes shorter.
    Radial = 0,
    /// The step keeps its length and is turned.
    Tangential = 1,
}

/// [`of`](StayaLaw::of) for enums that C passes as numbers.
macro_rules! numbered {
    ($($name:ident { $($variant:ident),* $(,)? })*) => {
        $(impl $name {
            /// The value with this number.
            ///
            /// # Errors
            /// `STAYA_STATUS_CHOICE` if there is none.
            pub fn of(number: u8) -> Checked<Self> {
                let mut all = [$(Self::$variant),*].into_iter();
                all.find(|known| *known as u8 == number).ok_or(StayaStatus::Choice)
            }
        })*
    };
}

numbered! {
    StayaLaw { Waypoint, Lattice, GoalFlock, Boids, Route, Formation, RouteOnGrid, FormationOnGrid, External }
    StayaAction { Idle, Stay, Velocity, Moves }
    StayaSafety { None, Orca, OrcaTable, Fly, PushOut }
    StayaWire { Postcard, Mavlink, Sealed }
    StayaShape { Wall, Ball, Plane }
}

/// Enums with the variants of an enum of the controller.
macro_rules! shown {
    ($($name:ident from $other:ident { $($variant:ident),* $(,)? })*) => {
        $(impl From<$other> for $name {
            fn from(other: $other) -> Self {
                match other {
                    $($other::$variant { .. } => Self::$variant,)*
                }
            }
        })*
    };
}

shown! {
    StayaMode from Mode { Idle, Forming, Cruise, Hold, Arrived, Fault, Passive }
    StayaWait from Wait { Team, Stopped, Route, Radio, Turn, Robots, GoalTaken }
    StayaEventKind from Event {
        ModeChanged, NoRoute, TargetMoved, MessageExpired, NeighborFound, NeighborLost, NeighborEvicted,
        NeighborRebooted, ContactLost, DuplicateId, Implausible, Muted,
    }
}

/// Enums whose numbers from C select a variant of an enum of the controller.
macro_rules! chosen {
    ($($name:ident to $other:ty { $($variant:ident = $value:expr),* $(,)? })*) => {
        $(impl $name {
            /// The controller's value for this number.
            ///
            /// # Errors
            /// `STAYA_STATUS_CHOICE` if there is none.
            pub fn chosen(number: u8) -> Checked<$other> {
                let mut all = [$((Self::$variant, $value)),*].into_iter();
                all.find(|(known, _)| *known as u8 == number).map(|(_, value)| value).ok_or(StayaStatus::Choice)
            }
        })*
    };
}

chosen! {
    StayaLatticeTerms to Algorithm { Others = Algorithm::One, Reference = Algorithm::Two, All = Algorithm::Three }
    StayaPushOutModel to Model { Radial = Model::Radial, Tangential = Model::Tangential }
    StayaWait to Option<Wait> {
        Nothing = None, Team = Some(Wait::Team), Stopped = Some(Wait::Stopped), Route = Some(Wait::Route),
        Radio = Some(Wait::Radio), Turn = Some(Wait::Turn), Robots = Some(Wait::Robots),
        GoalTaken = Some(Wait::GoalTaken),
    }
}
