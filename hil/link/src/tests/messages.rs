use super::{frame, read};
use crate::capacities::Capacities;
use crate::message::*;
use crate::robot::{Controller, Large, Robot, Small};
use crate::session::{Session, fault_frame};
use crate::surroundings::{OBSTACLE_BYTES, PackedSurroundings, TerrainWindow, pack, unpack};
use heapless::Vec;
use proptest::collection::vec;
use proptest::prelude::*;
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Cell, Dir};
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::{NumberFormat, Q16, Scalar};
use staya_controller::template::Template;
use staya_controller::template::TemplateEntry;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Format, Postcard};

fn content(frame: &[u8]) -> usize {
    let mut deframer = crate::frame::Deframer::<16384>::new();
    let bodies = frame.iter().filter_map(|byte| {
        let found = deframer.push(*byte)?;
        Some(found.expect("sound").1.len())
    });
    bodies.last().expect("a frame") + crate::frame::OVERHEAD
}

const FAR: Cell = Cell::new(i16::MIN, i16::MIN);
const LATE: Duration = Duration::from_micros(i32::MIN);
const LAST: Instant = Instant::from_micros(u32::MAX);
const HIGH: RobotId = RobotId(u32::MAX);

fn longest_result() -> StepResult {
    let event = Event::TargetMoved { from: FAR, to: FAR };
    StepResult {
        outputs: Outputs {
            command: Command::Velocity(Vec3::new(1.0, 2.0, 3.0)),
            wait: Some(Wait::GoalTaken),
            received: u16::MAX,
            rejected: u16::MAX,
            refused: Refused { unsigned: u16::MAX, forged: u16::MAX, replayed: u16::MAX, no_room: u16::MAX },
            implausible: ImplausibleCounts { numbers: u16::MAX, radii: u16::MAX, speeds: u16::MAX, jumps: u16::MAX },
            outbox: core::iter::repeat_n(0xFF, OUTBOX).collect(),
            events: core::iter::repeat_n(event, EVENTS).collect(),
            call_again: LAST,
        },
        mode: Mode::Fault,
        leader: HIGH,
        target: Some(FAR),
        digest: u64::MAX,
    }
}

#[test]
fn longest_answer_fits() {
    let stepped =
        Stepped { seq: u16::MAX, result: longest_result(), cost: Cost { ticks: u32::MAX, stack_bytes: u32::MAX } };
    let bytes = frame(kind::STEPPED, &stepped);
    assert!(bytes.len() <= MAX_ANSWER, "{}", bytes.len());
    assert_eq!(read::<Stepped>(kind::STEPPED, &bytes), stepped);
    assert!(stepped.result.is_identical(&stepped.result));
    for text in ["", "x", &"long ".repeat(100)] {
        let fault = fault_frame(FaultKind::Panic, text);
        let said: Fault = read(kind::FAULT, fault.bytes());
        assert_eq!(said.kind, FaultKind::Panic);
        assert!(text.starts_with(said.text.as_str()) && said.text.len() == text.len().min(80));
    }
}

#[test]
fn longest_hello_fits_a_note() {
    let about = crate::session::About {
        part: "a part whose name is much too long",
        firmware: "a firmware whose name is much too long for it",
        boot: u32::MAX,
        ticks_per_second: u32::MAX,
    };
    let mut session = Session::<Small, { super::SMALL }>::new(Small::new(), about);
    let hello = super::hello(session.hello());
    assert_eq!(hello.part.len(), 24);
    let (run, number) = (u32::MAX, u16::MAX);
    let token = Token { run, number };
    let greeting = frame(kind::GREETING, &Greeting { token });
    let answers = super::answers(&mut session, &greeting);
    assert_eq!(super::hello(&answers[0]).token, Some(token));
}

#[test]
fn longest_setup_fits() {
    let mut agent = super::in_plane().agent;
    agent.id = HIGH;
    agent.seed = u64::MAX;
    for span in [
        &mut agent.tick,
        &mut agent.beacon_period,
        &mut agent.latency,
        &mut agent.ages.stale_after,
        &mut agent.ages.expire_after,
        &mut agent.retry.interval,
        &mut agent.message_valid,
        &mut agent.plausibility.settle,
    ] {
        *span = LATE;
    }
    let (routing, _) = super::on_grid(u8::MAX);
    let LawSettings::Route(route) = routing.law else {
        panic!("a route");
    };
    let entry = TemplateEntry { offset: FAR, id: HIGH, hops: u8::MAX };
    let entries: Vec<_, TEMPLATE> = core::iter::repeat_n(entry, TEMPLATE).collect();
    let setup = Setup {
        agent,
        law: LawSettings::Formation(FormationSettings {
            route: RouteSettings { speed_mps: Some(1.0), ..route },
            template: template(entries),
            ..FormationSettings::default()
        }),
        safety: super::in_plane().safety,
        format: Format::Mavlink,
    };
    let waypoint =
        Waypoint { position: Position::from_mm([i32::MIN; 3]), velocity_mps: Vec3::new(1.0, 2.0, 3.0), at: LAST };
    let waypoints = core::iter::repeat_n((u8::MAX, waypoint), WAYPOINTS).collect();
    let configure = Configure { seq: u16::MAX, setup, task: Some(Task::Waypoints(waypoints)) };
    let bytes = frame(kind::CONFIGURE, &configure);
    let len = content(&bytes);
    // Spare room for larger parameters.
    assert!(len + 100 <= MAX_CONFIGURE, "{len}");
    assert_eq!(read::<Configure>(kind::CONFIGURE, &bytes), configure);
}

fn template(entries: Vec<TemplateEntry, TEMPLATE>) -> Template<TEMPLATE> {
    Template { slot: u8::MAX, offset: FAR, entries }
}

#[test]
fn longest_step_fits_its_buffer() {
    let obstacles = [0; OBSTACLE_BYTES * 32];
    let (cells, inbox) = ([9; 121], [8; 8192]);
    let inputs = StepInputs {
        tick: u32::MAX,
        now: LAST,
        state: KinematicState { position: Position::from_mm([i32::MIN; 3]), velocity_mps: Vec3::new(1.0, 2.0, 3.0) },
        cell: Some(CellState { cell: FAR, busy: LATE }),
        window: Some(TerrainWindow { origin: FAR, width: u16::MAX, height: u16::MAX, cells: &cells }),
        surroundings: Some(PackedSurroundings {
            max_speed_mps: 1.0,
            in_cell: Some(InCell { offset_m: Vec2::new(1.0, 2.0), cell_m: 3.0 }),
            obstacles: &obstacles,
        }),
        inbox: &inbox,
    };
    let seq = u16::MAX;
    let bytes = frame(kind::STEP, &Step { seq, inputs });
    assert!(content(&bytes) <= super::LARGE, "{}", content(&bytes));
    let mut session = super::large();
    let capacities = super::hello(session.hello()).capacities;
    assert_eq!(usize::from(capacities.inbox_bytes), crate::robot::LARGE_INBOX);
    assert!(bytes.len() <= capacities.frame_bytes());
    let answers = super::answers(&mut session, &bytes);
    let fault: Fault = read(kind::FAULT, &answers[0]);
    assert_eq!(fault.kind, FaultKind::NotConfigured);
}

#[test]
fn session_sizes_match_the_documentation() {
    // Pointers are larger on a 64-bit host.
    let small = size_of::<Session<Small, { super::SMALL }>>();
    assert!(small <= 9 * 1024, "{small}");
    let large = size_of::<Session<Large, { super::LARGE }>>();
    assert!(large <= 18 * 1024 + 256, "{large}");
    assert_eq!(Small::new().number(), NumberFormat::Q16);
    assert_eq!(Large::new().number(), NumberFormat::F32);
    let Capacities { neighbors, obstacles, .. } = Small::new().capacities();
    assert_eq!((neighbors, obstacles), (8, 16));
}

fn obstacle() -> impl Strategy<Value = Obstacle<f32>> {
    let number = || (-1000_i16..1000).prop_map(|n| f32::from(n) / 16.0);
    let numbers = [number(), number(), number(), number()];
    (0..3, numbers).prop_map(|(shape, [a, b, c, d])| match shape {
        0 => Obstacle::Wall([Vec2::new(a, b), Vec2::new(c, d)]),
        1 => Obstacle::Ball { center_m: Vec3::new(a, b, c), radius_m: d },
        _ => Obstacle::Plane { normal: Vec3::new(a, b, c), distance_m: d },
    })
}

proptest! {
    #[test]
    fn obstacles_survive_a_round_trip(obstacle in obstacle()) {
        prop_assert_eq!(unpack(&pack(&obstacle)), Some(obstacle));
        // Multiples of 1/16 are exact in Q16 too.
        let fixed = unpack::<Q16>(&pack(&obstacle)).expect("known");
        let back = |v: Q16| v.to_f32();
        let same = match (obstacle, fixed) {
            (Obstacle::Wall([a, b]), Obstacle::Wall([c, d])) => {
                [a.x, a.y, b.x, b.y] == [c.x, c.y, d.x, d.y].map(back)
            }
            (Obstacle::Ball { center_m: a, radius_m: r }, Obstacle::Ball { center_m: b, radius_m: q })
            | (Obstacle::Plane { normal: a, distance_m: r }, Obstacle::Plane { normal: b, distance_m: q }) => {
                [a.x, a.y, a.z, r] == [b.x, b.y, b.z, q].map(back)
            }
            _ => false,
        };
        prop_assert!(same);
    }

    #[test]
    fn steps_survive_a_round_trip(
        seq: u16,
        (tick, now) in any::<(u32, u32)>(),
        mm: [i32; 3],
        velocity in [-99_f32..99.0, -99_f32..99.0, -9_f32..9.0],
        cell in proptest::option::of((any::<[i16; 2]>(), any::<i32>())),
        land in proptest::option::of((any::<[i16; 2]>(), 1_u16..20, vec(any::<u8>(), 0..200))),
        obstacles in proptest::option::of(vec(obstacle(), 0..20)),
        inbox in vec(any::<u8>(), 0..600),
    ) {
        let packed: Option<std::vec::Vec<u8>> =
            obstacles.as_ref().map(|all| all.iter().flat_map(pack).collect());
        let [x, y, z] = velocity;
        let inputs = StepInputs {
            tick,
            now: Instant::from_micros(now),
            state: KinematicState { position: Position::from_mm(mm), velocity_mps: Vec3::new(x, y, z) },
            cell: cell.map(|([x, y], busy)| CellState {
                cell: Cell::new(x, y),
                busy: Duration::from_micros(busy),
            }),
            window: land.as_ref().map(|([x, y], width, cells)| TerrainWindow {
                origin: Cell::new(*x, *y),
                width: *width,
                height: 7,
                cells,
            }),
            surroundings: packed.as_ref().map(|obstacles| PackedSurroundings {
                max_speed_mps: x,
                in_cell: cell.map(|_| InCell { offset_m: Vec2::new(x, y), cell_m: z }),
                obstacles,
            }),
            inbox: &inbox,
        };
        let bytes = frame(kind::STEP, &Step { seq, inputs });
        let mut deframer = crate::frame::Deframer::<16384>::new();
        for byte in bytes {
            if let Some(found) = deframer.push(byte) {
                let (_, body) = found.expect("sound");
                prop_assert_eq!(postcard::from_bytes::<Step<'_>>(body), Ok(Step { seq, inputs }));
            }
        }
        if let Some(surroundings) = inputs.surroundings {
            let read: Option<std::vec::Vec<_>> = surroundings.obstacles::<f32>().collect();
            prop_assert_eq!(read, obstacles);
        }
    }

    #[test]
    fn reports_survive_a_round_trip(
        seq: u16,
        digest: u64,
        moves in vec(0_u8..9, 0..8),
        velocity in [-99_f32..99.0, -99_f32..99.0, -9_f32..9.0],
        outbox in vec(any::<u8>(), 0..OUTBOX),
        numbers in vec(any::<u32>(), 0..EVENTS),
        counts: (u16, u16, u32, u32),
    ) {
        let [x, y, z] = velocity;
        let command = match moves.len() {
            0 => Command::Hold,
            1 => Command::Velocity(Vec3::new(x, y, z)),
            _ => Command::Move(moves.iter().map(|m| Dir::from_index(*m)).collect()),
        };
        let event = |n: &u32| match n % 4 {
            0 => Event::NeighborFound(RobotId(*n)),
            1 => Event::MessageExpired(RobotId(*n)),
            2 => Event::ModeChanged { from: Mode::Idle, to: Mode::Hold },
            _ => Event::NoRoute,
        };
        let outputs = Outputs {
            command,
            wait: None,
            received: counts.0,
            rejected: counts.1,
            refused: Refused { forged: counts.0, replayed: counts.1, ..Refused::default() },
            implausible: ImplausibleCounts { numbers: counts.0, jumps: counts.1, ..ImplausibleCounts::default() },
            outbox: outbox.iter().copied().collect(),
            events: numbers.iter().map(event).collect(),
            call_again: Instant::from_micros(counts.2),
        };
        let (mode, leader) = (Mode::Cruise, RobotId(counts.3));
        let result = StepResult { outputs, mode, leader, target: None, digest };
        let cost = Cost { ticks: counts.2, stack_bytes: counts.3 };
        let stepped = Stepped { seq, result, cost };
        let bytes = frame(kind::STEPPED, &stepped);
        prop_assert_eq!(read::<Stepped>(kind::STEPPED, &bytes), stepped);
    }
}

#[test]
fn identical_means_every_bit() {
    let result = longest_result();
    let with = |x: f32| {
        let mut other = result.clone();
        other.outputs.command = Command::Velocity(Vec3::new(x, 0.0, 0.0));
        other
    };
    assert!(with(0.0) == with(-0.0) && !with(0.0).is_identical(&with(-0.0)));
    assert!(with(1.5).is_identical(&with(1.5)));
}

#[test]
fn unknown_shapes_are_refused() {
    assert_eq!(unpack::<f32>(&[3; OBSTACLE_BYTES]), None);
    assert_eq!(unpack::<f32>(&[0xFF; OBSTACLE_BYTES]), None);
}

#[test]
fn robots_speak_any_format_unless_built_for_a_single_one() {
    let setup = |format| Setup { format, ..super::in_plane() };
    let (mut large, mut small) = (Large::new(), Small::new());
    let mut lean = Robot::<Q16, CELLS, VISITS, 8, 16, 16, Postcard>::new();
    let postcard = large.configure(&setup(Format::Postcard), None, &[]);
    assert_eq!(large.configure(&setup(Format::Mavlink), None, &[]), postcard);
    let in_small = small.configure(&setup(Format::Mavlink), None, &[]);
    assert_eq!(lean.configure(&setup(Format::Postcard), None, &[]), in_small);
    assert!(postcard.is_ok() && in_small.is_ok());
    let refusal = lean.configure(&setup(Format::Mavlink), None, &[]).unwrap_err();
    assert_eq!(std::format!("{refusal}"), "this firmware was built without mavlink");
    assert!(lean.result().is_none());
}
