//! Runs one scenario on several ranks, with the bits of a run on one.
//!
//! Every rank has the scenario and an [`Engine`](staya_sim::engine::Engine) with the robots in its
//! block of the world. In each tick it decides for these robots. It exchanges with its neighbours
//! the packets that cross a border (`radio/border.rs`), bodies near the border with their moves
//! (`world/border.rs`), and possible collisions. Everything else about the whole run is a sum.
//!
//! Packet losses and the order of moves are functions of (seed, robot, tick), and the trace hash is
//! a sum over robots, so the assignment of robots to ranks does not matter. Robots move with their
//! whole state to the rank of their position.
//!
//! [`Exchange`] connects ranks: MPI in the program `staya-mpi`, channels between threads
//! ([`Threads`]) in tests.

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
