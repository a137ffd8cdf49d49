//! Facts that other robots rely on: a robot that does not give way stands, says so, and does not
//! count on its own bounds in the step after that.

use super::plane::{Onlooker, Robot, STEP, body_at, in_plane, orca, said, step_number};
use super::*;
use crate::geom::Vec3;

type Car = Robot<f32, Onlooker, OrcaSafety<f32, 16>>;

const EAST: Action<f32> = Action::Velocity { wish_mps: Vec3::new(1.0, 0.0, 0.0), way_m: None };

/// Drives east, unless it is broken or released.
fn car(config: &AgentConfig<f32>) -> Car {
    Robot::new(config, Onlooker { action: Some(EAST), ..Onlooker::default() }, orca(), [0.0; 2])
}

/// Two metres north, 1 m/s east.
fn beside(n: u16) -> Vec<u8> {
    bytes(2, 0, n, &[body_at([100 * i32::from(n), 2000], [1000, 0], Mode::Cruise)])
}

#[test]
fn a_robot_that_recovers_stands_for_another_step_and_forgets_its_bounds() {
    let config = AgentConfig { latency: STEP, ..in_plane(1) };
    let mut robot = car(&config);
    for n in 0..12 {
        robot.agent.law_mut().is_broken = (4..6).contains(&n);
        // Nothing is heard from step 3 on, so a stored bound would count.
        let inbox = if n < 3 { beside(n) } else { Vec::new() };
        let out = robot.step(step_number(n.into()), &inbox);
        let pauses = (4..7).contains(&n);
        assert_eq!(out.command == Command::Hold, pauses, "step {n}: {:?}", out.command);
        let gap_m = robot.agent.neighbors().first().map(|known| known.gap_m);
        assert!(!pauses || gap_m == Some(0.0), "step {n}: {gap_m:?}");
        let wanted = match n {
            4..6 => Mode::Fault,
            6 => Mode::Idle,
            _ => Mode::Cruise,
        };
        assert_eq!(said(&out).mode, wanted, "step {n}");
    }
    assert!(robot.speed() > 0.9);
}

#[test]
fn a_body_that_stops_at_once_says_that_it_stands() {
    for (most, wanted_mmps) in [(f32::MAX, 0), (1.0, 1000)] {
        let mut robot = car(&AgentConfig { max_acceleration_mps2: most, ..in_plane(1) });
        for n in 0..30 {
            robot.agent.law_mut().is_broken = n == 29;
            let out = robot.step(step_number(n), &[]);
            let [x, ..] = said(&out).velocity_mmps;
            assert!(n < 29 || (x - wanted_mmps).abs() < 2, "{x} with {most} m/s^2");
        }
    }
}

/// Another controller may steer a robot that its agent has released.
#[test]
fn a_released_robot_says_its_measured_velocity_from_the_second_step_on() {
    let mut robot = car(&in_plane(1));
    robot.agent.law_mut().action = Some(Action::Release);
    for (n, wanted_mmps) in [(0, 0), (1, 700), (2, 700)] {
        robot.velocity_mps = [0.7, 0.0];
        let out = robot.step(step_number(n), &[]);
        assert_eq!((out.command.clone(), said(&out).velocity_mmps[0]), (Command::Hold, wanted_mmps), "step {n}");
    }
}

/// Packets wait for the next step, and their senders decide meanwhile.
#[test]
fn beacons_of_a_late_step_are_older_by_its_delay() {
    let config = AgentConfig { latency: STEP, ..in_plane(1) };
    for (late_ms, older_ms) in [(0, 0), (12, 0), (13, 13), (350, 350)] {
        let mut robot = car(&config);
        let _ = robot.step(step_number(10), &beside(0));
        let _ = robot.step(step_number(11), &beside(1));
        assert!(robot.agent.neighbors()[0].gap_m > 0.1);
        let now = step_number(12) + Duration::from_millis(late_ms);
        let _ = robot.step(now, &beside(2));
        let heard = robot.agent.neighbors()[0].heard;
        assert_eq!(now.since(heard).as_micros(), STEP.as_micros() + 1000 * older_ms, "{late_ms} ms");
    }
}
