#![doc = include_str!("../README.md")]
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

mod file;
mod model;
mod orca;
#[cfg(test)]
mod tests;

pub use file::{FileError, HEADER_LEN, Header, VERSION, checksum};
pub use model::{Local, Model, ModelIn};
pub use orca::{PROBES, VoxelInSpace, VoxelNeighbor, VoxelNeighborIn, obstacles, velocity_half_plane};
