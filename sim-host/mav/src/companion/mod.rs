//! The companion: one controller per vehicle with a real autopilot, from telemetry to velocities.
//!
//! The behaviour of the swarm is a scenario in the plane, as for `staya run`. [`Config`] adds the
//! geographic position and assigns vehicles to robots. `OffboardStateMachine` speaks MAVLink to an
//! autopilot, `Controller` is the agent, `Medium` connects companions, `run` is the main loop.

mod config;
mod controller;
mod kind;
mod medium;
mod offboard;
mod report;
mod roll;
mod run;
mod seal;
mod twins;

pub use config::Config;
pub(crate) use run::Vehicle;
pub use run::{Options, Sight, run};
