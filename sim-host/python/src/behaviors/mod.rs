//! Single behaviours, applied to all robots at once. Neighbours come from exact positions.

pub mod flock;
pub mod negotiation;
pub mod orca;
pub mod route;

use staya_controller::agent::NEIGHBORS;
use staya_controller::body::Body;
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::nearby::{Cells, Found, Query, Search, Space};

pub(super) struct Robots<'a> {
    pub positions_m: &'a [[f64; 3]],
    pub velocities_mps: &'a [[f64; 3]],
    pub radii_m: &'a [f64],
}

pub(super) struct Obstacles<'a> {
    /// From (x, y) to (x, y).
    pub walls_m: &'a [[f64; 4]],
    /// Centre (x, y), radius.
    pub discs_m: &'a [[f64; 3]],
}

pub(super) struct Neighborhood<'a> {
    robots: Robots<'a>,
    range_m: f64,
    cells: Cells<f64, 3>,
}

impl<'a> Neighborhood<'a> {
    /// On a torus if circumferences are given.
    pub fn new(robots: Robots<'a>, range_m: f64, torus_m: Option<[f64; 2]>) -> Self {
        let torus = torus_m.and_then(|[x, y]| Space::torus([x, y, f64::MAX]));
        let mut cells = Cells::new(torus.unwrap_or(Space::OPEN), range_m);
        cells.rebuild(robots.positions_m);
        Self { robots, range_m, cells }
    }

    /// Nearest first, up to the capacity of an agent. `found` is scratch memory.
    pub fn of(&self, index: usize, found: &mut Vec<Found<f64, 3>>) -> heapless::Vec<Nearby<f32>, NEIGHBORS> {
        let query = Query {
            at: self.robots.positions_m[index],
            radius: self.range_m,
            most: NEIGHBORS,
            except: u32::try_from(index).ok(),
        };
        self.cells.within(&query, found);
        found.iter().take(NEIGHBORS).map(|found| self.nearby(found)).collect()
    }

    fn nearby(&self, found: &Found<f64, 3>) -> Nearby<f32> {
        let other = found.index as usize;
        Nearby {
            id: id(other),
            offset_m: vector(found.offset),
            velocity_mps: vector(self.robots.velocities_mps[other]),
            radius_m: self.robots.radii_m[other] as f32,
            gives_way: true,
            mode: Mode::Cruise,
            is_stranger: false,
        }
    }

    /// The body of robot `index` without inertia.
    pub fn body(&self, index: usize, max_speed_mps: f64, step_s: f64) -> Body<f32> {
        Body {
            id: id(index),
            velocity_mps: vector(self.robots.velocities_mps[index]),
            radius_m: self.robots.radii_m[index] as f32,
            max_speed_mps: max_speed_mps as f32,
            max_acceleration_mps2: f32::MAX,
            step_s: step_s as f32,
        }
    }
}

impl Obstacles<'_> {
    pub fn from(&self, [x, y, _]: [f64; 3]) -> impl Iterator<Item = Obstacle<f32>> + '_ {
        let point = move |px: f64, py: f64| Vec2::new((px - x) as f32, (py - y) as f32);
        let walls = self.walls_m.iter().map(move |&[ax, ay, bx, by]| Obstacle::Wall([point(ax, ay), point(bx, by)]));
        let discs = self.discs_m.iter().map(move |&[cx, cy, radius]| Obstacle::Ball {
            center_m: point(cx, cy).extend(0.0),
            radius_m: radius as f32,
        });
        walls.chain(discs)
    }
}

/// Settings, or a `ValueError` with the reason of refusal.
pub(super) fn refused<T>(settings: Result<T, String>) -> pyo3::PyResult<T> {
    settings.map_err(pyo3::exceptions::PyValueError::new_err)
}

fn id(index: usize) -> RobotId {
    RobotId(u32::try_from(index).unwrap_or(u32::MAX >> 1).saturating_add(1))
}

pub(super) fn vector(row: [f64; 3]) -> Vec3<f32> {
    let [x, y, z] = row.map(|component| component as f32);
    Vec3::new(x, y, z)
}

pub(super) fn array(vector: Vec3<f32>) -> [f64; 3] {
    [vector.x, vector.y, vector.z].map(f64::from)
}

pub(super) fn rows<'a, const D: usize>(array: &'a numpy::PyReadonlyArray2<'_, f64>) -> pyo3::PyResult<&'a [[f64; D]]> {
    Ok(array.as_slice()?.as_chunks::<D>().0)
}
