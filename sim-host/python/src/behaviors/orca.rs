//! ORCA (J. van den Berg and others 2011) of all robots at once.

use super::{Neighborhood, Obstacles, Robots, array, refused, rows, vector};
use crate::settings;
use crate::{pool, simulation};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::sync::MutexExt as _;
use rayon::prelude::*;
use staya_controller::agent::{FlySettings, HALF_PLANES};
use staya_controller::orca::{Avoider, InSpace};
use staya_controller::rand::Rng;
use std::sync::{Mutex, PoisonError};

/// Separates the random numbers that break ties from others.
const RANDOM: u32 = u32::from_be_bytes(*b"pyth");
const BATCH: usize = 32;

/// Collision avoidance of many robots, with the memory of each between steps.
#[pyclass(frozen, module = "staya._staya")]
pub struct Avoiders {
    all: Mutex<Vec<(AnyAvoider, Rng)>>,
    horizon_s: f64,
}

#[derive(Clone)]
enum AnyAvoider {
    Plane(Avoider<f32, HALF_PLANES>),
    Space(Avoider<f32, HALF_PLANES, InSpace<f32>>),
}

#[pymethods]
impl Avoiders {
    /// Creates `count` robots in the plane or in space.
    #[new]
    fn new(count: usize, in_space: bool, seed: u64, given: &str) -> PyResult<Self> {
        let (params, FlySettings { downwash, .. }) = refused(settings::orca(given, in_space))?;
        let avoider = match in_space {
            true => AnyAvoider::Space(Avoider::with_source(params, InSpace { downwash })),
            false => AnyAvoider::Plane(Avoider::new(params)),
        };
        let random = |number| Rng::keyed(seed, RANDOM, number, 0);
        let all = (1..).take(count).map(|number| (avoider.clone(), random(number))).collect();
        Ok(Self { all: Mutex::new(all), horizon_s: params.horizon_s.into() })
    }

    /// Returns the velocities until the next step, m/s. Each robot considers the 16 nearest robots
    /// in reach. O(robots * 16) and the neighbour search, on all cores, without the interpreter
    /// lock.
    #[expect(clippy::too_many_arguments, reason = "Python gives them by name")]
    fn velocities<'py>(
        &self,
        py: Python<'py>,
        positions_m: PyReadonlyArray2<'py, f64>,
        velocities_mps: PyReadonlyArray2<'py, f64>,
        wishes_mps: PyReadonlyArray2<'py, f64>,
        goals_m: Option<PyReadonlyArray2<'py, f64>>,
        radii_m: PyReadonlyArray1<'py, f64>,
        max_speeds_mps: PyReadonlyArray1<'py, f64>,
        walls_m: PyReadonlyArray2<'py, f64>,
        discs_m: PyReadonlyArray2<'py, f64>,
        step_s: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (positions_m, velocities_mps) = (rows::<3>(&positions_m)?, rows::<3>(&velocities_mps)?);
        let (radii_m, speeds_mps) = (radii_m.as_slice()?, max_speeds_mps.as_slice()?);
        let (wishes_mps, goals_m) = (rows::<3>(&wishes_mps)?, goals_m.as_ref().map(rows::<3>).transpose()?);
        let obstacles = Obstacles { walls_m: rows(&walls_m)?, discs_m: rows(&discs_m)? };
        let mut all = self.all.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let all = all.as_mut_slice();
        let best = pool::detached(py, || {
            let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
            // Robots farther away cannot be met within the horizon.
            let reach_m = 2.0 * largest(speeds_mps) * (self.horizon_s + step_s) + 2.0 * largest(radii_m);
            let neighborhood = Neighborhood::new(Robots { positions_m, velocities_mps, radii_m }, reach_m, None);
            let robots = all.par_iter_mut().enumerate().with_min_len(BATCH);
            let best = robots.map_init(Vec::new, |found, (index, (avoider, rng))| {
                let body = neighborhood.body(index, speeds_mps[index], step_s);
                let nearby = neighborhood.of(index, found);
                let seen: Vec<_> = obstacles.from(positions_m[index]).collect();
                let way = goals_m.map(|goals_m| {
                    let (goal_m, here_m) = (goals_m[index], positions_m[index]);
                    vector([0, 1, 2].map(|axis| goal_m[axis] - here_m[axis]))
                });
                let wish = vector(wishes_mps[index]);
                array(match avoider {
                    AnyAvoider::Plane(avoider) => {
                        let way = way.map(|way| way.xy());
                        let best = avoider.velocity(&body, wish.xy(), way, &nearby, &seen, rng);
                        best.velocity_mps.extend(wish.z)
                    }
                    AnyAvoider::Space(avoider) => avoider.velocity(&body, wish, way, &nearby, &seen, rng).velocity_mps,
                })
            });
            best.collect::<Vec<[f64; 3]>>()
        })?;
        Ok(simulation::rows(py, best.into_iter()))
    }
}
