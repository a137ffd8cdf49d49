use super::{answers, frame, hello, in_plane, large, on_grid, read, small, stepped};
use crate::frame::VERSION;
use crate::message::*;
use crate::robot::{Controller, Small};
use crate::session::{About, Meter, Reaction, Session};
use crate::surroundings::{OBSTACLE_BYTES, PackedSurroundings, TerrainWindow};
use proptest::collection::vec;
use proptest::prelude::*;
use staya_controller::agent::{CellState, KinematicState, Task, Waypoint};
use staya_controller::scalar::NumberFormat;
use staya_controller::time::Instant;
use std::string::ToString;
use std::vec::Vec;

const TOKEN: Token = Token { run: 5, number: 1 };

fn configure(seq: u16) -> Vec<u8> {
    let (setup, task) = on_grid(5);
    let task = Some(task);
    frame(kind::CONFIGURE, &Configure { seq, setup, task })
}

fn step(seq: u16) -> Vec<u8> {
    let inputs = StepInputs {
        tick: seq.into(),
        now: Instant::from_micros(u32::from(seq).wrapping_mul(100_000)),
        state: KinematicState::default(),
        cell: Some(CellState::default()),
        window: None,
        surroundings: None,
        inbox: &[],
    };
    frame(kind::STEP, &Step { seq, inputs })
}

fn fault(frames: &[Vec<u8>]) -> (FaultKind, u16, std::string::String) {
    assert_eq!(frames.len(), 1);
    let fault: Fault = read(kind::FAULT, &frames[0]);
    (fault.kind, fault.seq, fault.text.to_string())
}

#[test]
fn repeated_request_gets_an_identical_answer_without_a_second_step() {
    let mut session = small();
    let configured = answers(&mut session, &configure(9));
    assert_eq!(answers(&mut session, &configure(9)), configured);
    let first = answers(&mut session, &step(10));
    let state = session.controller().agent().map(|agent| agent.digest());
    assert_eq!(Some(stepped(&first[0]).result.digest), state);
    for _ in 0..3 {
        assert_eq!(answers(&mut session, &step(10)), first);
    }
    assert_eq!(session.controller().agent().map(|agent| agent.digest()), state);
    assert_eq!((session.counts().steps, session.counts().repeated), (1, 4));
    let second = answers(&mut session, &step(11));
    assert_ne!(stepped(&second[0]).result.digest, stepped(&first[0]).result.digest);
}

#[test]
fn requests_out_of_order_are_reported_or_ignored() {
    let mut session = small();
    let (kind, seq, text) = fault(&answers(&mut session, &step(3)));
    assert_eq!((kind, seq), (FaultKind::NotConfigured, 3), "{text}");
    answers(&mut session, &configure(u16::MAX));
    let (kind, seq, text) = fault(&answers(&mut session, &step(1)));
    assert_eq!((kind, seq), (FaultKind::Gap, 1));
    assert_eq!(text, "request 1 after 65535");
    assert_eq!(answers(&mut session, &step(0)).len(), 1, "after the wrap");
    assert!(answers(&mut session, &step(u16::MAX)).is_empty());
    assert!(answers(&mut session, &configure(u16::MAX - 5)).is_empty());
    assert_eq!(session.counts().stale, 2);
    let _ = answers(&mut session, &step(7));
    assert_eq!(stepped(&answers(&mut session, &step(0))[0]).seq, 0);
}

#[test]
fn setups_that_do_not_fit_are_refused_with_the_reason() {
    let mut session = small();
    for (radius, fits) in [(5, true), (6, false)] {
        let (setup, task) = on_grid(radius);
        let seq = u16::from(radius);
        let task = Some(task);
        let request = frame(kind::CONFIGURE, &Configure { seq, setup, task });
        let answers = answers(&mut session, &request);
        if fits {
            let configured: Configured = read(kind::CONFIGURED, &answers[0]);
            assert_eq!(configured.seq, seq);
        } else {
            let (kind, _, text) = fault(&answers);
            assert_eq!(kind, FaultKind::Capacity);
            assert_eq!(text, "a search of 225 cells, and room for 169");
        }
    }
    let (kind, ..) = fault(&answers(&mut session, &step(7)));
    assert_eq!(kind, FaultKind::NotConfigured);
    let mut setup = in_plane();
    setup.agent.id = staya_controller::robot::RobotId::NONE;
    let configure = |seq, setup, task| frame(kind::CONFIGURE, &Configure { seq, setup, task });
    let (kind, ..) = fault(&answers(&mut session, &configure(8, setup, None)));
    assert_eq!(kind, FaultKind::Setup);
    let (routing, _) = on_grid(5);
    let waypoint = Waypoint::fixed(staya_controller::geom::Position::ORIGIN);
    let waypoints = Task::Waypoints([(0, waypoint)].into_iter().collect());
    let (kind, _, text) = fault(&answers(&mut session, &configure(9, routing, Some(waypoints))));
    assert_eq!((kind, text.as_str()), (FaultKind::Setup, "the guidance law has no use for the task"));
}

#[test]
fn too_many_obstacles_and_inconsistent_inputs_are_refused_without_stopping_the_robot() {
    let mut session = small();
    let request = Configure { seq: 1, setup: in_plane(), task: None };
    answers(&mut session, &frame(kind::CONFIGURE, &request));
    let mut with = |bytes: usize, shape: u8, cells: &[u8]| {
        let obstacles = std::vec![shape; bytes];
        let inputs = StepInputs {
            tick: 1,
            now: Instant::from_micros(0),
            state: KinematicState::default(),
            cell: None,
            window: Some(TerrainWindow { origin: staya_controller::grid::Cell::default(), width: 2, height: 2, cells }),
            surroundings: Some(PackedSurroundings { max_speed_mps: 1.0, in_cell: None, obstacles: &obstacles }),
            inbox: &[],
        };
        let request = frame(kind::STEP, &Step { seq: 2, inputs });
        let answers = answers(&mut session, &request);
        assert_eq!(answers.len(), 1);
        let mut deframer = crate::frame::Deframer::<1024>::new();
        let fault = answers[0].iter().find_map(|byte| {
            let (kind, body) = deframer.push(*byte)?.expect("sound");
            (kind == kind::FAULT).then(|| postcard::from_bytes::<Fault>(body).expect("readable"))
        });
        fault.map(|fault| fault.kind)
    };
    let land = [1; 4];
    assert_eq!(with(17 * OBSTACLE_BYTES, 0, &land), Some(FaultKind::Capacity));
    assert_eq!(with(OBSTACLE_BYTES - 1, 0, &land), Some(FaultKind::Malformed));
    assert_eq!(with(OBSTACLE_BYTES, 3, &land), Some(FaultKind::Malformed));
    assert_eq!(with(OBSTACLE_BYTES, 0, &land[1..]), Some(FaultKind::Malformed));
    assert_eq!(with(16 * OBSTACLE_BYTES, 0, &land), None);
}

#[test]
fn other_versions_kinds_and_bodies_are_answered_with_a_fault() {
    let mut session = small();
    let mut content = std::vec![VERSION + 1, kind::GREETING, 1, 2];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&content);
    content.extend(crc.to_le_bytes());
    let mut foreign = cobs::encode_vec(&content);
    foreign.push(0);
    let (kind, _, text) = fault(&answers(&mut session, &foreign));
    assert_eq!(kind, FaultKind::Version);
    assert_eq!(text, std::format!("the device speaks version {VERSION} of the link, not {}", VERSION + 1));
    for (kind, body) in [(99, 7_u8), (kind::CONFIGURE, 1), (kind::STEP, 0xFF)] {
        let (kind, ..) = fault(&answers(&mut session, &frame(kind, &body)));
        assert_eq!(kind, FaultKind::Malformed);
    }
    assert_eq!(session.counts().damaged, 0);
}

#[test]
fn new_greeting_resets_the_session_and_a_delayed_one_does_not() {
    let mut session = small();
    let greet = |token| frame(kind::GREETING, &Greeting { token });
    let said = |answers: Vec<Vec<u8>>| hello(&answers[0]).token;
    assert_eq!(hello(session.hello()).token, None);
    assert_eq!(said(answers(&mut session, &greet(TOKEN))), Some(TOKEN));
    answers(&mut session, &configure(1));
    answers(&mut session, &step(2));
    for number in [1, 0, u16::MAX] {
        let delayed = Token { number, ..TOKEN };
        assert_eq!(said(answers(&mut session, &greet(delayed))), Some(TOKEN));
        assert!(session.controller().agent().is_some());
    }
    for token in [Token { number: 2, ..TOKEN }, Token { run: 6, number: 0 }] {
        answers(&mut session, &configure(7));
        assert_eq!(said(answers(&mut session, &greet(token))), Some(token));
        assert!(session.controller().agent().is_none());
    }
}

#[test]
fn only_the_host_that_greeted_last_can_restart_the_device() {
    let mut session = small();
    let restart = frame(kind::RESTART, &Restart { token: TOKEN });
    assert_eq!(hello(&answers(&mut session, &restart)[0]).token, None);
    answers(&mut session, &frame(kind::GREETING, &Greeting { token: TOKEN }));
    let reactions: Vec<bool> =
        restart.iter().map(|byte| session.receive(*byte, &mut ()) == Reaction::Restart).collect();
    assert_eq!(reactions.iter().filter(|restarts| **restarts).count(), 1);
    assert_eq!(reactions.last(), Some(&true));
}

#[test]
fn meter_runs_only_around_each_step() {
    #[derive(Default)]
    struct Counting {
        started: u32,
        finished: u32,
    }
    impl Meter for Counting {
        fn start(&mut self) {
            assert_eq!(self.started, self.finished);
            self.started += 1;
        }
        fn finish(&mut self) -> Cost {
            self.finished += 1;
            Cost { ticks: 100 + self.finished, stack_bytes: 7 }
        }
    }
    let (mut session, mut meter) = (large(), Counting::default());
    let mut last = Vec::new();
    for request in [configure(1), step(2), step(2), step(3)] {
        for byte in request {
            if let Reaction::Answer(frame) = session.receive(byte, &mut meter) {
                last = frame.to_vec();
            }
        }
    }
    assert_eq!((meter.started, meter.finished), (2, 2));
    let cost = stepped(&last).cost;
    assert_eq!((cost.ticks, cost.stack_bytes), (102, 7));
}

proptest! {
    #[test]
    fn session_works_after_any_bytes(
        noise in vec(vec(any::<u8>(), 0..200), 0..20),
        bodies in vec((0_u8..6, vec(any::<u8>(), 0..80)), 0..20),
    ) {
        let mut session = small();
        answers(&mut session, &configure(1));
        for bytes in &noise {
            answers(&mut session, bytes);
        }
        for (kind, body) in &bodies {
            let mut content = std::vec![VERSION, *kind];
            content.extend(body);
            let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&content);
            content.extend(crc.to_le_bytes());
            let mut sound = std::vec![0];
            sound.extend(cobs::encode_vec(&content));
            sound.push(0);
            answers(&mut session, &sound);
        }
        let token = Token { run: 0xDEAD_BEEF, number: 1 };
        let mut greeting = std::vec![0];
        greeting.extend(frame(kind::GREETING, &Greeting { token }));
        let said = answers(&mut session, &greeting);
        prop_assert_eq!(hello(said.last().expect("an answer")).token, Some(token));
        let said = answers(&mut session, &configure(1));
        prop_assert_eq!(read::<Configured>(kind::CONFIGURED, &said[0]).seq, 1);
        prop_assert_eq!(stepped(&answers(&mut session, &step(2))[0]).seq, 2);
    }
}

#[test]
fn hello_names_part_and_number_format() {
    let about = About { part: "nrf51", firmware: "lockstep", boot: 3, ticks_per_second: 16 };
    let mut session = Session::<Small, { super::SMALL }>::new(Small::new(), about);
    let hello = hello(session.hello());
    assert_eq!((hello.part.as_str(), hello.firmware.as_str()), ("nrf51", "lockstep"));
    assert_eq!((hello.boot, hello.ticks_per_second), (3, 16));
    assert_eq!(hello.number, NumberFormat::Q16);
    let controller = Small::new().capacities();
    let room = usize::from(hello.capacities.inbox_bytes);
    // A micro:bit's buffer must also hold a setup.
    assert!(room >= crate::robot::SMALL_INBOX);
    let inbox_bytes = hello.capacities.inbox_bytes;
    assert_eq!(hello.capacities, crate::capacities::Capacities { inbox_bytes, ..controller });
}
