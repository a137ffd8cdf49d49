//! Bodies in the plane or in space: discs (balls) that take the velocity they are told, as far as their inertia and the
//! land under them allow.
//!
//! This is no physics engine: nothing stops a body but its own robot. Bodies pass through each other and through
//! obstacles, and each such overlap is counted, so that no controller can rely on the world to be safe.

mod border;
mod eyes;
mod shape;
mod solid;
mod solids;

#[doc(hidden)]
pub use border::Beside;
pub use eyes::{Eyes, Sight};
pub use shape::{FAR_M, Shape};
pub use solid::Solid;
pub use solid::narrow;
pub use solids::Solids;

use super::{Refusal, set_cell};
use crate::nearby::{Cells, Found, Query, Search, Space};
use crate::terrain::Terrain;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use staya_controller::agent::Command;
use staya_controller::body::Body as Limits;
use staya_controller::geom::Vec3;
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::robot::RobotId;
use std::collections::HashMap;

/// A robot's body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// The robot.
    pub id: RobotId,
    /// Radius, metres.
    pub radius_m: f64,
    /// World position of its centre, metres.
    pub position_m: [f64; 3],
    /// World velocity, metres per second.
    pub velocity_mps: [f64; 3],
    /// What it can do.
    pub abilities: Abilities,
    /// How many times higher than wide the room is that others should leave it, for its rotors; 1: a ball.
    pub downwash: f64,
}

/// What a body can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Abilities {
    /// Highest speed on easy land (impassability 1) and off the map, m/s; u times less where the land takes u times
    /// longer to cross.
    pub max_speed_mps: f64,
    /// Highest acceleration, m/s^2; infinite: none.
    pub max_acceleration_mps2: f64,
    /// Length of a tick, seconds.
    pub step_s: f64,
}

/// Bodies, land and obstacles.
#[derive(Clone, Debug)]
pub struct Plane {
    terrain: Option<Terrain>,
    solids: Solids,
    discs: Vec<Disc>,
    /// By body: cells that were closed while it was there, as they were. It may leave them, and nobody enters.
    shut: Vec<Vec<(Cell, u8)>>,
    intruders: Vec<Disc>,
    centers: Vec<[f64; 3]>,
    index: Cells<f64, 3>,
    space: Space<f64, 3>,
    /// How far neighbours are looked for, metres.
    reach_m: f64,
    /// Radius of the largest body, metres.
    largest_m: f64,
}

/// How near bodies are to each other and to obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clearance {
    /// Least distance between the surfaces of two bodies, metres, negative when they overlap; infinite when no two are
    /// within three radii of each other.
    pub bodies_m: f64,
    /// Least distance between a body's surface and an obstacle, metres; infinite without obstacles.
    pub solids_m: f64,
    /// Pairs of bodies that overlap.
    pub overlaps: u64,
    /// Bodies that overlap an obstacle, or whose centre is in a blocked cell that was not closed around them.
    pub intrusions: u64,
    /// Least distance between a body's surface and an intruder's, metres; infinite without intruders.
    pub intruders_m: f64,
    /// Pairs of a body and an intruder that overlap.
    pub intruder_overlaps: u64,
    /// Pairs of bodies of which one is in the other's downwash, without overlap.
    pub washed: u64,
}

impl Clearance {
    /// Nothing is near.
    pub const FREE: Self = Self {
        bodies_m: f64::INFINITY,
        solids_m: f64::INFINITY,
        overlaps: 0,
        intrusions: 0,
        intruders_m: f64::INFINITY,
        intruder_overlaps: 0,
        washed: 0,
    };

    /// Takes in those of another moment.
    pub fn add(&mut self, other: &Self) {
        self.bodies_m = self.bodies_m.min(other.bodies_m);
        self.solids_m = self.solids_m.min(other.solids_m);
        self.overlaps += other.overlaps;
        self.intrusions += other.intrusions;
        self.intruders_m = self.intruders_m.min(other.intruders_m);
        self.intruder_overlaps += other.intruder_overlaps;
        self.washed += other.washed;
    }
}

/// Bodies that a thread takes at least at a time.
const BATCH: usize = 256;

/// Obstacles are looked for within so many radii of the largest body at least.
const CLOSE: f64 = 4.0;

/// Less overlap than this is rounding, metres.
const ROUNDING_M: f64 = 1e-9;

impl Plane {
    /// A world with these bodies.
    #[must_use]
    pub fn new(terrain: Option<Terrain>, solids: Vec<Solid>, discs: Vec<Disc>) -> Self {
        let largest_m = discs.iter().map(|disc| disc.radius_m).fold(0.0, f64::max);
        let highest = discs.iter().map(|disc| disc.downwash).fold(1.0, f64::max);
        let reach_m = largest_m * (2.0 * highest).max(3.0);
        Self {
            terrain,
            solids: Solids::new(solids, CLOSE * largest_m),
            intruders: Vec::new(),
            shut: vec![Vec::new(); discs.len()],
            centers: Vec::with_capacity(discs.len()),
            index: Cells::new(Space::OPEN, reach_m.max(1e-3)),
            space: Space::OPEN,
            reach_m,
            largest_m,
            discs,
        }
    }

    /// The same with bodies that are no robots: they go on as they go, through everything.
    #[must_use]
    pub fn with_intruders(mut self, intruders: Vec<Disc>) -> Self {
        self.intruders = intruders;
        self
    }

    /// The same in another space, such as a torus: who leaves on one side comes in on the other.
    #[must_use]
    pub fn in_space(mut self, space: Space<f64, 3>) -> Self {
        self.space = space;
        self.index = Cells::new(space, self.reach_m.max(1e-3));
        self
    }

    /// The same whose obstacles are quickly found from so far away, metres.
    #[must_use]
    pub fn with_sight(mut self, sight_m: f64) -> Self {
        let reach_m = sight_m.max(self.solids.reach_m());
        self.solids = Solids::new(self.solids.all().to_vec(), reach_m);
        self
    }

    /// The bodies that are no robots.
    #[must_use]
    pub fn intruders(&self) -> &[Disc] {
        &self.intruders
    }

    /// The bodies, in the order of their robots.
    #[must_use]
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// The obstacles.
    #[must_use]
    pub fn solids(&self) -> &[Solid] {
        self.solids.all()
    }

    /// The obstacles within `within_m` of a place, metres, in their order. O(those within sight and a few around it).
    pub fn solids_near(&self, place_m: [f64; 3], within_m: f64) -> impl Iterator<Item = &Solid> {
        self.solids.near(place_m, within_m).filter(move |solid| solid.distance_m(place_m) <= within_m)
    }

    /// Puts body `index`, behind the robots' an intruder's, where it was at another time, with the velocity that it had.
    pub(crate) fn put(&mut self, index: usize, position_m: [f64; 3], velocity_mps: [f64; 3]) {
        let intruders = self.intruders.iter_mut();
        if let Some(disc) = self.discs.iter_mut().chain(intruders).nth(index) {
            (disc.position_m, disc.velocity_mps) = (position_m, velocity_mps);
        }
    }

    /// Replaces all obstacles.
    pub(crate) fn put_solids(&mut self, solids: Vec<Solid>) {
        self.solids.change(|all| *all = solids);
    }

    /// Changes a cell of the land, whoever is there.
    pub(crate) fn put_cell(&mut self, cell: Cell, class: u8) {
        if let Some(terrain) = &mut self.terrain {
            terrain.set(cell, class);
        }
    }

    /// Changes cells of the land, whoever is there: what closes around a body stays open to it until it is out.
    /// O(bodies x cells under one + cells).
    pub fn change(&mut self, cells: &[(Cell, u8)]) {
        let Some(terrain) = &mut self.terrain else { return };
        let before: HashMap<Cell, u8> = cells.iter().map(|&(cell, _)| (cell, terrain.get(cell))).collect();
        cells.iter().for_each(|&(cell, class)| terrain.set(cell, class));
        for (disc, shut) in self.discs.iter().zip(&mut self.shut) {
            shut.retain(|&(cell, _)| !terrain.is_passable(cell));
            let closed = cells_under(terrain, disc).filter(|&cell| !terrain.is_passable(cell));
            let closed = closed.filter_map(|cell| Some((cell, *before.get(&cell)?)));
            shut.extend(closed.filter(|&(_, class)| class != BLOCKED));
        }
    }

    /// The cells that were closed while body `index` was there and in which it still is, as they were.
    #[must_use]
    pub fn shut(&self, index: usize) -> &[(Cell, u8)] {
        &self.shut[index]
    }

    /// Puts back what [`Plane::shut`] gave.
    pub(crate) fn put_shut(&mut self, index: usize, shut: Vec<(Cell, u8)>) {
        self.shut[index] = shut;
    }

    /// Puts obstacles behind those that there are, wherever bodies are.
    pub fn add_solids(&mut self, solids: impl IntoIterator<Item = Solid>) {
        self.solids.change(|all| all.extend(solids));
    }

    /// Moves an obstacle at once.
    ///
    /// # Errors
    /// There are not so many.
    pub fn move_solid(&mut self, index: usize, by_m: [f64; 2]) -> Result<(), Refusal> {
        self.solids.change(|all| {
            let count = all.len();
            let solid = all.get_mut(index).ok_or_else(|| no_solid(index, count))?;
            *solid = solid.moved(by_m);
            Ok(())
        })
    }

    /// Takes an obstacle away; those behind it move up.
    ///
    /// # Errors
    /// There are not so many.
    pub fn remove_solid(&mut self, index: usize) -> Result<(), Refusal> {
        if index >= self.solids().len() {
            return Err(no_solid(index, self.solids().len()));
        }
        self.solids.change(|all| all.remove(index));
        Ok(())
    }

    /// Changes a cell of the land; 0 is a wall.
    ///
    /// # Errors
    /// There is no such cell, or somebody is in it.
    pub fn set_cell(&mut self, cell: Cell, class: u8) -> Result<(), Refusal> {
        let is_taken = self.discs.iter().any(|disc| self.cell(disc.position_m) == Some(cell));
        let Some(terrain) = &mut self.terrain else {
            return Err(Refusal::new("kind", "there is no land", "draw a wall instead"));
        };
        set_cell(terrain, cell, class, is_taken)
    }

    /// The land, if there is any.
    #[must_use]
    pub const fn terrain(&self) -> Option<&Terrain> {
        self.terrain.as_ref()
    }

    /// The cell of the land under a place; `None` off the map and without land.
    #[must_use]
    pub fn cell(&self, position_m: [f64; 3]) -> Option<Cell> {
        let [x, y, _] = position_m;
        self.terrain.as_ref()?.cell_at([x, y])
    }

    /// How fast body `index` can go at a place, m/s. In a blocked cell, where it should not be, as on the worst land.
    #[must_use]
    pub fn max_speed_mps(&self, index: usize, position_m: [f64; 3]) -> f64 {
        max_speed_mps(self.terrain(), &self.shut[index], &self.discs[index].abilities, position_m)
    }

    /// Moves the bodies for one tick as their robots command; `commands[i]` belongs to body `i`. A body goes at even speed
    /// throughout the tick; one that is told to hold, or to move by cells, brakes.
    ///
    /// # Panics
    /// When there are fewer commands than bodies.
    pub fn advance(&mut self, commands: &[Command<f32>]) {
        assert!(commands.len() >= self.discs.len(), "a command for each body");
        let (land, space) = (self.terrain.as_ref(), self.space);
        let bodies = self.discs.par_iter_mut().zip(&mut self.shut).zip(commands).with_min_len(BATCH);
        bodies.for_each(|((disc, shut), command)| {
            let wish = match *command {
                Command::Velocity(v) => Vec3::new(v.x.into(), v.y.into(), v.z.into()),
                Command::Hold | Command::Move(_) => Vec3::ZERO,
            };
            let [vx, vy, vz] = disc.velocity_mps;
            let limits = Limits {
                id: disc.id,
                velocity_mps: Vec3::new(vx, vy, vz),
                radius_m: disc.radius_m,
                max_speed_mps: max_speed_mps(land, shut, &disc.abilities, disc.position_m),
                max_acceleration_mps2: disc.abilities.max_acceleration_mps2,
                step_s: disc.abilities.step_s,
            };
            let v = limits.reach(wish);
            disc.velocity_mps = [v.x, v.y, v.z];
            disc.go();
            if space.period().is_some() {
                // Heights do not close.
                let [x, y, _] = space.fold(disc.position_m);
                (disc.position_m[0], disc.position_m[1]) = (x, y);
            }
            if let Some(land) = land.filter(|_| !shut.is_empty()) {
                let under: Vec<Cell> = cells_under(land, disc).collect();
                shut.retain(|(cell, _)| under.contains(cell));
            }
        });
        self.intruders.iter_mut().for_each(Disc::go);
    }

    /// How near bodies are to each other, to obstacles and to intruders now. O(bodies x (neighbours + obstacles near by +
    /// intruders)); when no body is near an obstacle, O(bodies x obstacles).
    pub fn clearance(&mut self) -> Clearance {
        self.centers.clear();
        self.centers.extend(self.discs.iter().map(|disc| disc.position_m));
        self.index.rebuild(&self.centers);
        let close_m = self.solids.reach_m();
        let bodies = || self.discs.par_iter().enumerate().with_min_len(BATCH);
        let mut clearance = bodies().map_init(Vec::new, |found, (number, _)| self.clearance_of(number, found)).reduce(
            || Clearance::FREE,
            |mut one, other| {
                one.add(&other);
                one
            },
        );
        // Whoever was not looked at is farther off than that.
        if !self.solids().is_empty() && clearance.solids_m > close_m - self.largest_m {
            let gaps = bodies().map(|(_, disc)| self.solid_gap_m(disc, f64::INFINITY));
            clearance.solids_m = gaps.reduce(|| f64::INFINITY, f64::min);
        }
        clearance
    }

    /// How far the nearest of the obstacles within `within_m` is from a body's surface, metres.
    fn solid_gap_m(&self, disc: &Disc, within_m: f64) -> f64 {
        let gaps = self.solids.near(disc.position_m, within_m).map(|solid| solid.distance_m(disc.position_m));
        gaps.fold(f64::INFINITY, f64::min) - disc.radius_m
    }

    /// What one body adds to it: each pair counts with its first body.
    fn clearance_of(&self, number: usize, found: &mut Vec<Found<f64, 3>>) -> Clearance {
        let disc = &self.discs[number];
        // There are no more than 2^32 - 1.
        let number = number as u32;
        let mut clearance = Clearance::FREE;
        let query = Query { at: disc.position_m, radius: self.reach_m, most: usize::MAX, except: Some(number) };
        self.index.within(&query, found);
        for near in found.iter() {
            let other = &self.discs[near.index as usize];
            let gap = near.distance_squared.sqrt() - disc.radius_m - other.radius_m;
            clearance.bodies_m = clearance.bodies_m.min(gap);
            if near.index < number {
                continue;
            }
            if gap < -ROUNDING_M {
                clearance.overlaps += 1;
            } else if is_washed(disc, other) {
                clearance.washed += 1;
            }
        }
        let gap = self.solid_gap_m(disc, self.solids.reach_m());
        clearance.solids_m = gap;
        let land = self.terrain.as_ref();
        let cell = self.cell(disc.position_m).zip(land);
        let is_shut = |cell: Cell| self.shut[number as usize].iter().any(|&(shut, _)| shut == cell);
        let is_in_wall = cell.is_some_and(|(cell, terrain)| terrain.get(cell) == BLOCKED && !is_shut(cell));
        clearance.intrusions = u64::from(gap < -ROUNDING_M || is_in_wall);
        for intruder in &self.intruders {
            let way = [0, 1, 2].map(|axis| intruder.position_m[axis] - disc.position_m[axis]);
            let distance = libm::sqrt(way.iter().map(|x| x * x).sum());
            let gap = distance - disc.radius_m - intruder.radius_m;
            clearance.intruders_m = clearance.intruders_m.min(gap);
            clearance.intruder_overlaps += u64::from(gap < -ROUNDING_M);
        }
        clearance
    }
}

impl Disc {
    /// Goes on for a tick as it goes.
    fn go(&mut self) {
        for (place, speed) in self.position_m.iter_mut().zip(self.velocity_mps) {
            *place += speed * self.abilities.step_s;
        }
    }
}

/// See [`Plane::max_speed_mps`].
fn max_speed_mps(land: Option<&Terrain>, shut: &[(Cell, u8)], abilities: &Abilities, [x, y, _]: [f64; 3]) -> f64 {
    let class = |land: &Terrain| {
        let cell = land.cell_at([x, y])?;
        let before = shut.iter().find(|(shut, _)| *shut == cell);
        Some(before.map_or_else(|| land.get(cell), |&(_, class)| class))
    };
    let ticks = match land.and_then(class) {
        None => 1,
        Some(BLOCKED) => 9,
        Some(ticks) => ticks,
    };
    abilities.max_speed_mps / f64::from(ticks)
}

/// The cells of the land under a body. O(cells).
fn cells_under(land: &Terrain, disc: &Disc) -> impl Iterator<Item = Cell> {
    let ([x, y, _], r) = (disc.position_m, disc.radius_m);
    let (low, high) = (land.nearest_cell([x - r, y - r]), land.nearest_cell([x + r, y + r]));
    let (cell_m, origin_m) = (land.cell_m, land.origin_m);
    let all = (low.y..=high.y).flat_map(move |row| (low.x..=high.x).map(move |column| Cell::new(column, row)));
    all.filter(move |cell| {
        // From the centre to the nearest place of the cell.
        let off = |at: f64, cells: i16, axis: usize| {
            let west = origin_m[axis] + f64::from(cells) * cell_m;
            (west - at).max(at - west - cell_m).max(0.0)
        };
        libm::hypot(off(x, cell.x, 0), off(y, cell.y, 1)) <= r
    })
}

fn no_solid(index: usize, count: usize) -> Refusal {
    let what = format!("there is no obstacle {index}");
    Refusal::new("index", what, format!("there are {count}, counted from 0"))
}

/// Whether one of two bodies is in the other's downwash: an ellipsoid that is higher than wide.
fn is_washed(one: &Disc, other: &Disc) -> bool {
    let high = one.downwash.max(other.downwash);
    let [x, y, z] = [0, 1, 2].map(|axis| other.position_m[axis] - one.position_m[axis]);
    let low_z = z / high;
    libm::sqrt(x * x + y * y + low_z * low_z) < one.radius_m + other.radius_m - ROUNDING_M
}

#[cfg(test)]
mod tests;
