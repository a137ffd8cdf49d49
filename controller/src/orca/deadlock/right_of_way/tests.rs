//! A table of the right of way: a door of 0.4 m, whose middle is 1 m east of a robot of 0.15 m.

use super::*;
use crate::body::Body;
use crate::neighbor::Nearby;
use crate::orca::fixtures::{body, robot};
use crate::robot::Mode;
use std::vec::Vec;

mod steps;
mod zones;

const DOOR: Gap<f64> =
    Gap { middle: Vec2::new(1.0, 0.0), ahead: Vec2::new(1.0, 0.0), half: 0.2, depth: 0.0, is_only_way: false };

fn situation<'a>(body: &'a Body<f64>, nearby: &'a [Nearby<f64>]) -> Situation<'a, Vec2<f64>> {
    Situation { body, wish: Vec2::new(0.5, 0.0), goal: None, nearby, obstacles: &[] }
}

fn with_approach<T>(gap: Gap<f64>, nearby: &[Nearby<f64>], see: impl FnOnce(&Approach<'_, f64>) -> T) -> T {
    let body = body(5, [0.0; 2]);
    let situation = situation(&body, nearby);
    let own = gap.place(Vec2::ZERO);
    see(&Approach { gap, situation: &situation, own, is_narrow: true })
}

const NO_TRAFFIC: Traffic<f64> = Traffic::none(0.15);

/// Whether a robot in front of the door may go, patient and impatient.
fn may_go(memory: &RightOfWay<f64>, traffic: Traffic<f64>, gap: Gap<f64>, has_lanes: bool) -> [bool; 2] {
    with_approach(gap, &[], |approach| {
        [false, true].map(|is_impatient| memory.may_go(approach, &traffic, has_lanes, is_impatient))
    })
}

#[test]
fn rank_and_robots_in_the_door_decide_before_turns_do() {
    for (traffic, wanted) in [
        (NO_TRAFFIC, [true, true]),
        // A robot that comes out, or stands in the door, stops even an impatient one.
        (Traffic { comes_out: true, ..NO_TRAFFIC }, [false, false]),
        (Traffic { against: true, ..NO_TRAFFIC }, [false, false]),
        // Behind a waiting robot only impatience counts, and only behind no robot in the door.
        (Traffic { is_behind: true, rank: 1, ..NO_TRAFFIC }, [false, true]),
        (Traffic { is_behind: true, rank: 3, opposite: true, ..NO_TRAFFIC }, [false, true]),
        (Traffic { is_behind: true, ahead: true, ..NO_TRAFFIC }, [false, false]),
        // Behind a robot that moves to the door, it follows.
        (Traffic { is_behind: true, leads: true, ..NO_TRAFFIC }, [true, true]),
        (Traffic { is_behind: true, leads: true, ahead: true, ..NO_TRAFFIC }, [true, true]),
        // The nearer one of two that meet goes first, unless it is the turn of the other.
        (Traffic { opposite: true, oncoming: true, ..NO_TRAFFIC }, [true, true]),
        (Traffic { opposite: true, oncoming: true, oncoming_is_nearer: true, ..NO_TRAFFIC }, [false, false]),
        // The first of its side, while robots wait on the other one.
        (Traffic { opposite: true, ..NO_TRAFFIC }, [true, true]),
        (Traffic { opposite: true, opposite_is_nearer: true, ..NO_TRAFFIC }, [false, true]),
        // Without robots on the other side, robots follow each other.
        (Traffic { ahead: true, flows: true, ..NO_TRAFFIC }, [true, true]),
        (Traffic { opposite_is_nearer: true, ..NO_TRAFFIC }, [true, true]),
    ] {
        let (rank, comes_out, against) = (traffic.rank, traffic.comes_out, traffic.against);
        assert_eq!(may_go(&RightOfWay::NEW, traffic, DOOR, false), wanted, "{rank} {comes_out} {against}");
    }
}

#[test]
fn directions_take_turns() {
    let opposite = Traffic { opposite: true, opposite_is_nearer: true, ..NO_TRAFFIC };
    let deep = Gap { depth: 0.5, ..DOOR };
    let memory = |last, goes, turn_m| RightOfWay { last_went_ahead: Some(last), goes, turn_m, ..RightOfWay::NEW };
    // The others' turn, of 50 radii, with one of them on its way, and when it is over.
    for (turn_m, oncoming, wanted) in [(7.4, false, false), (7.6, false, true), (7.6, true, false)] {
        let traffic = Traffic { oncoming, ..opposite };
        let patient_only = may_go(&memory(false, false, turn_m), traffic, DOOR, false);
        assert_eq!(patient_only, [wanted, !oncoming], "{turn_m} {oncoming}");
    }
    // The own turn: robots follow until it is over; those in the lane still do.
    let ahead = || Traffic { ahead: true, leads: true, ..opposite };
    let near = Gap { middle: Vec2::new(0.6, 0.0), ..DOOR };
    for goes in [false, true] {
        assert_eq!(may_go(&memory(true, goes, 7.4), ahead(), DOOR, false), [true, true]);
        assert_eq!(may_go(&memory(true, goes, 7.6), ahead(), DOOR, false), [false, true]);
        assert_eq!(may_go(&memory(true, goes, 7.6), ahead(), near, false), [goes, true]);
    }
    // In a long passage it lasts for two passages more: four times half its depth.
    assert_eq!(may_go(&memory(true, false, 9.4), ahead(), deep, false), [true, true]);
    assert_eq!(may_go(&memory(true, false, 9.6), ahead(), deep, false), [false, true]);
}

#[test]
fn inside_the_door_only_a_robot_with_priority_bars() {
    // 1.2 radii before the door is inside, unless beside it.
    for (own, is_inside) in [([0.17, 0.0], true), ([0.19, 0.0], false), ([0.17, 0.21], false), ([-0.5, 0.0], true)] {
        let gap = Gap { middle: Vec2::new(own[0], own[1]), ..DOOR };
        let traffic = |bars| Traffic { bars, rank: 1, against: true, ..NO_TRAFFIC };
        assert_eq!(may_go(&RightOfWay::NEW, traffic(false), gap, false), [is_inside; 2], "{own:?}");
        assert_eq!(may_go(&RightOfWay::NEW, traffic(true), gap, false), [false; 2], "{own:?}");
    }
}

#[test]
fn in_a_wide_door_only_the_own_rank_counts() {
    let against = Traffic { against: true, comes_out: true, ..NO_TRAFFIC };
    assert_eq!(may_go(&RightOfWay::NEW, against, DOOR, true), [true, true]);
    assert_eq!(may_go(&RightOfWay::NEW, Traffic { rank: 1, ..NO_TRAFFIC }, DOOR, true), [false, true]);
    assert_eq!(may_go(&RightOfWay::NEW, Traffic { rank: 1, ahead: true, ..NO_TRAFFIC }, DOOR, true), [false, false]);
    let inside = Gap { middle: Vec2::new(0.1, 0.0), ..DOOR };
    assert_eq!(may_go(&RightOfWay::NEW, Traffic { rank: 2, ..NO_TRAFFIC }, inside, true), [true, true]);
}

/// Rank, `flows`, `comes_out` and `opposite` for robots of a number, place, speed east, and mode.
fn seen(others: &[(u32, [f64; 2], f64, Mode)]) -> (i32, bool, bool, bool) {
    let nearby: Vec<Nearby<f64>> =
        others.iter().map(|&(id, at, speed, mode)| Nearby { mode, ..robot(id, at, [speed, 0.0]) }).collect();
    let traffic = with_approach(DOOR, &nearby, |approach| approach.traffic());
    (traffic.rank, traffic.flows, traffic.comes_out, traffic.opposite)
}

#[test]
fn rank_counts_robots_that_wait_nearer_to_the_door() {
    let cruise = Mode::Cruise;
    // Nearer, equally near with a smaller and a larger number, and farther away.
    assert_eq!(seen(&[(9, [0.5, 0.0], 0.0, cruise)]).0, 1);
    assert_eq!(seen(&[(4, [1.0, 1.0], 0.0, cruise), (4, [0.4, 0.8], 0.0, cruise)]).0, 1);
    assert_eq!(seen(&[(6, [0.4, 0.8], 0.0, cruise)]).0, 0);
    assert_eq!(seen(&[(4, [-0.5, 0.0], 0.0, cruise)]).0, 0);
    // A parked robot does not wait, nor does one that leaves the door.
    for (mode, rank) in [(Mode::Arrived, 0), (Mode::Idle, 0), (Mode::Hold, 1), (Mode::Fault, 1), (cruise, 1)] {
        assert_eq!(seen(&[(9, [0.5, 0.0], 0.0, mode)]), (rank, false, false, false), "{mode:?}");
    }
    assert_eq!(seen(&[(9, [0.6, 0.0], -0.3, cruise)]), (0, true, true, false));
    // A robot that drives to the door is before this one, and the door is in use.
    assert_eq!(seen(&[(9, [0.6, 0.0], 0.3, cruise)]), (1, true, false, false));
    assert_eq!(seen(&[(9, [0.6, 0.0], 0.3, Mode::Idle)]), (0, false, false, false));
}

#[test]
fn robots_inside_a_passage_are_neither_before_nor_behind_it() {
    let inside = |middle_m: f64, speed: f64| {
        let gap = Gap { middle: Vec2::new(middle_m, 0.0), depth: 0.5, ..DOOR };
        with_approach(gap, &[robot(4, [0.7, 0.0], [speed, 0.0])], |approach| approach.traffic())
    };
    for speed in [0.0, 0.3, -0.3] {
        let traffic = inside(1.0, speed);
        assert_eq!((traffic.rank, traffic.opposite, traffic.comes_out), (0, false, false), "{speed}");
        assert_eq!((traffic.leads, traffic.against), (speed > 0.0, speed < 0.0), "{speed}");
    }
    assert!(!inside(0.3, 0.3).leads, "both are inside");
}

#[test]
fn a_robot_at_a_tenth_of_the_top_speed_does_not_move() {
    let seen = |x: f64, speed: f64| with_approach(DOOR, &[robot(9, [x, 0.0], [speed, 0.0])], |near| near.traffic());
    let moves = |speed: f64| {
        let (before, inside, behind) = (seen(0.6, speed), seen(1.0, speed), seen(1.5, speed));
        if speed > 0.0 {
            [before.leads, before.flows, inside.ahead, inside.leads]
        } else {
            [before.comes_out, before.flows, inside.against, behind.oncoming]
        }
    };
    for slow in [0.05, -0.05] {
        assert_eq!([moves(slow), moves(1.01 * slow)], [[false; 4], [true; 4]], "{slow}");
    }
}

#[test]
fn a_robot_beside_the_door_is_not_in_it() {
    for (y, is_inside) in [(0.0, true), (0.199, true), (0.2, false), (-0.199, true), (-0.2, false)] {
        assert_eq!(seen(&[(9, [1.0, y], 0.3, Mode::Cruise)]).1, is_inside, "{y}");
    }
}

#[test]
fn robots_behind_the_door_are_opposite_unless_parked_or_leaving() {
    for (at, speed, mode, is_opposite) in [
        ([1.5, 0.0], 0.0, Mode::Cruise, true),
        ([1.5, 0.0], -0.3, Mode::Cruise, true),
        ([1.5, 0.0], 0.3, Mode::Cruise, false),
        ([1.5, 0.0], 0.0, Mode::Arrived, false),
        ([1.8, 0.0], 0.0, Mode::Cruise, false),
    ] {
        assert_eq!(seen(&[(9, at, speed, mode)]).3, is_opposite, "{at:?} {speed} {mode:?}");
    }
}

#[test]
fn robots_follow_at_their_spacing() {
    let pace_in = |gap: Gap<f64>, at: [f64; 2], speed: f64, mode: Mode| {
        let nearby = [Nearby { mode, ..robot(9, at, [speed, 0.0]) }];
        let traffic = with_approach(gap, &nearby, |approach| approach.traffic());
        (traffic.leads, traffic.pace_mps)
    };
    let pace = |at, speed, mode| pace_in(DOOR, at, speed, mode);
    // 2.2 radii ahead is 0.33 m; at a speed of half a metre per second 0.15 m change by as much.
    for (at, speed, wanted) in [(0.33, 0.4, 0.4), (0.33 + 0.15, 0.4, 0.9), (0.33 - 0.06, 0.4, 0.2), (0.2, 0.1, 0.0)] {
        let (leads, got) = pace([at, 0.0], speed, Mode::Cruise);
        assert!(leads && (got - wanted).abs() < 1e-9, "{at} {speed}: {got}");
    }
    // Behind the door it still counts, a parked robot and one behind do not.
    assert!((pace([1.1, 0.0], 0.2, Mode::Cruise).1 - (0.2 + (1.1 - 0.33) / 0.3)).abs() < 1e-9);
    assert_eq!(pace([0.3, 0.0], 0.4, Mode::Arrived), (false, f64::MAX));
    assert_eq!(pace([-0.3, 0.0], 0.4, Mode::Cruise), (false, f64::MAX));
    assert_eq!(pace([0.3, 0.0], 0.04, Mode::Hold), (false, f64::MAX), "a stationary one");
    // In a passage that begins 0.5 m ahead, and behind it, its place along the passage counts.
    for at in [0.6, 1.3, 1.7] {
        let (leads, got) = pace_in(Gap { depth: 0.5, ..DOOR }, [at, 0.0], 0.2, Mode::Cruise);
        assert!(leads && (got - (0.2 + (at - 0.33) / 0.3)).abs() < 1e-9, "{at}: {got}");
    }
}

#[test]
fn a_silent_robot_has_no_place_in_the_order() {
    for (at, gives_way) in [([0.4, 0.0], true), ([0.4, 0.0], false), ([1.3, 0.0], true), ([1.3, 0.0], false)] {
        let nearby = [Nearby { gives_way, ..robot(9, at, [0.0, 0.0]) }];
        let got = with_approach(DOOR, &nearby, |approach| approach.traffic());
        let counts = |is_here: bool| gives_way && is_here;
        assert_eq!((got.rank, got.is_behind), (i32::from(counts(at[0] < 1.0)), counts(at[0] < 1.0)), "{at:?}");
        assert_eq!(got.opposite, counts(at[0] > 1.0), "{at:?}");
    }
}

#[test]
fn a_robot_too_near_to_the_one_ahead_moves_back() {
    let gap = Gap { middle: Vec2::new(1.5, 0.0), ..DOOR };
    let traffic = Traffic { crowds: Some(Vec2::new(0.3, 0.0)), is_behind: true, rank: 1, ..NO_TRAFFIC };
    let got = with_approach(gap, &[], |approach| approach.place_to_wait(&traffic, false)).unwrap();
    // Three radii behind it: 0.45 m, of which it has 0.3 m.
    assert!((got - Vec2::new(-1.65, 0.0)).norm() < 1e-9, "{got:?}");
}

#[test]
fn the_first_robot_in_the_door_that_is_ahead_decides_whether_it_bars() {
    let gap = Gap { middle: Vec2::new(0.15, 0.0), ..DOOR };
    let bars = |others: [(f64, f64); 2]| {
        let nearby = others.map(|(along, speed)| robot(9, [0.15 + along, 0.0], [speed, 0.0]));
        with_approach(gap, &nearby, |approach| approach.traffic()).bars
    };
    assert!(bars([(0.1, 0.0), (0.12, 0.3)]) && !bars([(0.1, 0.3), (0.12, 0.0)]));
    assert!(bars([(-0.2, 0.3), (0.1, 0.0)]), "one behind does not count");
    // Of two equally far from their exits, the smaller id has priority.
    let meets = |id: u32, along: f64| {
        with_approach(gap, &[robot(id, [0.15 + along, 0.0], [0.0; 2])], |approach| approach.traffic()).bars
    };
    assert_eq!([meets(4, 0.15), meets(6, 0.15)], [true, false]);
    assert_eq!([meets(4, 0.16), meets(6, 0.14)], [false, true]);
}

#[test]
fn two_lanes_need_room_for_two_robots_and_their_clearance() {
    for (half, largest, has_lanes) in
        [(0.31, 0.15, false), (0.3115, 0.15, true), (0.36, 0.2, false), (0.3615, 0.2, true)]
    {
        let got = with_approach(Gap { half, ..DOOR }, &[], |approach| approach.has_lanes(largest));
        assert_eq!(got, has_lanes, "{half} {largest}");
    }
}

#[test]
fn a_robot_is_between_walls_if_two_opposite_ones_are_near() {
    let wall = |ax: f64, ay: f64, bx: f64, by: f64| Obstacle::Wall([Vec2::new(ax, ay), Vec2::new(bx, by)]);
    let north = |y: f64| wall(-9.0, y, 9.0, y);
    let between = |obstacles: &[Obstacle<f64>]| {
        let body = body(5, [0.0; 2]);
        let situation = Situation { obstacles, ..situation(&body, &[]) };
        let own = DOOR.place(Vec2::ZERO);
        Approach { gap: DOOR, situation: &situation, own, is_narrow: true }.is_between_walls()
    };
    assert!(!between(&[]) && !between(&[north(0.2)]));
    assert!(between(&[north(0.2), north(-0.39)]) && between(&[north(-0.39), north(0.2)]));
    assert!(!between(&[north(0.2), north(-0.41)]), "wider than four radii");
    assert!(!between(&[north(0.2), wall(0.25, -9.0, 0.25, 9.0)]), "a corner");
    // Opposite is at more than 120 degrees: a wall whose nearest point is at 110 or 130 degrees.
    for (degrees, is_opposite) in [(110.0_f64, false), (130.0, true)] {
        let (sin, cos) = Scalar::sin_cos((90.0 + degrees).to_radians());
        let (foot, along) = (Vec2::new(cos, sin) * 0.3, Vec2::new(-sin, cos) * 0.1);
        let slanted = Obstacle::Wall([foot - along, foot + along]);
        assert_eq!(between(&[north(0.2), slanted]), is_opposite, "{degrees}");
    }
}

fn door_walls(x: f64, half: f64) -> [Obstacle<f64>; 2] {
    [half, -half].map(|y| Obstacle::Wall([Vec2::new(x, y), Vec2::new(x, y * 30.0)]))
}

/// Whether the rule applies at a door: its robot has a radius of 0.15 m.
fn applies(x: f64, half: f64, goal: [f64; 2], others: usize) -> Option<bool> {
    let (body, walls) = (body(5, [0.0; 2]), door_walls(x, half));
    let nearby = [robot(9, [-0.6, 0.0], [0.0; 2])];
    let situation = Situation { obstacles: &walls, ..situation(&body, &nearby[..others]) };
    Approach::new(&situation, Vec2::new(goal[0], goal[1])).map(|approach| approach.is_narrow)
}

#[test]
fn the_rule_applies_near_doors_with_robots_and_at_narrow_ones_that_are_the_only_way() {
    // 14 radii are 2.1 m; 4.15 radii, 0.6225 m, are narrow; 2.02 to 9 radii are a door.
    assert_eq!([2.09, 2.11].map(|x| applies(x, 0.2, [5.0, 0.0], 1)), [Some(true), None]);
    assert_eq!([2.09, 2.11].map(|x| applies(x, 0.2, [5.0, 0.0], 0)), [None, None]);
    assert_eq!([2.09, 2.11].map(|x| applies(x, 0.2, [5.0, 3.0], 0)), [None, None]);
    assert_eq!([2.09, 2.11].map(|x| applies(x, 0.2, [5.0, 3.0], 1)), [Some(true), Some(true)]);
    assert_eq!([2.09, 2.11].map(|x| applies(x, 0.4, [5.0, 3.0], 0)), [None, None]);
    assert_eq!([2.0, 2.05].map(|x| applies(x, 0.4, [5.0, 3.0], 1)), [Some(false), Some(false)]);
    let narrow = [0.311, 0.312].map(|half| applies(1.0, half, [5.0, 0.0], 1));
    assert_eq!(narrow, [Some(true), Some(false)]);
    let doors = [0.151, 0.152, 0.674, 0.676].map(|half| applies(1.0, half, [5.0, 0.0], 1).is_some());
    assert_eq!(doors, [false, true, true, false]);
    // Two radii behind a door the robot still moves straight ahead.
    assert_eq!([-0.29, -0.31].map(|x| applies(x, 0.2, [5.0, 0.0], 1).is_some()), [true, false]);
    let (body, walls) = (body(5, [0.0; 2]), door_walls(1.0, 0.2));
    let nearby = [robot(9, [-0.6, 0.0], [0.0; 2])];
    let still = Situation { obstacles: &walls, wish: Vec2::ZERO, ..situation(&body, &nearby) };
    assert!(Approach::new(&still, Vec2::new(5.0, 0.0)).is_none(), "a robot that stands needs no way");
}

#[test]
fn a_silent_robot_in_the_lane_behind_the_door_ends_the_rule_there() {
    // Places relative to this robot, which is 0.2 m behind the door or before it.
    for (own, at, gives_way, is_barred) in [
        (0.2, [0.4, 0.0], false, true),
        (0.2, [0.4, 0.34], false, true),
        (0.2, [0.4, 0.36], false, false),
        (0.2, [0.56, 0.0], false, false),
        (0.2, [-0.3, 0.0], false, false),
        (0.2, [0.4, 0.0], true, false),
        (-0.2, [0.6, 0.0], false, false),
    ] {
        let gap = Gap { middle: Vec2::new(-own, 0.0), ..DOOR };
        let nearby = [Nearby { gives_way, ..robot(1, at, [0.0; 2]) }];
        let barred = with_approach(gap, &nearby, |approach| approach.is_barred_behind());
        assert_eq!(barred, is_barred, "{own} {at:?} {gives_way}");
    }
}
