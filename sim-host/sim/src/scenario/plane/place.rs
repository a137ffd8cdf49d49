//! Where robots are at first, and where they are to go.

use serde::{Deserialize, Serialize};

/// Where a robot starts and what it is told.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// World position, metres.
    pub position_m: [f64; 3],
    /// World velocity, m/s.
    pub velocity_mps: [f64; 3],
    /// The places it is told to go to.
    pub places: Vec<Target>,
    /// Its group in [`PlaneSetup::groups`](super::PlaneSetup::groups); `None`: the general one.
    pub group: Option<usize>,
}

/// A place to go to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Where it is at the start of the run, or of an order, metres.
    pub position_m: [f64; 3],
    /// How it moves, m/s.
    pub velocity_mps: [f64; 3],
}
