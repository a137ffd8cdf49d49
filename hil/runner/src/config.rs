//! The configuration of a fleet.

use crate::line::LineFaults;
use staya_controller::agent::{Setup, Task};
use staya_link::robot::{Controller, Large, Small};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// What one device is to be.
#[derive(Clone, Debug)]
pub struct DeviceConfig {
    /// Where, for people; see [`Device`](crate::Device).
    pub device: String,
    /// What the robot is.
    pub setup: Setup,
    /// What it has to do.
    pub task: Option<Task>,
    /// The guidance law if it is one of somebody's own, as postcard writes it; otherwise empty.
    pub law: Vec<u8>,
    /// What the line does to frames.
    pub faults: LineFaults,
    /// When the device starts anew.
    pub resets: Vec<Reset>,
}

/// A reset on request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reset {
    /// In place of this step.
    pub tick: u32,
    /// For so many steps the robot stands; at least 1. How long the device really takes plays no part, so that runs
    /// repeat.
    pub down_ticks: u32,
}

/// Robots in this process, one of which computes as a device does.
pub type Shadows = fn() -> Vec<Box<dyn Controller + Send>>;

/// How a fleet is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// The folder that `cargo xtask firmware` writes to, or one ELF file for all emulated devices.
    pub firmware: PathBuf,
    /// What devices must say that they run, such as `lockstep 0.1.0`; `None`: anything.
    pub program: Option<String>,
    /// Among which a device's shadow is looked for, by its numbers and capacities: by default the robots that can have any law of Staya's.
    pub shadows: Shadows,
    /// The folder for the logs of emulated devices, one file per robot; `None`: no logs.
    pub logs: Option<PathBuf>,
    /// A request is sent again after this, and the time that the line takes for it, at the latest; a step sooner, by the round trips
    /// of steps before it ([`Port`](staya_link::port::Port)).
    pub resend_after: Duration,
    /// A step that takes longer is an error.
    pub step_limit: Duration,
    /// A start that takes longer is an error.
    pub start_limit: Duration,
    /// Tells this run from others that have talked to the same devices.
    pub run: u32,
    /// When this becomes true, [`Fleet::collect`](crate::Fleet::collect) ends at once and all its answers are
    /// [`Cause::Stopped`](crate::Cause::Stopped).
    pub stop: Arc<AtomicBool>,
}

impl Options {
    /// Requests are resent after half a second; 10 seconds for a step and 20 for a start.
    #[must_use]
    pub fn new(firmware: PathBuf) -> Self {
        Self {
            firmware,
            program: None,
            shadows: || vec![Box::new(Large::new()), Box::new(Small::new())],
            logs: None,
            resend_after: Duration::from_millis(500),
            step_limit: Duration::from_secs(10),
            start_limit: Duration::from_secs(20),
            run: std::process::id(),
            stop: Arc::default(),
        }
    }
}
