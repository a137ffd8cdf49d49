//! Flocks as papers simulate them: from normally distributed starts, or with exact knowledge of the
//! robots in range instead of agents and radio. All other fields are the scenario's.
//!
//! With exact knowledge, all robots move at once by the law alone (OLF, section VIII; PAV, sections
//! 2 and 3), in doubles. Differences from agents are effects of radio or bodies.

use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, draw, measure};
use crate::probe;
use staya_controller::agent::{GOALS, GuidanceSetup, SafetySetup};
use staya_controller::body::Body;
use staya_controller::digest::{chained, digest};
use staya_controller::geom::{Position, Vec3};
use staya_controller::goal_flock::{GoalParams, Goals, wish};
use staya_controller::lattice::{LatticeParams, Reference, ReferenceMotion, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::push_out::{PushOutParams, push_out};
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::{self, Moment, Outcome};
use staya_sim::metrics::flock::gaps;
use staya_sim::nearby::{Cells, Query, Search as _, Space};
use staya_sim::record::{Motion, PacketCounts, RobotRow, TickRow};
use staya_sim::scenario::{PlaneSetup, Scenario, Start, Target};
use staya_sim::world::plane::{Clearance, Solid};
use staya_sim::{choice, table};
use std::path::{Path, PathBuf};

const STARTS: u32 = 0x0046_0101;
const SQUARES: u32 = 0x0046_0201;
const TREES: u32 = 0x0046_0102;
const PLACES: u32 = 0x0047_0104;
const TRIES: u32 = 1000;

/// The study.
#[derive(Debug)]
pub struct Flock;

choice! {
    /// Knowledge of a robot about the others.
    pub enum Knowledge {
        /// Agents that receive packets.
        Packets = "packets",
        /// Exact places and velocities of all robots in the law's range.
        All = "all",
    }
}

table! {
    /// Discs of random sizes at random places.
    #[derive(Copy)]
    pub struct Scattered {
        /// Number of discs.
        pub count: u32;
        /// Smallest and largest radius. Default: points.
        pub radius_m: [f64; 2] = [0.0; 2];
        /// South-west corner.
        pub from_m: [f64; 2];
        /// North-east corner.
        pub to_m: [f64; 2];
        /// Least distance of two edges.
        pub gap_m: f64;
    }
}

impl Scattered {
    /// Centres and radii; `None` if they find no room or are invalid.
    fn draw(&self, most: usize, mut rng: Rng) -> Option<Vec<([f64; 3], f64)>> {
        if self.count as usize > most || !self.radius_m.iter().all(|radius| (0.0..=1e5).contains(radius)) {
            return None;
        }
        let mut discs: Vec<([f64; 3], f64)> = Vec::new();
        let [[west, south], [east, north]] = [self.from_m, self.to_m];
        let mut disc = || {
            let [x, y] = [uniform(&mut rng, west, east), uniform(&mut rng, south, north)];
            ([x, y, 0.0], uniform(&mut rng, self.radius_m[0], self.radius_m[1]))
        };
        for _ in 0..self.count {
            let is_free = |&(center, radius): &([f64; 3], f64)| {
                discs.iter().all(|other| distance_m(center, other.0) - radius - other.1 >= self.gap_m)
            };
            let drawn = (0..100 * TRIES).map(|_| disc()).find(is_free)?;
            discs.push(drawn);
        }
        Some(discs)
    }
}

table! {
    /// Starts in squares of rows, one square for each group of robots.
    pub struct Squares {
        /// South-west corners of the squares.
        pub from_m: Vec<[f64; 2]>;
        /// Distance of two rows.
        pub spacing_m: f64;
        /// Largest random offset of a start along each axis.
        pub noise_m: f64;
        /// Largest random offset of a square but the first to the north or south.
        pub shift_m: f64;
    }
}

impl Squares {
    /// `None` if a group has no square.
    fn place(&self, plane: &mut PlaneSetup, mut rng: Rng) -> Option<()> {
        let group_of = |start: &Start| start.group.map_or(0, |group| group + 1);
        for (group, [west, south]) in self.from_m.iter().enumerate() {
            let side = plane.starts.iter().filter(|start| group_of(start) == group).count().isqrt().max(1);
            let shift_m = if group == 0 { 0.0 } else { uniform(&mut rng, -self.shift_m, self.shift_m) };
            let mut noise = || uniform(&mut rng, -self.noise_m, self.noise_m);
            for (number, start) in plane.starts.iter_mut().filter(|start| group_of(start) == group).enumerate() {
                let [east, north] = [number / side, number % side].map(|rows| rows as f64 * self.spacing_m);
                start.position_m = [west + east + noise(), south + shift_m + north + noise(), 0.0];
            }
        }
        plane.starts.iter().all(|start| group_of(start) < self.from_m.len()).then_some(())
    }
}

table! {
    /// Parameters of a run.
    pub struct Parameters {
        /// Knowledge of a robot about the others. Default: `"packets"`.
        pub knows: Knowledge = Knowledge::Packets;
        /// Number of nearest robots that each robot knows with exact knowledge.
        pub nearest: usize = usize::MAX;
        /// Speed limit of alpha flocks with exact knowledge; the paper has none.
        pub fastest_mps: f64 = f64::MAX;
        /// Gain c2 of alpha flocks for neighbours, instead of 2 sqrt(c1).
        pub c2_alpha: Option<f32>;
        /// Gain c2 of alpha flocks for the reference, instead of 2 sqrt(c1).
        pub c2_gamma: Option<f32>;
        /// Standard deviation of starts along each axis, instead of the scenario's starts.
        pub deviation_m: [f64; 3] = [0.0; 3];
        /// Starts instead of the scenario's.
        pub squares: Option<Squares>;
        /// Balls besides those of the scenario.
        pub forest: Option<Scattered>;
        /// Goals instead of those of the scenario, in its plane.
        pub goals: Option<Scattered>;
    }
}

/// A checked run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The scenario, with its starts drawn.
    pub scenario: Scenario,
    parameters: Parameters,
}

impl Study for Flock {
    fn name(&self) -> &'static str {
        "flock"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        let own = [
            ("collisions", "pairs of bodies that overlap, summed over ticks"),
            ("least_gap_m", "smallest gap between two bodies; empty: none came close"),
            ("least_obstacle_gap_m", "smallest gap between a body and an obstacle"),
        ];
        own.map(|(name, meaning)| (name.to_owned(), meaning)).into_iter().chain(probe::measures()).collect()
    }

    fn takes_scenario(&self) -> bool {
        true
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let (run, measures) = (Run::read(given, given.parameters()?)?, given.measures.to_vec());
        Ok(Box::new(move |watch| measure(&run.scenario, &measures, watch, &|each| run.simulate(each))))
    }

    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let run = Run::read(given, given.parameters()?)?;
        draw(&run.scenario, given.measures, &|each| run.simulate(each), title, stem)
    }
}

impl Run {
    /// Reads the scenario of a run and checks it with the parameters.
    ///
    /// # Errors
    /// Names the field that is wrong.
    pub fn read(given: &Given<'_>, parameters: Parameters) -> Result<Self, SweepError> {
        let mut scenario = given.scenario()?;
        let Some(plane) = scenario.plane_mut().filter(|plane| plane.torus_m.is_none()) else {
            return Err(given.error("knows", "the scenario has no open plane", "name a scenario in the plane"));
        };
        if parameters.deviation_m != [0.0; 3] {
            let is_possible = parameters.deviation_m.iter().all(|deviation| (0.0..=1e5).contains(deviation));
            let drawn = is_possible.then(|| draw_starts(plane, parameters.deviation_m, given.seed)).flatten();
            if drawn.is_none() {
                let what = format!("the robots find no room with deviations of {:?} m", parameters.deviation_m);
                return Err(given.error("deviation_m", what, "give larger ones, up to 100,000"));
            }
        }
        if let Some(squares) = &parameters.squares
            && squares.place(plane, Rng::keyed(given.seed, SQUARES, 0, 0)).is_none()
        {
            let what = "there are more groups than squares";
            return Err(given.error("squares.from_m", what, "give a corner for each group, beginning with [plane]"));
        }
        let scattered = |field: &str, discs: Option<Scattered>, most: usize, key| {
            let no_room = || {
                let what = format!("they find no room, are more than {most}, or have a radius out of range");
                given.error(field, what, "give fewer, radii of 0 to 100,000 m, or corners farther apart")
            };
            let drawn = discs.map(|discs| discs.draw(most, Rng::keyed(given.seed, key, 0, 0)).ok_or_else(no_room));
            Ok::<_, SweepError>(drawn.transpose()?.unwrap_or_default())
        };
        for (center_m, radius_m) in scattered("forest", parameters.forest, 10_000, TREES)? {
            plane.solids.push(Solid::Ball { center_m, radius_m });
        }
        let goals = scattered("goals", parameters.goals, GOALS, PLACES)?;
        if let Some(first) = plane.starts.first().and_then(|start| start.places.first()).filter(|_| !goals.is_empty()) {
            let velocity_mps = first.velocity_mps;
            let target = |&(position_m, _): &([f64; 3], f64)| Target { position_m, velocity_mps };
            let targets: Vec<Target> = goals.iter().map(target).collect();
            plane.starts.iter_mut().for_each(|start| start.places.clone_from(&targets));
        }
        if let GuidanceSetup::Lattice { params, .. } = &mut plane.general.guidance {
            params.alpha.velocity = parameters.c2_alpha.unwrap_or(params.alpha.velocity);
            params.gamma.velocity = parameters.c2_gamma.unwrap_or(params.gamma.velocity);
        }
        let run = Self { scenario, parameters };
        if run.parameters.knows == Knowledge::All
            && run.scenario.plane().and_then(|plane| Crowd::new(&run, plane)).is_none()
        {
            let what = "exact knowledge is for one alpha flock, or goal flock behind push-out, among balls";
            return Err(given.error("knows", what, "give \"packets\""));
        }
        Ok(run)
    }

    /// Runs the scenario, passing each moment to the callback.
    ///
    /// # Errors
    /// The robots cannot be placed, or leave the world.
    pub fn simulate(&self, each: &mut engine::Watch<'_>) -> Result<Outcome, String> {
        let exact = self.scenario.plane().filter(|_| self.parameters.knows == Knowledge::All);
        match exact.and_then(|plane| Crowd::new(self, plane)) {
            Some(crowd) => crowd.simulate(&self.scenario, each),
            None => engine::simulate_with(&self.scenario, None, each)
                .map_err(|error| format!("the robots cannot be placed: {error}")),
        }
    }
}

/// Starts at least two radii apart, each a function of the seed and the robot.
fn draw_starts(plane: &mut PlaneSetup, deviation_m: [f64; 3], seed: u64) -> Option<()> {
    let mut places: Vec<[f64; 3]> = Vec::new();
    for robot in 0..plane.starts.len() {
        let apart_m = 2.0 * plane.group(robot).radius_m;
        let mut rng = Rng::keyed(seed, STARTS, robot as u32, 0);
        let is_free = |at: &[f64; 3]| places.iter().all(|other| distance_m(*other, *at) >= apart_m);
        let place = (0..TRIES).map(|_| deviation_m.map(|deviation| normal(&mut rng, deviation))).find(is_free)?;
        places.push(place);
    }
    for (start, place) in plane.starts.iter_mut().zip(places) {
        start.position_m = place;
    }
    Some(())
}

fn uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * ((rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
}

/// Mean 0 (Box and Muller).
fn normal(rng: &mut Rng, deviation: f64) -> f64 {
    let length = libm::sqrt(-2.0 * libm::log(1.0 - uniform(rng, 0.0, 1.0)));
    deviation * length * libm::cos(2.0 * std::f64::consts::PI * uniform(rng, 0.0, 1.0))
}

fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    libm::sqrt(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum())
}

enum Law {
    Lattice { params: LatticeParams<f64>, motion: ReferenceMotion<f64> },
    Goals { params: GoalParams<f64>, arrival_m: f64, push_out: Option<PushOutParams<f64>>, seed: u64 },
}

/// Robots with exact knowledge.
struct Crowd<'a> {
    plane: &'a PlaneSetup,
    law: Law,
    targets: Vec<Target>,
    range_m: f64,
    most: usize,
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
    fn new(run: &Run, plane: &'a PlaneSetup) -> Option<Self> {
        let group = &plane.general;
        let push_out = match group.safety {
            SafetySetup::None => None,
            SafetySetup::PushOut { params } => Some(params.cast()),
            SafetySetup::Orca { .. } | SafetySetup::Fly { .. } => return None,
        };
        let (law, range_m) = match &group.guidance {
            GuidanceSetup::Lattice { params, motion } if push_out.is_none() => {
                let params: LatticeParams<f64> = params.cast();
                (Law::Lattice { params, motion: motion.cast() }, params.range_m())
            }
            GuidanceSetup::GoalFlock { params, arrival_m, seed } => {
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
            targets: plane.starts.first().map_or(Vec::new(), |start| start.places.clone()),
            most: run.parameters.nearest,
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
    fn simulate(mut self, scenario: &Scenario, each: &mut engine::Watch<'_>) -> Result<Outcome, String> {
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
            self.step(&targets)?;
            tick += 1;
        }
        let robots = self.places.len();
        Ok(Outcome {
            ticks: tick,
            seconds: f64::from(tick) * self.step_s,
            arrived: 0,
            arrival_times: vec![None; robots],
            ends: vec![(Mode::Cruise, None); robots],
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

    fn step(&mut self, targets: &[Target]) -> Result<(), String> {
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
        for robot in 0..self.places.len() {
            let (at, except) = (self.places[robot], Some(robot as u32));
            cells.within(&Query { at, radius: self.range_m, most: self.most, except }, &mut found);
            nearby.clear();
            nearby.extend(found.iter().map(|other| Nearby {
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
        self.velocities = next;
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
                let wished = wish(params, &body, own, goals.current(), nearby);
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

#[cfg(test)]
mod tests;
