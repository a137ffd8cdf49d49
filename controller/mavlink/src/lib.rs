//! MAVLink for swarms: the messages of robots and ground stations, without `std` or an allocator.
//!
//! [`wire`] is the wire format of a robot that uses MAVLink; [`any`] selects between all wire
//! formats. [`frame`] finds and encodes frames in bytes. [`dialect`] is the table of messages.

#![no_std]
// Code that may panic is not permitted on a robot, except in tests.
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

pub mod any;
// Received numbers: an addition is meant to wrap, or a comment states why it cannot overflow.
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod frame;
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod signed;
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod signing;
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod wire;

pub mod constants;
#[allow(
    missing_docs,
    non_camel_case_types,
    reason = "names as `mavlink-bindgen` gives them; XML files document fields"
)]
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod dialect;

pub use mavlink_core;

const _: () = {
    const fn is_error<E: core::error::Error>() {}
    is_error::<frame::Full>();
    is_error::<signing::SignError>();
};
