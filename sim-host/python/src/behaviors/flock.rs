//! Flocking laws, one step of all robots at once.

use super::{Neighborhood, Obstacles, Robots, array, rows, vector};
use crate::pool;
use crate::simulation;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Position, Vec2};
use staya_controller::goal_flock::{GoalParams, wish};
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, Reference, acceleration};
use staya_controller::robot::RobotId;

const BATCH: usize = 64;

/// Accelerations of an alpha flock, m/s^2 (R. Olfati-Saber 2006). `gains` are alpha, beta and
/// gamma, each for positions and for velocities. Runs on all cores, without the interpreter lock.
///
/// # Errors
/// `ValueError` for parameters that the law refuses.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python gives them by name")]
pub fn lattice_acceleration<'py>(
    py: Python<'py>,
    positions_m: PyReadonlyArray2<'py, f64>,
    velocities_mps: PyReadonlyArray2<'py, f64>,
    reference: Option<([f64; 3], [f64; 3])>,
    walls_m: PyReadonlyArray2<'py, f64>,
    discs_m: PyReadonlyArray2<'py, f64>,
    algorithm: u8,
    spacing_m: f32,
    ratios: [f32; 2],
    bounds: [f32; 2],
    gains: [[f32; 2]; 3],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [alpha, beta, gamma] = gains.map(|[position, velocity]| Gain { position, velocity });
    let params = LatticeParams {
        algorithm: match algorithm {
            1 => Algorithm::One,
            2 => Algorithm::Two,
            _ => Algorithm::Three,
        },
        spacing_m,
        range_ratio: ratios[0],
        obstacle_ratio: ratios[1],
        attraction: bounds[0],
        repulsion: bounds[1],
        alpha,
        beta,
        gamma,
    };
    if !params.is_sound() {
        return Err(PyValueError::new_err(
            "spacing, range_ratio, obstacle_ratio, attraction, repulsion or gains are out of range; give a spacing of 0.01 to \
             100 m, a range_ratio above 1 and up to 4, an obstacle_ratio above 0 and up to 4, 0 < attraction <= repulsion, and \
             gains of at least 0",
        ));
    }
    let (positions_m, velocities_mps) = (rows::<3>(&positions_m)?, rows::<3>(&velocities_mps)?);
    let obstacles = Obstacles { walls_m: rows(&walls_m)?, discs_m: rows(&discs_m)? };
    let answers = pool::detached(py, || {
        let radii_m = &vec![0.0; positions_m.len()];
        let robots = Robots { positions_m, velocities_mps, radii_m };
        let neighborhood = Neighborhood::new(robots, f64::from(params.range_m()), None);
        let each = (0..positions_m.len()).into_par_iter().with_min_len(BATCH);
        let answers = each.map_init(Vec::new, |found, index| {
            let here_m = positions_m[index];
            let body = neighborhood.body(index, f64::MAX, 1.0);
            let nearby = neighborhood.of(index, found);
            let seen: Vec<_> = obstacles.from(here_m).collect();
            let reference = reference.map(|(place_m, velocity_mps)| Reference {
                offset_m: vector([0, 1, 2].map(|axis| place_m[axis] - here_m[axis])),
                velocity_mps: vector(velocity_mps),
            });
            array(acceleration(&params, &body, &nearby, &seen, reference.as_ref()))
        });
        answers.collect::<Vec<_>>()
    })?;
    Ok(simulation::rows(py, answers.into_iter()))
}

/// Preferred velocities of a goal flock, m/s (V. E. and V. V. Pavlovsky), on all cores. `gains` are
/// those of the goal, of the neighbours' centre and of repulsion.
///
/// # Errors
/// `ValueError` for parameters that the law refuses.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python gives them by name")]
pub fn goal_wish<'py>(
    py: Python<'py>,
    positions_m: PyReadonlyArray2<'py, f64>,
    goals_m: PyReadonlyArray2<'py, f64>,
    gains: [f32; 3],
    neighborhood_m: f32,
    min_distance_m: f32,
    speed_mps: f32,
    step_s: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [goal_gain, center_gain, repulsion_gain] = gains;
    let params = GoalParams { goal_gain, center_gain, repulsion_gain, neighborhood_m, min_distance_m, speed_mps };
    if !params.is_sound() {
        return Err(PyValueError::new_err(
            "gains, neighborhood, min_distance or speed are out of range; give finite gains, a min_distance above 0, a \
             neighborhood of at least twice min_distance, and a speed above 0",
        ));
    }
    let (positions_m, goals_m) = (rows::<3>(&positions_m)?, rows::<3>(&goals_m)?);
    let wishes = pool::detached(py, || {
        let still_mps = &vec![[0.0; 3]; positions_m.len()];
        let radii_m = &vec![0.0; positions_m.len()];
        let robots = Robots { positions_m, velocities_mps: still_mps, radii_m };
        let neighborhood = Neighborhood::new(robots, f64::from(neighborhood_m), None);
        let each = (0..positions_m.len()).into_par_iter().with_min_len(BATCH);
        let wishes = each.map_init(Vec::new, |found, index| {
            let body = neighborhood.body(index, f64::from(speed_mps), step_s);
            let nearby = neighborhood.of(index, found);
            let place = |place_m: [f64; 3]| Position::from_metres(place_m).unwrap_or_default();
            let goal = Some(place(goals_m[index]));
            array(wish(&params, &body, place(positions_m[index]), goal, &nearby))
        });
        wishes.collect::<Vec<_>>()
    })?;
    Ok(simulation::rows(py, wishes.into_iter()))
}

/// Headings of boids one step later, unit vectors (V. A. Starovoitova 2018), on all cores. `values`
/// are crowded and closest, metres, and the largest turns towards and away from others, radians.
///
/// # Errors
/// `ValueError` for arrays that cannot be read.
#[pyfunction]
pub fn boids_steer<'py>(
    py: Python<'py>,
    positions_m: PyReadonlyArray2<'py, f64>,
    headings: PyReadonlyArray2<'py, f64>,
    torus_m: Option<[f64; 2]>,
    values: [f32; 4],
    radii_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [crowded_m, closest_m, turn, turn_away] = values;
    let params = BoidsParams::new(crowded_m, closest_m, turn, turn_away);
    let (positions_m, headings, radii_m) = (rows::<3>(&positions_m)?, rows::<3>(&headings)?, radii_m.as_slice()?);
    let next = pool::detached(py, || {
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
