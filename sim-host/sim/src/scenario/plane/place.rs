//! Starts and goals of robots in the plane.

use serde::{Deserialize, Serialize};

/// Start state and goals of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// World position, metres.
    pub position_m: [f64; 3],
    /// World velocity, m/s.
    pub velocity_mps: [f64; 3],
    /// Places to visit, in order; for flocking laws, the goals.
    pub places: Vec<Target>,
    /// Index in [`PlaneSetup::groups`](super::PlaneSetup::groups); `None`: the general group.
    pub group: Option<usize>,
    /// Tick of the first decision; `None`: by [`Clocks::phases`](crate::scenario::Clocks::phases).
    pub phase_ticks: Option<u32>,
}

/// A goal, which may move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Position at the start of the run or of an order, metres.
    pub position_m: [f64; 3],
    /// Velocity, m/s.
    pub velocity_mps: [f64; 3],
}

impl Target {
    /// A goal at rest, metres.
    pub(super) const fn fixed(position_m: [f64; 3]) -> Self {
        Self { position_m, velocity_mps: [0.0; 3] }
    }
}
