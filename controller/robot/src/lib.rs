#![doc = include_str!("../README.md")]
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

pub mod drive;
pub mod odometry;
pub mod radio;
pub mod scan;
