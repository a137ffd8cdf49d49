use crate::channel::OpenError;
use crate::device::DeviceError;
use crate::mismatch::Mismatch;
use crate::printable::printable;
use staya_controller::robot::RobotId;
use staya_link::fit::WindowTooLarge;
use staya_link::message::{Hello, StepResult};
use staya_link::port::PortError;

/// Result of a robot's step.
#[derive(Debug)]
pub enum Answer {
    /// Device and shadow decided alike.
    Decided(Box<StepResult>),
    /// The device has restarted: the robot is stationary in this step.
    Down,
    /// Device and shadow differ.
    Mismatch(Box<Mismatch>),
    /// The device has failed for good.
    Failed(FleetError),
}

/// Failure of a device.
#[derive(Debug, thiserror::Error)]
#[error("robot {} on {device}: {cause}", .robot.0)]
pub struct FleetError {
    /// The robot that runs on it.
    pub robot: RobotId,
    /// The device, in the notation of [`Device`](crate::Device).
    pub device: String,
    /// Reason of the failure.
    pub cause: Box<Cause>,
}

/// Reason of a device's failure.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum Cause {
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error(transparent)]
    Name(#[from] DeviceError),
    #[error("cannot start the thread that reads: {0}")]
    Thread(std::io::Error),
    #[error("{}", printable(.0))]
    Device(PortError),
    #[error(
        "{error}; {bytes} bytes arrived, and no message: check the baud rate and the cable, and that the board runs \
         Staya's firmware"
    )]
    Junk { error: PortError, bytes: u64 },
    #[error(
        "{error}; other messages arrived ({messages}): the device restarts again and again, or does not receive; check its \
         power supply and the line to it"
    )]
    Unheard { error: PortError, messages: u32 },
    #[error(
        "the device restarts again and again: {restarts} times after it was greeted; check its power supply, and its log \
         for a panic"
    )]
    Restarts { restarts: u32 },
    #[error("{0}")]
    Gone(String),
    #[error("the firmware is for `{}`, not for `{expected}`", printable(.said))]
    OtherPart { expected: &'static str, said: String },
    #[error("the firmware computes in `{said}`, not in `{expected}`; name the device with `numbers={said}`")]
    OtherNumbers { expected: &'static str, said: &'static str },
    #[error(
        "it runs `{}`, this program steps `{expected}`: build firmware and program from the same source, and flash the firmware again",
        printable(.said)
    )]
    OtherProgram { expected: String, said: String },
    #[error(
        "no robot in this process has the numbers and capacities of {0:?}: build firmware and host from the same source"
    )]
    NoShadow(Box<Hello>),
    #[error("after the same setup the device's state has the digest {device:016x}, that in this process {shadow:016x}")]
    Setup { device: u64, shadow: u64 },
    #[error("the robot in this process refuses: {0}")]
    Shadow(String),
    #[error(transparent)]
    Window(WindowTooLarge),
    #[error("a request of more than {0} bytes")]
    TooLong(usize),
    #[error("it is still busy with the last step: collect its answer first")]
    NotReady,
    #[error("it was given up before")]
    GivenUp,
    #[error("stopped")]
    Stopped,
}
