//! The simulator as a library: a world, a lossy radio and any number of controllers between them.
//!
//! [`scenario`] reads what to simulate, [`terrain`] the land, [`engine`] runs every robot's
//! [`staya_controller::agent::Agent`] through two-phase ticks over [`world`] and [`radio`],
//! [`metrics`] measures, [`record`] keeps what happened, [`checkpoint`] what it takes to go on later,
//! [`summary`] has the figures, [`expected`] says how long a run will take. [`nearby`] tells who is near whom, [`walk`] lets
//! one robot walk, [`key`] reads the secret of a swarm.

pub mod checkpoint;
pub mod engine;
pub mod expected;
pub mod file;
pub mod key;
pub mod metrics;
pub mod nearby;
pub mod radio;
pub mod record;
pub mod scenario;
pub mod summary;
pub mod terrain;
pub mod walk;
pub mod world;
