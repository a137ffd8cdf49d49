//! Enums for C. Fields have them as integers, since C may write any number there.

use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{Event, Wait};
use staya_controller::robot::Mode;

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

/// How far a law of your own is with its task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaProgress {
    /// It goes to its goal, or as its law without a goal says.
    Going = 0,
    /// It is too far from its place in a formation, and goes there: STAYA_MODE_FORMING.
    Forming = 1,
    /// It stands for the reason `wait`: STAYA_MODE_HOLD; beside its occupied goal
    /// (STAYA_WAIT_GOAL_TAKEN) STAYA_MODE_ARRIVED.
    Waiting = 2,
    /// No route is open, and it stands: STAYA_MODE_HOLD.
    Stuck = 3,
    /// It is at its goal, and stands: STAYA_MODE_ARRIVED.
    Arrived = 4,
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

/// [`of`](StayaWire::of) for enums that C passes as numbers.
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
    StayaAction { Idle, Stay, Velocity, Moves }
    StayaProgress { Going, Forming, Waiting, Stuck, Arrived }
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

impl StayaWait {
    /// The controller's value for this number.
    ///
    /// # Errors
    /// `STAYA_STATUS_CHOICE` if there is none.
    pub fn chosen(number: u8) -> Checked<Option<Wait>> {
        let waits = [Wait::Team, Wait::Stopped, Wait::Route, Wait::Radio, Wait::Turn, Wait::Robots, Wait::GoalTaken];
        let mut all = [None].into_iter().chain(waits.into_iter().map(Some));
        let number_of = |wait: Option<Wait>| wait.map_or(Self::Nothing, Self::from) as u8;
        all.find(|wait| number_of(*wait) == number).ok_or(StayaStatus::Choice)
    }
}
