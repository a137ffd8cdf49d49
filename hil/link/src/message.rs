//! The messages. The order and the types of the fields are the wire format (postcard): a change is a new
//! [`VERSION`](crate::frame::VERSION).
//!
//! Numbers are `f32` in SI units, whatever the device computes with; the device casts them to its own kind of number
//! and back, and the host's shadow of the device does the same. That both decide alike shows in the digest of their states, which
//! covers the device's own numbers.

use crate::capacities::Capacities;
use heapless::String;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{CellState, InCell, Outputs, Pose, Setup, Task};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;
use staya_controller::time::Instant;
use staya_controller::wire::{Mode, RobotId};

/// Bytes of a frame from the device, at most: delimiters included (a test fills one).
pub const MAX_ANSWER: usize = 512;
/// Bytes of what is in a [`Configure`], at most: overhead included (a test fills one).
pub const MAX_CONFIGURE: usize = 640;
/// Bytes of a packed obstacle.
pub const OBSTACLE: usize = 17;

/// Kinds of messages: from the host, then from the device.
pub mod kind {
    /// [`Greeting`](super::Greeting).
    pub const GREETING: u8 = 1;
    /// [`Configure`](super::Configure).
    pub const CONFIGURE: u8 = 2;
    /// [`Step`](super::Step).
    pub const STEP: u8 = 3;
    /// [`Restart`](super::Restart).
    pub const RESTART: u8 = 4;
    /// [`Hello`](super::Hello).
    pub const HELLO: u8 = 0x81;
    /// [`Configured`](super::Configured).
    pub const CONFIGURED: u8 = 0x82;
    /// [`Stepped`](super::Stepped).
    pub const STEPPED: u8 = 0x83;
    /// [`Fault`](super::Fault).
    pub const FAULT: u8 = 0x84;
}

/// Names a stretch of work with one host, so that what was delayed from another one is told apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Token {
    /// Chosen anew by each run of a host.
    pub run: u32,
    /// Counts the greetings of the run, wraps.
    pub number: u16,
}

/// Host: who are you? One with a new token makes the device forget what it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Greeting {
    /// Of this greeting.
    pub token: Token,
}

/// Host: start anew, as if by the reset button. A device that has another token only says [`Hello`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Restart {
    /// Of the last greeting.
    pub token: Token,
}

/// Host: be this robot, just started.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configure {
    /// Any number ahead of the last one.
    pub seq: u16,
    /// What the robot is.
    pub setup: Setup,
    /// What it has to do, if anything.
    pub task: Option<Task>,
}

/// Host: this is what you sense; decide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step<'a> {
    /// One more than that of the last request.
    pub seq: u16,
    /// What the robot senses.
    #[serde(borrow)]
    pub inputs: StepInputs<'a>,
}

/// What a robot gets in a step: [`Inputs`](staya_controller::agent::Inputs) as the link carries them. Terrain and inbox stay in the
/// buffer that they were received in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepInputs<'a> {
    /// The host's count of steps, for people who read reports.
    pub tick: u32,
    /// The time of the step.
    pub now: Instant,
    /// Own state.
    pub pose: Pose<f32>,
    /// Own state on the grid.
    pub cell: Option<CellState>,
    /// Terrain in sight.
    #[serde(borrow)]
    pub land: Option<Land<'a>>,
    /// Surroundings in the plane or in space.
    #[serde(borrow)]
    pub around: Option<Around<'a>>,
    /// What the radio delivered.
    pub inbox: &'a [u8],
}

/// A [`Window`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Land<'a> {
    /// The south-west cell.
    pub origin: Cell,
    /// Cells from west to east.
    pub width: u16,
    /// Cells from south to north.
    pub height: u16,
    /// Impassabilities, row by row from the south-west corner.
    pub cells: &'a [u8],
}

impl<'a> From<Window<'a>> for Land<'a> {
    fn from(window: Window<'a>) -> Self {
        Self {
            origin: window.origin(),
            width: window.width(),
            height: window.height(),
            cells: window.cells(),
        }
    }
}

impl<'a> Land<'a> {
    /// The window; `None` unless there are as many cells as width and height say.
    #[must_use]
    pub fn window(&self) -> Option<Window<'a>> {
        Window::new(self.cells, self.origin, self.width, self.height)
    }
}

/// [`Surroundings`](staya_controller::agent::Surroundings) with packed obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Around<'a> {
    /// How fast the body can go where it is, m/s.
    pub max_speed_mps: f32,
    /// Where in its cell the robot is.
    pub in_cell: Option<InCell<f32>>,
    /// [`OBSTACLE`] bytes each, see [`pack`].
    pub obstacles: &'a [u8],
}

impl Around<'_> {
    /// The obstacles in the device's own numbers; `None` for one of no known shape. What is left over at the end is
    /// [`Around::is_whole`]'s matter.
    pub fn obstacles<S: Scalar>(&self) -> impl Iterator<Item = Option<Obstacle<S>>> {
        let (packed, _) = self.obstacles.as_chunks();
        packed.iter().map(unpack)
    }

    /// Whether the packed obstacles end where the last one does.
    #[must_use]
    pub const fn is_whole(&self) -> bool {
        let (_, rest) = self.obstacles.as_chunks::<OBSTACLE>();
        rest.is_empty()
    }
}

/// An obstacle as its shape's number (0 wall, 1 ball, 2 plane) and four `f32`, little-endian.
#[must_use]
pub fn pack(obstacle: &Obstacle<f32>) -> [u8; OBSTACLE] {
    let (shape, numbers) = match *obstacle {
        Obstacle::Wall([a, b]) => (0, [a.x, a.y, b.x, b.y]),
        Obstacle::Ball { center_m, radius_m } => {
            (1, [center_m.x, center_m.y, center_m.z, radius_m])
        }
        Obstacle::Plane { normal, distance_m } => (2, [normal.x, normal.y, normal.z, distance_m]),
    };
    let [a, b, c, d] = numbers.map(f32::to_le_bytes);
    let mut packed = [shape; OBSTACLE];
    let bytes = a.into_iter().chain(b).chain(c).chain(d);
    for (to, from) in packed.iter_mut().skip(1).zip(bytes) {
        *to = from;
    }
    packed
}

/// The inverse of [`pack`], in any kind of number; `None` for a shape that is not known. No number becomes 0.
#[must_use]
pub fn unpack<S: Scalar>(packed: &[u8; OBSTACLE]) -> Option<Obstacle<S>> {
    let (shape, numbers) = packed.split_first()?;
    let ([a, b, c, d], _) = numbers.as_chunks::<4>() else {
        return None;
    };
    let [a, b, c, d] = [a, b, c, d].map(|bytes| {
        let value = f32::from_le_bytes(*bytes);
        S::from_f32(value).unwrap_or(S::ZERO)
    });
    match shape {
        0 => Some(Obstacle::Wall([Vec2::new(a, b), Vec2::new(c, d)])),
        1 => Some(Obstacle::Ball {
            center_m: Vec3::new(a, b, c),
            radius_m: d,
        }),
        2 => Some(Obstacle::Plane {
            normal: Vec3::new(a, b, c),
            distance_m: d,
        }),
        _ => None,
    }
}

/// The kind of number that a device computes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NumberFormat {
    /// `f32`.
    F32,
    /// Q16.16.
    Q16,
}

/// Device: this is what I am. Also said once after each start, then without a token.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Of the greeting that this answers; `None` if nobody has greeted since the device started.
    pub token: Option<Token>,
    /// Another one after each start, if the part's memory allows.
    pub boot: u32,
    /// Rate of [`Cost::ticks`], per second.
    pub ticks_per_second: u32,
    /// What it computes with.
    pub number: NumberFormat,
    /// What it has room for.
    pub capacities: Capacities,
    /// Which part it is, such as `stm32f405`.
    pub part: String<24>,
    /// Which firmware it runs.
    pub firmware: String<32>,
}

/// Device: I am that robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configured {
    /// Of the request.
    pub seq: u16,
    /// Fingerprint of the robot's state.
    pub digest: u64,
}

/// Device: this is what I decided.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stepped {
    /// Of the request.
    pub seq: u16,
    /// What must be the same on every device.
    pub report: Report,
    /// What differs between devices.
    pub cost: Cost,
}

/// A decision and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// What the step gave.
    pub outputs: Outputs<f32>,
    /// What the robot is doing.
    pub mode: Mode,
    /// Whom it follows.
    pub leader: RobotId,
    /// Where it is going.
    pub target: Option<Cell>,
    /// Fingerprint of its state after the step.
    pub digest: u64,
}

impl Report {
    /// Whether both say the same to the last bit (`==` takes the two zeros for equal).
    #[must_use]
    pub fn is_identical(&self, other: &Self) -> bool {
        let bytes = |report: &Self| {
            let mut frame = crate::frame::Frame::<MAX_ANSWER>::new();
            frame.fill(kind::STEPPED, report).map(|()| frame)
        };
        match (bytes(self), bytes(other)) {
            (Ok(a), Ok(b)) => a.bytes() == b.bytes(),
            _ => false,
        }
    }
}

/// What a step cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cost {
    /// Ticks of the device's clock, see [`Hello::ticks_per_second`].
    pub ticks: u32,
    /// Bytes of stack that the step touched.
    pub stack_bytes: u32,
}

/// Why a device cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultKind {
    /// A step before [`Configure`]: the device has started anew, or nobody told it what to be.
    NotConfigured,
    /// A step went missing: its `seq` is ahead by more than one.
    Gap,
    /// What was asked does not fit the device.
    Capacity,
    /// The setup makes no sense to the device.
    Setup,
    /// A sound frame whose body cannot be read.
    Malformed,
    /// Another version of the link.
    Version,
    /// The firmware panicked and restarts.
    Panic,
}

/// Device: I cannot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Of the request; of no meaning for [`FaultKind::Panic`] and [`FaultKind::Version`].
    pub seq: u16,
    /// Why.
    pub kind: FaultKind,
    /// Why, for people.
    pub text: String<80>,
}
