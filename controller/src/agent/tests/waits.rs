//! Tests of reported waits and of occupied goals.

use super::contact_loss::{Mover, run, safety};
use super::plane::{Robot, STEP, body_at, in_plane, length, one_step_late, orca, place, step_number, waypoint};
use super::*;
use crate::geom::{Position, Vec2, Vec3};
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::Q16;
use proptest::prelude::*;

/// Waits of a robot that moves 10 m east while the others repeat their messages.
fn waits(others: &[Message], steps: u16) -> Vec<Option<Wait>> {
    let mut robot = Robot::new(&in_plane(9), waypoint::<f32>(), orca(), [0.0; 2]);
    let _ = robot.agent.order(&WaypointOrder::first(place(10_000, 0)));
    let mut step = |n: u16| {
        let say = |(id, message): (usize, &Message)| bytes(id as u32 + 1, 0, n, std::slice::from_ref(message));
        let inbox: Vec<u8> = others.iter().enumerate().flat_map(say).collect();
        robot.step(step_number(n.into()), &inbox).wait
    };
    (0..steps).map(&mut step).collect()
}

#[test]
fn an_advancing_robot_reports_no_wait() {
    assert!(waits(&[], 20).iter().all(Option::is_none));
    let beside = body_at([2000, 900], [0, 0], Mode::Idle);
    assert!(waits(&[beside], 60).iter().all(Option::is_none));
}

#[test]
fn robots_in_the_way_are_reported() {
    let row: Vec<_> = (-3..=3).map(|i| body_at([1000, i * 420], [0, 0], Mode::Fault)).collect();
    let waits = waits(&row, 40);
    assert_eq!(waits[0], None);
    assert_eq!(*waits.last().unwrap(), Some(Wait::Robots));
}

#[test]
fn a_robot_without_contact_waits_for_the_radio() {
    let silence = ContactLossPolicy {
        stands_after: STEP.saturating_mul(40),
        listen: Duration::ZERO,
        ..ContactLossPolicy::DEFAULT
    };
    let mut robot =
        Robot::new(&AgentConfig { contact_loss: silence, ..in_plane(1) }, waypoint::<f32>(), orca(), [0.0; 2]);
    let _ = robot.agent.order(&WaypointOrder::first(place(90_000, 0)));
    let far = bytes(2, 0, 0, &[body_at([-60_000, 0], [0, 0], Mode::Idle)]);
    for n in 0..60 {
        let out = robot.step(step_number(n), if n == 0 { &far } else { &[] });
        assert_eq!(out.wait, (n > 40).then_some(Wait::Radio), "step {n}");
    }
}

#[test]
fn a_wall_is_reported_as_the_way_and_a_door_as_a_turn() {
    let door = |half: f32| {
        let wall = |from: f32, to: f32| Obstacle::Wall([Vec2::new(1.5, from), Vec2::new(1.5, to)]);
        [wall(-20.0, -half), wall(half, 20.0)]
    };
    let last = |obstacles: &[Obstacle<f32>], others: &[Message]| {
        let mut agent = Agent::<f32, _, 8, _>::new(&in_plane(9), waypoint(), safety(), Postcard);
        let _ = agent.order(&WaypointOrder::first(place(10_000, 0)));
        let mut wait = None;
        for n in 0..10_u16 {
            let say = |(id, message): (usize, &Message)| bytes(id as u32 + 1, 0, n, std::slice::from_ref(message));
            let inbox: Vec<u8> = others.iter().enumerate().flat_map(say).collect();
            let state = KinematicState { position: Position::from_mm([1250, 0, 0]), velocity_mps: Vec3::ZERO };
            let obstacles: Vec<_> = obstacles.iter().map(|wall| moved(wall, -1.25)).collect();
            let surroundings = InPlane { max_speed_mps: 1.0, obstacles: &obstacles };
            wait = agent.step(&Inputs { state, surroundings, inbox: &inbox }, step_number(n.into()), &mut ()).wait;
        }
        wait
    };
    assert_eq!(last(&door(0.0), &[]), Some(Wait::Route));
    let comes_out = body_at([1500, 0], [-500, 0], Mode::Cruise);
    assert_eq!(last(&door(0.3), &[comes_out]), Some(Wait::Turn));
    assert_eq!(last(&door(5.0), &[]), None);
}

fn moved(wall: &Obstacle<f32>, x_m: f32) -> Obstacle<f32> {
    match wall {
        Obstacle::Wall(ends) => Obstacle::Wall(ends.map(|end| end + Vec2::new(x_m, 0.0))),
        other => *other,
    }
}

#[test]
fn on_the_grid_blocked_moves_and_stops_are_reported() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut step =
        |n: u32, x: i16, inbox: &[u8]| agent.step(&inputs(&FLAT, Cell::new(x, 5), inbox), tick(n), &mut ws).wait;
    assert_eq!(step(0, 5, &[]), None);
    assert_eq!(step(1, 6, &[]), None);
    assert_eq!(step(2, 6, &[]), Some(Wait::Robots));
    assert_eq!(step(3, 7, &[]), None);
    let inbox = bytes(2, 0, 0, &[Message::Beacon(beacon_at(2, 5)), stop(2, 1, 7)]);
    assert_eq!(step(4, 8, &inbox), Some(Wait::Stopped));
    let inbox = bytes(2, 0, 2, &[resume(2, 1, 8)]);
    assert_eq!(step(5, 8, &inbox), None);
}

#[test]
fn a_robot_arrives_beside_its_occupied_goal_until_it_is_free() {
    for mode in [Mode::Idle, Mode::Arrived, Mode::Fault, Mode::Passive] {
        let mut robot = Robot::new(&in_plane(9), waypoint::<f32>(), orca(), [0.0; 2]);
        let _ = robot.agent.order(&WaypointOrder::first(place(2000, 0)));
        for n in 0..120 {
            let on_it = body_at([2030, if n < 60 { 20 } else { 3000 }], [0, 0], mode);
            let wait = robot.step(step_number(n), &bytes(2, 0, n as u16, &[on_it])).wait;
            if n == 59 {
                assert_eq!((robot.agent.mode(), wait), (Mode::Arrived, Some(Wait::GoalTaken)), "{mode:?}");
                let off = length([2.03 - robot.at_m[0], 0.02 - robot.at_m[1]]);
                assert!((0.4..0.65).contains(&off), "{mode:?}: {off} m from the robot there");
            }
        }
        assert_eq!(robot.agent.mode(), Mode::Arrived);
        assert!(length([2.0 - robot.at_m[0], robot.at_m[1]]) < 0.02, "{:?}", robot.at_m);
    }
}

#[test]
fn a_robot_beside_its_goal_takes_it_when_it_becomes_free() {
    let mover = |id, at_m: [f64; 2]| {
        let mut robot: Mover<f32> = Robot::new(&one_step_late(id), waypoint(), safety(), at_m);
        let _ = robot.agent.order(&WaypointOrder::first(place(0, 0)));
        robot
    };
    let mut robots = [mover(1, [0.0, 0.0]), mover(2, [-3.0, 0.0])];
    let (least, have_arrived) = run(&mut robots, 200, |_, _, _| false);
    assert!(least > 0.0 && have_arrived, "{least} m");
    assert!(robots.iter().any(|robot| length(robot.at_m) > 0.4));
    let [first, _] = &mut robots;
    let _ = first.agent.order(&WaypointOrder::first(place(0, 4000)));
    let (least, have_arrived) = run(&mut robots, 200, |_, _, _| false);
    assert!(least > 0.0 && have_arrived, "{least} m");
    assert!(length(robots[1].at_m) < 0.02, "{:?}", robots[1].at_m);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Goals closer together than a body: all robots arrive, one of them at the goal.
    #[test]
    fn robots_with_one_goal_settle_around_it(
        angles in prop::collection::vec(0.0..1.0, 2..6),
        apart_mm in 0..150_i32,
        loss in prop::sample::select(vec![0_u32, 0, 20]),
    ) {
        fn check<S: Scalar>(angles: &[f64], apart_mm: i32, loss: u32) -> Result<(), TestCaseError> {
            let count = angles.len() as f64;
            let mut robots: Vec<Mover<S>> = (0..).zip(angles).map(|(i, off)| {
                let angle = (f64::from(i) + 0.5 * off) / count * core::f64::consts::TAU;
                let at_m = [2.5 * libm::cos(angle), 2.5 * libm::sin(angle)];
                let mut robot = Robot::new(&one_step_late(i + 1), waypoint(), safety(), at_m);
                let goal = at_m.map(|x| (-x / 2.5 * f64::from(apart_mm)) as i32);
                let _ = robot.agent.order(&WaypointOrder::first(place(goal[0], goal[1])));
                robot
            }).collect();
            let is_lost = |n: i32, from: usize, to: usize| {
                Rng::keyed(n as u64, 3, from as u32, to as u32).below(100) < loss
            };
            let (least, have_arrived) = run(&mut robots, 1500, is_lost);
            let modes: Vec<_> = robots.iter().map(|robot| robot.agent.mode()).collect();
            prop_assert!(have_arrived, "{modes:?}");
            prop_assert!(least > -1e-3, "{least} m");
            Ok(())
        }
        check::<f32>(&angles, apart_mm, loss)?;
        check::<Q16>(&angles, apart_mm, loss)?;
    }
}
