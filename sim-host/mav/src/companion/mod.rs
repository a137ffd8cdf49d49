//! The controller beside autopilots: one agent per vehicle, position and velocity from its telemetry, velocity setpoints to it.
//!
//! What the swarm does is a scenario in the plane, the same file that `staya run` simulates; [`Config`] adds where on the Earth that is, and which robot is
//! which vehicle. [`OffboardStateMachine`] is what a companion owes its autopilot, [`Controller`] the agent beside it, [`Medium`] carries packets
//! between companions, and [`run`] is the loop around all of them.

mod config;
mod controller;
mod kind;
mod medium;
mod offboard;
#[cfg(test)]
mod replay;
mod report;
mod roll;
mod run;
mod seal;

pub use config::{Config, VehicleSetup};
pub use controller::{Body, Controller};
pub use kind::Kind;
pub use medium::{Medium, MediumError, MediumSetup};
pub use offboard::{AUTOPILOT, COMPONENT, Entry, Event, Fix, OffboardCounters, OffboardStateMachine, Rules, State};
pub use report::{CompanionReport, VehicleReport};
pub use run::{Options, RunError, Seen, Sight, run};
pub use seal::{Seal, SealError};
