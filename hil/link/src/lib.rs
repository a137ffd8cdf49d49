//! The protocol between a host that simulates the world and a device that runs the controller.
//! Start with [`session`].
//!
//! In each tick the host sends [`message::Step`] (sensor readings and received packets). The device
//! answers with [`message::Stepped`] (command, packets to send, digest of its state). Both ends are
//! state machines without I/O: [`session::Session`] on the device and [`port::Port`] on the host.
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
//! The host resends its one outstanding request until it is answered. The device answers a repeated
//! `seq` with identical bytes and does not execute the request again, so a line that loses,
//! duplicates, delays, reorders or damages frames changes no result. A device that cannot execute a
//! request answers with a [`message::Fault`].
#![no_std]
// Code that may panic is forbidden in firmware, but allowed in tests.
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
