//! MAVLink on the host.
//!
//! [`bridge`] shows a simulated swarm to ground stations and scripts, [`companion`] is the controller beside autopilots, [`formation`]
//! gives a swarm another shape and goal. All speak over [`Lines`]: an [`Endpoint`] names a line as other MAVLink programs do, [`Lines`]
//! opens any number of them and gives whole frames, [`Tlog`] keeps them; [`geo`] is where metres become degrees.

pub mod bridge;
pub mod cli;
pub mod companion;
mod endpoint;
pub mod formation;
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
pub use tlog::{Tlog, TlogError};
pub use traffic::Counts;
