//! Numbers that stand for one of several, as enums for C: fields have them as integers, since C writes there what it likes.

use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{Event, Wait};
use staya_controller::flock::lattice::Algorithm;
use staya_controller::neighbor::Claim;
use staya_controller::push_out::Model;
use staya_controller::robot::Mode;
use staya_controller::wire::RequestKind;

/// How a robot goes: its guidance law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaLaw {
    /// Straight to its waypoint, `speed_mps`, until it is within `tolerance_m`.
    Waypoint = 0,
    /// The alpha flock (R. Olfati-Saber 2006): equal distances, and waypoint 0, if there is one, as its reference.
    Lattice = 1,
    /// The goal flock (V. E. and V. V. Pavlovsky): to the middle of the waypoints together, then each to one of them.
    GoalFlock = 2,
    /// Boids (V. A. Starovoitova 2018): constant speed, only headings change.
    Boids = 3,
    /// Across land in cells (A. V. Kuznetsov 2017), by velocities.
    Route = 4,
    /// The same, keeping a formation.
    Formation = 5,
    /// Across land in cells, by moves from cell to cell.
    RouteOnGrid = 6,
    /// The same, keeping a formation.
    FormationOnGrid = 7,
}

/// What keeps a robot clear of others: its safety layer. Robots that move from cell to cell have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaSafety {
    /// Nothing.
    None = 0,
    /// ORCA in the plane.
    Orca = 1,
    /// The same with half-planes from a table of 2 KiB.
    OrcaTable = 2,
    /// ORCA in space, for robots that fly.
    Fly = 3,
    /// Push-out: only against where others are now.
    PushOut = 4,
}

/// How robots speak; the same for all of a swarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaWire {
    /// The controller's own frames, at most 60 bytes, each with a zero byte behind it.
    Postcard = 0,
    /// MAVLink 2 frames with messages of Staya's dialect (`controller/mavlink/messages/staya.xml`).
    Mavlink = 1,
    /// As the first, with a code that only who has the `key` can make, and with protection against replays.
    Sealed = 2,
}

/// What the body should do until the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaCommand {
    /// Stand.
    Hold = 0,
    /// Take the first of `moves` whose cell is free and passable; none free: stand.
    Move = 1,
    /// Go with `velocity_mps`.
    Velocity = 2,
}

/// What the robot is doing as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaMode {
    /// No goal yet.
    Idle = 0,
    /// Taking its place in the formation.
    Forming = 1,
    /// On its way.
    Cruise = 2,
    /// Standing because somebody asked or no way is open.
    Hold = 3,
    /// At its target.
    Arrived = 4,
    /// Own input is missing or wrong; standing.
    Fault = 5,
    /// Its agent does not steer it.
    Passive = 6,
}

/// What a robot that has somewhere to go and does not get on waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaWait {
    /// It does not wait.
    Nothing = 0,
    /// Its leader or its followers are not there yet.
    Formation = 1,
    /// Somebody asked it to stop.
    Request = 2,
    /// Nothing but land or walls is in its way.
    Way = 3,
    /// It does not know where others are: they are not heard.
    Radio = 4,
    /// At a door others go first.
    Turn = 5,
    /// Other robots are in its way.
    Others = 6,
    /// Somebody stands on its goal; it has arrived beside it.
    Place = 7,
}

/// A move from a cell: compass points, as in `moves` and `heading`.
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

/// What happened in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaEventKind {
    /// Its mode changed: `before`, `after` (StayaMode).
    ModeChanged = 0,
    /// No exit of the window can be reached.
    NoRoute = 1,
    /// The target lay in an impassable cell and moved: `before_xy`, `after_xy`.
    TargetMoved = 2,
    /// A request to `robot` ran out of retries; `after`: 0 stop, 1 resume, 2 redirect.
    RequestExpired = 3,
    /// `robot` is known now.
    NeighborFound = 4,
    /// `robot` was silent for too long.
    NeighborLost = 5,
    /// The table was full and `robot` had to go.
    NeighborEvicted = 6,
    /// `robot` has restarted.
    NeighborRebooted = 7,
    /// Nobody is heard any more.
    NobodyHeard = 8,
    /// Two robots have the number `robot`.
    DuplicateId = 9,
    /// `robot` says of itself what is beyond `claims`; `after`: 0 its number, 1 radius, 2 speed, 3 place.
    Overclaimed = 10,
    /// The robot says nothing any more: its counters are used up, and a new key is needed.
    Muted = 11,
}

/// What does not move and stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaShape {
    /// An upright wall of no thickness from (`x_m`, `y_m`) to (`x2_m`, `y2_m`).
    Wall = 0,
    /// A ball, in the plane a disc, around (`x_m`, `y_m`, `z_m`) with the radius `size_m`.
    Ball = 1,
    /// All that is behind a plane: (`x_m`, `y_m`, `z_m`) is its normal, of length 1 and away from the obstacle, and the robot is
    /// `size_m` in front of it.
    Plane = 2,
}

/// Which terms of the alpha flock act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaLatticeTerms {
    /// Only the others.
    Others = 1,
    /// And the reference, with a pull that grows without bound.
    Reference = 2,
    /// And obstacles; the pull of the reference is bounded.
    All = 3,
}

/// [`of`](StayaLaw::of) for enums that C names by number.
macro_rules! numbered {
    ($($name:ident { $($variant:ident),* $(,)? })*) => {
        $(impl $name {
            /// The one of this number.
            ///
            /// # Errors
            /// `STAYA_STATUS_CHOICE` when there is none.
            pub fn of(number: u8) -> Checked<Self> {
                let mut all = [$(Self::$variant),*].into_iter();
                all.find(|known| *known as u8 == number).ok_or(StayaStatus::Choice)
            }
        })*
    };
}

numbered! {
    StayaLaw { Waypoint, Lattice, GoalFlock, Boids, Route, Formation, RouteOnGrid, FormationOnGrid }
    StayaSafety { None, Orca, OrcaTable, Fly, PushOut }
    StayaWire { Postcard, Mavlink, Sealed }
    StayaShape { Wall, Ball, Plane }
    StayaLatticeTerms { Others, Reference, All }
    StayaPushOutModel { Radial, Tangential }
}

impl From<StayaLatticeTerms> for Algorithm {
    fn from(terms: StayaLatticeTerms) -> Self {
        match terms {
            StayaLatticeTerms::Others => Self::One,
            StayaLatticeTerms::Reference => Self::Two,
            StayaLatticeTerms::All => Self::Three,
        }
    }
}

/// What push-out makes of a step that leads too near.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StayaPushOutModel {
    /// It slides along and slows down.
    Radial = 0,
    /// It keeps its length and is turned.
    Tangential = 1,
}

impl From<StayaPushOutModel> for Model {
    fn from(model: StayaPushOutModel) -> Self {
        match model {
            StayaPushOutModel::Radial => Self::Radial,
            StayaPushOutModel::Tangential => Self::Tangential,
        }
    }
}

impl From<Mode> for StayaMode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Idle => Self::Idle,
            Mode::Forming => Self::Forming,
            Mode::Cruise => Self::Cruise,
            Mode::Hold => Self::Hold,
            Mode::Arrived => Self::Arrived,
            Mode::Fault => Self::Fault,
            Mode::Passive => Self::Passive,
        }
    }
}

impl From<Option<Wait>> for StayaWait {
    fn from(wait: Option<Wait>) -> Self {
        match wait {
            None => Self::Nothing,
            Some(Wait::Formation) => Self::Formation,
            Some(Wait::Request) => Self::Request,
            Some(Wait::Way) => Self::Way,
            Some(Wait::Radio) => Self::Radio,
            Some(Wait::Turn) => Self::Turn,
            Some(Wait::Others) => Self::Others,
            Some(Wait::Place) => Self::Place,
        }
    }
}

/// The number of a request's kind in an event.
pub(crate) const fn request(kind: RequestKind) -> u8 {
    match kind {
        RequestKind::Stop => 0,
        RequestKind::Resume => 1,
        RequestKind::Redirect => 2,
    }
}

/// The number of a claim in an event.
pub(crate) const fn claim(claim: Claim) -> u8 {
    match claim {
        Claim::Number => 0,
        Claim::Radius => 1,
        Claim::Speed => 2,
        Claim::Jump => 3,
    }
}

impl From<&Event> for StayaEventKind {
    fn from(event: &Event) -> Self {
        match event {
            Event::ModeChanged { .. } => Self::ModeChanged,
            Event::NoRoute => Self::NoRoute,
            Event::TargetMoved { .. } => Self::TargetMoved,
            Event::RequestExpired { .. } => Self::RequestExpired,
            Event::NeighborFound(_) => Self::NeighborFound,
            Event::NeighborLost(_) => Self::NeighborLost,
            Event::NeighborEvicted(_) => Self::NeighborEvicted,
            Event::NeighborRebooted(_) => Self::NeighborRebooted,
            Event::NobodyHeard => Self::NobodyHeard,
            Event::DuplicateId(_) => Self::DuplicateId,
            Event::Overclaimed { .. } => Self::Overclaimed,
            Event::Muted => Self::Muted,
        }
    }
}
