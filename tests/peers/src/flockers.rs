//! One flock in Staya's simulator and in `krabmaga`, with the same law, torus and start.

use krabmaga::engine::agent::Agent;
use krabmaga::engine::fields::field::Field;
use krabmaga::engine::fields::field_2d::{Field2D, Location2D};
use krabmaga::engine::location::Real2D;
use krabmaga::engine::schedule::Schedule;
use krabmaga::engine::state::State;
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Torus, Vec2, Vec3};
use staya_controller::neighbor::Nearby;
use staya_controller::robot::{Mode, RobotId};
use staya_lab::study::boids::{Flock, Parameters};
use std::any::Any;
use std::cell::RefCell;
use std::fmt;
use std::hash::{Hash, Hasher};

/// The paper's flock, dense enough for boids to align and to turn away.
#[must_use]
pub fn plan() -> Parameters {
    Parameters::default()
}

/// Creates about `boids` boids at the paper's density. Both sides of the torus are multiples of the
/// visible distance, because only then does `krabmaga`'s grid wrap around.
#[must_use]
pub fn flock(boids: u32) -> Flock {
    let plan = plan();
    let side = (boids as f32 * plan.area_per_boid).sqrt();
    let whole = (side / plan.closest).floor().max(3.0) * plan.closest;
    plan.flock_on(boids, [whole; 2], 1)
}

#[derive(Clone, Copy, Debug)]
struct Boid {
    id: u32,
    place: Real2D,
    heading: Vec2<f32>,
}

impl PartialEq for Boid {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Boid {}

impl Hash for Boid {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        self.id.hash(hasher);
    }
}

impl fmt::Display for Boid {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.id)
    }
}

impl Location2D<Real2D> for Boid {
    fn get_location(self) -> Real2D {
        self.place
    }

    fn set_location(&mut self, place: Real2D) {
        self.place = place;
    }
}

struct World {
    field: Field2D<Boid>,
    torus: Torus<f32>,
    params: BoidsParams<f32>,
    closest: f32,
    speed: f32,
    start: Vec<Boid>,
}

impl World {
    fn new(flock: &Flock) -> Self {
        let plan = plan();
        let [width, height] = flock.sides();
        let boids = flock.places().iter().zip(flock.headings());
        let start = (0..).zip(boids).map(|(id, (&[x, y], &heading))| Boid { id, place: Real2D { x, y }, heading });
        Self {
            // With the option "toroidal", the field's search stops at the borders (version 0.6.2).
            field: Field2D::new(width, height, plan.closest, false),
            torus: Torus { size_m: [width, height] },
            params: BoidsParams::new(plan.crowded, plan.closest, plan.max_turn, plan.max_turn_away),
            closest: plan.closest,
            speed: plan.speed,
            start: start.collect(),
        }
    }
}

impl State for World {
    fn init(&mut self, schedule: &mut Schedule) {
        for boid in &self.start {
            self.field.set_object_location(*boid, boid.place);
            schedule.schedule_repeating(Box::new(*boid), 0.0, 0);
        }
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_state_mut(&mut self) -> &mut dyn State {
        self
    }

    fn as_state(&self) -> &dyn State {
        self
    }

    fn reset(&mut self) {}

    fn update(&mut self, _step: u64) {
        self.field.lazy_update();
    }
}

impl Agent for Boid {
    fn step(&mut self, state: &mut dyn State) {
        let Some(world) = state.as_any().downcast_ref::<World>() else {
            return;
        };
        // The nine surrounding cells; the law skips boids out of range and the boid itself.
        let others = world.field.get_neighbors_within_relax_distance(self.place, world.closest);
        let seen = others.iter().map(|other| {
            let offset = Vec2::new(other.place.x - self.place.x, other.place.y - self.place.y);
            let Vec2 { x, y } = world.torus.shortest(offset);
            Nearby {
                id: RobotId(other.id + 1),
                offset_m: Vec3::new(x, y, 0.0),
                velocity_mps: other.heading.extend(0.0),
                radius_m: 0.0,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            }
        });
        let seen: Vec<Nearby<f32>> = seen.collect();
        self.heading = world.params.steer(RobotId(self.id + 1), self.heading, &seen);
        let moved = Vec2::new(self.place.x, self.place.y) + self.heading * world.speed;
        let Vec2 { x, y } = world.torus.wrap(moved);
        self.place = Real2D { x, y };
        world.field.set_object_location(*self, self.place);
    }
}

/// A flock in `krabmaga`.
pub struct Peer {
    schedule: Schedule,
    world: World,
}

impl Peer {
    /// Creates the peer with the same start.
    #[must_use]
    pub fn new(flock: &Flock) -> Self {
        let mut world = World::new(flock);
        let mut schedule = Schedule::new();
        world.init(&mut schedule);
        Self { schedule, world }
    }

    /// Turns and moves all boids.
    pub fn step(&mut self) {
        self.schedule.step(&mut self.world);
    }

    /// Headings, in the order of boid numbers.
    #[must_use]
    pub fn headings(&self) -> Vec<Vec2<f32>> {
        let all = RefCell::new(vec![Vec2::ZERO; self.world.start.len()]);
        self.world.field.iter_objects(|_, boid| {
            all.borrow_mut()[boid.id as usize] = boid.heading;
        });
        all.into_inner()
    }
}

/// The grid of `krabmaga` alone, with the places of a flock.
pub struct Grid {
    field: Field2D<Boid>,
    torus: Torus<f32>,
    closest: f32,
    boids: Vec<Boid>,
}

impl Grid {
    /// Creates the grid of this flock's torus.
    #[must_use]
    pub fn new(flock: &Flock) -> Self {
        let World { field, torus, closest, start, .. } = World::new(flock);
        Self { field, torus, closest, boids: start }
    }

    /// Inserts all places and counts the neighbours of all boids.
    pub fn neighbours(&mut self) -> usize {
        for boid in &self.boids {
            self.field.set_object_location(*boid, boid.place);
        }
        self.field.lazy_update();
        let near = self.boids.iter().map(|boid| {
            let others = self.field.get_neighbors_within_relax_distance(boid.place, self.closest);
            let is_near = |other: &&Boid| {
                let offset = Vec2::new(other.place.x - boid.place.x, other.place.y - boid.place.y);
                other.id != boid.id && self.torus.shortest(offset).norm_squared() <= self.closest * self.closest
            };
            others.iter().filter(is_near).count()
        });
        near.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_sim::nearby::{Cells, Query, Search, Space};

    #[test]
    fn both_flocks_fly_alike() {
        let mut flock = flock(2000);
        let mut peer = Peer::new(&flock);
        let space = Space::torus(flock.sides()).expect("a torus");
        let mut cells = Cells::new(space, plan().closest);
        for _ in 0..3 {
            flock.step_by_cells(&mut cells);
            peer.step();
        }
        let same = flock.headings().iter().zip(peer.headings());
        // Sums run in another order, so a boid between two choices may take the other one.
        let alike = same.filter(|(one, other)| (**one - *other).norm() < 1e-4).count();
        assert!(alike >= 1990, "{alike} of 2000");
    }

    #[test]
    fn both_grids_find_the_same_neighbours() {
        let flock = flock(2000);
        let mut cells = Cells::new(Space::torus(flock.sides()).expect("a torus"), plan().closest);
        cells.rebuild(flock.places());
        let mut found = Vec::new();
        let near = (0..).zip(flock.places()).map(|(boid, &at)| {
            let query = Query { at, radius: plan().closest, most: usize::MAX, except: Some(boid) };
            cells.within(&query, &mut found);
            found.len()
        });
        let mut grid = Grid::new(&flock);
        let wanted: usize = near.sum();
        assert_eq!((grid.neighbours(), grid.neighbours()), (wanted, wanted));
    }
}
