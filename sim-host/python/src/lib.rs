//! The module `staya._staya`; the package in `python/staya` provides its interface and checks all
//! arguments (arrays are contiguous, finite and of the right shape). `simulation` runs scenarios,
//! `bodies` their bodies alone; `behaviors` applies single behaviours to all robots at once.
#![cfg(feature = "module")]

pub mod behaviors;
pub mod bodies;
mod pool;
pub mod simulation;
mod trace;

use pyo3::prelude::*;

#[pymodule]
mod _staya {
    #[pymodule_export]
    use super::behaviors::flock::{boids_steer, goal_wish, lattice_acceleration};
    #[pymodule_export]
    use super::behaviors::negotiation::Negotiators;
    #[pymodule_export]
    use super::behaviors::orca::Avoiders;
    #[pymodule_export]
    use super::behaviors::route::route;
    #[pymodule_export]
    use super::bodies::GridBodies;
    #[pymodule_export]
    use super::simulation::{Run, ScenarioError};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
