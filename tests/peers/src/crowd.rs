//! A robot among others, avoided by Staya's ORCA and by `dodgy_2d`'s.

use dodgy_2d::{Agent, AvoidanceOptions};
use staya_controller::geom::Vec2;
use staya_controller::orca::{HalfPlane, MovingBall, Params, half_plane, solve};
use staya_controller::rand::Rng;
use std::borrow::Cow;

/// Neighbours of the robot.
pub const NEIGHBORS: usize = 10;
pub(crate) const RADIUS_M: f32 = 0.3;
pub(crate) const SPEED_MPS: f32 = 1.5;
pub(crate) const STEP_S: f32 = 0.05;
pub(crate) const HORIZON_S: f32 = 2.0;

/// A robot in the origin among [`NEIGHBORS`] others, in the terms of both crates.
#[derive(Clone, Debug)]
pub struct Crowd {
    own_velocity: Vec2<f32>,
    preferred: Vec2<f32>,
    neighbors: Vec<MovingBall<Vec2<f32>>>,
    own_agent: Agent,
    agents: Vec<Cow<'static, Agent>>,
}

impl Crowd {
    /// A random crowd within 6 m; nobody overlaps the robot.
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
        // The robot takes the whole correction: `dodgy_2d` shares it only inside the velocity obstacle
        // and hands out all room outside of it to each of both, Staya (as ORCA) shares always.
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

    /// The half-planes of all neighbours and the velocity, by Staya; with how far it violates them, m/s.
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
    fn both_choose_the_same_velocity_where_there_is_one() {
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
