//! Tests of the flocks with packets between robots.

use super::plane::{Robot, length, one_step_late, place, step_number};
use super::*;
use crate::boids::BoidsParams;
use crate::goal_flock::{GoalParams, Stage};
use crate::lattice::{Gain, LatticeParams};
use crate::parameters::Parameter;
use core::ops::Range;

fn run<G>(robots: &mut [Robot<f32, G, Unguarded>], steps: Range<i32>)
where
    G: for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()>,
{
    let mut said: Vec<Vec<u8>> = vec![Vec::new(); robots.len()];
    for n in steps {
        let mut next = Vec::new();
        for (index, robot) in robots.iter_mut().enumerate() {
            let others = said.iter().enumerate().filter(|(from, _)| *from != index);
            let inbox: Vec<u8> = others.flat_map(|(_, bytes)| bytes.clone()).collect();
            next.push(robot.step(step_number(n), &inbox).outbox.to_vec());
        }
        said = next;
    }
}

fn distance([x, y]: [f64; 2], [other_x, other_y]: [f64; 2]) -> f64 {
    length([x - other_x, y - other_y])
}

#[test]
fn an_alpha_flock_keeps_its_distances_and_follows_its_reference() {
    let new = |id, at_m| {
        // Gentle enough for ten decisions per second with states that are 0.1 s old.
        let params =
            LatticeParams { alpha: Gain::critical(1.0), gamma: Gain::critical(0.5), ..LatticeParams::new(1.0) };
        let guidance = LatticeGuidance::new(params, true);
        let mut robot = Robot::new(&one_step_late(id), guidance, Unguarded, at_m);
        let reference = Waypoint { velocity_mps: crate::geom::Vec3::new(0.25, 0.0, 0.0), ..place(1000, 0) };
        assert!(robot.agent.order(&WaypointOrder::first(reference)));
        assert!(!robot.agent.order(&WaypointOrder { index: 1, waypoint: reference }), "there is one");
        robot
    };
    let mut robots = [new(1, [0.0, 0.0]), new(2, [0.0, 0.6]), new(3, [0.5, 0.3])];
    run(&mut robots, 0..800);
    let reference = [1.0 + 0.25 * 80.0, 0.0];
    for (index, robot) in robots.iter().enumerate() {
        assert_eq!(robot.agent.mode(), Mode::Cruise);
        assert!(distance(robot.at_m, reference) < 1.5, "{:?}", robot.at_m);
        let off = distance(robot.velocity_mps, [0.25, 0.0]);
        assert!(off < 0.05, "{:?}", robot.velocity_mps);
        for other in &robots[..index] {
            let apart = distance(robot.at_m, other.at_m);
            assert!((0.8..1.2).contains(&apart), "{apart}");
        }
    }
}

#[test]
fn an_alpha_flock_limits_an_absurd_speed() {
    let guidance = LatticeGuidance::new(LatticeParams::<f32>::new(1.0), true);
    let mut robot = Robot::new(&one_step_late(1), guidance, Unguarded, [0.0; 2]);
    robot.velocity_mps = [f64::MAX, 0.0];
    let _ = robot.agent.order(&WaypointOrder::first(place(1000, 0)));
    let out = robot.step(step_number(0), &[]);
    assert!(matches!(out.command, Command::Velocity(v) if v.norm() <= 1.001), "{:?}", out.command);
}

#[test]
fn a_goal_flock_moves_to_the_centre_and_then_to_single_goals() {
    let new = |id, at_m| {
        let params = GoalParams::new(0.5, 1.0);
        let guidance = GoalFlockGuidance::new(params, 1.0, 7);
        let mut robot = Robot::new(&one_step_late(id), guidance, Unguarded, at_m);
        assert!(!robot.agent.order(&WaypointOrder { index: 1, waypoint: place(0, 0) }), "not before number 0");
        assert!(robot.agent.order(&WaypointOrder::first(place(20_000, 8_000))));
        assert!(robot.agent.order(&WaypointOrder { index: 1, waypoint: place(20_000, -8_000) }));
        robot
    };
    let mut robots = [new(1, [0.0, 0.0]), new(2, [0.0, 1.0]), new(3, [1.0, 0.5])];
    run(&mut robots, 0..50);
    for robot in &robots {
        assert_eq!(robot.agent.law().stage(), Stage::Gather);
        assert_eq!(robot.agent.mode(), Mode::Cruise);
    }
    run(&mut robots, 50..650);
    for robot in &robots {
        let Stage::Goal(goal) = robot.agent.law().stage() else {
            panic!("{:?} at {:?}", robot.agent.law().stage(), robot.at_m)
        };
        let goal = [[20.0, 8.0], [20.0, -8.0]][goal];
        assert!(distance(robot.at_m, goal) <= 1.0);
        assert_eq!(robot.agent.mode(), Mode::Arrived);
    }
}

#[test]
fn a_goal_flock_follows_goals_that_move() {
    let mut robot =
        Robot::new(&one_step_late(1), GoalFlockGuidance::new(GoalParams::new(0.5, 1.0), 1.0, 7), Unguarded, [0.0; 2]);
    let goal = |at, velocity_mps| Waypoint { velocity_mps, ..place(10_000, at) };
    let north = crate::geom::Vec3::new(0.0, 0.4, 0.0);
    assert!(robot.agent.order(&WaypointOrder::first(goal(2_000, north))));
    assert!(robot.agent.order(&WaypointOrder { index: 1, waypoint: goal(-2_000, north) }));
    let mut robots = [robot];
    run(&mut robots, 0..600);
    let [robot] = &mut robots;
    let Stage::Goal(drawn) = robot.agent.law().stage() else { panic!("still at {:?}", robot.at_m) };
    let was_m = [2.0, -2.0][drawn];
    assert!(distance(robot.at_m, [10.0, was_m + 0.4 * 60.0]) <= 0.6, "{:?}", robot.at_m);
    let index = u8::try_from(drawn).unwrap();
    assert!(robot.agent.order(&WaypointOrder { index, waypoint: place(10_000, 0) }));
    run(&mut robots, 600..1600);
    assert!(distance(robots[0].at_m, [10.0, 0.0]) <= 0.6, "{:?}", robots[0].at_m);
}

#[test]
fn boids_keep_their_speed_and_align_their_headings() {
    let new = |id, at_m, velocity_mps| {
        let params = BoidsParams::new(0.3, 30.0, 0.05, 0.02);
        let guidance = BoidsGuidance::new(params, 0.5);
        let mut robot = Robot::new(&one_step_late(id), guidance, Unguarded, at_m);
        robot.velocity_mps = velocity_mps;
        robot
    };
    let mut robots = [new(1, [0.0, 0.0], [0.5, 0.0]), new(2, [2.0, 0.0], [0.4, 0.3]), new(3, [0.0, 2.0], [0.3, -0.4])];
    run(&mut robots, 0..600);
    for robot in &robots {
        let speed = distance(robot.velocity_mps, [0.0; 2]);
        assert!((speed - 0.5).abs() < 1e-3, "{speed}");
        let off = distance(robot.velocity_mps, robots[0].velocity_mps);
        // Up to 127 degrees apart at first.
        assert!(off < 0.2, "{:?}", robot.velocity_mps);
    }
}

#[test]
fn a_stationary_boid_starts_in_a_random_direction() {
    let heading = |id, seed| {
        let params = BoidsParams::new(0.3, 30.0, 0.05, 0.02);
        let config = AgentConfig { seed, ..one_step_late(id) };
        let guidance = BoidsGuidance::<f32>::new(params, 0.5);
        let mut robots = [Robot::new(&config, guidance, Unguarded, [0.0; 2])];
        run(&mut robots, 0..1);
        robots[0].velocity_mps
    };
    assert_eq!(heading(1, 1), heading(1, 1));
    assert_ne!(heading(1, 1), heading(2, 1));
    assert_ne!(heading(1, 1), heading(1, 2));
}

#[test]
fn goal_flocks_of_different_numbers_do_not_gather() {
    let parted = |other| {
        let new = |id, flock, at_m| {
            let params = GoalParams { goal_gain: 0.0, ..GoalParams::new(0.5, 1.0) };
            let config = AgentConfig { flock, ..one_step_late(id) };
            Robot::new(&config, GoalFlockGuidance::new(params, 1.0, 7), Unguarded, at_m)
        };
        let mut robots = [new(1, 3, [0.0, 0.0]), new(2, other, [1.5, 0.0])];
        run(&mut robots, 0..100);
        assert_eq!(robots[0].agent.neighbors()[0].flock, other);
        distance(robots[0].at_m, robots[1].at_m)
    };
    assert!(parted(3) < 1.2);
    assert!(parted(4) > 1.49 && parted(0) > 1.49);
}

#[test]
fn each_flock_reports_the_parameters_that_it_was_given() {
    /// Numbers of known and of accepted parameters.
    fn keeps(mut law: impl Law<f32>) -> [usize; 2] {
        let mut counts = [0; 2];
        law.parameters(&mut |table| {
            for (index, Parameter { name, .. }) in table.table().iter().enumerate() {
                let before = table.get(index);
                let is_accepted = table.set(index, 0.75).is_ok();
                assert_eq!(table.get(index), if is_accepted { Some(0.75) } else { before }, "{name}");
                assert!(before.is_some_and(|value| value != 0.0 && value != 0.75), "{name}: {before:?}");
                counts[0] += 1;
                counts[1] += usize::from(is_accepted);
            }
        });
        counts
    }
    let boids = BoidsGuidance::new(BoidsParams::new(0.3, 30.0, 0.05, 0.02), 0.5);
    let goal = GoalFlockGuidance::new(GoalParams::new(0.5, 1.0), 1.0, 7);
    let lattice = LatticeGuidance::new(LatticeParams::<f32>::new(1.0), true);
    assert_eq!([keeps(boids), keeps(goal), keeps(lattice)], [[5, 5], [7, 6], [11, 10]]);
}
