//! The controller beside autopilots: one agent per vehicle, position and velocity from its telemetry, velocity setpoints to it.
//!
//! What the swarm does is a scenario in the plane, the same file that `staya run` simulates; [`Config`] adds where on the Earth that is, and which robot is
//! which vehicle. [`Duties`] is what a companion owes its autopilot, [`Brain`] the agent beside it, [`Air`] carries packets
//! between companions, and [`run`] is the loop around all of them.

mod air;
mod brain;
mod config;
mod duties;
mod kind;
mod report;
mod run;
mod voice;

pub use air::{Air, AirError, AirSetup};
pub use brain::{Body, Brain};
pub use config::{Config, VehicleSetup};
pub use duties::{AUTOPILOT, COMPONENT, Duties, Entry, Event, Fix, Rules, State, Tally};
pub use kind::Kind;
pub use report::{Report, VehicleReport};
pub use run::{Options, RunError, run};
pub use voice::{Seal, Voice, VoiceError};
