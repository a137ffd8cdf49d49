//! The contract between a host and a device that runs the controller, and nothing else. Read [`session`] first.
//!
//! The host knows the world; the device decides. In each tick the host sends [`message::Step`] (what the robot senses,
//! what its radio received) and the device answers with [`message::Stepped`] (what the robot does and says, and a
//! digest of its whole state). Both ends are state machines without I/O: [`session::Session`] on the device takes bytes
//! and gives bytes, [`port::Port`] on the host also takes the time.
//!
//! ```text
//! host                                   device
//!   Hello { token }             ->
//!                               <-       Hello { token, part, capacities, boot, .. }
//!   Configure { seq, setup, .. } ->
//!                               <-       Configured { seq, digest }
//!   Step { seq + 1, inputs }    ->
//!                               <-       Stepped { seq + 1, outputs, digest, cost }
//! ```
//!
//! One request is on its way at a time. The host resends it until it is answered; the device answers a repeated `seq`
//! with the very same bytes and decides nothing a second time, so that a line that loses, repeats, delays, reorders or
//! damages frames changes no result. What cannot go on is a [`message::Fault`] with its reason.
#![no_std]
// What may panic has no place on a robot; tests may.
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::integer_division_remainder_used,
        clippy::panic,
        clippy::std_instead_of_alloc,
        clippy::std_instead_of_core,
        clippy::string_slice,
        clippy::todo,
        clippy::unimplemented,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

#[cfg(test)]
extern crate std;

mod body;
pub mod capacities;
pub mod fit;
pub mod frame;
pub mod message;
pub mod own;
pub mod port;
pub mod refusal;
pub mod robot;
pub mod session;
pub mod surroundings;

#[cfg(test)]
mod tests;
