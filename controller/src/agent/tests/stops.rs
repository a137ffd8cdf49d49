//! Tests of the stops that a robot on the grid keeps, and of its messages on the air.

use super::*;
use crate::land::{LandPatch, PATCH_TILES};
use crate::wire::{MAX_CONTENT, MAX_MESSAGE};

const A: RobotId = RobotId(2);
const B: RobotId = RobotId(3);
const LEADER: RobotId = RobotId(1);
const VALID: Duration = Duration::from_millis(12_000);
/// The clock wraps within each test.
const START: Instant = Instant::from_micros(u32::MAX - 150_000);

fn after(millis: i32) -> Instant {
    START + Duration::from_millis(millis)
}

fn stopping(origin: RobotId, valid_ms: u16) -> GridMessage {
    GridMessage::Stop { origin, valid_ms }
}

fn resuming(origin: RobotId) -> GridMessage {
    GridMessage::Resume { origin }
}

/// The messages passed on with their validity, and whether the robot decides at once.
type Passed = (Vec<(RobotId, GridMessage, Duration)>, bool);

fn receive(task: &mut GridTask, from: RobotId, message: &GridMessage, now: Instant) -> Passed {
    let mut outgoing = Outgoing::default();
    let mut radio = Radio::new(now, VALID, &mut outgoing);
    task.receive(from, message, &mut radio);
    let decides_at_once = radio.takes_decision();
    let decoded = |content: &[u8]| GridMessage::decode(Grid::ID, Grid::ID, content).unwrap();
    let passed = outgoing.messages.iter().map(|queued| (queued.to, decoded(&queued.content), queued.valid));
    (passed.collect(), decides_at_once)
}

#[test]
fn a_stop_lasts_for_its_validity() {
    let mut task = GridTask::NEW;
    assert!(!task.is_stopped(START));
    let _ = receive(&mut task, A, &stopping(A, 1_000), START);
    assert_eq!((task.stopped_until(), task.report().stopped_until), (Some(after(1_000)), Some(after(1_000))));
    assert_eq!([0, 999, 1_000].map(|millis| task.is_stopped(after(millis))), [true, true, false]);
    let _ = receive(&mut task, A, &stopping(A, 1_000), after(900));
    assert_eq!([1_899, 1_900].map(|millis| task.is_stopped(after(millis))), [true, false], "a new one prolongs it");
    let _ = receive(&mut task, A, &stopping(A, 0), after(1_000));
    assert!(!task.is_stopped(after(1_000)), "and may shorten it");
}

#[test]
fn a_resume_lifts_the_stop_of_its_own_sender_and_origin_only() {
    let mut task = GridTask::NEW;
    // A asks for itself and passes on the stop of B; B also asks directly.
    for (sender, origin) in [(A, A), (A, B), (B, B)] {
        let _ = receive(&mut task, sender, &stopping(origin, 1_000), START);
    }
    for (sender, origin, stopped) in [(A, B, true), (B, A, true), (B, B, true), (A, A, false)] {
        let _ = receive(&mut task, sender, &resuming(origin), START);
        assert_eq!(task.is_stopped(START), stopped);
    }
    assert_eq!(task.stopped_until(), None);
}

#[test]
fn the_robot_is_stopped_until_the_last_active_stop_ends() {
    let mut task = GridTask::NEW;
    let _ = receive(&mut task, A, &stopping(A, u16::MAX), START);
    let _ = receive(&mut task, B, &stopping(B, 1_000), START);
    assert_eq!(task.stopped_until(), Some(after(65_535)));
    assert_eq!([65_534, 65_535].map(|millis| task.is_stopped(after(millis))), [true, false]);
    let _ = receive(&mut task, B, &stopping(B, 0), after(65_535));
    assert!(!task.is_stopped(after(65_535)));
}

#[test]
fn stops_and_resumes_are_passed_on_to_the_leader() {
    let mut task = GridTask::NEW;
    assert_eq!(receive(&mut task, A, &stopping(A, 1_000), START), (vec![], true), "it leads");
    task.shown.leader = LEADER;
    let (millis, stop, resume) = (Duration::from_millis, stopping(B, 1_000), resuming(B));
    assert_eq!(receive(&mut task, A, &stop, START), (vec![(LEADER, stop, millis(1_000))], true));
    assert_eq!(receive(&mut task, A, &resume, START), (vec![(LEADER, resume, VALID)], true));
    for its_own in [stopping(LEADER, 1_000), resuming(LEADER)] {
        assert_eq!(receive(&mut task, A, &its_own, START), (vec![], true), "not back to its origin");
    }
    assert_eq!(receive(&mut task, A, &GridMessage::Redirect, START), (vec![], true));
    let patch = LandPatch::from_bytes(Cell::default(), [0; PATCH_TILES]);
    assert_eq!(receive(&mut task, A, &GridMessage::Land(patch), START), (vec![], false));
}

#[test]
fn a_full_list_refuses_further_stops_until_one_ends() {
    let mut task = GridTask::NEW;
    task.shown.leader = LEADER;
    let stop = |n: u32, valid_ms| stopping(RobotId(10 + n), valid_ms);
    let mut passed = |n, valid_ms, now| receive(&mut task, RobotId(10 + n), &stop(n, valid_ms), now).0.len();
    for n in 0..4 {
        assert_eq!(passed(n, if n == 2 { 1_000 } else { 5_000 }, START), 1);
    }
    assert_eq!(passed(8, 9_000, after(999)), 0, "neither kept nor passed on");
    assert_eq!(passed(3, 5_000, after(999)), 1, "a known one is renewed");
    assert_eq!(passed(8, 9_000, after(1_000)), 1);
    assert_eq!(task.stopped_until(), Some(after(10_000)));
    assert_eq!(receive(&mut task, RobotId(18), &resuming(RobotId(18)), after(1_000)).0.len(), 1);
    assert_eq!(task.stopped_until(), Some(after(5_999)));
}

#[test]
fn after_any_pause_up_to_a_turn_of_the_clock_no_stop_is_active() {
    let mut task = GridTask::NEW;
    let _ = receive(&mut task, A, &stopping(A, 12_000), START);
    for minutes in [1, 36, 50, 70] {
        let now = (0..minutes).fold(START, |now, _| now + Duration::from_millis(60_000));
        assert!(!task.is_stopped(now), "after {minutes} min");
    }
}

/// The clock wraps after 71 minutes and 35 seconds.
#[test]
fn an_expired_stop_does_not_return_when_the_clock_has_wrapped() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let stop = bytes(2, 0, 0, &[stop(2, 1, 0)]);
    for n in 0..80 * 60 {
        let now = Instant::from_micros((TICK as u32).wrapping_mul(n));
        let inbox = if n == 0 { &stop[..] } else { &[] };
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), inbox), now, &mut ws);
        assert_eq!(agent.mode() == Mode::Hold, n < 12, "after {n} s");
    }
}

#[test]
fn stops_and_resumes_of_one_origin_have_one_subject() {
    let subject = Grid::subject;
    for origin in [RobotId(1), RobotId(2), RobotId(u32::MAX)] {
        assert_eq!(subject(&stopping(origin, 5)), subject(&resuming(origin)));
    }
    let patch = LandPatch::from_bytes(Cell::default(), [0; PATCH_TILES]);
    let subjects = [stopping(A, 5), stopping(B, 5), GridMessage::Redirect].map(|message| subject(&message));
    assert!(subjects[0] != subjects[1] && subjects[0] != subjects[2] && subjects[1] != subjects[2]);
    assert_eq!(subject(&GridMessage::Land(patch)), subject(&GridMessage::Redirect));
    let template = GridOrder::Template {
        part: TemplatePart {
            version: 0,
            part: 0,
            parts: 1,
            slot: 0,
            offset: Cell::default(),
            entries: heapless::Vec::new(),
        },
        is_restarted: false,
    };
    let orders = [GridOrder::Goal(Cell::default()), GridOrder::FormationGoal(Cell::default()), template];
    assert_eq!(orders.map(|order| Grid::order_subject(&order)), [Some(0), Some(0), None]);
}

#[test]
fn a_stop_has_a_validity_of_65_seconds_at_most() {
    let of = |valid| match GridMessage::stop(A, valid) {
        GridMessage::Stop { origin: A, valid_ms } => valid_ms,
        other => panic!("{other:?}"),
    };
    let millis = Duration::from_millis;
    assert_eq!([millis(0), millis(-5), millis(1_200), millis(65_535)].map(of), [0, 0, 1_200, 65_535]);
    assert_eq!([millis(65_536), Duration::MAX].map(of), [u16::MAX; 2]);
}

#[test]
fn messages_have_the_golden_bytes() {
    let bytes = |message: &GridMessage| message.encode::<MAX_MESSAGE>(Grid::ID).unwrap().1.to_vec();
    assert_eq!(bytes(&stopping(RobotId(7), 0x0102)), [0, 7, 2, 1]);
    assert_eq!(bytes(&resuming(RobotId(300))), [1, 0xAC, 2]);
    assert_eq!(bytes(&GridMessage::Redirect), [2]);
    assert_eq!(bytes(&stopping(RobotId(u32::MAX), 1)).len(), 8);
    let land = GridMessage::Land(LandPatch::from_bytes(Cell::new(-2, 300), core::array::from_fn(|n| n as u8)));
    assert_eq!(land.encode::<MAX_MESSAGE>(Grid::ID), None);
    let (id, bytes) = land.encode::<MAX_CONTENT>(Grid::ID).unwrap();
    assert_eq!((id, &bytes[..7], bytes.len()), (Grid::ID, &[3, 0xFE, 0xFF, 0x2C, 1, 0, 1][..], 37));
    assert_eq!(GridMessage::decode(Grid::ID, id, &bytes), Some(land));
}
