//! The simulated swarm seen from outside: every robot is a MAVLink vehicle, for ground stations and scripts.
//!
//! [`Vehicle`] is one robot's side of the protocol, without sockets or a clock; [`Swarm`] runs a scenario in real time between vehicles and lines.
//! An operator's wish reaches the robot's controller ([`Commanded`](staya_controller::agent::Commanded)), where the safety layer stays behind
//! it; nobody's state is changed from outside.

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
mod testing;
mod vehicle;

pub use model::{FlightMode, Sample, VehicleModel};
pub use params::{Meaning, NotSet, Parameters};
pub use report::{BridgeReport, LineReport, Refused};
pub use streams::Streams;
pub use swarm::{BridgeError, Options, Swarm};
pub use vehicle::{Action, Out, Vehicle};
