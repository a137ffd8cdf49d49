//! MAVLink for swarms: the messages that robots and ground stations exchange, without `std` or an allocator.
//!
//! [`wire`] is the wire format of a robot that speaks MAVLink, [`any`] all of them in one. [`frame`] finds and makes frames in bytes. [`dialect`] is made by `mavlink-bindgen` from `messages/staya.xml` (Staya's own messages) and `messages/common.xml` (the part of the public ones that Staya speaks).

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
// The generated code asks for features that it does not need.
#![allow(unexpected_cfgs)]

#[cfg(test)]
extern crate std;

pub mod any;
// Numbers from the air: where one is added to, it is meant to wrap, or the reason is there why it cannot.
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod frame;
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod signed;
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod signing;
#[cfg_attr(not(test), warn(clippy::arithmetic_side_effects))]
pub mod wire;

/// What `mavlink-bindgen` made.
#[allow(
    missing_docs,
    unused_imports,
    unused_mut,
    unused_variables,
    non_camel_case_types,
    clippy::all,
    clippy::disallowed_methods,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::integer_division_remainder_used,
    reason = "generated"
)]
mod generated {
    include!(concat!(env!("OUT_DIR"), "/module.rs"));
}

pub mod constants;

pub use generated::dialect;
pub use mavlink_core;

/// Every public error is a [`core::error::Error`].
const _: () = {
    const fn is_error<E: core::error::Error>() {}
    is_error::<frame::Full>();
    is_error::<signing::SignError>();
};
