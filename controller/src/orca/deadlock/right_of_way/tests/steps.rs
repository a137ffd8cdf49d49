//! The state of a robot at a door from step to step.

use super::zones::{Other, others};
use super::*;
use crate::orca::fixtures::rng_of;
use crate::robot::RobotId;
use proptest::prelude::*;

/// The wishes in some steps at a door 1 m ahead, and the state after them.
fn wishes(memory: &mut RightOfWay<f64>, nearby: &[Nearby<f64>], goal: [f64; 2], steps: u32) -> Vec<Vec2<f64>> {
    let (body, walls) = (body(5, [0.0; 2]), door_walls(1.0, 0.2));
    let situation = Situation { obstacles: &walls, ..situation(&body, nearby) };
    let goal = Vec2::new(goal[0], goal[1]);
    (0..steps).map(|step| memory.wish(&situation, goal, 5.0, &mut rng_of(5, step)).unwrap_or_default()).collect()
}

#[test]
fn a_robot_follows_through_a_door_at_the_pace_of_the_one_ahead() {
    let east = Vec2::new(1.0, 0.0);
    let far = robot(9, [-0.6, 0.0], [0.0; 2]);
    let mut free = RightOfWay::NEW;
    assert_eq!(wishes(&mut free, &[far], [4.0, 0.0], 1), [east * 0.5]);
    assert!(free.goes && !free.waits() && !free.takes_turns());
    // Its place along the gap counts: 0.33 m ahead it moves as fast as the robot ahead.
    let leader = robot(9, [0.33, 0.0], [0.2, 0.0]);
    let mut follows = RightOfWay::NEW;
    let got = wishes(&mut follows, &[leader], [4.0, 0.0], 1)[0];
    assert!((got - east * 0.2).norm() < 1e-9, "{got:?}");
    assert!(follows.goes && follows.takes_turns());
    // The next point of the way is the goal, if that is nearer.
    let mut near = RightOfWay::NEW;
    let got = wishes(&mut near, &[far], [1.1, 0.0], 1)[0];
    assert!((got - east * 0.5).norm() < 1e-9, "{got:?}");
}

#[test]
fn inside_a_passage_the_pace_of_the_robot_ahead_is_no_limit() {
    // The passage begins 0.1 m before the robot, or 0.1 m behind it.
    for (begin, is_limited) in [(0.1, true), (-0.1, false)] {
        let sides = [0.2, -0.2].map(|y| Obstacle::Wall([Vec2::new(begin, y), Vec2::new(begin + 1.0, y)]));
        let walls = [door_walls(begin, 0.2), door_walls(begin + 1.0, 0.2), sides].concat();
        let nearby = [robot(9, [0.35, 0.0], [0.1, 0.0])];
        let body = body(5, [0.0; 2]);
        let situation = Situation { obstacles: &walls, ..situation(&body, &nearby) };
        let mut memory = RightOfWay::NEW;
        let wish = memory.wish(&situation, Vec2::new(4.0, 0.0), 5.0, &mut rng_of(5, 0)).unwrap();
        assert_eq!((wish.norm() < 0.49, memory.takes_turns()), (is_limited, true), "{wish:?}");
    }
}

#[test]
fn a_robot_waits_until_its_patience_ends() {
    // A robot within five radii behind the door, 0.75 m, waits for it.
    for (x, waits) in [(1.5, true), (1.74, true), (1.76, false)] {
        let mut memory = RightOfWay::NEW;
        let goes = (0..200).find(|_| {
            let _ = wishes(&mut memory, &[robot(4, [x, 0.0], [0.0; 2])], [4.0, 0.0], 1);
            memory.goes
        });
        // Five to ten times 0.15 m, in steps of 0.025 m.
        let (least, most) = if waits { (29, 61) } else { (0, 0) };
        assert!(goes.is_some_and(|step| (least..=most).contains(&step)), "{x} {goes:?}");
    }
}

#[test]
fn turns_are_measured_while_robots_pass() {
    let in_door = |speed: f64| robot(9, [1.0, 0.0], [speed, 0.0]);
    let mut memory = RightOfWay::NEW;
    let step = |memory: &mut RightOfWay<f64>, other: Nearby<f64>, steps| {
        let _ = wishes(memory, &[other], [4.0, 0.0], steps);
        (memory.last_went_ahead, (memory.turn_m / 0.025).round() as i32, memory.idle.is_some())
    };
    // 0.025 m per step at the top speed.
    assert_eq!(step(&mut memory, in_door(0.3), 1), (Some(true), 0, true));
    assert_eq!(step(&mut memory, in_door(0.3), 9), (Some(true), 9, true));
    assert_eq!(step(&mut memory, in_door(-0.3), 1), (Some(false), 0, true), "the other direction begins");
    assert_eq!(step(&mut memory, in_door(-0.3), 4), (Some(false), 4, true));
    let away = robot(9, [-0.6, 0.0], [0.0; 2]);
    assert_eq!(step(&mut memory, away, 3), (Some(false), 7, true), "an empty door ends no turn");
    // The time at an empty door counts, in radii; while robots pass it does not.
    let (idle, enough) = memory.idle.unwrap();
    assert!((idle - 4.0 * 0.025 / 0.15).abs() < 1e-9 && (5.0..10.0).contains(&enough), "{idle} {enough}");
    let _ = step(&mut memory, in_door(0.3), 5);
    assert!(memory.idle.is_some_and(|(idle, _)| (idle - 0.025 / 0.15).abs() < 1e-9), "{memory:?}");
    let _ = wishes(&mut memory, &[], [4.0, 0.0], 1);
    assert_eq!(memory, RightOfWay::NEW, "alone at a door, the rule does not apply");
}

#[test]
fn a_parked_robot_that_moves_back_through_the_door_is_waited_for() {
    for (speed, idle) in [(-0.3, 0.0), (0.3, 0.0), (0.0, 3.0)] {
        let mut memory = RightOfWay { idle: Some((3.0, 5.0)), ..RightOfWay::NEW };
        let parked = Nearby { mode: Mode::Arrived, ..robot(9, [1.0, 0.0], [speed, 0.0]) };
        let _ = wishes(&mut memory, &[parked], [4.0, 0.0], 1);
        assert!(memory.idle.is_some_and(|(got, _)| (got - idle - 0.025 / 0.15).abs() < 1e-9), "{speed} {memory:?}");
    }
}

#[test]
fn patience_grows_with_the_rank() {
    let ahead = robot(9, [0.4, 0.0], [0.0; 2]);
    let opposite = robot(4, [1.7, 0.0], [0.0; 2]);
    for (other, idle, goes) in
        [(opposite, 4.99, false), (opposite, 5.01, true), (ahead, 6.66, false), (ahead, 6.67, true)]
    {
        let mut memory = RightOfWay { idle: Some((idle, 5.0)), ..RightOfWay::NEW };
        let _ = wishes(&mut memory, &[other], [4.0, 0.0], 1);
        assert_eq!((memory.goes, memory.waits()), (goes, !goes), "{idle}");
    }
    // It is drawn for each time that the door is empty.
    for step in 0..5 {
        let (mut memory, mut rng) = (RightOfWay::NEW, rng_of(5, step));
        let (body, walls) = (body(5, [0.0; 2]), door_walls(1.0, 0.2));
        let nearby = [opposite];
        let situation = Situation { obstacles: &walls, ..situation(&body, &nearby) };
        let _ = memory.wish(&situation, Vec2::new(4.0, 0.0), 5.0, &mut rng);
        let more = f64::from(rng_of(5, step).below(1000)) / 1000.0;
        assert_eq!(memory.idle, Some((0.025 / 0.15, 5.0 + 5.0 * more)));
    }
}

#[test]
fn a_robot_slows_down_before_the_point_that_it_heads_for() {
    let (body, walls) = (body(5, [0.0; 2]), door_walls(-0.05, 0.2));
    let nearby = [robot(9, [-0.9, 0.0], [0.0; 2])];
    let situation = Situation { obstacles: &walls, ..situation(&body, &nearby) };
    let wish = |goal_m: f64| {
        let mut rng = rng_of(5, 0);
        RightOfWay::NEW.clone().wish(&situation, Vec2::new(goal_m, 0.0), 5.0, &mut rng).unwrap()
    };
    // 0.01 m in a step of 0.05 s.
    assert!((wish(0.01) - Vec2::new(0.2, 0.0)).norm() < 1e-9, "{:?}", wish(0.01));
    let far = wish(4.0);
    // Four radii behind the door, and 0.3 radii to the right.
    let way = Vec2::new(0.6 - 0.05, -0.045);
    assert!((far - way * (0.5 / way.norm())).norm() < 1e-9, "{far:?}");
}

/// A door, a robot before it, and others, in other units of length and time.
fn scaled(others: &[Other], length: f64, time: f64, steps: usize) -> Vec<Option<Vec2<f64>>> {
    let body =
        Body { radius_m: 0.15 * length, max_speed_mps: 0.5 * length / time, step_s: 0.05 * time, ..body(5, [0.0; 2]) };
    let walls = door_walls(1.0, 0.2).map(|wall| match wall {
        Obstacle::Wall(ends) => Obstacle::Wall(ends.map(|end| end * length)),
        other => other,
    });
    let mut memory = RightOfWay::NEW;
    (0..steps)
        .map(|step| {
            let nearby: Vec<_> = others
                .iter()
                .map(|other| {
                    let [x, y] = other.place;
                    let on = 1.0 + x + other.speed * 0.05 * step as f64;
                    Nearby {
                        id: RobotId(other.id),
                        mode: other.mode,
                        gives_way: other.gives_way,
                        radius_m: 0.15 * length,
                        ..robot(9, [on * length, y * length], [other.speed * length / time, 0.0])
                    }
                })
                .collect();
            let wish = Vec2::new(0.5 * length / time, 0.0);
            let situation = Situation { body: &body, wish, goal: None, nearby: &nearby, obstacles: &walls };
            let mut rng = rng_of(5, step as u32);
            memory.wish(&situation, Vec2::new(4.0 * length, 0.0), 5.0, &mut rng)
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn decisions_are_equal_in_other_units_of_length_and_time(
        others in proptest::collection::vec(others(), 1..4), length in -3..4_i32, time in -3..4_i32,
    ) {
        let (length, time) = (libm::ldexp(1.0, length), libm::ldexp(1.0, time));
        let plain = scaled(&others, 1.0, 1.0, 12);
        for (step, (plain, other)) in plain.into_iter().zip(scaled(&others, length, time, 12)).enumerate() {
            prop_assert_eq!(plain.is_some(), other.is_some());
            if let Some((plain, other)) = plain.zip(other) {
                prop_assert!((other * (time / length) - plain).norm() < 1e-9, "{step}: {plain:?} {other:?}");
            }
        }
    }
}
