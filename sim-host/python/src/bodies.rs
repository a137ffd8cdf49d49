//! The bodies of a scenario on the grid, without controllers.

use crate::simulation::scenario_error;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::sync::MutexExt as _;
use staya_controller::agent::Command;
use staya_controller::grid::{Cell, Dir};
use staya_sim::engine::Grid;
use staya_sim::scenario::{Movement, Overrides, Scenario};
use staya_sim::world::World;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Bodies that move from cell to cell, for comparisons with other simulators.
#[pyclass(frozen, module = "staya._staya")]
pub struct GridBodies {
    /// With the next tick.
    world: Mutex<(World, u32)>,
}

#[pymethods]
impl GridBodies {
    /// The bodies of the scenario in the file `path` at their starts.
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let scenario = Scenario::load(&path, &Overrides::default()).map_err(|error| scenario_error(&error))?;
        let Movement::Cells(rules) = scenario.movement else {
            return Err(scenario_error(&"the robots are not in cells"));
        };
        let grid = Grid::new(&scenario, rules).map_err(|error| scenario_error(&error))?;
        Ok(Self { world: Mutex::new((grid.world, 0)) })
    }

    /// Runs one tick. `wishes`: a move (x, y) of each robot; others than those to the eight
    /// neighbours mean staying. Returns the cells (x, y).
    fn step<'py>(&self, py: Python<'py>, wishes: PyReadonlyArray2<'py, i16>) -> PyResult<Bound<'py, PyArray2<i16>>> {
        let mut world = self.world.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (world, tick) = &mut *world;
        let mut commands = vec![Command::Hold; world.bodies().len()];
        for (command, &[x, y]) in commands.iter_mut().zip(wishes.as_slice()?.as_chunks().0) {
            let dir = Dir::between(Cell::default(), Cell::new(x, y)).unwrap_or_default();
            *command = Command::Move([dir].into());
        }
        world.advance(*tick, &commands);
        *tick += 1;
        let cells: Vec<_> = world.bodies().iter().map(|body| vec![body.cell.x, body.cell.y]).collect();
        Ok(PyArray2::from_vec2(py, &cells)?)
    }
}
