//! Both ends over a line with faults, in simulated time.

use super::{ABOUT, LARGE, in_plane, on_grid};
use crate::message::{Report, StepInputs, pack};
use crate::port::{Asked, Event, Limits, Next, Port, PortError};
use crate::robot::{Brain, Large, Robot, Small};
use crate::session::{About, Reaction, Session};
use proptest::prelude::*;
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::obstacle::Obstacle;
use staya_controller::rand::Rng;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Header, Message, Mode, RobotId, encode};
use staya_mavlink::any::AnyWire;
use std::vec::Vec;

const LIMITS: Limits = Limits {
    resend_after_us: 20_000,
    attempts: 60,
};

/// What one direction does to frames, probabilities in percent.
#[derive(Clone, Copy, Debug, Default)]
struct Faults {
    lost: u32,
    repeated: u32,
    flipped: u32,
    cut: u32,
    /// Longest delay: frames overtake each other.
    delay_us: u32,
}

/// One direction.
struct Line {
    faults: Faults,
    rng: Rng,
    on_the_way: Vec<(u64, Vec<u8>)>,
}

impl Line {
    fn new(faults: Faults, seed: u64) -> Self {
        Self {
            faults,
            rng: Rng::new(seed),
            on_the_way: Vec::new(),
        }
    }

    fn happens(&mut self, percent: u32) -> bool {
        self.rng.below(100) < percent
    }

    fn send(&mut self, frame: &[u8], now: u64) {
        let faults = self.faults;
        let copies = 1 + usize::from(self.happens(faults.repeated));
        for _ in 0..copies {
            if self.happens(faults.lost) {
                continue;
            }
            let mut bytes = frame.to_vec();
            if self.happens(faults.flipped) {
                let at = self.rng.below(bytes.len() as u32) as usize;
                bytes[at] ^= 1 << self.rng.below(8);
            }
            if self.happens(faults.cut) {
                bytes.truncate(self.rng.below(bytes.len() as u32) as usize);
            }
            let delay = 100 + u64::from(self.rng.below(faults.delay_us));
            self.on_the_way.push((now + delay, bytes));
        }
    }

    fn next(&self) -> Option<u64> {
        self.on_the_way.iter().map(|(due, _)| *due).min()
    }

    fn arrived(&mut self, now: u64) -> Vec<Vec<u8>> {
        self.on_the_way.sort_by_key(|(due, _)| *due);
        let count = self
            .on_the_way
            .iter()
            .filter(|(due, _)| *due <= now)
            .count();
        self.on_the_way
            .drain(..count)
            .map(|(_, bytes)| bytes)
            .collect()
    }
}

/// A host, a device and what is between them.
struct Bench<B> {
    port: Port<16384>,
    session: Session<B, LARGE>,
    there: Line,
    back: Line,
    now: u64,
    boot: u32,
}

impl<B: Brain + Default> Bench<B> {
    fn new(faults: Faults, seed: u64) -> Self {
        let mut bench = Self {
            port: Port::new(seed as u32, LIMITS),
            session: Session::new(B::default(), ABOUT),
            there: Line::new(faults, seed),
            back: Line::new(faults, seed ^ 0xFFFF),
            now: 0,
            boot: ABOUT.boot,
        };
        let hello = bench.session.hello().to_vec();
        bench.back.send(&hello, 0);
        bench
    }

    fn reset(&mut self) {
        self.boot += 1;
        let boot = self.boot;
        self.session = Session::new(B::default(), About { boot, ..ABOUT });
        let hello = self.session.hello().to_vec();
        self.back.send(&hello, self.now);
    }

    /// Until something comes of what was asked.
    fn wait(&mut self) -> Result<Event, PortError> {
        loop {
            let until = match self.port.poll(self.now)? {
                Next::Send(frame) => {
                    self.there.send(frame, self.now);
                    continue;
                }
                Next::WaitUntil(until) => until,
                Next::Idle => panic!("nothing was asked"),
            };
            let next = [self.there.next(), self.back.next()]
                .into_iter()
                .flatten()
                .min();
            self.now = next.map_or(until, |next| next.min(until)).max(self.now);
            let mut restarts = false;
            for bytes in self.there.arrived(self.now) {
                for byte in bytes {
                    match self.session.receive(byte, &mut ()) {
                        Reaction::None => {}
                        Reaction::Answer(frame) => self.back.send(frame, self.now),
                        Reaction::Restart => restarts = true,
                    }
                }
            }
            if restarts {
                self.reset();
            }
            for bytes in self.back.arrived(self.now) {
                let mut said = None;
                for byte in bytes {
                    said = self.port.receive(byte, self.now)?.or(said);
                }
                if let Some(event) = said {
                    return Ok(event);
                }
            }
        }
    }

    /// Greets and configures until the device has it.
    fn configure(&mut self, setup: &Setup, task: Option<&Task>) -> u64 {
        loop {
            self.port.greet(self.now);
            if !matches!(self.wait(), Ok(Event::Hello(_))) {
                continue;
            }
            self.port.configure(setup, task, self.now).expect("fits");
            match self.wait() {
                Ok(Event::Configured(configured)) => return configured.digest,
                Ok(Event::Restarted) => {}
                other => panic!("{other:?}"),
            }
        }
    }

    fn step(&mut self, inputs: &StepInputs<'_>) -> Option<Report> {
        self.port.step(inputs, self.now).expect("fits");
        match self.wait() {
            Ok(Event::Stepped(stepped)) => Some(stepped.report),
            Ok(Event::Restarted) => None,
            other => panic!("step {}: {other:?}", inputs.tick),
        }
    }
}

/// A beacon of robot 2 on its way round the first one.
fn inbox(tick: u32, now: Instant) -> Vec<u8> {
    let at = (tick % 400) as i32;
    let beacon = Beacon {
        time: now,
        position_mm: [at * 50 - 2000, 300 - at, 0],
        velocity_mmps: [500, -10, 0],
        radius_mm: 250,
        mode: Mode::Cruise,
        ..Beacon::default()
    };
    let header = Header {
        boot: 0,
        sender: RobotId(2),
        sequence: tick as u16,
    };
    let mut out = heapless::Vec::<u8, 128>::new();
    encode(header, &Message::Beacon(beacon), &mut out).expect("fits");
    // Every ninth one is damaged on the air.
    if tick.is_multiple_of(9) {
        out[10] ^= 1;
    }
    out.to_vec()
}

/// A robot without faults that lives beside the one behind the line, and the world for both.
struct World {
    position: Position,
    velocity: Vec3<f32>,
    cell: Cell,
}

/// What the world shows to the robot.
struct Scene {
    now: Instant,
    inbox: Vec<u8>,
    land: Vec<u8>,
    origin: Cell,
    obstacles: [Obstacle<f32>; 2],
}

impl World {
    const START: Self = Self {
        position: Position::ORIGIN,
        velocity: Vec3::new(0.0, 0.0, 0.0),
        cell: Cell::new(0, 0),
    };

    fn scene(&self, tick: u32) -> Scene {
        let now = Instant::from_micros(tick.wrapping_mul(100_000));
        let origin = self.cell - Cell::new(5, 5);
        let impassability = |i: i16| {
            let (x, y) = (origin.x + i % 11, origin.y + i / 11);
            if (x * 7 + y * 3) % 5 == 1 {
                0
            } else {
                1 + (x + y).rem_euclid(3) as u8
            }
        };
        let [x, y, _] = self.position.mm.map(|mm| mm as f32 / 1000.0);
        let corner = |dx: f32, dy: f32| Vec2::new(dx - x, dy - y);
        Scene {
            now,
            inbox: inbox(tick, now),
            land: (0..121).map(impassability).collect(),
            origin,
            obstacles: [
                Obstacle::Wall([corner(4.0, -1.0), corner(4.0, 1.0)]),
                Obstacle::Ball {
                    center_m: corner(8.0, 0.5).extend(0.0),
                    radius_m: 0.5,
                },
            ],
        }
    }

    fn follow(&mut self, command: &Command<f32>) {
        match command {
            Command::Hold => self.velocity = Vec3::default(),
            Command::Velocity(velocity) => {
                self.velocity = *velocity;
                self.position = self.position.moved(*velocity * 0.1).expect("finite");
            }
            Command::Move(moves) => self.cell = self.cell + moves[0].offset(),
        }
    }
}

impl Scene {
    fn inputs(&self, world: &World, plane: bool) -> Inputs<'_, f32> {
        let cell = CellState {
            cell: world.cell,
            busy: Duration::ZERO,
        };
        Inputs {
            pose: Pose {
                position: world.position,
                velocity_mps: world.velocity,
            },
            cell: (!plane).then_some(cell),
            window: if plane {
                None
            } else {
                Window::new(&self.land, self.origin, 11, 11)
            },
            surroundings: plane.then_some(Surroundings {
                max_speed_mps: 1.0,
                obstacles: &self.obstacles,
                in_cell: None,
            }),
            inbox: &self.inbox,
        }
    }
}

/// A step of a brain without a line.
fn decide(brain: &mut impl Brain, step: &StepInputs<'_>) -> Report {
    brain.step(step).expect("fits");
    brain.report().expect("a robot")
}

/// A thousand steps of a robot over a line, beside the same robot without one; what the line cost.
fn thousand_steps<B: Brain + Default>(
    faults: Faults,
    seed: u64,
    (setup, task): (&Setup, Option<&Task>),
    mut plain: impl FnMut(&Inputs<'_, f32>, &StepInputs<'_>) -> (Command<f32>, u64),
) -> Bench<B> {
    let mut bench = Bench::<B>::new(faults, seed);
    bench.configure(setup, task);
    let mut world = World::START;
    let mut moved = false;
    for tick in 0..1000 {
        let scene = world.scene(tick);
        let plane = matches!(setup.guidance, GuidanceSetup::Waypoint { .. });
        let inputs = scene.inputs(&world, plane);
        let capacities = Large::new().capacities();
        let capacities = crate::capacities::Capacities {
            inbox_bytes: 1024,
            ..capacities
        };
        let mut packed = [0; 64];
        let (step, _) = capacities
            .fit(
                tick,
                scene.now,
                &inputs,
                &AnyWire::new(setup.format),
                &mut packed,
            )
            .expect("fits");
        let report = bench.step(&step).expect("no reset");
        let (command, digest) = plain(&inputs, &step);
        assert_eq!(report.outputs.command, command, "step {tick}");
        assert_eq!(report.digest, digest, "step {tick}");
        let before = (world.position, world.cell);
        world.follow(&command);
        moved |= before != (world.position, world.cell);
    }
    assert!(moved, "a robot that stands proves little");
    bench
}

const BAD: Faults = Faults {
    lost: 10,
    repeated: 10,
    flipped: 10,
    cut: 5,
    delay_us: 50_000,
};

fn to_the_east() -> Task {
    let place = Place::fixed(Position::from_mm([30_000, 500, 0]));
    Task::Places([(0, place)].into_iter().collect())
}

#[test]
fn steps_over_a_bad_line_are_those_of_a_plain_agent() {
    let (setup, task) = (in_plane(), to_the_east());
    let (on_grid, to_a_cell) = on_grid(5);
    for (setup, task) in [(setup, task), (on_grid, to_a_cell)] {
        for (faults, seed) in [(Faults::default(), 1), (BAD, 2), (BAD, 3)] {
            let agent: Option<AnyAgent<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES>> = setup.agent();
            let mut agent = agent.expect("postcard");
            assert!(agent.assign(&task));
            let mut workspace = GridWorkspace::new();
            let bench =
                thousand_steps::<Large>(faults, seed, (&setup, Some(&task)), |inputs, step| {
                    let out = agent.step(inputs, step.now, &mut workspace);
                    (out.command, agent.digest())
                });
            let (host, device) = (bench.port.counts(), bench.session.counts());
            assert_eq!(device.steps, 1000);
            if faults.lost == 0 {
                // The first greeting crosses the device's own hello.
                assert_eq!((host.resent, host.damaged, device.damaged), (1, 0, 0));
            } else {
                assert!(
                    host.resent > 100 && host.damaged > 20 && host.stale > 20,
                    "{host:?}"
                );
                let seen = [device.repeated, device.stale, device.damaged];
                assert!(seen.iter().all(|count| *count > 20), "{device:?}");
            }
        }
    }
}

#[test]
fn fixed_point_steps_over_a_bad_line_are_those_of_its_shadow() {
    let (setup, task) = (in_plane(), to_the_east());
    let mut shadow = Small::new();
    shadow.configure(&setup, Some(&task)).expect("fits");
    thousand_steps::<Small>(BAD, 4, (&setup, Some(&task)), |_, step| {
        let report = decide(&mut shadow, step);
        (report.outputs.command, report.digest)
    });
}

#[test]
fn device_that_resets_is_noticed_and_rejoins() {
    let (setup, task) = (in_plane(), to_the_east());
    for (faults, by_host) in [
        (Faults::default(), false),
        (BAD, false),
        (Faults::default(), true),
        (BAD, true),
    ] {
        let mut bench = Bench::<Large>::new(faults, 5);
        bench.configure(&setup, Some(&task));
        let (mut resets, mut done) = (0, 0);
        let mut shadow = Large::new();
        shadow.configure(&setup, Some(&task)).expect("fits");
        for tick in 0..300 {
            let inbox = inbox(tick, Instant::from_micros(tick * 100_000));
            let packed = pack(&Obstacle::Wall([Vec2::new(9.0, 1.0), Vec2::new(9.0, -1.0)]));
            let step = StepInputs {
                tick,
                now: Instant::from_micros(tick * 100_000),
                pose: Pose::default(),
                cell: None,
                land: None,
                around: Some(crate::message::Around {
                    max_speed_mps: 1.0,
                    in_cell: None,
                    obstacles: &packed,
                }),
                inbox: &inbox,
            };
            if tick % 100 == 50 {
                if by_host {
                    bench.port.restart(bench.now);
                    assert_eq!(bench.wait(), Ok(Event::Restarted));
                    assert!(bench.boot > 1 && bench.session.brain().agent().is_none());
                } else {
                    bench.reset();
                    assert_eq!(bench.step(&step), None, "step {tick}: a reset is no answer");
                }
                resets += 1;
                let mut again = setup.clone();
                again.agent.boot = resets;
                let digest = bench.configure(&again, Some(&task));
                assert_eq!(shadow.configure(&again, Some(&task)), Ok(digest));
                continue;
            }
            let report = bench.step(&step).expect("no reset");
            assert!(
                report.is_identical(&decide(&mut shadow, &step)),
                "step {tick}"
            );
            done += 1;
        }
        assert_eq!((resets, done), (3, 297));
    }
}

#[test]
fn silent_device_is_given_up_with_what_was_asked_and_for_how_long() {
    let deaf = Faults {
        lost: 100,
        ..Faults::default()
    };
    let mut bench = Bench::<Small>::new(deaf, 1);
    bench.port.greet(0);
    let error = bench.wait().expect_err("nobody is there");
    let waited_us = u64::from(LIMITS.attempts) * LIMITS.resend_after_us;
    let (asked, attempts) = (Asked::Hello, LIMITS.attempts);
    assert_eq!(
        error,
        PortError::Silent {
            asked,
            attempts,
            waited_us
        }
    );
    assert_eq!(
        std::format!("{error}"),
        "no answer to greeting within 1200 ms (60 attempts)"
    );
    assert_eq!(bench.port.poll(bench.now), Ok(Next::Idle));
    // In the middle of a run the step is named.
    let mut bench = Bench::<Small>::new(Faults::default(), 1);
    bench.configure(&in_plane(), None);
    bench.there.faults = deaf;
    let inputs = StepInputs {
        tick: 77,
        now: Instant::from_micros(0),
        pose: Pose::default(),
        cell: None,
        land: None,
        around: None,
        inbox: &[],
    };
    bench.port.step(&inputs, bench.now).expect("fits");
    let error = bench.wait().expect_err("cut off");
    assert_eq!(
        std::format!("{error}"),
        "no answer to step 77 within 1200 ms (60 attempts)"
    );
}

#[test]
fn device_of_another_version_is_a_clear_error() {
    let mut bench = Bench::<Small>::new(Faults::default(), 1);
    let mut content = std::vec![9, 0x81, 1, 2];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&content);
    content.extend(crc.to_le_bytes());
    let mut foreign = cobs::encode_vec(&content);
    foreign.push(0);
    bench.port.greet(0);
    bench.back.on_the_way.clear();
    bench.back.send(&foreign, 0);
    let error = bench.wait().expect_err("version 9");
    assert_eq!(error, PortError::Version { device: 9 });
    assert!(std::format!("{error}").contains("version 9 of the link, this host version 2"));
}

#[test]
fn refusal_names_what_was_asked_and_why() {
    let mut bench = Bench::<Small>::new(Faults::default(), 1);
    bench.port.greet(0);
    assert!(matches!(bench.wait(), Ok(Event::Hello(_))));
    let (setup, task) = on_grid(9);
    bench
        .port
        .configure(&setup, Some(&task), bench.now)
        .expect("fits");
    let error = bench.wait().expect_err("too far");
    let text = std::format!("{error}");
    assert_eq!(
        text,
        "the device answers to setup: Capacity: a search of 441 cells, and room for 169"
    );
    let panic = crate::session::fault_frame(crate::message::FaultKind::Panic, "at main.rs:3");
    bench.port.configure(&setup, None, bench.now).expect("fits");
    let mut errors = Vec::new();
    for byte in panic.bytes() {
        errors.extend(bench.port.receive(*byte, 0).err());
    }
    assert_eq!(
        std::format!("{}", errors[0]),
        "the device answers to setup: Panic: at main.rs:3"
    );
}

#[test]
fn requests_longer_than_the_buffer_are_not_sent() {
    let mut port = Port::<64>::new(1, LIMITS);
    assert!(port.configure(&in_plane(), None, 0).is_err());
    assert_eq!(port.poll(0), Ok(Next::Idle));
}

proptest! {
    /// Any line that lets something through is only slow.
    #[test]
    fn any_faults_change_no_result(
        seed: u64,
        lost in 0_u32..40,
        repeated in 0_u32..60,
        flipped in 0_u32..30,
        cut in 0_u32..20,
        delay_us in 0_u32..100_000,
    ) {
        let faults = Faults { lost, repeated, flipped, cut, delay_us };
        let (setup, task) = (in_plane(), to_the_east());
        let mut bench = Bench::<Large>::new(faults, seed);
        let mut shadow: Robot<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, 32, AnyWire> = Robot::new();
        let digest = bench.configure(&setup, Some(&task));
        prop_assert_eq!(shadow.configure(&setup, Some(&task)), Ok(digest));
        for tick in 0..20 {
            let now = Instant::from_micros(tick * 100_000);
            let inbox = inbox(tick, now);
            let around = crate::message::Around { max_speed_mps: 1.0, in_cell: None, obstacles: &[] };
            let step = StepInputs {
                tick, now, pose: Pose::default(), cell: None, land: None, around: Some(around), inbox: &inbox,
            };
            let report = bench.step(&step).expect("no reset");
            prop_assert!(report.is_identical(&decide(&mut shadow, &step)));
        }
    }
}
