//! The MAVLink bridge of the simulation: every robot appears as a vehicle to ground stations and
//! scripts.
//!
//! [`Swarm`] runs a scenario in real time; `Vehicle` is one robot's side of the protocol, without
//! sockets or a clock. A command becomes a goal of the robot's controller
//! ([`Guided`](staya_controller::agent::Guided)), so the safety layer still applies.

mod budget;
mod commands;
mod files;
mod guided;
mod items;
mod mission;
mod model;
mod ordered;
mod params;
mod report;
mod streams;
mod swarm;
mod telemetry;
#[cfg(test)]
mod test_support;
mod vehicle;

pub use report::{BridgeReport, LineReport, Refused};
pub use swarm::{Options, Swarm};
