//! Runs one scenario on several ranks, bit for bit as on one.
//!
//! Every rank has the scenario and an [`Engine`](staya_sim::engine::Engine) with the robots in its
//! block of the world, for which it decides. In each tick it exchanges with its neighbours the
//! packets that cross a border (`radio/border.rs`), bodies near the border with their moves
//! (`world/border.rs`), and possible collisions. Everything else about the whole run is a sum.
//! Robots move with their whole state to the rank of their position.
//!
//! Packet losses and the order of moves are functions of (seed, robot, tick), and the trace hash is
//! a sum over robots, so the assignment of robots to ranks does not matter.

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
pub use run::{Ended, Sharing, check, remark, simulate_on};
pub use threads::Threads;
