//! Windowed routing (A. V. Kuznetsov 2017) of many robots on one map, without interaction.

use super::refused;
use crate::{pool, settings};
use numpy::{IntoPyArray as _, PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use staya_controller::agent::{LEARNED, RouteSettings, VISITS};
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_controller::rand::Rng;
use staya_sim::engine::WIDE;
use staya_sim::terrain::Terrain;
use staya_sim::walk::{Task, Walk, Walker};

/// Separates the order of moves from other random numbers.
const RANDOM: u32 = u32::from_be_bytes(*b"path");

/// Cells of each path, times in ticks, and whether each path ends at the goal.
type Routes<'py> = (Vec<Bound<'py, PyArray2<i16>>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);

/// Moves robots from their starts to their goals by their windows. Returns the cells of each path
/// (x, y), its travel time in ticks, and whether it arrived. `land` is row by row from the south, 0
/// for a wall; `seed` is that of the order of moves. Runs on all cores, without the interpreter
/// lock.
///
/// # Errors
/// `ValueError` for a map of an unsupported size, or settings that the law refuses.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python gives them by name")]
pub fn route<'py>(
    py: Python<'py>,
    land: PyReadonlyArray2<'py, u8>,
    starts: PyReadonlyArray2<'py, i16>,
    goals: PyReadonlyArray2<'py, i16>,
    chebyshev: bool,
    corner_cutting: bool,
    seed: u64,
    given: &str,
) -> PyResult<Routes<'py>> {
    let [height, width] = [land.shape()[0], land.shape()[1]].map(|side| u16::try_from(side).unwrap_or(u16::MAX));
    let land = Terrain::from_cells(width, height, land.as_slice()?.to_vec());
    let land = land.map_err(|error| PyValueError::new_err(format!("land: {error}")))?;
    let norm = if chebyshev { Norm::Chebyshev } else { Norm::Euclidean };
    let RouteSettings { params, replan, sharpness, .. } = refused(settings::route(given, norm, corner_cutting))?;
    let cells = |array: &PyReadonlyArray2<'py, i16>| -> PyResult<Vec<Cell>> {
        Ok(array.as_slice()?.as_chunks::<2>().0.iter().map(|&[x, y]| Cell::new(x, y)).collect())
    };
    let (starts, goals) = (cells(&starts)?, cells(&goals)?);
    let walks = pool::detached(py, || {
        let pairs = starts.par_iter().zip(&goals).enumerate().with_max_len(16);
        let walks = pairs.map_init(Walker::<WIDE, VISITS, LEARNED>::default, |walker, (index, (&from, &to))| {
            let task = Task { land: &land, parked: &[], from, to };
            let mut rng = Rng::keyed(seed, RANDOM, index as u32, 0);
            let walk = walker.walk_shuffled(&task, &params, replan, sharpness, &mut rng);
            (walk, walker.path().iter().flat_map(|cell| [cell.x, cell.y]).collect::<Vec<i16>>())
        });
        walks.collect::<Vec<(Walk, Vec<i16>)>>()
    })?;
    let ticks: Vec<f64> = walks.iter().map(|(walk, _)| walk.cost as f64 / f64::from(UNIT)).collect();
    let arrived: Vec<bool> = walks.iter().map(|(walk, _)| walk.arrived).collect();
    let paths = walks.into_iter().map(|(_, path)| {
        let path = numpy::ndarray::Array2::from_shape_vec([path.len() / 2, 2], path);
        PyArray2::from_owned_array(py, path.unwrap_or_default())
    });
    Ok((paths.collect(), ticks.into_pyarray(py), arrived.into_pyarray(py)))
}
