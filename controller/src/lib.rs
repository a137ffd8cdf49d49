#![doc = include_str!("../README.md")]
//! ## Layers
//!
//! Modules use only modules of an earlier layer:
//!
//! 1. Numbers, geometry, names and ids: [`names`], [`scalar`], [`geom`], [`time`], [`rand`],
//!    [`grid`], [`cost`], [`shuffle`], [`obstacle`], [`land`], [`robot`], [`auth`].
//! 2. State of the own robot and of its neighbours, parameters: [`body`], [`neighbor`],
//!    [`mod@parameters`], [`template`], [`wire`].
//! 3. Behaviours, which never import each other: [`route`], [`formation`], [`orca`], [`flock`],
//!    [`push_out`].
//! 4. Composition: [`supervisor`], [`agent`].
#![no_std]
// The lists of laws and layers import what their lines need.
#![cfg_attr(not(feature = "lists"), allow(unused_imports))]
// Code that may panic is denied on a robot and allowed in tests.
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

#[cfg(feature = "host")]
extern crate alloc;
#[cfg(test)]
extern crate std;

#[cfg(feature = "agent")]
pub mod agent;
#[cfg(any(feature = "negotiation", feature = "wire"))]
mod array;
#[cfg(feature = "auth")]
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod auth;
pub mod body;
pub mod cost;
pub mod digest;
mod fixint;
pub mod geom;
pub mod grid;
#[cfg(any(feature = "route", feature = "wire"))]
pub mod land;
#[cfg(feature = "agent")]
mod law;
#[cfg(any(feature = "flock", feature = "formation", feature = "negotiation", feature = "route"))]
mod laws;
mod list;
pub mod names;
pub mod neighbor;
pub mod obstacle;
#[cfg(feature = "orca")]
pub mod orca;
pub mod parameters;
#[cfg(feature = "push_out")]
pub mod push_out;
pub mod rand;
pub mod robot;
#[cfg(feature = "agent")]
mod safety;
pub mod scalar;
pub mod shuffle;
pub mod supervisor;
pub mod template;
pub mod time;
#[cfg(feature = "wire")]
// Decoded values come from the radio: each addition is meant to wrap or cannot overflow.
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod wire;

#[cfg(feature = "formation")]
pub use laws::formation;
#[cfg(feature = "negotiation")]
pub use laws::negotiation;
#[cfg(feature = "route")]
pub use laws::route;
#[cfg(feature = "flock")]
pub use laws::{boids, flock, goal_flock, lattice};

const _: () = {
    const fn is_error<E: core::error::Error>() {}
    is_error::<template::TemplateError>();
    #[cfg(feature = "wire")]
    {
        is_error::<wire::DecodeError>();
        is_error::<wire::EncodeError>();
        is_error::<wire::SendError>();
    }
    #[cfg(feature = "agent")]
    {
        is_error::<agent::BadInput>();
        is_error::<agent::PartError>();
        is_error::<agent::WrongTask>();
    }
};

#[cfg(all(test, debug_assertions))]
mod tests {
    #[test]
    #[should_panic(expected = "overflow")]
    fn tests_run_with_overflow_checks() {
        core::hint::black_box(core::hint::black_box(u8::MAX) + 1);
    }
}
