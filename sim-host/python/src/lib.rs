//! Staya for Python: the module `staya._staya`, which the package in `python/staya` puts into words. Arguments come checked from
//! there: arrays are contiguous, of the right shape, and finite.
//!
//! `simulation` runs scenarios, `behaviors` has the controller's behaviours by themselves, over all robots at once.
#![cfg(feature = "module")]

pub mod behaviors;
pub mod simulation;
mod trace;

use pyo3::prelude::*;

/// The module.
#[pymodule]
mod _staya {
    #[pymodule_export]
    use super::behaviors::flock::{boids_steer, goal_wish, lattice_acceleration};
    #[pymodule_export]
    use super::behaviors::orca::Avoiders;
    #[pymodule_export]
    use super::behaviors::route::route;
    #[pymodule_export]
    use super::simulation::{Run, ScenarioError};
}
