//! A robot among others that avoids them with Staya's ORCA or with `dodgy_2d`.

use dodgy_2d::{Agent, AvoidanceOptions};
use staya_controller::geom::Vec2;
use staya_controller::orca::{HalfPlane, MovingBall, Params, half_plane, solve};
use staya_controller::rand::Rng;
use std::borrow::Cow;

/// Number of neighbours.
pub const NEIGHBORS: usize = 10;
pub(crate) const RADIUS_M: f32 = 0.3;
pub(crate) const SPEED_MPS: f32 = 1.5;
pub(crate) const STEP_S: f32 = 0.05;
pub(crate) const HORIZON_S: f32 = 2.0;

/// A robot at the origin among [`NEIGHBORS`] others, in the types of both crates.
#[derive(Clone, Debug)]
pub struct Crowd {
    own_velocity: Vec2<f32>,
    preferred: Vec2<f32>,
    neighbors: Vec<MovingBall<Vec2<f32>>>,
    own_agent: Agent,
    agents: Vec<Cow<'static, Agent>>,
}

impl Crowd {
    /// Creates a random crowd within 6 m in which no neighbour overlaps the robot.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut within = |range: f32| (rng.below(2_000_001) as f32 / 1e6 - 1.0) * range;
        let mut pair = |range| Vec2::new(within(range), within(range));
        let own_velocity = pair(1.0);
        let preferred = pair(1.0);
        let mut neighbors = Vec::new();
        while neighbors.len() < NEIGHBORS {
            let (offset_m, velocity_mps) = (pair(6.0), pair(1.0));
            if offset_m.norm() > 2.0 * RADIUS_M {
                neighbors.push(MovingBall { offset_m, velocity_mps, radii_m: 2.0 * RADIUS_M, tie: Vec2::ZERO });
            }
        }
        // The robot takes the whole correction: `dodgy_2d` shares it only inside the velocity
        // obstacle, while Staya, like ORCA, always shares.
        let agent = |position: Vec2<f32>, velocity: Vec2<f32>, responsibility: f32| Agent {
            position: dodgy_2d::Vec2::new(position.x, position.y),
            velocity: dodgy_2d::Vec2::new(velocity.x, velocity.y),
            radius: RADIUS_M,
            avoidance_responsibility: responsibility,
        };
        Self {
            own_agent: agent(Vec2::ZERO, own_velocity, 1.0),
            agents: neighbors.iter().map(|n| Cow::Owned(agent(n.offset_m, n.velocity_mps, 0.0))).collect(),
            own_velocity,
            preferred,
            neighbors,
        }
    }

    /// Staya's velocity, and its violation of the half-planes, m/s.
    #[must_use]
    pub fn staya(&self) -> ([f32; 2], f32) {
        let params = Params { horizon_s: HORIZON_S, separation_s: STEP_S, share: 1.0 };
        let nowhere = HalfPlane { point: Vec2::ZERO, normal: Vec2::ZERO };
        let mut planes = [nowhere; NEIGHBORS];
        let mut count = 0;
        for neighbor in &self.neighbors {
            if let Some(plane) = half_plane(self.own_velocity, neighbor, &params) {
                planes[count] = plane;
                count += 1;
            }
        }
        let found = solve::<_, NEIGHBORS>(&planes[..count], 0, self.preferred, SPEED_MPS);
        let Vec2 { x, y } = found.velocity_mps;
        ([x, y], found.penetration_mps)
    }

    /// The velocity by `dodgy_2d`.
    #[must_use]
    pub fn dodgy(&self) -> [f32; 2] {
        let options =
            AvoidanceOptions { obstacle_margin: 0.0, time_horizon: HORIZON_S, obstacle_time_horizon: HORIZON_S };
        let preferred = dodgy_2d::Vec2::new(self.preferred.x, self.preferred.y);
        let velocity =
            self.own_agent.compute_avoiding_velocity(&self.agents, &[], preferred, SPEED_MPS, STEP_S, &options);
        [velocity.x, velocity.y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_choose_the_same_velocity_if_a_permitted_one_exists() {
        let mut compared = 0;
        for seed in 0..2000 {
            let crowd = Crowd::new(seed);
            let (own, penetration) = crowd.staya();
            let other = crowd.dodgy();
            if penetration < 1e-5 {
                compared += 1;
                let off = (own[0] - other[0]).abs() + (own[1] - other[1]).abs();
                assert!(off < 2e-3, "seed {seed}: {own:?} and {other:?}");
            }
        }
        assert!(compared > 1000, "{compared} crowds had a solution");
    }
}
