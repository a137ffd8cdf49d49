//! The module `staya._staya`; the package in `python/staya` provides its interface and checks all
//! arguments (arrays are contiguous, finite and of the right shape). `simulation` runs scenarios,
//! `bodies` their bodies alone; `behaviors` applies single behaviours to all robots at once, with
//! the values that `settings` reads.

#[cfg(feature = "module")]
pub mod behaviors;
#[cfg(feature = "module")]
pub mod bodies;
#[cfg(feature = "module")]
mod pool;
pub mod settings;
#[cfg(feature = "module")]
pub mod simulation;
#[cfg(feature = "module")]
mod trace;

#[cfg(feature = "module")]
use pyo3::prelude::*;

#[cfg(feature = "module")]
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
