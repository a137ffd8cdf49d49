//! The companion: one controller per vehicle with a real autopilot, from telemetry to velocities.
//!
//! The behaviour of the swarm is a scenario in the plane, as for `staya run`. [`Config`] adds the
//! geographic position and assigns vehicles to robots. [`OffboardStateMachine`] speaks MAVLink to
//! an autopilot, [`Controller`] is the agent, [`Medium`] connects companions, [`run`] is the main
//! loop.

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
pub use offboard::{AUTOPILOT, Entry, Event, Fix, OffboardCounters, OffboardStateMachine, Rules, State};
pub use report::{CompanionReport, VehicleReport};
pub use run::{Options, RunError, Seen, Sight, run};
pub use seal::{Seal, SealError};
