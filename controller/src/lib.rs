//! Onboard control of a robot in a swarm.
//!
//! The robot's brain is a pure function of what it has sensed and received: [`agent::Agent::step`]
//! takes the time, the own pose, a window of terrain and the bytes that the radio delivered, and
//! returns a motion command, bytes to send, events and the time of the next call. It never
//! allocates, never panics, never blocks, reads no clock and keeps no statics, so that the same
//! code gives the same bits on a microcontroller, in a simulator and beside an autopilot.
//!
//! Layers point down only:
//! numbers and geometry ([`scalar`], [`geom`], [`time`], [`rand`], [`grid`], [`cost`], [`shuffle`],
//! [`obstacle`])
//! < what is known of others and of oneself ([`wire`], [`neighbor`], [`body`])
//! < behaviours ([`route`], [`formation`], [`orca`], [`flock`], [`push_out`]; they never import each other)
//! < composition ([`supervisor`], [`agent`]).
#![no_std]
// What may panic has no place on a robot (see Cargo.toml); tests may.
#![cfg_attr(
    test,
    allow(
        clippy::indexing_slicing,
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::integer_division_remainder_used,
        clippy::std_instead_of_alloc,
        clippy::std_instead_of_core
    )
)]

#[cfg(test)]
extern crate std;

pub mod agent;
pub mod auth;
pub mod body;
pub mod cost;
pub mod digest;
mod fixint;
pub mod flock;
pub mod formation;
pub mod geom;
pub mod grid;
mod list;
pub mod neighbor;
pub mod obstacle;
pub mod orca;
pub mod push_out;
pub mod rand;
pub mod robot;
pub mod route;
pub mod scalar;
pub mod shuffle;
pub mod supervisor;
pub mod template;
pub mod time;
pub mod wire;
