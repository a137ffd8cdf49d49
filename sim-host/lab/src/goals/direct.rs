//! The law alone, without agents, radio and packets: every robot has perfect knowledge of the
//! robots within R_nbh, and all move at once (PAV, sections 2 and 3). A tick is the flock's wish,
//! push-out, and the step.

use super::Plan;
use super::scene::Scene;
use super::setting::{Knowledge, Setting};
use super::watch::Watch;
use anyhow::{Context as _, Result, bail};
use staya_controller::agent::{GOALS, NEIGHBORS, SafetyKind};
use staya_controller::body::Body;
use staya_controller::digest::{chained, digest};
use staya_controller::geom::{Position, Vec3};
use staya_controller::goal_flock::{GoalParams, Goals, wish};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::push_out::{PushOutParams, push_out};
use staya_controller::robot::{Mode, RobotId};
use staya_sim::nearby::{Cells, Found, Query, Search as _, Space};
use staya_sim::world::plane::Solid;

struct Crowd<'a> {
    scene: &'a Scene,
    params: GoalParams<f32>,
    push_out: Option<PushOutParams<f32>>,
    most: usize,
    arrival_m: f32,
    seed: u64,
    step_s: f32,
    places: Vec<Position>,
    velocities: Vec<Vec3<f32>>,
    goals: Vec<Goals<GOALS>>,
    cells: Cells<f64, 2>,
}

/// Returns a hash of all places in all ticks. O(ticks n k) with k robots within R_nbh.
pub(super) fn run(plan: &Plan, setting: &Setting, scene: &Scene, seed: u64, watch: &mut Watch<'_>) -> Result<u64> {
    let mut crowd = Crowd::new(plan, setting, scene, seed)?;
    let mut hash = 0;
    for tick in 0..=crate::arena::ticks(plan.seconds, plan.step_s) {
        let places_m: Vec<[f64; 2]> = crowd.places.iter().map(|&place| metres(place)).collect();
        let velocities_mps = crowd.velocities.iter().map(|v| [f64::from(v.x), f64::from(v.y)]).collect();
        watch.look(tick, places_m, velocities_mps);
        hash = chained(hash, digest(&crowd.places));
        crowd.step(tick)?;
    }
    Ok(hash)
}

fn metres(place: Position) -> [f64; 2] {
    [0, 1].map(|axis| f64::from(place.mm[axis]) / 1000.0)
}

impl<'a> Crowd<'a> {
    fn new(plan: &Plan, setting: &Setting, scene: &'a Scene, seed: u64) -> Result<Self> {
        let push_out = match setting.safety {
            SafetyKind::None => None,
            SafetyKind::PushOut => Some(PushOutParams {
                model: setting.model,
                evasion: setting.evasion,
                min_distance_m: plan.min_distance_m as f32,
            }),
            other => bail!("safety \"{other}\" needs agents"),
        };
        let place = |at: [f64; 3]| Position::from_metres(at).context("a robot is too far away");
        let places: Vec<Position> = scene.starts.iter().map(|start| place(start.position_m)).collect::<Result<_>>()?;
        let robots = places.len();
        Ok(Self {
            scene,
            params: setting.params(plan.min_distance_m, plan.speed_mps()),
            push_out,
            most: if setting.knows == Knowledge::Nearest { NEIGHBORS } else { usize::MAX },
            arrival_m: (setting.arrival() * plan.min_distance_m) as f32,
            seed,
            step_s: plan.step_s as f32,
            velocities: vec![Vec3::ZERO; robots],
            goals: vec![Goals::new(); robots],
            cells: Cells::new(Space::OPEN, setting.neighborhood_m),
            places,
        })
    }

    fn step(&mut self, tick: u32) -> Result<()> {
        let places_m: Vec<[f64; 2]> = self.places.iter().map(|&place| metres(place)).collect();
        self.cells.rebuild(&places_m);
        let targets = self.scene.goals_at(tick);
        let targets: Vec<_> = targets.into_iter().filter_map(Position::from_metres).collect();
        let (mut found, mut nearby, mut next) = (Vec::new(), Vec::new(), Vec::new());
        for robot in 0..self.places.len() {
            for (index, &target) in targets.iter().enumerate() {
                let goals = &mut self.goals[robot];
                if !goals.set_goal(index, target) {
                    goals.push(target).ok().context("too many goals")?;
                }
            }
            self.look_around(robot, &places_m, &mut found, &mut nearby);
            next.push(self.decide(robot, &nearby));
        }
        self.velocities = next;
        for (place, &velocity) in self.places.iter_mut().zip(&self.velocities) {
            *place = place.moved(velocity * self.step_s).context("a robot is nowhere any more")?;
        }
        Ok(())
    }

    fn look_around(
        &self,
        robot: usize,
        places_m: &[[f64; 2]],
        found: &mut Vec<Found<f64, 2>>,
        nearby: &mut Vec<Nearby<f32>>,
    ) {
        let radius = f64::from(self.params.neighborhood_m);
        let query = Query { at: places_m[robot], radius, most: self.most, except: Some(robot as u32) };
        self.cells.within(&query, found);
        nearby.clear();
        nearby.extend(found.iter().map(|other| Nearby {
            id: number(other.index as usize),
            offset_m: self.places[other.index as usize].since(self.places[robot]),
            velocity_mps: self.velocities[other.index as usize],
            radius_m: 0.0,
            gives_way: true,
            mode: Mode::Cruise,
            is_stranger: false,
        }));
    }

    fn decide(&mut self, robot: usize, nearby: &[Nearby<f32>]) -> Vec3<f32> {
        let (own, id) = (self.places[robot], number(robot));
        // The paper's robots are points, kept apart by R_MinDist.
        let body = Body {
            id,
            velocity_mps: self.velocities[robot],
            radius_m: 0.0,
            max_speed_mps: self.params.speed_mps,
            max_acceleration_mps2: f32::MAX,
            step_s: self.step_s,
        };
        let goals = &mut self.goals[robot];
        let _ = goals.update(own, self.arrival_m, self.seed, id);
        let wished = wish(&self.params, &body, own, goals.current(), nearby);
        let Some(params) = &self.push_out else {
            return wished;
        };
        // Robots beyond the smallest distance plus two steps have no effect.
        let reach_m = params.min_distance_m + 2.0 * body.max_speed_mps * body.step_s;
        let near = nearby.iter().take_while(|other| other.offset_m.norm() <= reach_m).count();
        let seen = self.scene.solids.iter().filter_map(|solid| match solid {
            Solid::Ball { center_m, radius_m } => {
                let center_m = Position::from_metres(*center_m)?.since(own);
                let obstacle = Obstacle::Ball { center_m, radius_m: *radius_m as f32 };
                obstacle.nearest_point().filter(|(_, distance)| *distance <= reach_m).map(|_| obstacle)
            }
            _ => None,
        });
        push_out(params, &body, wished, &nearby[..near], &seen.collect::<Vec<_>>())
    }
}

fn number(index: usize) -> RobotId {
    RobotId(index as u32 + 1)
}
