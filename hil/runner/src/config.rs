use crate::line::LineFaults;
use staya_controller::agent::{Setup, Task};
use staya_controller::scalar::{Fast32, Q16};
use staya_link::robot::{Controller, Large, LargeIn, Small};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Configuration of one device.
#[derive(Clone, Debug)]
pub struct DeviceConfig {
    /// The device as text; see [`Device`](crate::Device).
    pub device: String,
    /// The robot's setup.
    pub setup: Setup,
    /// The robot's initial task.
    pub task: Option<Task>,
    /// A user-defined guidance law in postcard format; empty for a built-in law.
    pub law: Vec<u8>,
    /// Simulated faults of the line.
    pub faults: LineFaults,
    /// Scheduled resets of the device.
    pub resets: Vec<Reset>,
}

/// A scheduled reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reset {
    /// The step that the reset replaces.
    pub tick: u32,
    /// Steps in which the robot is stationary, at least 1. Fixed, so that runs are reproducible.
    pub down_ticks: u32,
}

/// Creates a robot in this process.
pub type Shadow = fn() -> Box<dyn Controller + Send>;

/// Options of a fleet.
#[derive(Clone, Debug)]
pub struct Options {
    /// The output folder of `cargo xtask firmware`, or one ELF file for all emulated devices.
    pub firmware: PathBuf,
    /// Name that the firmware of all devices must have, such as `lockstep 0.1.0`; `None`: any.
    pub program: Option<String>,
    /// Candidate shadows, chosen by number format and capacities; by default all built-in laws.
    pub shadows: Vec<Shadow>,
    /// Folder for the logs of emulated devices, one file per robot; `None`: no logs.
    pub logs: Option<PathBuf>,
    /// Longest time before a request is resent, plus its transmission time
    /// ([`Port`](staya_link::port::Port)).
    pub resend_after: Duration,
    /// Timeout of a step.
    pub step_limit: Duration,
    /// Timeout of a start.
    pub start_limit: Duration,
    /// Distinguishes this run from others that have used the same devices.
    pub run: u32,
    /// Makes [`Fleet::collect`](crate::Fleet::collect) return at once with
    /// [`Cause::Stopped`](crate::Cause::Stopped) for all robots.
    pub stop: Arc<AtomicBool>,
}

impl Options {
    /// Requests are resent after 0.5 s; timeouts are 10 s for a step and 20 s for a start.
    #[must_use]
    pub fn new(firmware: PathBuf) -> Self {
        Self {
            firmware,
            program: None,
            shadows: vec![
                || Box::new(Large::new()),
                || Box::new(LargeIn::<Fast32>::new()),
                || Box::new(LargeIn::<Q16>::new()),
                || Box::new(Small::new()),
            ],
            logs: None,
            resend_after: Duration::from_millis(500),
            step_limit: Duration::from_secs(10),
            start_limit: Duration::from_secs(20),
            run: std::process::id(),
            stop: Arc::default(),
        }
    }
}
