//! Bodies in the plane or in space: discs (balls) that follow velocity commands within the limits
//! of their inertia and the terrain.
//!
//! This is not a physics engine: bodies pass through each other and through obstacles, and each
//! overlap is counted, so that a controller cannot rely on the world for safety.

mod barrier;
mod border;
mod motion;
mod sensing;
mod shape;
mod solid;
mod solids;

pub use barrier::{Barrier, Barriers};
#[doc(hidden)]
pub use border::Beside;
pub use motion::CommandAge;
pub use sensing::{Sensing, Sight};
pub(crate) use shape::contains;
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
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::robot::RobotId;
use std::collections::HashMap;

/// A robot's body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Id of the robot.
    pub id: RobotId,
    /// Radius, metres.
    pub radius_m: f64,
    /// World position of its centre, metres.
    pub position_m: [f64; 3],
    /// World velocity, metres per second.
    pub velocity_mps: [f64; 3],
    /// Velocity that it approaches until its robot decides again, m/s; its own without a lag.
    pub target_mps: [f64; 3],
    /// Speed and acceleration limits.
    pub abilities: Abilities,
    /// Ratio of height to width of the space to avoid because of downwash; 1: a ball.
    pub downwash: f64,
}

/// Speed and acceleration limits of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Abilities {
    /// Highest speed on land of impassability 1 and off the map, m/s; else divided by it.
    pub max_speed_mps: f64,
    /// Highest acceleration, m/s^2; may be infinite.
    pub max_acceleration_mps2: f64,
    /// Time constant with which the velocity follows a command (first order), seconds; 0: at once.
    pub lag_s: f64,
    /// Time between two decisions of its robot, seconds.
    pub step_s: f64,
    /// Length of a tick, seconds.
    pub tick_s: f64,
}

impl Abilities {
    /// Least look-ahead for other robots, seconds, at most a minute: the time to brake from the
    /// highest speed, once for the own speed and once for the other's.
    #[must_use]
    pub fn least_horizon_s(&self) -> f64 {
        (2.0 * (self.max_speed_mps / self.max_acceleration_mps2 + self.lag_s)).min(60.0)
    }
}

/// Bodies, terrain and obstacles.
#[derive(Clone, Debug)]
pub struct Plane {
    terrain: Option<Terrain>,
    solids: Solids,
    discs: Vec<Disc>,
    /// By body: cells that closed around it, with their previous class; none may enter.
    shut: Vec<Vec<(Cell, u8)>>,
    intruders: Vec<Disc>,
    centers: Vec<[f64; 3]>,
    index: Cells<f64, 3>,
    space: Space<f64, 3>,
    reach_m: f64,
    largest_m: f64,
}

/// Distances of bodies to each other and to obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clearance {
    /// Smallest distance between the surfaces of two bodies, metres, negative if they overlap;
    /// infinite if no two are within three radii of each other.
    pub bodies_m: f64,
    /// Smallest distance between a body and an obstacle, metres; infinite without obstacles.
    pub solids_m: f64,
    /// Pairs of bodies that overlap.
    pub overlaps: u64,
    /// Bodies that overlap an obstacle, or are in a blocked cell that did not close around them.
    pub intrusions: u64,
    /// Smallest gap between a body and an intruder, metres; infinite without intruders.
    pub intruders_m: f64,
    /// Pairs of a body and an intruder that overlap.
    pub intruder_overlaps: u64,
    /// Pairs of bodies without overlap, one of which is in the other's downwash.
    pub washed: u64,
}

impl Clearance {
    /// No bodies and obstacles in range.
    pub const FREE: Self = Self {
        bodies_m: f64::INFINITY,
        solids_m: f64::INFINITY,
        overlaps: 0,
        intrusions: 0,
        intruders_m: f64::INFINITY,
        intruder_overlaps: 0,
        washed: 0,
    };

    /// Adds the values of another moment.
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

const BATCH: usize = 256;

/// Smallest search radius for obstacles, in radii of the largest body.
const CLOSE: f64 = 4.0;

/// Overlaps smaller than this are rounding errors, metres.
const ROUNDING_M: f64 = 1e-9;

impl Plane {
    /// Creates a plane with these bodies.
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

    /// Adds intruders: foreign bodies that move at constant velocity through everything.
    #[must_use]
    pub fn with_intruders(mut self, intruders: Vec<Disc>) -> Self {
        self.intruders = intruders;
        self
    }

    /// Replaces the space, for example by a torus with periodic borders.
    #[must_use]
    pub fn in_space(mut self, space: Space<f64, 3>) -> Self {
        self.space = space;
        self.index = Cells::new(space, self.reach_m.max(1e-3));
        self
    }

    /// Extends the obstacle index to this search radius, metres.
    #[must_use]
    pub fn with_sight(mut self, sight_m: f64) -> Self {
        let reach_m = sight_m.max(self.solids.reach_m());
        self.solids = Solids::new(self.solids.all().to_vec(), reach_m);
        self
    }

    /// The intruders.
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

    /// Obstacles within `within_m` metres of a position, in order. O(obstacles around it).
    pub fn solids_near(&self, place_m: [f64; 3], within_m: f64) -> impl Iterator<Item = &Solid> {
        self.solids.near(place_m, within_m).filter(move |solid| solid.distance_m(place_m) <= within_m)
    }

    /// Restores the position, velocity and target of a body; intruders follow the robots.
    pub(crate) fn put(&mut self, index: usize, [position_m, velocity_mps, target_mps]: [[f64; 3]; 3]) {
        let intruders = self.intruders.iter_mut();
        if let Some(disc) = self.discs.iter_mut().chain(intruders).nth(index) {
            (disc.position_m, disc.velocity_mps, disc.target_mps) = (position_m, velocity_mps, target_mps);
        }
    }

    pub(crate) fn put_solids(&mut self, solids: Vec<Solid>) {
        self.solids.change(|all| *all = solids);
    }

    pub(crate) fn put_cell(&mut self, cell: Cell, class: u8) {
        if let Some(terrain) = &mut self.terrain {
            terrain.set(cell, class);
        }
    }

    /// Changes terrain cells. A cell that closes around a body stays open for it until it leaves.
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

    /// Cells that closed around body `index` and still hold it, with their previous class.
    #[must_use]
    pub fn shut(&self, index: usize) -> &[(Cell, u8)] {
        &self.shut[index]
    }

    pub(crate) fn put_shut(&mut self, index: usize, shut: Vec<(Cell, u8)>) {
        self.shut[index] = shut;
    }

    /// Appends obstacles, even where bodies are.
    pub fn add_solids(&mut self, solids: impl IntoIterator<Item = Solid>) {
        self.solids.change(|all| all.extend(solids));
    }

    /// Moves an obstacle instantly.
    ///
    /// # Errors
    /// The obstacle does not exist.
    pub fn move_solid(&mut self, index: usize, by_m: [f64; 2]) -> Result<(), Refusal> {
        self.solids.change(|all| {
            let count = all.len();
            let solid = all.get_mut(index).ok_or_else(|| no_solid(index, count))?;
            *solid = solid.moved(by_m);
            Ok(())
        })
    }

    /// Removes an obstacle; the indices of later obstacles decrease by one.
    ///
    /// # Errors
    /// The obstacle does not exist.
    pub fn remove_solid(&mut self, index: usize) -> Result<(), Refusal> {
        if index >= self.solids().len() {
            return Err(no_solid(index, self.solids().len()));
        }
        self.solids.change(|all| all.remove(index));
        Ok(())
    }

    /// Changes a terrain cell; 0 is a wall.
    ///
    /// # Errors
    /// The cell does not exist or is occupied.
    pub fn set_cell(&mut self, cell: Cell, class: u8) -> Result<(), Refusal> {
        let is_taken = self.discs.iter().any(|disc| self.cell(disc.position_m) == Some(cell));
        let Some(terrain) = &mut self.terrain else {
            return Err(Refusal::new("kind", "there is no land", "draw a wall instead"));
        };
        set_cell(terrain, cell, class, is_taken)
    }

    /// The terrain, if there is any.
    #[must_use]
    pub const fn terrain(&self) -> Option<&Terrain> {
        self.terrain.as_ref()
    }

    /// Terrain cell at a position; `None` off the map and without terrain.
    #[must_use]
    pub fn cell(&self, position_m: [f64; 3]) -> Option<Cell> {
        let [x, y, _] = position_m;
        self.terrain.as_ref()?.cell_at([x, y])
    }

    /// Highest speed of body `index` at a position, m/s. A blocked cell counts as the slowest land.
    #[must_use]
    pub fn max_speed_mps(&self, index: usize, position_m: [f64; 3]) -> f64 {
        max_speed_mps(self.terrain(), &self.shut[index], &self.discs[index].abilities, position_m)
    }

    /// Moves the bodies by one tick; `commands[i]` and `ages[i]` belong to body `i`. A hold command
    /// or a command for cells makes it brake.
    ///
    /// A new command changes the velocity at once, by as much as the body can change it in a step
    /// ([`Body::reach`](staya_controller::body::Body::reach)); then the velocity stays for the
    /// step. So the number of ticks in a step does not change the motion that the robot has
    /// planned. A body with a lag approaches this velocity during the step. A body whose command
    /// has expired brakes in each tick, within its acceleration.
    ///
    /// # Panics
    /// If there are fewer commands or ages than bodies.
    pub fn advance(&mut self, commands: &[Command<f32>], ages: &[CommandAge]) {
        let bodies = self.discs.len();
        assert!(commands.len() >= bodies && ages.len() >= bodies, "a command with its age for each body");
        let (land, space) = (self.terrain.as_ref(), self.space);
        let bodies =
            self.discs.par_iter_mut().zip(&mut self.shut).zip(commands.par_iter().zip(ages)).with_min_len(BATCH);
        bodies.for_each(|((disc, shut), (command, age))| {
            disc.steer(command, *age, land, shut);
            disc.go();
            if space.period().is_some() {
                // The height is not periodic.
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

    /// Current distances between bodies, obstacles and intruders. O(bodies x (neighbours +
    /// obstacles in range + intruders)); if no body is near an obstacle, O(bodies x obstacles).
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
        // Obstacles outside the index are farther away than this.
        if !self.solids().is_empty() && clearance.solids_m > close_m - self.largest_m {
            let gaps = bodies().map(|(_, disc)| self.solid_gap_m(disc, f64::INFINITY));
            clearance.solids_m = gaps.reduce(|| f64::INFINITY, f64::min);
        }
        clearance
    }

    fn solid_gap_m(&self, disc: &Disc, within_m: f64) -> f64 {
        let gaps = self.solids.near(disc.position_m, within_m).map(|solid| solid.distance_m(disc.position_m));
        gaps.fold(f64::INFINITY, f64::min) - disc.radius_m
    }

    /// Contribution of one body; a pair counts at its first body.
    fn clearance_of(&self, number: usize, found: &mut Vec<Found<f64, 3>>) -> Clearance {
        let disc = &self.discs[number];
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

fn cells_under(land: &Terrain, disc: &Disc) -> impl Iterator<Item = Cell> {
    let ([x, y, _], r) = (disc.position_m, disc.radius_m);
    let (low, high) = (land.nearest_cell([x - r, y - r]), land.nearest_cell([x + r, y + r]));
    let (cell_m, origin_m) = (land.cell_m, land.origin_m);
    let all = (low.y..=high.y).flat_map(move |row| (low.x..=high.x).map(move |column| Cell::new(column, row)));
    all.filter(move |cell| {
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

/// Whether one of two bodies is in the other's downwash, an ellipsoid higher than wide.
fn is_washed(one: &Disc, other: &Disc) -> bool {
    let high = one.downwash.max(other.downwash);
    let [x, y, z] = [0, 1, 2].map(|axis| other.position_m[axis] - one.position_m[axis]);
    let low_z = z / high;
    libm::sqrt(x * x + y * y + low_z * low_z) < one.radius_m + other.radius_m - ROUNDING_M
}

#[cfg(test)]
mod tests;
