//! MAVLink on the host.
//!
//! - [`bridge`] connects a simulated swarm to ground stations and scripts.
//! - [`companion`] runs controllers next to real autopilots.
//! - [`formation`] sends a new shape and goal to a swarm.
//!
//! All of them use [`Lines`], which opens links ([`Endpoint`]) and returns whole frames. [`Tlog`]
//! records frames, and [`geo`] converts metres to degrees.

pub mod bridge;
pub mod cli;
pub mod companion;
mod endpoint;
pub mod formation;
mod framed;
pub mod geo;
mod inbox;
mod lines;
mod stream;
mod tlog;
mod traffic;
mod udp;

pub use endpoint::{Endpoint, EndpointError};
pub use inbox::{Peer, Received};
pub use lines::{Lines, OpenError};
pub use tlog::Tlog;
pub use traffic::Counts;
