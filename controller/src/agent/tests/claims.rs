//! Tests of implausible beacons.

use super::plane::{Robot, STEP, body_at, one_step_late, orca, step_number, waypoint};
use super::*;
use crate::neighbor::{Claim, PlausibilityLimits};

type Listener = Robot<f32, WaypointGuidance<f32>, OrcaSafety<f32, 16>>;

const CLAIMS: PlausibilityLimits<f32> = PlausibilityLimits {
    max_radius_m: 0.4,
    max_speed_mps: 2.0,
    slack_m: 0.8,
    settle: Duration::from_micros(4 * STEP.as_micros()),
    last: RobotId(20),
};

fn listener(plausibility: PlausibilityLimits<f32>) -> Listener {
    Robot::new(&AgentConfig { plausibility, ..one_step_late(7) }, waypoint(), orca(), [0.0; 2])
}

fn beacon(x_mm: i32, change: impl FnOnce(&mut Beacon)) -> Message {
    let Message::Beacon(mut beacon) = body_at([x_mm, 0], [0, 0], Mode::Hold) else {
        panic!("a beacon");
    };
    change(&mut beacon);
    Message::Beacon(beacon)
}

fn frame(sender: u32, sequence: u16, message: &Message) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    encode(Header { boot: 0, sender: RobotId(sender), sequence }, message, &mut out).unwrap();
    out.to_vec()
}

fn claims(out: &Outputs<f32>) -> Vec<(u32, Claim)> {
    let claims = out.events.iter().filter_map(|event| match event {
        Event::Implausible { id, claim } => Some((id.0, *claim)),
        _ => None,
    });
    claims.collect()
}

fn where_is(robot: &Listener, id: u32) -> Option<i32> {
    let known = robot.agent.neighbors().iter().find(|known| known.id == RobotId(id));
    known.map(|known| known.position.mm[0])
}

#[test]
fn plausible_values_are_accepted_unchanged() {
    let mut robot = listener(CLAIMS);
    for n in 0..50_i32 {
        // 2 m/s back and forth, and a jump within the slack.
        let x_mm = 5000 + 200 * (n % 20 - 10).abs() + if n == 33 { 700 } else { 0 };
        let said = beacon(x_mm, |beacon| (beacon.radius_mm, beacon.velocity_mmps) = (400, [2000, 0, 0]));
        let out = robot.step(step_number(n), &frame(20, n as u16, &said));
        assert_eq!(out.implausible, ImplausibleCounts::default(), "step {n}");
        assert_eq!(where_is(&robot, 20), Some(x_mm), "step {n}");
        let known = robot.agent.neighbors()[0];
        assert_eq!((known.radius_m, known.velocity_mps.x), (0.4, 2.0));
    }
}

#[test]
fn an_excessive_radius_or_speed_is_reduced_reported_once_and_always_counted() {
    let mut robot = listener(CLAIMS);
    let mut told = Vec::new();
    for n in 0..10 {
        let lie = beacon(9000, |beacon| (beacon.radius_mm, beacon.velocity_mmps) = (65_000, [-30_000, 0, 30_000]));
        let out = robot.step(step_number(n), &frame(3, n as u16, &lie));
        assert_eq!((out.implausible.radii, out.implausible.speeds, out.received), (1, 1, 1));
        told.extend(claims(&out));
        let known = robot.agent.neighbors()[0];
        assert_eq!(known.radius_m, 0.4);
        assert!((known.velocity_mps.norm() - 2.0).abs() < 1e-3, "{:?}", known.velocity_mps);
    }
    assert_eq!(told, [(3, Claim::Radius), (3, Claim::Speed)]);
    let _ = robot.step(step_number(10), &frame(3, 10, &beacon(9000, |_| ())));
    let lie = beacon(9000, |beacon| beacon.radius_mm = 65_000);
    assert_eq!(claims(&robot.step(step_number(11), &frame(3, 11, &lie))), [(3, Claim::Radius)]);
    let lie = beacon(9000, |beacon| beacon.velocity_mmps = [0, 3000, 0]);
    assert_eq!(claims(&robot.step(step_number(12), &frame(3, 12, &lie))), [(3, Claim::Speed)]);
}

#[test]
fn ids_that_no_robot_has_evict_no_neighbour() {
    let mut robot = listener(CLAIMS);
    let truth: Vec<u8> = (1..=6).flat_map(|id| frame(id, 0, &beacon(5000 + 1000 * id as i32, |_| ()))).collect();
    let ghosts: Vec<u8> = (21..40).flat_map(|id| frame(id, 0, &beacon(3000 + 10 * id as i32, |_| ()))).collect();
    let out = robot.step(step_number(0), &[truth, ghosts].concat());
    assert_eq!((out.received, out.rejected, out.implausible.numbers), (6, 19, 19));
    assert_eq!(claims(&out), [(21, Claim::Number)], "once a step");
    let known: Vec<_> = robot.agent.neighbors().iter().map(|known| known.id.0).collect();
    assert_eq!(known, [1, 2, 3, 4, 5, 6]);
}

/// A sender that forges known ids fills the table with duplicates. In a full one they replace each
/// other, and the first owner of an id.
#[test]
fn duplicate_ids_evict_at_most_one_first_owner() {
    let mut robot = listener(PlausibilityLimits::ANY);
    let truth = |n| (11..=18).flat_map(move |id| frame(id, n, &beacon(1000 * id as i32, |_| ()))).collect::<Vec<u8>>();
    let _ = robot.step(step_number(0), &truth(0));
    let ghosts: Vec<u8> = (11..=18).flat_map(|id| frame(id, 2, &beacon(-3000 - 10 * id as i32, |_| ()))).collect();
    let _ = robot.step(step_number(1), &[truth(1), ghosts].concat());
    let known: Vec<_> = robot.agent.neighbors().iter().map(|known| known.id.0).collect();
    assert_eq!(known, [12, 13, 14, 15, 16, 17, 18, RobotId(11).duplicate().0]);
}

#[test]
fn a_robot_that_jumps_again_is_refused_until_it_has_settled() {
    let mut robot = listener(CLAIMS);
    let _ = robot.step(step_number(0), &frame(3, 0, &beacon(9000, |_| ())));
    let out = robot.step(step_number(1), &frame(3, 1, &beacon(-7000, |_| ())));
    assert_eq!((out.implausible.jumps, out.received, robot.agent.neighbors().len()), (0, 1, 2));
    let double = RobotId(3).duplicate().0;
    let mut told = Vec::new();
    for n in 2..=6 {
        let out = robot.step(step_number(n), &frame(3, n as u16, &beacon(-2000 + 100 * n, |_| ())));
        told.extend(claims(&out));
        let (received, place) = if n <= 5 { (0, -7000) } else { (1, -1400) };
        assert_eq!((out.implausible.jumps, out.received), (1, received), "step {n}");
        assert_eq!((where_is(&robot, 3), where_is(&robot, double)), (Some(9000), Some(place)), "step {n}");
    }
    assert_eq!(told, [(3, Claim::Jump)]);
    let out = robot.step(step_number(7), &frame(3, 7, &beacon(-1300, |_| ())));
    assert_eq!((out.implausible.jumps, out.received), (0, 1), "believed");
}

#[test]
fn a_robot_that_always_jumps_is_never_accepted() {
    let mut robot = listener(CLAIMS);
    let _ = robot.step(step_number(0), &frame(3, 0, &beacon(9000, |_| ())));
    let _ = robot.step(step_number(1), &frame(3, 1, &beacon(-9000, |_| ())));
    for n in 2..20 {
        let x_mm = 4000 - 3000 * (n % 2);
        let out = robot.step(step_number(n), &frame(3, n as u16, &beacon(x_mm, |_| ())));
        assert_eq!((out.implausible.jumps, robot.agent.neighbors().len()), (1, 2), "step {n}");
        assert_eq!((where_is(&robot, 3), where_is(&robot, RobotId(3).duplicate().0)), (Some(9000), Some(-9000)));
    }
}

#[test]
fn delayed_packets_do_not_count_as_a_jump() {
    let mut robot = listener(CLAIMS);
    let _ = robot.step(step_number(0), &frame(3, 0, &beacon(9000, |_| ())));
    let out = robot.step(step_number(1), &frame(3, 30, &beacon(11_500, |_| ())));
    assert_eq!((out.implausible, out.received), (ImplausibleCounts::default(), 1));
    assert_eq!(where_is(&robot, 3), Some(11_500));
}

#[test]
fn without_limits_all_values_are_accepted() {
    let mut robot = listener(PlausibilityLimits::ANY);
    let huge = beacon(80_000, |beacon| (beacon.radius_mm, beacon.velocity_mmps) = (65_000, [-30_000, 0, 0]));
    let out = robot.step(step_number(0), &frame((1 << 31) - 1, 0, &huge));
    assert_eq!((out.implausible, out.received), (ImplausibleCounts::default(), 1));
    assert_eq!(robot.agent.neighbors()[0].radius_m, 65.0);
}
