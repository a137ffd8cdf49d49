//! Zones of a door and places to wait, by their borders in metres.

use super::*;
use proptest::prelude::*;

/// A robot anywhere around a door in metres: 0.15 m are one radius, 0.05 m/s are slow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    pub(super) id: u32,
    /// Behind the middle of the door, and to the left of its axis.
    pub(super) place: [f64; 2],
    pub(super) speed: f64,
    pub(super) mode: Mode,
    pub(super) gives_way: bool,
}

prop_compose! {
    pub(super) fn others()(
        id in prop_oneof![Just(4_u32), Just(6)],
        place in prop_oneof![[-1.6..1.6_f64, -0.5..0.5_f64], [-0.3..0.3_f64, -0.25..0.25_f64]],
        speed in -0.15..0.15_f64,
        mode in prop_oneof![3 => Just(Mode::Cruise), 1 => Just(Mode::Arrived)],
        gives_way in prop::bool::weighted(0.8),
    ) -> Other {
        Other { id, place, speed, mode, gives_way }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    /// The zones of a door of 0.4 m for another robot, by their borders in metres.
    #[test]
    fn each_zone_of_a_door_has_its_meaning(
        other in others(), own_m in prop_oneof![Just(1.0), -0.3..0.5_f64], depth in prop_oneof![Just(0.0), Just(0.5)],
        is_narrow: bool,
    ) {
        let gap = Gap { middle: Vec2::new(own_m, 0.0), depth, ..DOOR };
        let Other { id, place: [along, y], speed, mode, gives_way } = other;
        let nearby = [Nearby { mode, gives_way, ..robot(id, [own_m + along, y], [speed, 0.0]) }];
        let body = body(5, [0.0; 2]);
        let situation = situation(&body, &nearby);
        let own = gap.place(Vec2::ZERO);
        let got = Approach { gap, situation: &situation, own, is_narrow }.traffic();

        let beyond = (along.abs() - depth).max(0.0);
        let x = if along < 0.0 { -beyond } else { beyond };
        let (distance, own_distance) = (libm::hypot(x, y), (own_m.abs() - depth).max(0.0));
        let is_parked = mode == Mode::Arrived || !gives_way;
        // Positions are rounded: equally far robots have the order of their ids.
        let is_nearer = if (distance - own_distance).abs() > 0.09e-3 { distance < own_distance } else { id < 5 };
        let (goes, comes) = (speed > 0.05, speed < -0.05);
        let is_in_door = x.abs() < 0.225 && y.abs() < 0.2;
        prop_assert_eq!(got.ahead, is_in_door && goes, "ahead");
        let stands = is_in_door && !is_parked && !goes && x > 0.0 && is_nearer;
        prop_assert_eq!(got.against, is_in_door && comes || stands, "against");
        let is_first = if (along - own_m).abs() > 0.09e-3 { along < own_m } else { id < 5 };
        let bars = is_in_door && along > -own_m && !is_parked && !goes && is_first;
        prop_assert_eq!(got.bars, bars, "bars");
        let is_before = x < 0.0 && is_nearer && mode == Mode::Cruise && (gives_way || !is_narrow);
        prop_assert_eq!(got.rank, i32::from(is_before && !comes), "rank");
        let flows = is_narrow && (is_in_door && !is_parked || is_before && (goes || comes));
        prop_assert_eq!(got.flows, flows, "flows");
        let comes_out = x < 0.0 && comes && distance < own_distance - 0.15 && x > -0.75 && y.abs() < 0.3;
        prop_assert_eq!(got.comes_out, comes_out, "comes out");
        let opposite = x > 0.0 && distance < 0.75 && speed < 0.05 && !is_parked;
        let oncoming = opposite && comes && y.abs() < 0.35;
        prop_assert_eq!([got.opposite, got.oncoming], [opposite, oncoming]);
        prop_assert_eq!([got.opposite_is_nearer, got.oncoming_is_nearer], [opposite && is_nearer, oncoming && is_nearer]);
        let apart = libm::hypot(own_m + along, y);
        let queues = is_narrow && is_before && !comes && apart < 0.525;
        prop_assert_eq!(got.is_behind, queues && (own_m + along) * own_m > 0.0, "queue");
        prop_assert_eq!(got.crowds.is_some(), queues && apart < 0.45, "crowd");
        let is_ahead = own.x < 0.0 && is_nearer || x > 0.0 && y.abs() < 0.3;
        if !(is_ahead && !is_parked && !comes) {
            prop_assert!(!got.leads && got.pace_mps == f64::MAX, "follows");
        } else if x >= 0.0 {
            prop_assert_eq!(got.leads, goes, "leads");
        }
    }

    #[test]
    fn the_way_through_a_door_bends_into_its_lane(
        own in [-1.0..1.0_f64, -0.5..0.5_f64], half in 0.1..0.6_f64, has_lanes: bool,
    ) {
        let gap = Gap { middle: Vec2::new(-own[0], own[1]), half, ..DOOR };
        let [x, y] = own;
        let lane = if has_lanes { half / 2.0 } else { 0.0 };
        let is_beside = (y - lane).abs() > (half - 0.15).max(0.045);
        let wanted = match (x > 0.0, is_beside) {
            (true, _) => [0.6, lane + 0.045],
            (false, true) if has_lanes => [-0.12, lane],
            (false, true) => [x.clamp(-0.225, -0.12), lane],
            (false, false) => [0.3, lane],
        };
        let got = with_approach(gap, &[], |approach| approach.way_through(has_lanes));
        prop_assert!((got - Vec2::new(wanted[0], wanted[1])).norm() < 1e-9, "{got:?} {wanted:?}");
    }

    #[test]
    fn robots_wait_beside_the_lane_by_rank(
        own in [-1.5..-0.01_f64, -1.0..1.0_f64], half in 0.1..0.6_f64, rank in 0..6_i32, is_behind: bool, has_lanes: bool,
    ) {
        let gap = Gap { middle: Vec2::new(-own[0], own[1]), half, ..DOOR };
        let [x, y] = own;
        let side = if has_lanes || y >= 0.0 { 1.0 } else { -1.0 };
        let spot = [-0.225, (half.max(0.15) + 0.18) * side];
        let is_in_lane = y.abs() < half.max(0.15) + 0.15 && x > -0.75;
        let room = 0.15 * (6.5 * f64::from(rank)).sqrt();
        let wanted = if is_in_lane && !has_lanes {
            // First back, then aside.
            Some(if x > -0.195 { [-0.375, spot[1]] } else { [x, spot[1] + 0.075 * side] })
        } else {
            Some(spot).filter(|spot| !is_behind && libm::hypot(spot[0] - x, spot[1] - y) >= room)
        };
        let traffic = Traffic { rank, is_behind, ..NO_TRAFFIC };
        let got = with_approach(gap, &[], |approach| approach.place_to_wait(&traffic, has_lanes));
        prop_assert_eq!(got.is_some(), wanted.is_some(), "{:?} {:?}", got, wanted);
        if let Some((got, wanted)) = got.zip(wanted) {
            prop_assert!((got - Vec2::new(wanted[0], wanted[1])).norm() < 1e-9, "{got:?} {wanted:?}");
        }
    }
}

#[test]
fn only_robots_that_move_back_neither_lead_nor_wait() {
    // Beside the lane, towards the door: at a tenth of the top speed, 0.05 m/s, it moves back.
    for (speed_ahead, leads) in [(0.0, true), (-0.049, true), (-0.05, false), (-0.06, false)] {
        let nearby = [robot(9, [0.9, 0.4], [speed_ahead, -0.3])];
        let traffic = with_approach(DOOR, &nearby, |approach| approach.traffic());
        assert_eq!((traffic.leads, traffic.rank), (leads, i32::from(leads)), "{speed_ahead}");
    }
}

#[test]
fn the_first_waiting_robot_that_is_too_near_crowds() {
    let crowds = |places: &[[f64; 2]]| {
        let nearby: Vec<_> = places.iter().map(|at| robot(4, *at, [0.0; 2])).collect();
        let traffic = with_approach(DOOR, &nearby, |approach| approach.traffic());
        (traffic.is_behind, traffic.crowds)
    };
    assert_eq!(crowds(&[[0.53, 0.0]]), (false, None), "3.5 radii are 0.525 m");
    assert_eq!(crowds(&[[0.52, 0.0]]), (true, None));
    assert_eq!(crowds(&[[0.46, 0.0]]), (true, None), "three radii are 0.45 m");
    let near = [Vec2::new(0.44, 0.0), Vec2::new(0.3, 0.1)];
    assert_eq!(crowds(&[[0.44, 0.0], [0.3, 0.1]]), (true, Some(near[0])));
    assert_eq!(crowds(&[[0.5, 0.0], [0.3, 0.1]]), (true, Some(near[1])));
}

#[test]
fn inside_a_passage_the_way_leads_on_along_its_axis() {
    let inside = Gap { middle: Vec2::new(0.2, -0.15), depth: 0.5, ..DOOR };
    let way = |has_lanes| with_approach(inside, &[], |approach| approach.way_through(has_lanes));
    assert!((way(false) - Vec2::new(0.3, 0.0)).norm() < 1e-9, "{:?}", way(false));
    assert!((way(true) - Vec2::new(0.3, 0.1)).norm() < 1e-9, "{:?}", way(true));
}

#[test]
fn one_that_stands_behind_the_gap_bars_a_robot_that_is_behind_it_too() {
    let is_barred = |own_x: f64, at: [f64; 2], gives_way: bool| {
        let gap = Gap { middle: Vec2::new(-own_x, 0.0), depth: 0.5, ..DOOR };
        let nearby = [Nearby { gives_way, ..robot(9, at, [0.0; 2]) }];
        with_approach(gap, &nearby, |approach| approach.is_barred_behind())
    };
    assert!(is_barred(0.7, [0.3, 0.0], false));
    assert!(!is_barred(0.7, [0.3, 0.0], true) && !is_barred(0.7, [0.3, 0.4], false), "it gives way, or is aside");
    assert!(!is_barred(0.7, [-0.5, 0.0], false), "that one is in the passage");
    assert!(!is_barred(-0.2, [0.8, 0.0], false), "the own robot is in the passage");
}

#[test]
fn the_nearer_one_of_two_that_come_from_both_sides_is_known() {
    for (x, is_nearer) in [(1.3, true), (1.6, false)] {
        let gap = Gap { middle: Vec2::new(0.5, 0.0), ..DOOR };
        let nearby = [robot(9, [x - 0.5, 0.0], [-0.3, 0.0])];
        let traffic = with_approach(gap, &nearby, |approach| approach.traffic());
        assert_eq!((traffic.opposite_is_nearer, traffic.oncoming_is_nearer), (is_nearer, is_nearer), "{x}");
    }
}
