//! Tests of robots with sensors that detect other robots.

use super::plane::{RADIUS_MM, Robot, STEP, body_at, in_plane, one_step_late, orca, place, step_number, waypoint};
use super::*;
use crate::digest::digest;
use crate::geom::{Position, Vec3};
use crate::neighbor::{Sighting, TrackParams, Tracker};
use crate::scalar::cast;
use crate::wire::{Header, encode};

fn params<S: Scalar>() -> TrackParams<S> {
    let params = TrackParams {
        acceleration_mps2: 4.0_f64,
        speed_mps: 1.0,
        heard_m: 0.002,
        heard_mps: 0.01,
        gate: 4.0,
        margin: 2.0,
        forget: STEP.saturating_mul(4),
    };
    params.cast()
}

type Seer<S> = Robot<S, WaypointGuidance<S>, OrcaSafety<S, 16>, Tracker<S>>;

fn seer<S: Scalar>(id: u32, at_m: [f64; 2], goal: Waypoint<S>) -> Seer<S> {
    let mut robot = Robot::seeing(&in_plane(id), waypoint(), orca(), at_m, Tracker::new(params()));
    robot.agent.order(&WaypointOrder::first(goal.cast()));
    robot
}

fn look<S: Scalar>(robot: &mut Seer<S>, other_m: [f64; 2], now: Instant) -> crate::neighbor::Sighted {
    recognize(robot, None, other_m, now)
}

fn recognize<S: Scalar>(
    robot: &mut Seer<S>,
    id: Option<RobotId>,
    other_m: [f64; 2],
    now: Instant,
) -> crate::neighbor::Sighted {
    let number = |x: f64| S::from_f64(x).unwrap();
    let [[x, y], [vx, vy]] = [robot.at_m, robot.velocity_mps];
    let state = KinematicState {
        position: Position::from_metres([x, y, 0.0]).unwrap(),
        velocity_mps: Vec3::new(number(vx), number(vy), S::ZERO),
    };
    let sighting = Sighting {
        offset_m: Vec3::new(number(other_m[0] - x), number(other_m[1] - y), S::ZERO),
        deviation_m: cast(0.005_f32),
        age: Duration::ZERO,
        radius_m: S::from_milli(RADIUS_MM),
        id,
        velocity_mps: None,
    };
    robot.agent.see(&[sighting], &state, now)
}

fn pass_each_other<S: Scalar>() {
    let mut one = seer::<S>(1, [0.0, 0.0], place(4000, 0));
    let mut other = seer::<S>(2, [4.0, 0.05], place(0, 50));
    let mut least_m = f64::INFINITY;
    for n in 0..200 {
        let (a, b) = (one.at_m, other.at_m);
        assert_eq!(look(&mut one, b, step_number(n)).refused, 0);
        let _ = look(&mut other, a, step_number(n));
        let _ = (one.step(step_number(n), &[]), other.step(step_number(n), &[]));
        least_m = least_m.min(super::plane::length([0, 1].map(|axis| one.at_m[axis] - other.at_m[axis])));
    }
    assert_eq!((one.agent.mode(), other.agent.mode()), (Mode::Arrived, Mode::Arrived));
    assert!(least_m >= 0.4 && one.agent.neighbors().iter().all(|known| known.id.is_local()), "{least_m}");
}

#[test]
fn two_robots_that_detect_each_other_pass_without_radio() {
    pass_each_other::<f32>();
    pass_each_other::<f64>();
    pass_each_other::<crate::scalar::Q16>();
}

#[test]
fn without_a_tracker_detections_are_dropped() {
    let mut blind = Robot::<f32, _, _>::new(&in_plane(1), waypoint(), orca(), [0.0; 2]);
    let before = digest(&blind.agent);
    let state = KinematicState::default();
    let sighting = Sighting {
        offset_m: Vec3::new(1.0, 0.0, 0.0),
        deviation_m: 0.01,
        age: Duration::ZERO,
        radius_m: 0.2,
        id: None,
        velocity_mps: None,
    };
    assert_eq!(blind.agent.see(&[sighting], &state, step_number(0)).no_room, 1);
    assert_eq!(digest(&blind.agent), before);
}

#[test]
fn a_silent_robot_in_sight_is_in_contact_and_otherwise_lost() {
    let speak = |n: u32| {
        let header = Header { boot: 0, sender: RobotId(2), sequence: n as u16 };
        let mut bytes = heapless::Vec::<u8, 64>::new();
        encode(header, &body_at([3000, 0], [0, 0], Mode::Cruise), &mut bytes).unwrap();
        bytes.to_vec()
    };
    let run = |is_seen: bool| {
        let tracker = Tracker::new(params());
        let mut robot: Seer<f32> = Robot::seeing(&one_step_late(1), waypoint(), orca(), [0.0; 2], tracker);
        let mut events = std::vec::Vec::new();
        for n in 0..60 {
            if is_seen {
                let _ = look(&mut robot, [3.0, 0.0], step_number(n));
            }
            let inbox = if n < 5 { speak(n as u32) } else { std::vec::Vec::new() };
            events.extend(robot.step(step_number(n), &inbox).events.iter().copied());
        }
        let ids: std::vec::Vec<_> = robot.agent.neighbors().iter().map(|known| known.id).collect();
        (ids, events.contains(&Event::ContactLost))
    };
    assert_eq!(run(true), (std::vec![RobotId(2)], false));
    assert_eq!(run(false), (std::vec![], true));
}

#[test]
fn repeated_frames_of_a_robot_detected_first_are_refused() {
    let mut robot = seer::<f32>(1, [0.0; 2], place(0, 0));
    let _ = recognize(&mut robot, Some(RobotId(2)), [3.0, 0.0], step_number(0));
    let _ = robot.step(step_number(0), &[]);
    let header = Header { boot: 0, sender: RobotId(2), sequence: 7 };
    let mut frame = heapless::Vec::<u8, 64>::new();
    encode(header, &body_at([3000, 0], [0, 0], Mode::Cruise), &mut frame).unwrap();
    let counts: [(u16, u16); 2] = [1, 2].map(|n| {
        let _ = recognize(&mut robot, Some(RobotId(2)), [3.0, 0.0], step_number(n));
        let out = robot.step(step_number(n), &frame);
        (out.received, out.rejected)
    });
    assert_eq!(counts, [(1, 0), (0, 1)]);
}
