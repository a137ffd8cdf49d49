//! The host side of Staya: a world, a lossy radio and any number of controllers between them.
//!
//! [`scenario`] reads what to simulate, [`terrain`] the land, [`engine`] runs every robot's
//! [`staya_controller::agent::Agent`] through two-phase ticks over [`world`] and [`radio`],
//! [`metrics`] measures, [`record`] keeps what happened, [`plot`] draws it, [`experiment`]
//! reproduces papers, [`mavlink`] is the edge to autopilots and ground stations, [`companion`] the controller beside
//! autopilots, [`cli`] is the command `staya`.

pub mod bridge;
pub mod cli;
pub mod companion;
pub mod engine;
pub mod experiment;
mod file;
pub mod hil;
pub mod key;
pub mod mavlink;
pub mod metrics;
pub mod nearby;
pub mod plot;
pub mod radio;
pub mod record;
pub mod scenario;
pub mod stats;
pub mod terrain;
pub mod world;
