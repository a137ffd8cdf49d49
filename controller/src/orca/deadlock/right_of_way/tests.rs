//! A table of the right of way: a door of 0.4 m, whose middle is 1 m east of a robot of 0.15 m.

use super::*;
use crate::body::Body;
use crate::neighbor::Nearby;
use crate::orca::fixtures::{body, robot};
use crate::robot::Mode;
use std::vec::Vec;

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
        // Others before this one: only impatience counts, and only behind no robot in the door.
        (Traffic { rank: 1, ..NO_TRAFFIC }, [false, true]),
        (Traffic { rank: 3, opposite: true, ..NO_TRAFFIC }, [false, true]),
        (Traffic { rank: 1, ahead: true, ..NO_TRAFFIC }, [false, false]),
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
    // The last robot came out: the turn is this side's, until its own robot is in the door.
    assert_eq!(may_go(&memory(false, false, 9.0), Traffic { ahead: false, ..opposite }, DOOR, false), [true, true]);
    let ahead = Traffic { ahead: true, ..opposite };
    assert_eq!(may_go(&memory(false, false, 9.0), ahead, DOOR, false), [false, true]);
    // The last robot went in: the others' turn, unless this one has begun.
    for goes in [false, true] {
        let own = Traffic { ahead: false, ..opposite };
        assert_eq!(may_go(&memory(true, goes, 0.0), own, DOOR, false), [goes, true]);
    }
    // In a long passage robots follow for the time of two passages: four times half its depth.
    let ahead = || Traffic { ahead: true, ..opposite };
    assert_eq!(may_go(&memory(true, false, 1.9), ahead(), deep, false), [true, true]);
    assert_eq!(may_go(&memory(true, true, 2.0), ahead(), deep, false), [false, true]);
    assert_eq!(may_go(&memory(true, true, 0.0), ahead(), DOOR, false), [false, true]);
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
