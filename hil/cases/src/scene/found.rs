//! Written by `cargo xtask size --search`.

use super::Radio::{self, Heard, Lost, Stale};
use super::{Robot, Scene};

const fn robot(at_mm: [i16; 2], velocity_mmps: [i16; 2], radius_mm: i16, mode: u8, radio: Radio) -> Robot {
    Robot { at_mm, velocity_mmps, radius_mm, mode, radio }
}

/// The scenes with the longest steps that the search found.
pub const FOUND: &[Scene] = &[
];
