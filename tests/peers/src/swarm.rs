//! A step of collision avoidance for many robots, by Staya's ORCA or by `dodgy_2d`.

use crate::crowd::{HORIZON_S, NEIGHBORS, RADIUS_M, SPEED_MPS, STEP_S};
use dodgy_2d::{Agent, AvoidanceOptions};
use staya_controller::geom::Vec2;
use staya_controller::orca::{HalfPlane, MovingBall, Params, half_plane, solve};
use staya_controller::rand::Rng;
use staya_sim::nearby::{Cells, Found, Query, Search, Space};
use std::borrow::Cow;

const RANGE_M: f32 = 5.0;
const CELL_M: f32 = 2.5;
/// About 22 robots are in range, of which the nearest ten are used.
const GROUND_M2: f32 = 3.6;

/// Robots on a square, each with a preferred velocity.
#[derive(Clone, Debug)]
pub struct Swarm {
    places: Vec<[f32; 2]>,
    agents: Vec<Agent>,
    wishes: Vec<Vec2<f32>>,
    cells: Cells<f32, 2>,
    found: Vec<Found<f32, 2>>,
    /// Velocities of the last step.
    pub chosen: Vec<[f32; 2]>,
}

impl Swarm {
    /// Creates `robots` robots at random, non-overlapping places.
    #[must_use]
    pub fn new(robots: usize, seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut share = || rng.below(2_000_001) as f32 / 1e6 - 1.0;
        let half = (robots as f32 * GROUND_M2).sqrt() / 2.0;
        let mut places: Vec<[f32; 2]> = Vec::new();
        while places.len() < robots {
            let at = [share() * half, share() * half];
            let is_free = |&[x, y]: &[f32; 2]| {
                let off = Vec2::new(x - at[0], y - at[1]);
                off.norm() > 2.0 * RADIUS_M
            };
            if places.iter().all(is_free) {
                places.push(at);
            }
        }
        let mut pair = || Vec2::new(share(), share());
        let agents = places.iter().map(|&[x, y]| {
            let velocity = pair();
            Agent {
                position: dodgy_2d::Vec2::new(x, y),
                velocity: dodgy_2d::Vec2::new(velocity.x, velocity.y),
                radius: RADIUS_M,
                avoidance_responsibility: 1.0,
            }
        });
        let agents = agents.collect();
        Self {
            wishes: places.iter().map(|_| pair()).collect(),
            chosen: vec![[0.0; 2]; robots],
            agents,
            places,
            cells: Cells::new(Space::OPEN, CELL_M),
            found: Vec::new(),
        }
    }

    fn query(at: [f32; 2], robot: u32) -> Query<f32, 2> {
        Query { at, radius: RANGE_M, most: NEIGHBORS, except: Some(robot) }
    }

    /// One step with Staya: index, neighbours, half-planes, velocities.
    pub fn staya(&mut self) {
        let params = Params { horizon_s: HORIZON_S, separation_s: STEP_S, share: 0.5 };
        let nowhere = HalfPlane { point: Vec2::ZERO, normal: Vec2::ZERO };
        let velocity = |agent: &Agent| Vec2::new(agent.velocity.x, agent.velocity.y);
        self.cells.rebuild(&self.places);
        for &robot in self.cells.order() {
            let own = robot as usize;
            self.cells.within(&Self::query(self.places[own], robot), &mut self.found);
            let own_velocity = velocity(&self.agents[own]);
            let mut planes = [nowhere; NEIGHBORS];
            let mut count = 0;
            for other in &self.found {
                let agent = &self.agents[other.index as usize];
                let neighbor = MovingBall {
                    offset_m: Vec2::new(other.offset[0], other.offset[1]),
                    velocity_mps: velocity(agent),
                    radii_m: RADIUS_M + agent.radius,
                    tie: Vec2::ZERO,
                };
                if let Some(plane) = half_plane(own_velocity, &neighbor, &params) {
                    planes[count] = plane;
                    count += 1;
                }
            }
            let wish = self.wishes[own];
            let found = solve::<_, NEIGHBORS>(&planes[..count], 0, wish, SPEED_MPS);
            self.chosen[own] = [found.velocity_mps.x, found.velocity_mps.y];
        }
    }

    /// One step with the same neighbours and velocities by `dodgy_2d`.
    pub fn dodgy(&mut self) {
        let options =
            AvoidanceOptions { obstacle_margin: 0.0, time_horizon: HORIZON_S, obstacle_time_horizon: HORIZON_S };
        self.cells.rebuild(&self.places);
        let mut others: Vec<Cow<'_, Agent>> = Vec::new();
        for &robot in self.cells.order() {
            let own = robot as usize;
            self.cells.within(&Self::query(self.places[own], robot), &mut self.found);
            others.clear();
            let seen = self.found.iter();
            others.extend(seen.map(|other| Cow::Borrowed(&self.agents[other.index as usize])));
            let wish = dodgy_2d::Vec2::new(self.wishes[own].x, self.wishes[own].y);
            let velocity = self.agents[own].compute_avoiding_velocity(&others, &[], wish, SPEED_MPS, STEP_S, &options);
            self.chosen[own] = [velocity.x, velocity.y];
        }
    }

    /// The neighbour search alone; returns the number of neighbours found.
    pub fn search(&mut self) -> usize {
        self.cells.rebuild(&self.places);
        let mut count = 0;
        for &robot in self.cells.order() {
            let query = Self::query(self.places[robot as usize], robot);
            self.cells.within(&query, &mut self.found);
            count += self.found.len();
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_have_about_ten_neighbours_and_keep_the_speed_limit() {
        let mut swarm = Swarm::new(1000, 1);
        assert!(swarm.search() > 9500);
        let is_sound = |swarm: &Swarm| {
            let speeds = swarm.chosen.iter().map(|[x, y]| Vec2::new(*x, *y).norm());
            speeds.fold(0.0_f32, f32::max) <= SPEED_MPS * 1.001
        };
        swarm.staya();
        let own = swarm.chosen.clone();
        assert!(is_sound(&swarm));
        swarm.dodgy();
        assert!(is_sound(&swarm));
        // The shares differ outside velocity obstacles (see `crowd`).
        let off = |(a, b): (&[f32; 2], &[f32; 2])| Vec2::new(a[0] - b[0], a[1] - b[1]).norm();
        let alike = own.iter().zip(&swarm.chosen).filter(|pair| off(*pair) < 0.5);
        assert!(alike.count() > 500);
    }
}
