//! Robots between simulated hardware (UART, encoders, lidar, PWM) and the real agent.
#![allow(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::integer_division_remainder_used,
    clippy::panic,
    clippy::unreachable,
    clippy::std_instead_of_alloc,
    clippy::std_instead_of_core
)]

use crate::common;
use core::convert::Infallible;
use embedded_io::{ErrorType, Read, ReadReady, Write, WriteReady};
use staya_controller::agent::{
    Agent, AgentConfig, CELLS, CellFollower, CellState, GridOrder, GridWorkspace, HALF_PLANES, InCell, InCells,
    InPlane, Inputs, Law, NEIGHBORS, OnGrid, OrcaAgent, OrcaSafety, RouteGuidance, VISITS, Waypoint, WaypointGuidance,
    WaypointOrder,
};
use staya_controller::geom::{Position, Vec2};
use staya_controller::grid::{Cell, GridFrame};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::AvoidParams;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::route::RouteParams;
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;
use staya_robot::drive::{
    Calibration, Differential, HBridge, Kinematics, Limits, LookAhead, Mixer, Wheels, wished_velocity,
};
use staya_robot::odometry::{Encoder, Odometry};
use staya_robot::radio::PacketLink;
use staya_robot::scan::{LocalMap, MapParams, OutlineParams, Scan, is_neighbor, outline};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// Control at 20 Hz; the world moves ten times as often.
const TICK: Duration = Duration::from_millis(50);
const MOMENT_US: u32 = 5_000;
const MOMENT_S: f64 = 0.005;
const TRACK_M: f64 = 0.12;
const WHEEL_M: f64 = 0.03;
const BODY_M: f64 = 0.09;
const TICKS_PER_TURN: u16 = 1440;
/// Rim speed at full duty, and the part of the duty that moves nothing.
const FULL_MPS: f64 = 0.6;
const DEAD: f64 = 0.12;
const MAX_DUTY: u16 = 999;
const BEAMS: usize = 90;
const RANGE_M: f64 = 2.0;
const FRAME: GridFrame<f32> = GridFrame { origin_m: Vec2::new(0.0, 0.0), cell_m: 0.4 };

type Channel = common::Channel<MAX_DUTY>;

#[derive(Clone, Default)]
struct Uart {
    heard: Rc<RefCell<VecDeque<u8>>>,
    said: Rc<RefCell<VecDeque<u8>>>,
}

/// 57,600 baud.
const BYTES_PER_MOMENT: usize = 28;

impl ErrorType for Uart {
    type Error = Infallible;
}

impl Read for Uart {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, Infallible> {
        let mut heard = self.heard.borrow_mut();
        assert!(!heard.is_empty(), "a read that would block");
        let len = buf.len().min(heard.len());
        buf.iter_mut().zip(heard.drain(..len)).for_each(|(to, from)| *to = from);
        Ok(len)
    }
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.heard.borrow().is_empty())
    }
}

impl Write for Uart {
    fn write(&mut self, buf: &[u8]) -> Result<usize, Infallible> {
        let mut said = self.said.borrow_mut();
        let len = buf.len().min(BYTES_PER_MOMENT - said.len());
        assert!(len > 0, "a write that would block");
        said.extend(&buf[..len]);
        Ok(len)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        unreachable!("a flush would block")
    }
}

impl WriteReady for Uart {
    fn write_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.said.borrow().len() < BYTES_PER_MOMENT)
    }
}

struct Body {
    axle: Vec2<f64>,
    heading: f64,
    rims: [f64; 2],
    ways: [f64; 2],
    channels: [[Channel; 2]; 2],
    uart: Uart,
}

impl Body {
    fn at(axle: Vec2<f64>, heading: f64) -> Self {
        Self { axle, heading, rims: [0.0; 2], ways: [0.0; 2], channels: Default::default(), uart: Uart::default() }
    }

    /// The motors lag by 40 ms; the right one is mounted inversely.
    fn roll(&mut self) {
        for (side, [ahead, back]) in self.channels.iter().enumerate() {
            let duty = f64::from(ahead.0.get()) - f64::from(back.0.get());
            let duty = if side == 1 { -duty } else { duty } / f64::from(MAX_DUTY);
            let live = (duty.abs() - DEAD).max(0.0) / (1.0 - DEAD);
            let wanted = FULL_MPS * live * duty.signum();
            self.rims[side] += (wanted - self.rims[side]) * MOMENT_S / 0.04;
            self.ways[side] += self.rims[side] * MOMENT_S;
        }
        let [left, right] = self.rims;
        let turn = (right - left) / TRACK_M * MOMENT_S;
        let (sin, cos) = Scalar::sin_cos(self.heading + turn / 2.0);
        self.axle += Vec2::new(cos, sin) * ((left + right) / 2.0 * MOMENT_S);
        self.heading += turn;
    }

    fn counts(&self) -> [u16; 2] {
        let ticks =
            |way: f64| (way / (core::f64::consts::TAU * WHEEL_M) * f64::from(TICKS_PER_TURN)).floor() as i64 as u16;
        [ticks(self.ways[0]), ticks(-self.ways[1])]
    }

    /// Noise of a centimetre, one lost range in fifty.
    fn ranges(&self, walls: &[[Vec2<f64>; 2]], others: &[Vec2<f64>], rng: &mut Rng) -> Vec<f32> {
        let beam = |number: usize| {
            let bearing = core::f64::consts::TAU * number as f64 / BEAMS as f64;
            let (sin, cos) = Scalar::sin_cos(self.heading + bearing);
            let ahead = Vec2::new(cos, sin);
            let walls = walls.iter().filter_map(|wall| crossing(self.axle, ahead, *wall));
            let others = others.iter().filter_map(|other| {
                let to = *other - self.axle;
                let (along, aside) = (ahead.dot(to), ahead.det(to));
                let half = BODY_M * BODY_M - aside * aside;
                (half > 0.0 && along > 0.0).then(|| along - half.sqrt())
            });
            walls.chain(others).fold(f64::INFINITY, f64::min)
        };
        (0..BEAMS)
            .map(|number| {
                let noise = (f64::from(rng.below(2001)) - 1000.0) * 1e-5;
                let range = beam(number);
                let lost = rng.below(50) == 0;
                if lost { f32::NAN } else { (range + noise) as f32 }
            })
            .collect()
    }

    fn gap_to(&self, wall: &[Vec2<f64>; 2]) -> f64 {
        let seen = Obstacle::Wall(wall.map(|end| end - self.axle));
        seen.nearest_point().unwrap().1 - BODY_M
    }
}

fn crossing(from: Vec2<f64>, ahead: Vec2<f64>, [a, b]: [Vec2<f64>; 2]) -> Option<f64> {
    let (to, along) = (a - from, b - a);
    let across = ahead.det(along);
    let range = to.det(along) / across;
    let part = to.det(ahead) / across;
    (range >= 0.0 && (0.0..=1.0).contains(&part)).then_some(range)
}

struct Firmware<G: Law<f32>> {
    agent: Agent<f32, G, NEIGHBORS, OrcaSafety<f32, HALF_PLANES>>,
    workspace: G::Workspace,
    radio: PacketLink<Uart>,
    wheels: Wheels<f32, HBridge<Channel>, 2>,
    mixer: Mixer<f32, Differential<f32>, 2>,
    ahead: LookAhead<f32>,
    encoders: [Encoder<f32>; 2],
    odometry: Odometry<f32>,
    map: LocalMap,
    max_speed_mps: f32,
}

const LIMITS: Limits<f32> = Limits { speed_mps: 0.5, acceleration_mps2: 1.5 };
const AHEAD_M: f32 = 0.06;
const RADIUS_M: f32 = BODY_M as f32 + AHEAD_M + 0.02;

impl<G> Firmware<G>
where
    G: for<'a> Law<f32, Surroundings<'a>: From<InCells<'a, f32>>>,
{
    fn new(id: u32, guidance: impl FnOnce(f32) -> G, workspace: G::Workspace, body: &Body) -> Self {
        let track = TRACK_M as f32;
        let ahead = LookAhead::new(AHEAD_M).unwrap();
        let max_speed_mps = ahead.max_speed(LIMITS.speed_mps, track);
        let config = AgentConfig {
            seed: 5,
            max_acceleration_mps2: ahead.max_speed(LIMITS.acceleration_mps2, track),
            latency: Duration::from_millis(25),
            ..AgentConfig::new(RobotId(id), RADIUS_M, TICK)
        };
        let inflation = StalenessInflation { growth_mps: 0.1, max_m: 0.2 };
        let safety = OrcaSafety::new(AvoidParams::default(), inflation);
        let motor =
            Calibration { full_mps: FULL_MPS as f32, dead_duty: DEAD as f32, still_mps: 0.004, is_inverted: false };
        let mirrored = Calibration { is_inverted: true, ..motor };
        let [left, right] = body.channels.clone();
        let bridge = |[ahead, back]: [Channel; 2]| HBridge::new(ahead, back);
        let encoder = |mirrored| Encoder::new(WHEEL_M as f32, TICKS_PER_TURN, mirrored).unwrap();
        let start = Position::from_metres([body.axle.x, body.axle.y, 0.0]).unwrap();
        Self {
            agent: Agent::new(&config, guidance(max_speed_mps), safety, Postcard),
            workspace,
            radio: PacketLink::new(body.uart.clone()),
            wheels: Wheels::new([(bridge(left), motor), (bridge(right), mirrored)]),
            mixer: Mixer::new(Differential::new(track).unwrap(), LIMITS).unwrap(),
            ahead,
            encoders: [encoder(false), encoder(true)],
            odometry: Odometry::new(start, body.heading as f32).unwrap(),
            map: LocalMap::new(MapParams::default(), Cell::default()),
            max_speed_mps,
        }
    }

    fn tick(&mut self, counts: [u16; 2], ranges: &[f32], now: Instant) {
        let [left, right] = &mut self.encoders;
        let rims = [left.travelled(counts[0]), right.travelled(counts[1])];
        self.odometry.advance(&self.mixer.kinematics().twist(&rims), TICK);
        let heading = self.odometry.heading_rad();
        let turn = self.odometry.twist().turn_radps;
        let state = self.ahead.state(&self.odometry.state(), heading, turn);
        let place = state.position.since::<f32>(Position::ORIGIN).xy();
        let scan = Scan {
            first_rad: 0.0,
            step_rad: core::f32::consts::TAU / BEAMS as f32,
            ranges_m: ranges,
            min_m: 0.05,
            max_m: RANGE_M as f32,
            mount_m: Vec2::new(-AHEAD_M, 0.0),
        };
        let neighbors = self.agent.neighbors();
        let is_robot = |place| is_neighbor(neighbors, state.position, now, TICK.saturating_mul(4), place, 0.05);
        assert!(self.map.observe(&FRAME, place, heading, &scan, now, is_robot));
        let params = OutlineParams { tolerance_m: 0.03, gap_m: 0.3, point_m: 0.03 };
        let obstacles = outline::<_, 16>(&scan, heading, &params, is_robot);
        let cell = FRAME.cell(place).unwrap();
        let inputs = Inputs {
            state,
            surroundings: G::Surroundings::from(InCells {
                grid: OnGrid { cell: CellState { cell, busy: Duration::ZERO }, window: self.map.window() },
                plane: InPlane { max_speed_mps: self.max_speed_mps, obstacles: &obstacles },
                in_cell: InCell { offset_m: place - FRAME.center(cell), cell_m: FRAME.cell_m },
            }),
            inbox: self.radio.take(),
        };
        let out = self.agent.step(&inputs, now, &mut self.workspace);
        self.radio.send(&out.outbox);
        let twist = self.ahead.twist(wished_velocity(&out.command), heading);
        let Ok(()) = self.wheels.turn(&self.mixer.mix(&twist, TICK));
    }
}

/// One flipped bit per thousand bytes, and spurious bytes.
fn carry(bodies: &[Body], rng: &mut Rng) {
    for (from, speaker) in bodies.iter().enumerate() {
        let said: Vec<u8> = speaker.uart.said.borrow_mut().drain(..).collect();
        for (to, listener) in bodies.iter().enumerate() {
            if to == from {
                continue;
            }
            let mut heard = listener.uart.heard.borrow_mut();
            for byte in &said {
                let flip = if rng.below(1000) == 0 { 1 << rng.below(8) } else { 0 };
                heard.push_back(byte ^ flip);
            }
            if rng.below(40) == 0 {
                heard.push_back(rng.below(256) as u8);
            }
        }
    }
}

/// Returns the time until all have arrived; calls `check` after each step of the world.
fn run<G: for<'a> Law<f32, Surroundings<'a>: From<InCells<'a, f32>>>>(
    bodies: &mut [Body],
    robots: &mut [Firmware<G>],
    walls: &[[Vec2<f64>; 2]],
    mut check: impl FnMut(&[Body]),
) -> f64 {
    let mut rng = Rng::keyed(7, 0, 0, 0);
    let start = u32::MAX - 5_000_000;
    for moment in 0..24_000u32 {
        let now = Instant::from_micros(start.wrapping_add(moment * MOMENT_US));
        if moment % 10 == 0 {
            let places: Vec<Vec2<f64>> = bodies.iter().map(|body| body.axle).collect();
            for (number, (body, robot)) in bodies.iter().zip(&mut *robots).enumerate() {
                let mut others = places.clone();
                others.remove(number);
                let ranges = body.ranges(walls, &others, &mut rng);
                robot.tick(body.counts(), &ranges, now);
            }
            let is_done = |robot: &Firmware<G>| robot.agent.mode() == Mode::Arrived;
            if moment > 0 && robots.iter().all(is_done) {
                return f64::from(moment) * MOMENT_S;
            }
        }
        for robot in &mut *robots {
            robot.radio.pump().unwrap();
        }
        carry(bodies, &mut rng);
        bodies.iter_mut().for_each(Body::roll);
        check(bodies);
    }
    panic!("no robot arrives: {:?}", bodies.iter().map(|b| b.axle).collect::<Vec<_>>());
}

#[test]
fn a_robot_gets_around_a_wall_known_only_from_ranges() {
    // The only path leads around the north end of the wall.
    let v = Vec2::new;
    let walls = [
        [v(2.0, 0.0), v(2.0, 2.4)],
        [v(0.0, 0.0), v(4.0, 0.0)],
        [v(0.0, 0.0), v(0.0, 4.0)],
        [v(4.0, 0.0), v(4.0, 4.0)],
        [v(0.0, 4.0), v(4.0, 4.0)],
    ];
    let mut bodies = [Body::at(v(1.0, 1.0), 0.0)];
    let guidance = |speed| CellFollower::new(RouteGuidance::<CELLS, VISITS>::new(RouteParams::default()), speed);
    let mut robots = [Firmware::new(1, guidance, GridWorkspace::new(), &bodies[0])];
    let goal = Cell::new(7, 2);
    robots[0].agent.order(&GridOrder::Goal(goal));
    let mut least = f64::MAX;
    let time = run(&mut bodies, &mut robots, &walls, |bodies| {
        let gaps = walls.iter().map(|wall| bodies[0].gap_to(wall));
        least = gaps.fold(least, f64::min);
    });
    let [body] = &bodies;
    let (sin, cos) = Scalar::sin_cos(body.heading);
    let point = body.axle + v(cos, sin) * f64::from(AHEAD_M);
    let center = FRAME.center(goal);
    let off = point - v(center.x.into(), center.y.into());
    println!("{time} s, least gap {least} m, {off:?} off");
    assert!(off.x.abs().max(off.y.abs()) < 0.23, "{off:?}");
    assert!(least > 0.0, "it touched a wall: {least}");
}

#[test]
fn two_differential_robots_swap_places_over_a_bad_wire() {
    let v = Vec2::new;
    let mut bodies = [Body::at(v(0.5, 1.0), 0.0), Body::at(v(3.5, 1.0), core::f64::consts::PI)];
    let guidance = |speed| WaypointGuidance::new(speed, 0.02);
    let mut robots = [1, 2].map(|id| Firmware::new(id, guidance, (), &bodies[id as usize - 1]));
    let goals = [v(3.5, 1.0), v(0.5, 1.0)];
    for (robot, goal) in robots.iter_mut().zip(goals) {
        let place = Position::from_metres([goal.x, goal.y, 0.0]).unwrap();
        assert!(robot.agent.order(&WaypointOrder::first(Waypoint::fixed(place))));
    }
    let mut least = f64::MAX;
    let time = run(&mut bodies, &mut robots, &[], |bodies| {
        let gap = (bodies[0].axle - bodies[1].axle).norm() - 2.0 * BODY_M;
        least = least.min(gap);
    });
    println!("{time} s, least gap {least} m");
    assert!(least > 0.02, "closer than the margins: {least}");
    for ((body, goal), robot) in bodies.iter().zip(goals).zip(&mut robots) {
        assert!((body.axle - goal).norm() < f64::from(AHEAD_M) + 0.05);
        let (heard, said) = robot.radio.counts();
        println!("{heard:?} {said:?}");
        assert!(heard.frames > 100 && said.frames > 100);
        assert!(heard.refused > 0, "the wire was bad");
        assert_eq!((heard.dropped, said.dropped), (0, 0));
    }
    // 3 m at the speed that holds in any direction.
    assert!(time < 2.0 * 3.0 / f64::from(robots[0].max_speed_mps), "{time}");
}

/// The types in the README equal these.
#[test]
fn the_default_agent_equals_the_one_tested_here() {
    fn is_default(_: &OrcaAgent) {}
    let body = Body::at(Vec2::ZERO, 0.0);
    let guidance = |speed| WaypointGuidance::new(speed, 0.02);
    is_default(&Firmware::new(1, guidance, (), &body).agent);
}
