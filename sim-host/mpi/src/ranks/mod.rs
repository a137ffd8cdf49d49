//! One world over ranks: processes, each with its robots, that together make the run that one process makes, to the bit.
//!
//! Every rank has the scenario and an [`Engine`](super::Engine) with the robots in its block of the world. In each tick it decides for them, and exchanges
//! with its neighbours what can be heard over a border (`radio/border.rs`), who stands near it and where he wants to go
//! (`world/border.rs`), and who may have run into whom. All else that is of the whole is a sum. Fates of packets and the order
//! of moves are functions of (seed, robot, tick), and a run's fingerprint is a sum over robots, so it does not matter who has whom;
//! robots go, with all that they know, to where their packets are.
//!
//! [`Exchange`] is what connects ranks: MPI in the program `staya-mpi`, channels between threads ([`Threads`]) in tests.

mod cut;
mod exchange;
mod ground;
mod outcome;
mod region;
mod run;
mod saved;
mod share;
#[cfg(test)]
mod tests;
mod threads;
mod wire;

pub use exchange::{Exchange, Lost, RankError, Traffic};
pub use run::{Ended, Sharing, check, remark, simulate_on, simulate_on_from};
pub use threads::Threads;
