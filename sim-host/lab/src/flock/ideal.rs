//! The law alone, as in the paper: particles with perfect knowledge, in doubles, without a speed
//! limit by default. Differences from agents are effects of radio or bodies.

use super::Plan;
use anyhow::{Context as _, Result};
use staya_controller::agent::GuidanceSetup;
use staya_controller::body::Body;
use staya_controller::geom::Vec3;
use staya_controller::lattice::{LatticeParams, Reference, ReferenceMotion, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::nearby::{Cells, Query, Search as _, Space};
use staya_sim::scenario::{Scenario, Target};
use staya_sim::world::plane::Solid;

/// Passes each moment to the caller, including the start, and returns their hash. As in the engine,
/// velocities change before places. O(n + edges) per tick.
pub(super) fn simulate(
    plan: &Plan,
    scenario: &Scenario,
    mut look: impl FnMut(u32, &[[f64; 3]], &[[f64; 3]]),
) -> Result<u64> {
    let setup = scenario.plane.as_ref().context("particles fly in the plane or in space")?;
    let GuidanceSetup::Lattice { params, motion } = &setup.general.guidance else {
        anyhow::bail!("particles go by the alpha flock");
    };
    let (params, motion) = (params.cast(), motion.cast());
    let mut places: Vec<[f64; 3]> = setup.starts.iter().map(|start| start.position_m).collect();
    let mut velocities: Vec<[f64; 3]> = setup.starts.iter().map(|start| start.velocity_mps).collect();
    let target = setup.starts.first().and_then(|start| start.places.first()).copied();
    let step_s = scenario.tick_s();
    let swarm = Swarm {
        fastest_mps: plan.fastest.map_or(f64::MAX, |fastest| fastest * plan.spacing_m / 7.0),
        most: plan.nearest.unwrap_or(usize::MAX),
        range_m: params.range_m(),
        solids: &setup.solids,
        params,
        motion,
        step_s,
    };
    let mut hash = 0;
    look(0, &places, &velocities);
    for tick in 1..=scenario.ticks {
        let target = target.map(|target| swarm.target_at(target, f64::from(tick - 1) * step_s));
        let changes = swarm.changes(&places, &velocities, target);
        for ((place, velocity), change) in places.iter_mut().zip(&mut velocities).zip(changes) {
            *velocity = swarm.limited(std::array::from_fn(|axis| velocity[axis] + change[axis] * step_s));
            *place = std::array::from_fn(|axis| place[axis] + velocity[axis] * step_s);
        }
        look(tick, &places, &velocities);
        hash = staya_controller::digest::chained(hash, staya_controller::digest::digest(&places));
    }
    Ok(hash)
}

struct Swarm<'a> {
    params: LatticeParams<f64>,
    motion: ReferenceMotion<f64>,
    solids: &'a [Solid],
    range_m: f64,
    most: usize,
    fastest_mps: f64,
    step_s: f64,
}

impl Swarm<'_> {
    fn target_at(&self, target: Target, time_s: f64) -> Target {
        let Target { position_m, velocity_mps } = target;
        if self.motion != ReferenceMotion::Dynamic {
            return target;
        }
        let position_m = std::array::from_fn(|axis| position_m[axis] + velocity_mps[axis] * time_s);
        Target { position_m, velocity_mps }
    }

    fn limited(&self, velocity: [f64; 3]) -> [f64; 3] {
        let speed = libm::sqrt(velocity.iter().map(|v| v * v).sum());
        if speed > self.fastest_mps { velocity.map(|v| v * self.fastest_mps / speed) } else { velocity }
    }

    fn changes(&self, places: &[[f64; 3]], velocities: &[[f64; 3]], target: Option<Target>) -> Vec<[f64; 3]> {
        let vec = |[x, y, z]: [f64; 3]| Vec3::new(x, y, z);
        let mut cells = Cells::new(Space::OPEN, self.range_m);
        cells.rebuild(places);
        let (mut found, mut nearby) = (Vec::new(), Vec::new());
        let mut change = |(robot, &at): (u32, &[f64; 3])| {
            let query = Query { at, radius: self.range_m, most: self.most, except: Some(robot) };
            cells.within(&query, &mut found);
            nearby.clear();
            nearby.extend(found.iter().map(|other| Nearby {
                id: RobotId(other.index + 1),
                offset_m: vec(other.offset),
                velocity_mps: vec(velocities[other.index as usize]),
                radius_m: 0.0,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            }));
            let body = Body {
                id: RobotId(robot + 1),
                velocity_mps: vec(velocities[robot as usize]),
                radius_m: 0.0,
                max_speed_mps: self.fastest_mps,
                max_acceleration_mps2: f64::MAX,
                step_s: self.step_s,
            };
            let ball = |solid: &Solid| match *solid {
                Solid::Ball { center_m, radius_m } => {
                    Some(Obstacle::Ball { center_m: vec(center_m) - vec(at), radius_m })
                }
                Solid::Wall(_) | Solid::Plane { .. } => None,
            };
            let obstacles: Vec<Obstacle<f64>> = self.solids.iter().filter_map(ball).collect();
            let reference = target.map(|target| {
                let offset_m = vec(target.position_m) - vec(at);
                Reference { offset_m, velocity_mps: self.motion.wanted(offset_m, vec(target.velocity_mps)) }
            });
            let u = acceleration(&self.params, &body, &nearby, &obstacles, reference.as_ref());
            [u.x, u.y, u.z]
        };
        (0..).zip(places).map(&mut change).collect()
    }
}
