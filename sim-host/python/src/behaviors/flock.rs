//! Flocking laws, one step of all robots at once.

use super::{Neighborhood, Obstacles, Robots, array, refused, rows, vector};
use crate::{pool, settings, simulation};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use staya_controller::agent::BoidsSettings;
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Position, Vec2};
use staya_controller::goal_flock::wish;
use staya_controller::lattice::{Reference, acceleration};
use staya_controller::robot::RobotId;

const BATCH: usize = 64;

/// Accelerations of an alpha flock, m/s^2 (R. Olfati-Saber 2006). Runs on all cores, without the
/// interpreter lock.
///
/// # Errors
/// `ValueError` for settings that the law refuses.
#[pyfunction]
pub fn lattice_acceleration<'py>(
    py: Python<'py>,
    positions_m: PyReadonlyArray2<'py, f64>,
    velocities_mps: PyReadonlyArray2<'py, f64>,
    reference: Option<([f64; 3], [f64; 3])>,
    walls_m: PyReadonlyArray2<'py, f64>,
    discs_m: PyReadonlyArray2<'py, f64>,
    given: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let settings = refused(settings::lattice(given))?;
    let params = settings.params;
    let (positions_m, velocities_mps) = (rows::<3>(&positions_m)?, rows::<3>(&velocities_mps)?);
    let obstacles = Obstacles { walls_m: rows(&walls_m)?, discs_m: rows(&discs_m)? };
    let answers = pool::detached(py, || {
        let radii_m = &vec![0.0; positions_m.len()];
        let robots = Robots { positions_m, velocities_mps, radii_m };
        let neighborhood = Neighborhood::new(robots, f64::from(params.range_m()), None);
        let each = (0..positions_m.len()).into_par_iter().with_min_len(BATCH);
        let motion = settings.motion();
        let answers = each.map_init(Vec::new, |found, index| {
            let here_m = positions_m[index];
            let body = neighborhood.body(index, f64::MAX, 1.0);
            let nearby = neighborhood.of(index, found);
            let seen: Vec<_> = obstacles.from(here_m).collect();
            let reference = reference.map(|(place_m, velocity_mps)| {
                let offset_m = vector([0, 1, 2].map(|axis| place_m[axis] - here_m[axis]));
                Reference { offset_m, velocity_mps: motion.wanted(offset_m, vector(velocity_mps)) }
            });
            array(acceleration(&params, &body, &nearby, &seen, reference.as_ref()))
        });
        answers.collect::<Vec<_>>()
    })?;
    Ok(simulation::rows(py, answers.into_iter()))
}

/// Preferred velocities of a goal flock, m/s (V. E. and V. V. Pavlovsky), on all cores.
///
/// # Errors
/// `ValueError` for settings that the law refuses.
#[pyfunction]
pub fn goal_wish<'py>(
    py: Python<'py>,
    positions_m: PyReadonlyArray2<'py, f64>,
    goals_m: PyReadonlyArray2<'py, f64>,
    step_s: f64,
    given: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let params = refused(settings::goal(given))?;
    let (positions_m, goals_m) = (rows::<3>(&positions_m)?, rows::<3>(&goals_m)?);
    let wishes = pool::detached(py, || {
        let still_mps = &vec![[0.0; 3]; positions_m.len()];
        let radii_m = &vec![0.0; positions_m.len()];
        let robots = Robots { positions_m, velocities_mps: still_mps, radii_m };
        let neighborhood = Neighborhood::new(robots, f64::from(params.neighborhood_m), None);
        let each = (0..positions_m.len()).into_par_iter().with_min_len(BATCH);
        let wishes = each.map_init(Vec::new, |found, index| {
            let body = neighborhood.body(index, f64::from(params.speed_mps), step_s);
            let nearby = neighborhood.of(index, found);
            let place = |place_m: [f64; 3]| Position::from_metres(place_m).unwrap_or_default();
            let goal = Some(place(goals_m[index]));
            array(wish(&params, &body, place(positions_m[index]), goal, &nearby))
        });
        wishes.collect::<Vec<_>>()
    })?;
    Ok(simulation::rows(py, wishes.into_iter()))
}

/// Headings of boids one step later, unit vectors (V. A. Starovoitova 2018), on all cores.
///
/// # Errors
/// `ValueError` for settings that the law refuses.
#[pyfunction]
pub fn boids_steer<'py>(
    py: Python<'py>,
    positions_m: PyReadonlyArray2<'py, f64>,
    headings: PyReadonlyArray2<'py, f64>,
    torus_m: Option<[f64; 2]>,
    given: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let BoidsSettings { crowded_m, closest_m, max_turn, max_turn_away, .. } = refused(settings::boids(given))?;
    let params = BoidsParams::new(crowded_m, closest_m, max_turn, max_turn_away);
    let (positions_m, headings) = (rows::<3>(&positions_m)?, rows::<3>(&headings)?);
    let next = pool::detached(py, || {
        let radii_m = &vec![0.0; positions_m.len()];
        // One common speed makes headings sufficient.
        let robots = Robots { positions_m, velocities_mps: headings, radii_m };
        let neighborhood = Neighborhood::new(robots, f64::from(closest_m), torus_m);
        let each = (0..positions_m.len()).into_par_iter().with_min_len(BATCH);
        let next = each.map_init(Vec::new, |found, index| {
            let [x, y, _] = headings[index].map(|component| component as f32);
            let number = RobotId(index as u32 + 1);
            let next = params.steer(number, Vec2::new(x, y), &neighborhood.of(index, found));
            [next.x, next.y].map(f64::from)
        });
        next.collect::<Vec<_>>()
    })?;
    Ok(simulation::rows(py, next.into_iter()))
}
