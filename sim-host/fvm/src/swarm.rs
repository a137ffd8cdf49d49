//! Robots that swap places in a room: ORCA from formulas, its table, or functional voxel models.

use crate::Room;
use clap::Args;
use serde::Serialize;
use staya_controller::body::Body;
use staya_controller::geom::Vec2;
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::{Analytic, AvoidParams, Avoider, HalfSpaces, VoxelTable2k};
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_voxel::{FileError, Model, VoxelNeighbor, obstacles};
use std::f64::consts::TAU;

const RADIUS_M: f32 = 0.12;
const SPEED_MPS: f32 = 0.8;
const STEP_S: f32 = 0.05;
const SIGHT_M: f32 = 1.5;
const ARRIVED_M: f32 = 0.1;
const PURPOSE: u32 = u32::from_be_bytes(*b"swap");

/// Source of half-planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The formula.
    Formula,
    /// ORCA's table of 2 KiB.
    Table,
    /// A functional voxel model.
    Model,
}

/// Robots on a circle; the goal of each is opposite its start. Each start has a random offset of up
/// to 20 mm.
#[derive(Args, Clone, Copy, Debug)]
pub struct Crowd {
    /// Number of robots.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub robots: u32,
    /// Radius of the circle of starts around the origin, metres.
    #[arg(long, value_name = "M", default_value_t = 2.5)]
    pub circle: f32,
    /// Seed; equal seeds give equal starts.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Time limit of a run, seconds.
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    pub limit: f32,
}

/// A swap of places.
#[derive(Clone, Debug)]
pub struct Swap<'a> {
    /// The robots.
    pub crowd: Crowd,
    /// The room.
    pub room: Room,
    /// Bytes of the model of [`Template::Room`](crate::Template::Room).
    pub room_model: &'a [u8],
    /// Bytes of the model of [`Template::Neighbor`](crate::Template::Neighbor).
    pub neighbor_model: &'a [u8],
}

/// Result of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Source of the neighbours' half-planes.
    pub neighbors: Source,
    /// Source of the walls' half-planes.
    pub walls: Source,
    /// Number of robots that arrived.
    pub arrived: u32,
    /// Time of the last arrival, seconds; the limit if not all arrived.
    pub time_s: f32,
    /// Smallest gap between two robots, metres.
    pub gap_m: f32,
    /// Smallest gap between a robot and a wall of the exact room, metres.
    pub wall_gap_m: f32,
    /// Overlaps, summed over pairs and ticks.
    pub overlaps: u32,
}

struct Robot<P: HalfSpaces<f32>> {
    at: Vec2<f32>,
    velocity: Vec2<f32>,
    goal: Vec2<f32>,
    avoider: Avoider<f32, 32, P>,
    has_arrived: bool,
}

impl Swap<'_> {
    /// The first robot, counted from 1, whose place on the circle is inside a wall.
    #[must_use]
    pub fn blocked(&self) -> Option<u32> {
        let function = self.room.function(crate::System::R1);
        let free = |index| {
            let Vec2 { x, y } = self.place(index);
            function.value([x.into(), y.into()]) < -f64::from(RADIUS_M + 0.03)
        };
        (0..self.crowd.robots).find(|&index| !free(index)).map(|index| index + 1)
    }

    fn place(&self, index: u32) -> Vec2<f32> {
        let (sin, cos) = libm::sincos(TAU * f64::from(index) / f64::from(self.crowd.robots));
        Vec2::new(cos as f32, sin as f32) * self.crowd.circle
    }

    /// Simulates one run.
    ///
    /// # Errors
    /// An invalid model.
    pub fn run(&self, neighbors: Source, walls: Source) -> Result<Outcome, FileError> {
        match neighbors {
            Source::Formula => self.go([neighbors, walls], Analytic),
            Source::Table => self.go([neighbors, walls], VoxelTable2k),
            Source::Model => self.go([neighbors, walls], VoxelNeighbor::new(Model::from_bytes(self.neighbor_model)?)),
        }
    }

    fn go<P: HalfSpaces<f32, Velocity = Vec2<f32>> + Clone>(
        &self,
        [neighbors, walls]: [Source; 2],
        by: P,
    ) -> Result<Outcome, FileError> {
        let model = Model::<f32, 2>::from_bytes(self.room_model)?;
        let truth = self.room.function(crate::System::R1);
        let mut robots: Vec<Robot<P>> = (0..self.crowd.robots).map(|index| self.robot(index, by.clone())).collect();
        let mut outcome = Outcome {
            neighbors,
            walls,
            arrived: 0,
            time_s: self.crowd.limit,
            gap_m: f32::INFINITY,
            wall_gap_m: f32::INFINITY,
            overlaps: 0,
        };
        let ticks = (self.crowd.limit / STEP_S) as u32;
        for tick in 0..ticks {
            let wished: Vec<_> =
                (0..robots.len()).map(|own| self.decide(&mut robots, own, tick, walls, &model)).collect();
            for (robot, velocity) in robots.iter_mut().zip(wished) {
                robot.velocity = velocity;
                robot.at += velocity * STEP_S;
                robot.has_arrived = robot.has_arrived || (robot.goal - robot.at).norm() < ARRIVED_M;
                let inside = truth.value([robot.at.x.into(), robot.at.y.into()]) as f32;
                outcome.wall_gap_m = outcome.wall_gap_m.min(-inside - RADIUS_M);
            }
            for (index, one) in robots.iter().enumerate() {
                for other in &robots[index + 1..] {
                    let gap = (one.at - other.at).norm() - 2.0 * RADIUS_M;
                    outcome.gap_m = outcome.gap_m.min(gap);
                    outcome.overlaps += u32::from(gap < 0.0);
                }
            }
            outcome.arrived = robots.iter().filter(|robot| robot.has_arrived).count() as u32;
            if outcome.arrived == self.crowd.robots {
                outcome.time_s = (tick + 1) as f32 * STEP_S;
                break;
            }
        }
        Ok(outcome)
    }

    fn robot<P: HalfSpaces<f32>>(&self, index: u32, by: P) -> Robot<P> {
        let place = self.place(index);
        let mut rng = Rng::keyed(self.crowd.seed, PURPOSE, index, 0);
        let mut off = || (rng.below(41) as f32 - 20.0) * 0.001;
        let at = place + Vec2::new(off(), off());
        let avoider = Avoider::with_source(AvoidParams { margin_m: 0.004, ..AvoidParams::default() }, by);
        Robot { at, velocity: Vec2::ZERO, goal: -place, avoider, has_arrived: false }
    }

    fn decide<P: HalfSpaces<f32, Velocity = Vec2<f32>>>(
        &self,
        robots: &mut [Robot<P>],
        own: usize,
        tick: u32,
        walls: Source,
        model: &Model<'_, f32, 2>,
    ) -> Vec2<f32> {
        let number = |index: usize| RobotId(index as u32 + 1);
        let (at, velocity, goal) = (robots[own].at, robots[own].velocity, robots[own].goal);
        let others = robots.iter().enumerate().filter(|(index, _)| *index != own);
        let mut nearby: Vec<Nearby<f32>> = others
            .map(|(index, other)| Nearby {
                id: number(index),
                offset_m: (other.at - at).extend(0.0),
                velocity_mps: other.velocity.extend(0.0),
                radius_m: RADIUS_M,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            })
            .collect();
        nearby.sort_by(|one, other| one.offset_m.norm().total_cmp(&other.offset_m.norm()));
        nearby.truncate(16);
        let around: Vec<Obstacle<f32>> = match walls {
            // Outside the model the robot avoids neighbours only, which shows in the result.
            Source::Model => obstacles(model, at, RADIUS_M + 2.0 * SPEED_MPS * STEP_S)
                .map(|found| found.iter().copied().collect())
                .unwrap_or_default(),
            Source::Formula | Source::Table => {
                let mut all = self.room.obstacles(at);
                all.retain(|one| one.nearest_point().is_none_or(|(_, distance)| distance < SIGHT_M));
                all
            }
        };
        let body = Body {
            id: number(own),
            velocity_mps: velocity.extend(0.0),
            radius_m: RADIUS_M,
            max_speed_mps: SPEED_MPS,
            max_acceleration_mps2: f32::MAX,
            step_s: STEP_S,
        };
        let way = goal - at;
        let wish = (way * (1.0 / STEP_S)).clamp_norm(SPEED_MPS);
        let mut rng = Rng::keyed(self.crowd.seed, PURPOSE, own as u32, tick + 1);
        robots[own].avoider.velocity(&body, wish, Some(way), &nearby, &around, &mut rng).velocity_mps
    }
}
