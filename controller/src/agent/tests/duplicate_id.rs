//! Tests of two robots that use one id: the own one and another, or two others.

use super::plane::{Robot, body_at, in_plane, one_step_late, orca, place, step_number, waypoint};
use super::*;
use proptest::prelude::*;

type Walker = Robot<f32, WaypointGuidance<f32>, OrcaSafety<f32, 16>>;

fn walker(boot: u8, at_m: [f64; 2], goal_mm: [i32; 2]) -> Walker {
    let mut robot = Robot::new(&AgentConfig { boot, ..one_step_late(7) }, waypoint(), orca(), at_m);
    let _ = robot.agent.order(&WaypointOrder::first(place(goal_mm[0], goal_mm[1])));
    robot
}

fn frame(sender: u32, boot: u8, sequence: u16, message: &Message) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    encode(Header { boot, sender: RobotId(sender), sequence }, message, &mut out).unwrap();
    out.to_vec()
}

fn standing(x_mm: i32) -> Message {
    body_at([x_mm, 0], [0, 0], Mode::Hold)
}

fn is_double(event: &Event) -> bool {
    matches!(event, Event::DuplicateId(_))
}

fn known(robot: &Walker) -> Vec<u32> {
    robot.agent.neighbors().iter().map(|other| other.id.0).collect()
}

const DOUBLE: u32 = 7 | 1 << 31;

#[test]
fn duplicate_ids_are_distinct_from_real_ids() {
    assert_eq!(RobotId(7).duplicate(), RobotId(DOUBLE));
    assert_eq!((RobotId(DOUBLE).duplicate_of(), RobotId(7).duplicate_of()), (Some(RobotId(7)), None));
    assert_eq!(
        (std::format!("{}", RobotId(7)), std::format!("{}", RobotId(DOUBLE))),
        ("7".into(), "7 (the second one)".into())
    );
}

#[test]
fn echoes_of_own_frames_are_not_another_robot() {
    let mut robot = walker(3, [0.0; 2], [60_000, 0]);
    let mut said = Vec::new();
    for n in 0..200_u16 {
        let delays = [1, 2, 2, 15, 16, 17, 40, usize::from(n) / 2 + 1];
        let heard =
            delays.into_iter().filter_map(|delay: usize| said.len().checked_sub(delay).and_then(|at| said.get(at)));
        let inbox = heard.cloned().collect::<Vec<Vec<u8>>>().concat();
        let out = robot.step(step_number(n.into()), &inbox);
        assert_eq!((out.received, known(&robot)), (0, vec![]), "step {n}");
        assert!(!out.events.iter().any(is_double));
        said.push(out.outbox.to_vec());
    }
    let mut robot = walker(4, robot.at_m, [60_000, 0]);
    for n in 0..20 {
        let out = robot.step(step_number(n), &said.concat());
        assert!(known(&robot).is_empty() && out.received == 0, "step {n}");
    }
}

/// Two robots approach each other; the second one starts `late` steps later.
fn meet(boots: [u8; 2], late: i32) -> [usize; 2] {
    let mut robots = [walker(boots[0], [-4.0, 0.0], [4000, 0]), walker(boots[1], [4.0, 0.02], [-4000, 0])];
    let (mut said, mut noticed) = ([Vec::new(), Vec::new()], [0; 2]);
    for n in 0..160 {
        let mut next = said.clone();
        for (at, robot) in robots.iter_mut().enumerate() {
            let since = n - late * at as i32;
            if since < 0 {
                continue;
            }
            let out = robot.step(step_number(since), &said[1 - at]);
            noticed[at] += out.events.iter().filter(|event| is_double(event)).count();
            next[at] = out.outbox.to_vec();
        }
        said = next;
        let [a, b] = robots.each_ref().map(|robot| robot.at_m);
        let apart = plane::length([a[0] - b[0], a[1] - b[1]]);
        assert!(apart > 0.4, "{apart} m at step {n}, boots {boots:?}, {late} late");
        if n > late + 3 {
            assert_eq!(robots.each_ref().map(known), [vec![DOUBLE], vec![DOUBLE]], "step {n}");
        }
    }
    for (robot, goal) in robots.iter().zip([4.0, -4.0]) {
        assert!((robot.at_m[0] - goal).abs() < 0.02, "{:?}", robot.at_m);
    }
    noticed
}

#[test]
fn two_robots_with_one_id_detect_each_other_in_any_order_of_starts() {
    for boots in [[0, 0], [0, 1], [1, 0], [250, 3], [3, 250]] {
        for late in [0, 1, 5, 15, 16, 30] {
            assert_eq!(meet(boots, late), [1, 1], "{boots:?} {late}");
        }
    }
}

#[test]
fn a_duplicate_id_is_reported_once_and_again_after_a_loss() {
    let mut robot = walker(0, [0.0; 2], [0, 0]);
    let mut noticed = Vec::new();
    for n in 0..150_u16 {
        let speaks = !(40..90).contains(&n);
        let inbox = if speaks { frame(7, 0, n + 3, &standing(3000)) } else { Vec::new() };
        let out = robot.step(step_number(n.into()), &inbox);
        if out.events.contains(&Event::DuplicateId(RobotId(7))) {
            noticed.push(n);
        }
        let lost = out.events.contains(&Event::NeighborLost(RobotId(DOUBLE)));
        assert_eq!(lost, n == 69, "step {n}: {:?}", out.events);
    }
    assert_eq!(noticed, [0, 90]);
}

#[test]
fn the_own_duplicate_stays_in_a_full_table_and_its_orders_are_ignored() {
    let mut robot = walker(0, [0.0; 2], [0, 0]);
    let crowd = |n: u16| (1..=6).chain(8..=12).flat_map(move |id| frame(id, 0, n, &standing(1000 + 500 * id as i32)));
    for n in 0..5 {
        let goal = goal(0, 9, Cell::new(1, 1));
        let own = [frame(7, 0, 2 * n + 20, &standing(90_000)), frame(7, 0, 2 * n + 21, &goal)].concat();
        let inbox: Vec<u8> = own.into_iter().chain(crowd(n)).collect();
        let out = robot.step(step_number(n.into()), &inbox);
        assert_eq!((out.received, out.rejected), (12, 1));
        assert!(known(&robot).contains(&DOUBLE) && known(&robot).len() == 8);
        assert_eq!(out.events.iter().any(is_double), n == 0);
    }
}

#[test]
fn two_other_robots_with_one_id_are_both_known_and_not_confused() {
    for (apart, boot) in [(0, 0), (1, 0), (5, 0), (40, 0), (0, 1)] {
        let mut robot = Robot::new(&in_plane(7), waypoint::<f32>(), orca(), [0.0; 2]);
        let mut noticed = Vec::new();
        for n in 0..60_u16 {
            let mut inbox = Vec::new();
            if n % 5 != 3 {
                inbox.extend(frame(5, 0, n, &standing(40_000)));
            }
            if n % 7 != 4 {
                inbox.extend(frame(5, boot, n + apart, &standing(-40_000)));
            }
            let out = robot.step(step_number(n.into()), &inbox);
            noticed.extend(out.events.iter().filter(|event| is_double(event)).copied());
            let places: Vec<_> =
                robot.agent.neighbors().iter().map(|other| (other.id.0, other.position.mm[0])).collect();
            assert_eq!(places.len(), 2, "step {n}");
            assert_eq!(places, [(5, 40_000), (5 | 1 << 31, -40_000)], "step {n}, {apart} apart");
        }
        assert_eq!(noticed, [Event::DuplicateId(RobotId(5))], "{apart} apart, boot {boot}");
    }
}

proptest! {
    #[test]
    fn one_robot_is_never_mistaken_for_two(
        turns in proptest::collection::vec((any::<[i8; 2]>(), 0..40_usize, any::<bool>(), 0..3_usize), 1..150),
        latency in 0..3,
    ) {
        let config = AgentConfig { latency: plane::STEP.saturating_mul(latency), ..in_plane(7) };
        let mut robot = Robot::new(&config, waypoint::<f32>(), orca(), [0.0; 2]);
        let (mut at, mut held) = ([3000, 3000], vec![Vec::new(); 250]);
        for (n, ([x, y], delay, is_lost, copies)) in turns.into_iter().enumerate() {
            let step = [x, y].map(|v| i32::from(v) / 2);
            for (at, step) in at.iter_mut().zip(step) {
                *at += step;
            }
            let said = frame(5, 0, n as u16, &body_at(at, if x > 0 { [0, 0] } else { step.map(|v| v as i16 * 10) }, Mode::Cruise));
            if !is_lost {
                let arrives = n + if delay < 30 { 0 } else { delay - 29 };
                (0..=copies).for_each(|copy| held[arrives + copy].extend(said.clone()));
            }
            let out = robot.step(step_number(n as i32), &held[n]);
            prop_assert!(!out.events.iter().any(is_double), "step {}", n);
        }
    }
}

#[test]
fn a_robot_that_was_moved_is_forgotten_at_its_previous_position() {
    let mut robot = Robot::new(&in_plane(7), waypoint::<f32>(), orca(), [0.0; 2]);
    let mut events = Vec::new();
    for n in 0..100_u16 {
        let x_mm = if n < 20 { 2000 } else { -3000 };
        // The far robot keeps the others in range.
        let inbox = [frame(5, 0, n, &standing(x_mm)), frame(4, 0, n, &standing(9000))].concat();
        let out = robot.step(step_number(n.into()), &inbox);
        let others = robot.agent.neighbors().iter().filter(|other| other.id != RobotId(4));
        let places: Vec<_> = others.map(|other| (other.id.0, other.position.mm[0])).collect();
        match n {
            0..20 => assert_eq!(places, [(5, 2000)], "step {n}"),
            20..50 => assert_eq!(places, [(5, 2000), (5 | 1 << 31, -3000)], "step {n}"),
            50..80 => assert_eq!(places, [(5, -3000), (5 | 1 << 31, -3000)], "step {n}"),
            _ => assert_eq!(places, [(5, -3000)], "step {n}"),
        }
        assert!(robot.agent.link.table.lost().is_empty());
        events.extend(out.events.iter().map(|&event| (n, event)));
    }
    let [first, second] = [RobotId(5), RobotId(5 | 1 << 31)];
    let expected = [
        (0, Event::NeighborFound(first)),
        (0, Event::NeighborFound(RobotId(4))),
        (20, Event::DuplicateId(first)),
        (50, Event::NeighborLost(first)),
        (50, Event::NeighborFound(first)),
        (80, Event::NeighborLost(second)),
    ];
    assert_eq!(events, expected);
}
