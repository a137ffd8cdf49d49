//! Tests of the step in which a silent robot counts as lost, of sequence windows of robots that
//! leave the table, and of the room for beacons.

use super::plane::{Robot, STEP, body_at, in_plane, step_number, waypoint};
use super::*;
use crate::neighbor::{Ages, LossEstimate};

type Walker = Robot<f32, WaypointGuidance<f32>, Unguarded>;

fn walker(config: &AgentConfig<f32>) -> Walker {
    Robot::new(config, waypoint(), Unguarded, [0.0; 2])
}

fn said(id: u32, sequence: u16, x_mm: i32) -> Vec<u8> {
    bytes(id, 0, sequence, &[body_at([x_mm, 0], [0, 0], Mode::Hold)])
}

/// The steps in which each of `robots` is lost; all of them speak in the same steps.
fn lost_in(config: &AgentConfig<f32>, robots: u32, speak: impl Fn(i32) -> bool, steps: i32) -> Vec<i32> {
    let mut robot = walker(config);
    let mut lost = Vec::new();
    for n in 0..steps {
        let inbox: Vec<u8> = (2..2 + robots).filter(|_| speak(n)).flat_map(|id| said(id, n as u16, 3000)).collect();
        let out = robot.step(step_number(n), &inbox);
        lost.extend(out.events.iter().filter(|event| matches!(event, Event::NeighborLost(_))).map(|_| n));
    }
    lost
}

/// With one neighbour, 40 frames and no loss, 22 silent periods are explained by chance.
#[test]
fn a_loss_is_reported_in_the_step_after_the_patience_whatever_the_latency() {
    for latency_ms in [0, 30, 100, 250] {
        let config = AgentConfig { latency: Duration::from_millis(latency_ms), ..in_plane(1) };
        assert_eq!(lost_in(&config, 1, |n| n < 40, 100), [39 + 23], "{latency_ms} ms");
    }
}

#[test]
fn each_number_of_robots_and_each_earlier_loss_has_its_patience() {
    for robots in [1, 3, 7] {
        let ages = Ages { expire_after: STEP.saturating_mul(60), ..in_plane::<f32>(1).ages };
        let config = AgentConfig { latency: STEP, ages, ..in_plane(1) };
        let Ages { stale_after, expire_after } = config.ages;
        let periods = |estimate: &LossEstimate| {
            let patience = estimate.patience(robots as usize, STEP, expire_after).max(stale_after);
            // The state is a step old when it arrives, and nothing outlives `expire_after`.
            patience.as_micros().min(expire_after.as_micros() - STEP.as_micros()) / STEP.as_micros()
        };
        let mut estimate = LossEstimate::new();
        (0..40 * robots).for_each(|_| estimate.heard(0));
        let first = periods(&estimate);
        (0..robots).for_each(|_| estimate.gave_up(first as u16));
        (0..40 * robots).for_each(|_| estimate.heard(0));
        let second = periods(&estimate);
        assert_ne!(first, second);
        let wanted = [39 + first + 1, 139 + second + 1].map(|step| vec![step; robots as usize]).concat();
        assert_eq!(lost_in(&config, robots, |n| n % 100 < 40, 200), wanted, "{robots} robots");
    }
}

#[test]
fn a_robot_is_not_lost_before_its_state_is_stale() {
    let ages = Ages { stale_after: STEP.saturating_mul(26), ..in_plane::<f32>(1).ages };
    assert_eq!(lost_in(&AgentConfig { ages, ..in_plane(1) }, 1, |n| n < 40, 100), [39 + 27]);
}

/// Robots come, leave and return three times; then each known one repeats its last frame.
fn assert_repeats_are_refused(mut robot: Walker, pause: i32) {
    let frames: Vec<Vec<u8>> = (0..72).map(|n| said(2 + n % 24, n as u16, 90_000 - 1000 * n as i32)).collect();
    for (n, frame) in (0..).zip(&frames) {
        let out = robot.step(step_number(n * pause), frame);
        assert_eq!((out.received, out.rejected), (1, 0), "frame {n}");
        for silent in 1..pause {
            let _ = robot.step(step_number(n * pause + silent), &[]);
        }
    }
    let known = robot.agent.neighbors().len();
    let out = robot.step(step_number(72 * pause), &frames[72 - known..].concat());
    assert_eq!((usize::from(out.received), usize::from(out.rejected)), (0, known));
    let more = said(2 + 71 % 24, 72, 19_000);
    assert_eq!(robot.step(step_number(72 * pause + 1), &more).received, 1, "the next frame is new");
}

#[test]
fn evicted_robots_that_return_cannot_repeat_a_frame() {
    let robot = walker(&in_plane(1));
    assert_repeats_are_refused(robot, 1);
}

#[test]
fn lost_robots_that_return_cannot_repeat_a_frame() {
    // Lost after at most 30 steps: one robot is known at the end of each pause.
    let robot = walker(&in_plane(1));
    assert_repeats_are_refused(robot, 25);
}

#[test]
fn acknowledgements_leave_room_for_the_beacon() {
    for count in [1, 20, 60] {
        let inbox: Vec<u8> = (0..count).flat_map(|n| bytes(2, 0, n.into(), &[redirect(1, n)])).collect();
        let out = route_agent(1).step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut workspace());
        let sent: Vec<Message> = sent(&out).into_iter().map(|frame| frame.message).collect();
        let acks = sent.iter().filter(|message| matches!(message, Message::Ack(_))).count();
        assert!(acks >= usize::from(count).min(14), "{acks} of {count}");
        assert!(matches!(sent.last(), Some(Message::Beacon(_))), "{count}");
    }
}

#[test]
fn a_nearer_robot_evicts_the_farthest_one_of_a_full_table() {
    let mut robot = walker(&in_plane(1));
    // It knows eight others at most.
    for id in 2..10 {
        let out = robot.step(step_number(id - 2), &said(id as u32, 0, 10_000 + 1000 * id));
        assert_eq!(out.events.as_slice(), [Event::NeighborFound(RobotId(id as u32))]);
    }
    let out = robot.step(step_number(8), &said(10, 0, 5_000));
    assert_eq!(out.events.as_slice(), [Event::NeighborEvicted(RobotId(9)), Event::NeighborFound(RobotId(10))]);
}
