//! Bodies in the plane or in space, and the sensors of their robots.

mod barriers;
mod company;
mod ground;
mod orders;

use company::company;
pub(super) use orders::frames;
use orders::{course, waypoint};

use super::grid::{Changed, duration};
use super::ground::Senses;
use crate::scenario::{Clocks, Order, PlaneSetup, Robot, Scenario};
use crate::world::plane::{Clearance, Disc, Plane, Sight, Solid, narrow};
use crate::world::scouts::Scouts;
use crate::world::window_but;
use staya_controller::agent::{
    AgentConfig, AnyInputs, AnySurroundings, CellState, ContactLossPolicy, Goals, InCell, InCells, InPlane, Inputs,
    KinematicState, OnGrid, Task, WAYPOINTS,
};
use staya_controller::auth::Key;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Cell, GridFrame};
use staya_controller::obstacle::grid_walls;
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;
use staya_controller::wire::Format;

/// Most terrain walls that a robot sees at a time.
const WALLS: usize = 16;
/// Steps for which robots listen before they move, beyond the latency: time for others to tell of
/// robots that are not heard.
const LISTEN_STEPS: i32 = 6;
/// A radio without a limit works this far, metres.
const FARTHEST_M: f64 = 1e6;

/// Bodies that move in the plane or in space.
pub struct PlaneGround {
    #[doc(hidden)]
    pub plane: Plane,
    setup: PlaneSetup,
    #[doc(hidden)]
    pub clearance: Clearance,
    /// Smallest gap between two bodies after the last tick, metres.
    pub gap_m: Option<f64>,
    changed: Changed,
    sight: Option<Sight>,
    /// Number of the first robot of a goal flock.
    flock: Option<usize>,
    /// Robots' knowledge of terrain outside their sight.
    pub scouts: Option<Scouts>,
    robots: Vec<Robot>,
    /// Robot number of each body.
    pub numbers: Vec<u32>,
    radius: u8,
    tick_us: u32,
    clocks: Clocks,
    /// Longest delay of a packet, without reordering.
    delay_us: u32,
    range_m: f32,
    /// By robot: whether another one that works starts within radio range.
    has_company: Vec<bool>,
    since: Vec<u32>,
    format: Format,
    key: Option<Key>,
    /// Most restarts of a robot, which the operator hears of.
    restarts: u32,
    /// Encoded orders to all robots, sorted by tick.
    orders: Vec<(u32, Vec<u8>)>,
}

impl PlaneGround {
    /// Creates the scenario's bodies at their starts.
    #[must_use]
    pub fn new(scenario: &Scenario, setup: &PlaneSetup) -> Self {
        let discs = (0..scenario.robots.len()).map(|number| disc(scenario.robots[number].id, setup, number));
        let land = setup.has_terrain.then(|| scenario.land.terrain.clone());
        // Beaconing intruders have the ids after the robots' last; silent intruders need none.
        let last = scenario.robots.last().map_or(0, |robot| robot.id.0);
        let mut ids = (last + 1..).map(RobotId);
        let intruders = setup.intruders.iter().map(|intruder| Disc {
            id: if intruder.is_heard { ids.next().unwrap_or_default() } else { RobotId::NONE },
            radius_m: intruder.radius_m,
            position_m: intruder.position_m,
            velocity_mps: intruder.velocity_mps,
            target_mps: intruder.velocity_mps,
            abilities: setup.general.abilities,
            downwash: 1.0,
        });
        let intruders = intruders.collect();
        let sights = setup.kinds().map(|group| group.sight_m + group.radius_m);
        let plane = Plane::new(land, setup.solids.clone(), discs.collect()).with_intruders(intruders);
        let plane = plane.with_sight(sights.fold(0.0, f64::max)).in_space(setup.space());
        let is_flat = setup.starts.iter().all(|start| start.position_m[2] == 0.0)
            && setup.kinds().all(|group| !group.safety.flies());
        let sight = scenario.sensing().map(|sensing| {
            let mut sight = Sight::new(sensing, scenario.seed, scenario.tick_us, is_flat);
            sight.look(&plane);
            sight
        });
        Self {
            sight,
            flock: (0..setup.starts.len()).find(|&index| setup.group(index).law.goals().movable() > 1),
            clearance: Clearance::FREE,
            gap_m: None,
            changed: Changed::new(),
            scouts: scenario.scouts(),
            plane,
            robots: scenario.numbered(),
            numbers: (0..scenario.robots.len() as u32).collect(),
            radius: scenario.laws.radius,
            tick_us: scenario.tick_us,
            clocks: scenario.clocks.clone(),
            delay_us: libm::round((scenario.radio.delay_ms + scenario.radio.jitter_ms) * 1000.0) as u32,
            range_m: scenario.radio.range_m.min(FARTHEST_M) as f32,
            orders: frames(&setup.orders, scenario.radio.format, scenario.key(), scenario.most_restarts()),
            has_company: vec![false; setup.starts.len()],
            since: vec![0; scenario.robots.len()],
            format: scenario.radio.format,
            key: scenario.key().cloned(),
            restarts: scenario.most_restarts(),
            setup: setup.clone(),
        }
    }

    /// Lets robots that start within radio range of another one expect others, unless the scenario
    /// says what they expect. Not for a companion, which may steer one robot of the scenario alone.
    #[must_use]
    pub fn with_company(mut self, scenario: &Scenario) -> Self {
        self.has_company = company(scenario, &self.setup);
        self
    }

    /// The bodies and their surroundings.
    #[must_use]
    pub const fn plane(&self) -> &Plane {
        &self.plane
    }

    /// Sensor data that the robot of body `index` would have at a position with a velocity; the
    /// inbox is empty. Positions must be finite.
    pub fn sense_at<'a>(
        &'a self,
        index: usize,
        position_m: [f64; 3],
        velocity_mps: [f64; 3],
        senses: &'a mut Senses,
    ) -> AnyInputs<'a, f32> {
        let Senses { cells, known, obstacles } = senses;
        let group = self.setup.group(self.number(index));
        let sight_m = group.sight_m + group.radius_m;
        obstacles.clear();
        // Robots see a silent intruder as a static ball at its current position.
        let silent = self.plane.intruders().iter().filter(|intruder| !intruder.id.is_some());
        let silent = silent.map(|disc| Solid::Ball { center_m: disc.position_m, radius_m: disc.radius_m });
        let silent = silent.filter(|solid| solid.distance_m(position_m) <= sight_m);
        let near = self.plane.solids_near(position_m, sight_m).copied().chain(silent);
        obstacles.extend(near.map(|solid| narrow(&solid.seen_from(position_m))));
        let place = self.in_cell(position_m);
        let here = place.map(|(cell, ..)| cell).zip(self.plane.terrain());
        let sight = self.scouts.as_ref().map_or(self.radius, Scouts::sight);
        let seen = here.and_then(|(cell, land)| window_but(land, cell, sight, self.plane.shut(index), cells));
        if let (Some((cell, off, cell_m)), Some(window)) = (place, &seen) {
            // Grid frame relative to the robot.
            let origin = |cells: i16, axis: usize| -off[axis] - (f64::from(cells) + 0.5) * cell_m;
            let frame = GridFrame {
                origin_m: Vec2::new(origin(cell.x, 0) as f32, origin(cell.y, 1) as f32),
                cell_m: cell_m as f32,
            };
            let walls = grid_walls::<f32, WALLS>(window, &frame, Vec2::ZERO, sight_m as f32);
            obstacles.extend(walls);
        }
        let window = match &self.scouts {
            None => seen,
            Some(scouts) => here.and_then(|(cell, land)| scouts.window(land, index, cell, known)),
        };
        let max_speed_mps = self.plane.max_speed_mps(index, position_m) as f32;
        let plane = InPlane { max_speed_mps, obstacles };
        let [vx, vy, vz] = velocity_mps.map(|v| v as f32);
        Inputs {
            state: KinematicState {
                // The world's numbers are finite.
                position: Position::from_metres(position_m).unwrap_or_default(),
                velocity_mps: Vec3::new(vx, vy, vz),
            },
            surroundings: match place {
                None => AnySurroundings::InPlane(plane),
                Some((cell, off, cell_m)) => AnySurroundings::InCells(InCells {
                    grid: OnGrid { cell: CellState { cell, busy: Duration::ZERO }, window },
                    plane,
                    in_cell: InCell { offset_m: Vec2::new(off[0] as f32, off[1] as f32), cell_m: cell_m as f32 },
                }),
            },
            inbox: &[],
        }
    }

    /// Orders to a robot before `tick`; a later goal supersedes orders for the first.
    fn ordered(&self, number: usize, tick: u32) -> impl Iterator<Item = &Order> {
        let orders = self.setup.orders.iter().take_while(move |order| order.tick < tick);
        orders.filter(move |order| order.index > 0 || order.tick >= self.since[number])
    }

    fn config(&self, number: usize) -> AgentConfig<f32> {
        let (step, latency) = (duration(self.clocks.step_us()), duration(self.clocks.latency_us(self.delay_us)));
        // A robot that comes late is silent for as much longer.
        let silent_us = latency.as_micros().saturating_add(duration(self.clocks.late_us()).as_micros());
        let group = self.setup.group(number);
        AgentConfig {
            max_acceleration_mps2: group.abilities.max_acceleration_mps2 as f32,
            lag_s: group.abilities.lag_s as f32,
            is_synchronous: self.clocks.is_synchronous(),
            latency,
            contact_loss: ContactLossPolicy {
                listen: group
                    .listen
                    .unwrap_or(Duration::from_micros(silent_us.saturating_add(LISTEN_STEPS * step.as_micros()))),
                expects_others: group.expects_others.unwrap_or(self.has_company[number]),
                reach_m: self.range_m,
                ..group.contact_loss
            },
            flock: group.flock,
            ..AgentConfig::new(self.robots[number].id, group.radius_m as f32, step)
        }
    }

    fn task(&self, number: usize, tick: u32) -> Task {
        let law = &self.setup.group(number).law;
        if law.is_on_grid() {
            return Task::Cell(self.robots[number].goal);
        }
        let first = (0..).zip(&self.setup.starts[number].places);
        let first = first.map(|(index, target)| (index, 0, target));
        let later = self.ordered(number, tick).map(|order| (order.index, order.tick, &order.target));
        let aged = first.chain(later).map(|(index, since, target)| {
            let age_s = f64::from(tick - since) * f64::from(self.tick_us) / 1e6;
            (index, waypoint(target, age_s))
        });
        Task::Waypoints(course(aged, law.goals() == Goals::Waypoints))
    }

    fn goals_m(&self, tick: u32) -> [Option<[f64; 3]>; WAYPOINTS] {
        let mut goals_m = [None; WAYPOINTS];
        if let Some(first) = self.flock {
            let places = self.setup.starts[first].places.iter();
            let later = self.ordered(first, tick + 1);
            let places = (0..).zip(places).chain(later.map(|order| (usize::from(order.index), &order.target)));
            for (index, place) in places {
                if let Some(goal_m) = goals_m.get_mut(index) {
                    *goal_m = Some(place.position_m);
                }
            }
        }
        goals_m
    }

    /// Body of robot `number` at its start.
    pub fn disc_of(&self, number: usize, id: RobotId) -> Disc {
        disc(id, &self.setup, number)
    }

    fn number(&self, index: usize) -> usize {
        self.numbers[index] as usize
    }

    /// Cell of a position, offset from its centre, and side of a cell; metres.
    fn in_cell(&self, position_m: [f64; 3]) -> Option<(Cell, [f64; 2], f64)> {
        let cell = self.plane.cell(position_m)?;
        let land = self.plane.terrain()?;
        let off = |cells: i16, axis: usize| {
            let center = land.origin_m[axis] + (f64::from(cells) + 0.5) * land.cell_m;
            position_m[axis] - center
        };
        Some((cell, [off(cell.x, 0), off(cell.y, 1)], land.cell_m))
    }
}

fn disc(id: RobotId, setup: &PlaneSetup, number: usize) -> Disc {
    let (group, start) = (setup.group(number), &setup.starts[number]);
    Disc {
        id,
        radius_m: group.radius_m,
        position_m: start.position_m,
        velocity_mps: start.velocity_mps,
        target_mps: start.velocity_mps,
        abilities: group.abilities,
        downwash: group.downwash(),
    }
}
