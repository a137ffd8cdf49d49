//! The messages. Order and types of the fields are the wire format (postcard): any change needs a
//! new [`VERSION`](crate::frame::VERSION).
//!
//! Numbers on the wire are `f32` in SI units; a device, and the host's shadow of it, convert them
//! to and from its own number format, which digests cover.

use crate::capacities::Capacities;
use crate::surroundings::{PackedSurroundings, TerrainWindow};
use heapless::String;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{CellState, KinematicState, Outputs, Setup, Task};
use staya_controller::grid::Cell;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::NumberFormat;
use staya_controller::time::Instant;

/// Largest frame from the device, bytes, delimiters included. A test fills one.
pub const MAX_ANSWER: usize = 512;
/// Largest content of a [`Configure`] frame, bytes, overhead included. A test fills one.
pub const MAX_CONFIGURE: usize = 640;

/// Message kinds: below 0x80 from the host, otherwise from the device.
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

/// Identifies a session with one host, so that delayed frames of another session are recognised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Token {
    /// Drawn by the host at each start.
    pub run: u32,
    /// Number of the greeting within the run; wraps.
    pub number: u16,
}

/// Host: asks the device to introduce itself. A new token makes the device forget its robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Greeting {
    /// Token of the new session.
    pub token: Token,
}

/// Host: asks the device to reset. A device whose token differs only answers with [`Hello`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Restart {
    /// Token of the last greeting.
    pub token: Token,
}

/// Host: asks the device to become this robot, in its initial state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configure {
    /// Any number ahead of the previous request's.
    pub seq: u16,
    /// Configuration of the agent.
    pub setup: Setup,
    /// Initial task, if any. The rest of the frame is an [own](crate::own) guidance law, if any.
    pub task: Option<Task>,
}

/// Host: asks the device to execute a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step<'a> {
    /// Number of the previous request plus one.
    pub seq: u16,
    /// Sensor readings and received packets.
    #[serde(borrow)]
    pub inputs: StepInputs<'a>,
}

/// Inputs of one step: [`Inputs`](staya_controller::agent::Inputs), borrowed from the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepInputs<'a> {
    /// The host's step count, for reports only.
    pub tick: u32,
    /// Time of the step.
    pub now: Instant,
    /// The robot's own state.
    pub state: KinematicState<f32>,
    /// The robot's own state on the grid.
    pub cell: Option<CellState>,
    /// Terrain in view.
    #[serde(borrow)]
    pub window: Option<TerrainWindow<'a>>,
    /// Surroundings in the plane or in space.
    #[serde(borrow)]
    pub surroundings: Option<PackedSurroundings<'a>>,
    /// Packets that the radio delivered.
    pub inbox: &'a [u8],
}

/// Device: introduces itself, in answer to a greeting and, without a token, once after each start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Token of the greeting that this answers; `None` if there was none since the start.
    pub token: Option<Token>,
    /// Start number. Differs after each start if the part's memory allows.
    pub boot: u32,
    /// Rate of [`Cost::ticks`], per second.
    pub ticks_per_second: u32,
    /// Number format of its arithmetic.
    pub number: NumberFormat,
    /// Its capacities.
    pub capacities: Capacities,
    /// Name of the part, such as `stm32f405`.
    pub part: String<24>,
    /// Name of the firmware.
    pub firmware: String<32>,
}

/// Device: confirms [`Configure`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configured {
    /// Number of the request.
    pub seq: u16,
    /// Digest of the robot's state.
    pub digest: u64,
}

/// Device: result of a [`Step`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stepped {
    /// Number of the request.
    pub seq: u16,
    /// The part that must be identical on every device.
    pub result: StepResult,
    /// The part that differs between devices.
    pub cost: Cost,
}

/// Outputs of a step and the agent's state after it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepResult {
    /// Command and packets.
    pub outputs: Outputs<f32>,
    /// The agent's mode.
    pub mode: Mode,
    /// The robot that it follows.
    pub leader: RobotId,
    /// The cell that it moves to.
    pub target: Option<Cell>,
    /// Digest of the agent's state after the step.
    pub digest: u64,
}

impl StepResult {
    /// Whether both are bitwise identical (`==` considers 0.0 and -0.0 equal).
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

/// Time and memory that a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cost {
    /// Ticks of the device's clock; see [`Hello::ticks_per_second`].
    pub ticks: u32,
    /// Bytes of stack that the step touched.
    pub stack_bytes: u32,
}

/// Reason why a device cannot execute a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultKind {
    /// A step before [`Configure`]: the device has restarted or was never configured.
    NotConfigured,
    /// A step is missing: its `seq` is ahead by more than one.
    Gap,
    /// The inputs or the setup exceed the device's capacities.
    Capacity,
    /// The device cannot use the setup.
    Setup,
    /// An intact frame whose body cannot be parsed.
    Malformed,
    /// A frame of another link version.
    Version,
    /// The firmware panicked and restarts.
    Panic,
}

/// Device: reports that it cannot execute a request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Number of the request; meaningless for [`FaultKind::Panic`] and [`FaultKind::Version`].
    pub seq: u16,
    /// Machine-readable reason.
    pub kind: FaultKind,
    /// Human-readable reason.
    pub text: String<80>,
}
