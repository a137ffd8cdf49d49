//! The messages. The order and the types of the fields are the wire format (postcard): a change is a new
//! [`VERSION`](crate::frame::VERSION).
//!
//! Numbers are `f32` in SI units, whatever the device computes with; the device casts them to its own kind of number
//! and back, and the host's shadow of the device does the same. That both decide alike shows in the digest of their states, which
//! covers the device's own numbers.

use crate::capacities::Capacities;
use crate::surroundings::{PackedSurroundings, TerrainWindow};
use heapless::String;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{CellState, KinematicState, Outputs, Setup, Task};
use staya_controller::grid::Cell;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::time::Instant;

/// Bytes of a frame from the device, at most: delimiters included (a test fills one).
pub const MAX_ANSWER: usize = 512;
/// Bytes of what is in a [`Configure`], at most: overhead included (a test fills one).
pub const MAX_CONFIGURE: usize = 640;

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
    /// What it has to do, if anything. The rest of the frame is the guidance law, if it is one of somebody's [own](crate::own).
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
    pub state: KinematicState<f32>,
    /// Own state on the grid.
    pub cell: Option<CellState>,
    /// Terrain in sight.
    #[serde(borrow)]
    pub window: Option<TerrainWindow<'a>>,
    /// Surroundings in the plane or in space.
    #[serde(borrow)]
    pub surroundings: Option<PackedSurroundings<'a>>,
    /// What the radio delivered.
    pub inbox: &'a [u8],
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
    pub result: StepResult,
    /// What differs between devices.
    pub cost: Cost,
}

/// A decision and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepResult {
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

impl StepResult {
    /// Whether both say the same to the last bit (`==` takes the two zeros for equal).
    #[must_use]
    pub fn is_identical(&self, other: &Self) -> bool {
        let bytes = |result: &Self| {
            let mut frame = crate::frame::Frame::<MAX_ANSWER>::new();
            frame.fill(kind::STEPPED, result).map(|()| frame)
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
