//! MAVLink on the host.
//!
//! - `bridge` connects a simulated swarm to ground stations and scripts.
//! - [`companion`] runs controllers next to real autopilots.
//! - `formation` sends a new shape and goal to a swarm.
//!
//! All of them use `Lines`, which opens links (`Endpoint`) and returns whole frames. `Tlog` records
//! frames, and `geo` converts metres to degrees.

mod boot;
mod bridge;
pub mod cli;
pub mod companion;
mod endpoint;
mod formation;
mod framed;
pub mod geo;
mod inbox;
mod lines;
mod reassembly;
mod stream;
mod terminal;
mod tlog;
mod traffic;
mod udp;

use endpoint::Endpoint;
use inbox::{Peer, Received};
use lines::Lines;
use tlog::Tlog;
use traffic::Counts;
