//! Robots with exact knowledge, which move by the law alone.

use super::Run;
use super::vote::{self, Rule, Shares};
use staya_controller::agent::{GOALS, GoalFlockSettings, LawSettings, LayerSettings};
use staya_controller::body::Body;
use staya_controller::digest::{chained, digest};
use staya_controller::geom::{Position, Vec3};
use staya_controller::goal_flock::{GoalParams, Goals, wish};
use staya_controller::lattice::{LatticeParams, Reference, ReferenceMotion, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::push_out::{PushOutParams, push_out};
use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::{self, Moment, Outcome};
use staya_sim::metrics::flock::gaps;
use staya_sim::nearby::{Cells, Query, Search as _, Space};
use staya_sim::record::{Motion, PacketCounts, RobotRow, TickRow};
use staya_sim::scenario::{PlaneSetup, Scenario, Target};
use staya_sim::world::plane::{Clearance, Solid};

enum Law {
    Lattice { params: LatticeParams<f64>, motion: ReferenceMotion<f64> },
    Goals { params: GoalParams<f64>, arrival_m: f64, push_out: Option<PushOutParams<f64>>, seed: u64 },
}

/// Robots with exact knowledge.
pub(super) struct Crowd<'a> {
    plane: &'a PlaneSetup,
    law: Law,
    targets: Vec<Target>,
    range_m: f64,
    most: usize,
    leaders: u32,
    dying: usize,
    die_s: f64,
    rule: Rule,
    votes: Vec<Shares>,
    fastest_mps: f64,
    step_s: f64,
    places: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    goals: Vec<Goals<GOALS>>,
}

const fn vec([x, y, z]: [f64; 3]) -> Vec3<f64> {
    Vec3 { x, y, z }
}

impl<'a> Crowd<'a> {
    /// `None` if the scenario has another law, several groups, or obstacles that are not balls.
    pub(super) fn new(run: &Run, plane: &'a PlaneSetup) -> Option<Self> {
        let group = &plane.general;
        let push_out = match group.safety {
            LayerSettings::None(_) => None,
            LayerSettings::PushOut(settings) => Some(settings.params.cast()),
            _ => return None,
        };
        let (law, range_m) = match group.law.built_in()? {
            LawSettings::Lattice(lattice) if push_out.is_none() => {
                let params: LatticeParams<f64> = lattice.params.cast();
                (Law::Lattice { params, motion: lattice.motion().cast() }, params.range_m())
            }
            LawSettings::GoalFlock(GoalFlockSettings { params, arrival_m, seed }) => {
                let (params, arrival_m): (GoalParams<f64>, _) = (params.cast(), f64::from(*arrival_m));
                (Law::Goals { params, arrival_m, push_out, seed: *seed }, params.neighborhood_m)
            }
            _ => return None,
        };
        let is_plain = plane.groups.is_empty() && plane.solids.iter().all(|solid| matches!(solid, Solid::Ball { .. }));
        is_plain.then(|| Self {
            fastest_mps: match law {
                Law::Lattice { .. } => run.parameters.fastest_mps,
                Law::Goals { .. } => group.abilities.max_speed_mps,
            },
            rule: run.parameters.votes,
            votes: {
                let goals = plane.starts.first().map_or(0, |start| start.places.len());
                let first = |robot| vote::first(goals, run.parameters.first_goal, run.scenario.seed, robot);
                (0..plane.starts.len() as u32).map(first).collect()
            },
            targets: plane.starts.first().map_or(Vec::new(), |start| start.places.clone()),
            most: run.parameters.nearest,
            leaders: run.parameters.leaders,
            dying: run.parameters.dying as usize,
            die_s: run.parameters.die_s,
            step_s: run.scenario.tick_s(),
            places: plane.starts.iter().map(|start| start.position_m).collect(),
            velocities: plane.starts.iter().map(|start| start.velocity_mps).collect(),
            goals: vec![Goals::new(); plane.starts.len()],
            plane,
            law,
            range_m,
        })
    }

    /// Velocities change before places. O(ticks n k) with k robots in range.
    pub(super) fn simulate(mut self, scenario: &Scenario, each: &mut engine::Watch<'_>) -> Result<Outcome, String> {
        let (mut trace_hash, mut clearance, mut tick) = (0, Clearance::FREE, 0);
        loop {
            let now = self.clearance();
            clearance.add(&now);
            trace_hash = chained(trace_hash, digest(&self.places));
            let time_s = f64::from(tick) * self.step_s;
            let targets = self.targets_at(tick);
            let row = TickRow {
                tick,
                time_s,
                formation_error_per_agent: f64::NAN,
                graph_distance: f64::NAN,
                packets: PacketCounts::default(),
            };
            let mut goals_m = [None; staya_controller::agent::WAYPOINTS];
            goals_m.iter_mut().zip(&targets).for_each(|(goal, target)| *goal = Some(target.position_m));
            let moment = Moment {
                row: &row,
                arrived: 0,
                waiting: 0,
                collisions: clearance.overlaps,
                gap_m: now.bodies_m.is_finite().then_some(now.bodies_m),
                intruders: &[],
                land: None,
                solids: &self.plane.solids,
                goals_m,
                trace_hash,
                run: None,
            };
            if each(&moment, &mut self.rows()).is_break() || tick == scenario.ticks {
                break;
            }
            let dead = if time_s >= self.die_s { self.dying.min(self.places.len()) } else { 0 };
            self.step(&targets, dead)?;
            tick += 1;
        }
        let robots = self.places.len();
        Ok(Outcome {
            ticks: tick,
            seconds: f64::from(tick) * self.step_s,
            arrived: 0,
            arrival_times: vec![None; robots],
            ends: vec![engine::End { mode: Mode::Cruise, wait: None, barrier: None, body: None }; robots],
            collisions: clearance.overlaps,
            packets: PacketCounts::default(),
            throttled: 0,
            waits: Vec::new(),
            formation: None,
            place_error: None,
            formations: Vec::new(),
            clearance: Some(clearance),
            trace_hash,
        })
    }

    fn rows(&self) -> impl Iterator<Item = RobotRow> + '_ {
        let motions = self.places.iter().zip(&self.velocities);
        (1..).zip(motions).map(|(id, (&position_m, &velocity_mps))| RobotRow {
            id,
            motion: Motion { position_m, velocity_mps, cell: Default::default() },
            mode: Mode::Cruise,
            leader: 0,
            target: Default::default(),
            target_m: None,
            wait: None,
            formation_error_cells: f32::NAN,
            radius_m: Some(self.plane.general.radius_m),
            has_cells: false,
        })
    }

    fn clearance(&self) -> Clearance {
        let radius_m = self.plane.general.radius_m;
        let gaps = gaps(&self.places, &vec![radius_m; self.places.len()], &[], 2.0 * radius_m, Space::OPEN);
        let off_m = |place: &[f64; 3], solid: &Solid| solid.distance_m(*place) - radius_m;
        let off = self.places.iter().flat_map(|place| self.plane.solids.iter().map(move |solid| off_m(place, solid)));
        Clearance {
            bodies_m: gaps.between_robots_m.unwrap_or(f64::INFINITY),
            solids_m: off.fold(f64::INFINITY, f64::min),
            overlaps: gaps.overlapping_pairs as u64,
            ..Clearance::FREE
        }
    }

    /// Goals after their motion and the operator's orders.
    fn targets_at(&self, tick: u32) -> Vec<Target> {
        let target = |(index, first): (usize, &Target)| {
            let mut orders =
                self.plane.orders.iter().filter(|order| usize::from(order.index) == index && order.tick < tick);
            let (since, Target { position_m, velocity_mps }) =
                orders.next_back().map_or((0, *first), |order| (order.tick, order.target));
            let moves = !matches!(self.law, Law::Lattice { motion, .. } if motion != ReferenceMotion::Dynamic);
            let span_s = if moves { f64::from(tick - since) * self.step_s } else { 0.0 };
            let position_m = std::array::from_fn(|axis| position_m[axis] + velocity_mps[axis] * span_s);
            Target { position_m, velocity_mps }
        };
        self.targets.iter().enumerate().map(target).collect()
    }

    /// The first `dead` robots are dead.
    fn step(&mut self, targets: &[Target], dead: usize) -> Result<(), String> {
        for (index, target) in targets.iter().enumerate().filter(|_| matches!(self.law, Law::Goals { .. })) {
            let goal = Position::from_metres(target.position_m).ok_or("a goal is too far away")?;
            for goals in &mut self.goals {
                if !goals.set_goal(index, goal) {
                    goals.push(goal).map_err(|_| "too many goals")?;
                }
            }
        }
        let mut cells = Cells::new(Space::OPEN, self.range_m);
        cells.rebuild(&self.places);
        let (mut found, mut nearby, mut next) = (Vec::new(), Vec::new(), Vec::new());
        let (mut votes, weight) = (self.votes.clone(), 1.0 / self.places.len() as f64);
        for (robot, vote) in votes.iter_mut().enumerate() {
            if robot < dead {
                next.push([0.0; 3]);
                continue;
            }
            let (at, except) = (self.places[robot], Some(robot as u32));
            cells.within(&Query { at, radius: self.range_m, most: self.most, except }, &mut found);
            nearby.clear();
            let alive = found.iter().filter(|other| other.index as usize >= dead);
            let heard = alive.clone().filter_map(|other| self.votes.get(other.index as usize));
            *vote = vote::next(self.rule, &self.votes[robot], heard, weight);
            nearby.extend(alive.map(|other| Nearby {
                id: RobotId(other.index + 1),
                offset_m: vec(other.offset),
                velocity_mps: vec(self.velocities[other.index as usize]),
                radius_m: 0.0,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            }));
            next.push(self.next_velocity(robot, &nearby, targets)?);
        }
        (self.velocities, self.votes) = (next, votes);
        for (place, velocity) in self.places.iter_mut().zip(&self.velocities) {
            *place = std::array::from_fn(|axis| place[axis] + velocity[axis] * self.step_s);
        }
        Ok(())
    }

    fn next_velocity(&mut self, robot: usize, nearby: &[Nearby<f64>], targets: &[Target]) -> Result<[f64; 3], String> {
        let (at, velocity) = (vec(self.places[robot]), vec(self.velocities[robot]));
        // The papers' robots are points.
        let body = Body {
            id: RobotId(robot as u32 + 1),
            velocity_mps: velocity,
            radius_m: 0.0,
            max_speed_mps: self.fastest_mps,
            max_acceleration_mps2: f64::MAX,
            step_s: self.step_s,
        };
        let obstacles = self.plane.solids.iter().filter_map(|solid| match *solid {
            Solid::Ball { center_m, radius_m } => Some(Obstacle::Ball { center_m: vec(center_m) - at, radius_m }),
            Solid::Wall(_) | Solid::Plane { .. } => None,
        });
        let mut obstacles: Vec<Obstacle<f64>> = obstacles.collect();
        let next = match &self.law {
            Law::Lattice { params, motion } => {
                let reference = targets.first().map(|target| {
                    let offset_m = vec(target.position_m) - at;
                    Reference { offset_m, velocity_mps: motion.wanted(offset_m, vec(target.velocity_mps)) }
                });
                let next = velocity + acceleration(params, &body, nearby, &obstacles, reference.as_ref()) * self.step_s;
                let speed = next.norm();
                if speed > self.fastest_mps { next * (self.fastest_mps / speed) } else { next }
            }
            Law::Goals { params, arrival_m, push_out: layer, seed } => {
                let own = Position::from_metres(self.places[robot]).ok_or("a robot is too far away")?;
                let goals = &mut self.goals[robot];
                let _ = goals.update(own, *arrival_m, *seed, body.id);
                let goal = if self.rule != Rule::None {
                    goals.as_slice().get(vote::choice(&self.votes[robot])).copied()
                } else if robot < self.leaders as usize {
                    goals.current()
                } else {
                    let leader = nearby.iter().find(|other| other.id.0 <= self.leaders);
                    leader.and_then(|leader| own.moved(leader.offset_m))
                };
                let wished = wish(params, &body, own, goal, nearby);
                match layer {
                    None => wished,
                    Some(layer) => {
                        // Those beyond the smallest distance plus two steps have no effect.
                        let reach_m = layer.min_distance_m + 2.0 * body.max_speed_mps * body.step_s;
                        let near = nearby.iter().take_while(|other| other.offset_m.norm() <= reach_m).count();
                        obstacles.retain(|it| it.nearest_point().is_some_and(|(_, distance_m)| distance_m <= reach_m));
                        push_out(layer, &body, wished, &nearby[..near], &obstacles)
                    }
                }
            }
        };
        Ok([next.x, next.y, next.z])
    }
}
