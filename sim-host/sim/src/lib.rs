//! The simulator as a library: a world, a lossy radio, and any number of robot controllers.
//!
//! | module | content |
//! | --- | --- |
//! | [`scenario`] | reads and checks simulation inputs |
//! | [`terrain`] | terrain maps: readers, generators, changes |
//! | [`engine`] | steps each [`staya_controller::agent::Agent`] in two-phase ticks |
//! | [`world`], [`radio`] | bodies and their motion; transmission of packets |
//! | [`metrics`], [`summary`] | measurements and the results of a run |
//! | [`record`], [`checkpoint`] | result files; saving and resuming a run |
//! | [`expected`] | prediction of the remaining ticks |
//! | [`nearby`], [`walk`] | neighbour search; simulation of a single robot |
//! | [`voxel`] | models in files that replace ORCA's formula |
//! | [`key`] | files with the secret key of a swarm |
//! | [`shown`] | names and messages without control characters |

pub mod checkpoint;
pub mod engine;
pub mod expected;
pub mod file;
pub mod key;
pub mod metrics;
pub mod nearby;
mod own_law;
pub mod radio;
pub mod record;
pub mod remembered;
pub mod scenario;
pub mod shown;
pub mod summary;
pub mod terrain;
pub mod voxel;
pub mod walk;
pub mod words;
pub mod world;
