use super::{Full, GoalParams, Goals, Stage, wish};
use crate::body::Body;
use crate::flock::fixtures::{body, exact, near, number};
use crate::geom::{Position, Vec3};
use crate::neighbor::{Nearby, tie};
use crate::robot::RobotId;
use crate::scalar::{Q16, Scalar};
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec3<f64>;

const HERE: Position = Position::from_mm([1_000_000_000, -5_000, 0]);

/// R_MinDist = 10, R_nbh = 40, speed 2; gains K1, K2, K3.
fn params<S: Scalar>(gains: [f64; 3]) -> GoalParams<S> {
    let [goal, center, repulsion] = gains.map(number);
    GoalParams {
        goal_gain: goal,
        center_gain: center,
        repulsion_gain: repulsion,
        ..GoalParams::new(S::from_i32(10), S::TWO)
    }
}

fn goal(x: f64, y: f64, z: f64) -> Option<Position> {
    HERE.moved(V::new(x, y, z))
}

fn wished(gains: [f64; 3], goal: Option<Position>, nearby: &[Nearby<f64>]) -> V {
    wish(&params(gains), &body([0.0; 3]), HERE, goal, nearby)
}

fn at(x: f64, y: f64) -> Nearby<f64> {
    near(2, [x, y, 0.0], [9.0, 9.0, 0.0])
}

fn assert_close(got: V, expected: [f64; 3]) {
    let [x, y, z] = expected;
    assert!((got - V::new(x, y, z)).norm() < 1e-9, "{got:?} {expected:?}");
}

#[test]
fn goal_pulls_with_its_gain_limited_to_the_speed() {
    let far = goal(30.0, 40.0, 0.0);
    assert_close(wished([0.5, 0.0, 0.0], far, &[]), [0.6, 0.8, 0.0]);
    assert_close(wished([150.0, 0.0, 0.0], far, &[]), [1.2, 1.6, 0.0]);
    assert_close(wished([-0.5, 0.0, 0.0], far, &[]), [-0.6, -0.8, 0.0]);
    assert_close(wished([1.0, 0.0, 0.0], goal(0.0, 0.0, 9.0), &[]), [0.0, 0.0, 2.0]);
    assert_eq!(wished([1.0, 1.0, 1.0], None, &[]), V::ZERO);
    assert_eq!(wished([1.0, 1.0, 1.0], Some(HERE), &[]), V::ZERO);
}

#[test]
fn last_step_ends_on_the_goal() {
    for gain in [1.0, 150.0] {
        let got = wished([gain, 0.0, 0.0], goal(0.01, 0.0, 0.0), &[]);
        assert_close(got * 0.02, [0.01, 0.0, 0.0]);
    }
    assert_close(wished([1.0, 0.0, 0.0], goal(0.04, 0.0, 0.0), &[]) * 0.02, [0.04, 0.0, 0.0]);
    assert_close(wished([0.1, 0.0, 0.0], goal(0.03, 0.0, 0.0), &[]) * 0.02, [0.004, 0.0, 0.0]);
}

#[test]
fn middle_of_the_neighbours_within_sight_pulls() {
    let seen = [at(30.0, 20.0), at(-6.0, 12.0), at(40.001, 0.0)];
    assert_close(wished([0.0, 0.5, 0.0], None, &seen), [0.6, 0.8, 0.0]);
    assert_close(wished([0.0, -0.5, 0.0], None, &seen), [-0.6, -0.8, 0.0]);
    assert_close(wished([0.0, 0.5, 0.0], None, &[at(40.0, 0.0)]), [1.0, 0.0, 0.0]);
    assert_close(wished([0.0, 0.5, 0.0], None, &[at(9.0, 0.0), at(-9.0, 0.0)]), [0.0; 3]);
}

#[test]
fn repulsion_grows_with_the_square_and_is_held_below_half_the_least_distance() {
    let push = |d: f64| -wished([0.0, 0.0, 0.1], None, &[at(d, 0.0)]).x / 2.0;
    for (distance, expected) in
        [(20.0, 0.0), (20.1, 0.0), (15.0, 0.025), (10.0, 0.1), (5.0, 0.225), (4.999, 0.225), (0.001, 0.225)]
    {
        assert!((push(distance) - expected).abs() < 1e-9, "{distance}");
    }
    let around = [at(10.0, 0.0), at(0.0, 10.0)];
    assert_close(wished([0.0, 0.0, 0.1], None, &around), [-0.2, -0.2, 0.0]);
    assert_close(wished([0.0, 0.0, -0.1], None, &around), [0.2, 0.2, 0.0]);
}

#[test]
fn robots_in_one_place_separate_in_opposite_directions() {
    let push = |own: u32, other: u32| {
        let own = Body { id: RobotId(own), ..body([0.0; 3]) };
        let coincident = near(other, [0.0; 3], [0.0; 3]);
        wish(&params::<f64>([0.0, 1.0, 0.1]), &own, HERE, None, &[coincident])
    };
    assert_eq!(push(1, 2), -push(2, 1));
    assert!((push(1, 2).norm() - 0.45).abs() < 1e-9);
    assert!(push(1, 2).xy().dot(tie(RobotId(1), RobotId(2))) > 0.4);
    assert_eq!(push(1, 1), V::ZERO);
}

#[test]
fn three_rules_add_up_before_the_cut() {
    let got = wished([0.5, 0.2, 0.1], goal(99.0, 0.0, 0.0), &[at(0.0, 10.0)]);
    assert_close(got, [1.0, 0.2, 0.0]);
}

#[test]
fn invalid_input_gives_no_motion() {
    let good = params::<f64>([1.0, 1.0, 1.0]);
    let bad = [
        GoalParams { goal_gain: f64::NAN, ..good },
        GoalParams { center_gain: f64::INFINITY, ..good },
        GoalParams { min_distance_m: 0.0, ..good },
        GoalParams { neighborhood_m: 19.9, ..good },
        GoalParams { neighborhood_m: f64::INFINITY, ..good },
        GoalParams { speed_mps: -1.0, ..good },
        GoalParams { speed_mps: f64::NAN, ..good },
    ];
    for params in bad {
        assert!(!params.is_sound());
        assert_eq!(wish(&params, &body([0.0; 3]), HERE, goal(9.0, 0.0, 0.0), &[at(1.0, 1.0)]), V::ZERO);
    }
    assert!(good.is_sound());
    for speed in [0.0, -1.0, f64::NAN] {
        let lame = Body { max_speed_mps: speed, ..body([0.0; 3]) };
        assert_eq!(wish(&good, &lame, HERE, goal(9.0, 0.0, 0.0), &[]), V::ZERO);
    }
    let slow = Body { max_speed_mps: 0.5, ..body([0.0; 3]) };
    assert_close(wish(&good, &slow, HERE, goal(9.0, 0.0, 0.0), &[]), [0.5, 0.0, 0.0]);
    let expected = wished([0.2, 0.2, 0.1], goal(9.0, 0.0, 0.0), &[at(3.0, 4.0)]);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut lost = [at(1.0, 0.0), at(1.0, 0.0)];
        lost[0].offset_m.x = bad;
        lost[1].offset_m.y = -bad;
        let seen = [lost[0], at(3.0, 4.0), lost[1]];
        assert_eq!(wished([0.2, 0.2, 0.1], goal(9.0, 0.0, 0.0), &seen), expected);
    }
}

#[test]
fn goals_are_full_at_capacity_and_an_empty_list_has_no_destination() {
    let mut none = Goals::<0>::new();
    assert_eq!(none.push(HERE), Err(Full));
    assert_eq!((none.centroid(), none.current()), (None, None));
    assert!(!none.has_arrived(HERE, 1e9));
    assert_eq!(none.update(HERE, 1e9, 1, RobotId(1)), None);
    let mut two = Goals::<2>::new();
    assert_eq!((two.push(HERE), two.push(Position::ORIGIN)), (Ok(()), Ok(())));
    assert_eq!(two.push(HERE), Err(Full));
    assert_eq!(two.as_slice(), [HERE, Position::ORIGIN]);
    assert!(!two.set_goal(2, HERE) && two.set_goal(1, HERE));
    assert_eq!(two.as_slice(), [HERE, HERE]);
}

#[test]
fn middle_of_the_goals_is_rounded_to_nearest_and_never_overflows() {
    let mut goals = Goals::<3>::new();
    let place = |x, y, z| Position::from_mm([x, y, z]);
    goals.push(place(i32::MAX, i32::MIN, 1)).unwrap();
    assert_eq!(goals.centroid(), Some(place(i32::MAX, i32::MIN, 1)));
    goals.push(place(i32::MAX, i32::MIN, 2)).unwrap();
    goals.push(place(i32::MAX, i32::MIN, 2)).unwrap();
    assert_eq!(goals.centroid(), Some(place(i32::MAX, i32::MIN, 2)));
    assert!(goals.set_goal(0, place(0, 0, -6)));
    // (2 * 2147483647) / 3 = 1431655764.67, -(2^32) / 3 = -1431655765.33.
    assert_eq!(goals.centroid(), Some(place(1_431_655_765, -1_431_655_765, -1)));
}

#[test]
fn robot_goes_to_the_middle_then_to_the_goal_it_draws() {
    let mut goals = Goals::<3>::new();
    for x in [0, 3_000, 6_000] {
        goals.push(Position::from_mm([x, 0, 0])).unwrap();
    }
    let middle = Position::from_mm([3_000, 0, 0]);
    let robot = RobotId(7);
    assert_eq!((goals.current(), goals.stage()), (Some(middle), Stage::Gather));
    let off = Position::from_mm([3_000, 501, 0]);
    assert_eq!(goals.update(off, 0.5, 1, robot), None);
    let on_edge = Position::from_mm([3_000, 500, 0]);
    let index = goals.update(on_edge, 0.5, 1, robot).unwrap();
    assert_eq!(goals.stage(), Stage::Goal(index));
    assert_eq!(goals.current(), Some(goals.as_slice()[index]));
    assert_eq!(goals.update(on_edge, 0.5, 1, robot), None);
    let moved = Position::from_mm([9, 9, 9]);
    assert!(goals.set_goal(index, moved));
    assert_eq!(goals.current(), Some(moved));
    assert!(goals.has_arrived(moved, 0.0) && !goals.has_arrived(middle, 0.1));
    goals.restart();
    assert_eq!(goals.stage(), Stage::Gather);
    assert_ne!(goals.current(), Some(middle), "the middle has moved along");
}

#[test]
fn goals_are_chosen_uniformly_and_again_after_a_restart() {
    let mut all = Goals::<3>::new();
    for _ in 0..3 {
        all.push(HERE).unwrap();
    }
    let (mut shares, mut changed) = ([0; 3], 0);
    for robot in 1..=3000 {
        let mut goals = all.clone();
        let first = goals.update(HERE, 1.0, 5, RobotId(robot)).unwrap();
        assert_eq!(all.clone().update(HERE, 1.0, 5, RobotId(robot)), Some(first));
        shares[first] += 1;
        goals.restart();
        changed += u32::from(goals.update(HERE, 1.0, 5, RobotId(robot)) != Some(first));
    }
    // 1000 and 2000 expected, deviations of 26.
    assert!(shares.iter().all(|n| (870..1130).contains(n)), "{shares:?}");
    assert!((1870..2130).contains(&changed), "{changed}");
}

#[test]
fn a_flock_gathers_in_the_middle_and_splits_to_its_three_goals() {
    const STEP_S: f64 = 0.1;
    let params = GoalParams::<f64>::new(1.0, 1.0);
    let mut all = Goals::<3>::new();
    for mm in [[60_000, 0, 0], [60_000, 40_000, 0], [0, 40_000, 0]] {
        all.push(Position::from_mm(mm)).unwrap();
    }
    let start = |i: i32| Position::from_mm([1_300 * (i % 7), 1_300 * (i / 7), 0]);
    let mut robots: Vec<_> = (0..45).map(|i| (start(i), all.clone())).collect();
    let mut nearest = f64::MAX;
    for _ in 0..1500 {
        let before = robots.clone();
        for (i, (place, goals)) in robots.iter_mut().enumerate() {
            let robot = RobotId(i as u32 + 1);
            goals.update(*place, params.neighborhood_m, 1, robot);
            let own = Body { id: robot, step_s: STEP_S, ..body([0.0; 3]) };
            let others = before.iter().zip(1..).filter(|(_, id)| *id != robot.0);
            let nearby: Vec<_> = others
                .map(|((other, _), id)| {
                    let offset: V = other.since(*place);
                    nearest = nearest.min(offset.norm());
                    near(id, [offset.x, offset.y, 0.0], [0.0; 3])
                })
                .collect();
            let wished = wish(&params, &own, *place, goals.current(), &nearby);
            *place = place.moved(wished * STEP_S).unwrap();
        }
    }
    let mut shares = [0; 3];
    for (place, goals) in &robots {
        let Stage::Goal(index) = goals.stage() else {
            panic!("{place:?} never came to the middle");
        };
        shares[index] += 1;
        assert!(goals.has_arrived(*place, params.neighborhood_m), "{place:?}");
    }
    assert!(shares.iter().all(|share| *share > 5), "{shares:?}");
    assert!(nearest > 0.2, "least distance {nearest}");
}

fn seen() -> impl Strategy<Value = Vec<[f64; 2]>> {
    proptest::collection::vec([-45.0..45.0_f64, -45.0..45.0_f64], 0..10)
}

fn answer<S: Scalar>(gains: [f64; 3], way: [f64; 2], seen: &[[f64; 2]]) -> V {
    let goal = HERE.moved(V::new(way[0], way[1], 0.0));
    let nearby: Vec<_> = (2..).zip(seen).map(|(id, [x, y])| near::<S>(id, [*x, *y, 0.0], [0.0; 3])).collect();
    exact(wish(&params(gains), &body([0.0; 3]), HERE, goal, &nearby))
}

proptest! {
    #[test]
    fn the_result_turns_and_mirrors_with_the_world_and_ignores_order(
        gains in [-2.0..2.0_f64, -2.0..2.0, -1.0..1.0], way in [-99..99_i32, -99..99], seen in seen(),
    ) {
        let way = way.map(f64::from);
        let plain = answer::<f64>(gains, way, &seen);
        let turn = |[x, y]: [f64; 2]| [-y, x];
        let turned: Vec<_> = seen.iter().map(|v| turn(*v)).collect();
        let got = answer::<f64>(gains, turn(way), &turned);
        prop_assert!((got - V::new(-plain.y, plain.x, 0.0)).norm() < 1e-9);
        let mirror = |[x, y]: [f64; 2]| [x, -y];
        let mirrored: Vec<_> = seen.iter().map(|v| mirror(*v)).collect();
        let got = answer::<f64>(gains, mirror(way), &mirrored);
        prop_assert!((got - V::new(plain.x, -plain.y, 0.0)).norm() < 1e-9);
        let reversed: Vec<_> = seen.iter().rev().copied().collect();
        prop_assert!((answer::<f64>(gains, way, &reversed) - plain).norm() < 1e-9);
        prop_assert!(plain.norm() <= 2.0 + 1e-9 && plain.z == 0.0);
    }

    #[test]
    fn f32_and_q16_agree_with_f64(
        gains in [0.1..1.0_f64, 0.1..1.0, 0.0..0.5], way in [1..99_i32, -99..99], seen in seen(),
    ) {
        let (x, y) = seen.iter().fold((0.0, 0.0), |(x, y), v| (x + v[0], y + v[1]));
        prop_assume!(x * x + y * y > 1.0);
        prop_assume!(seen.iter().all(|[x, y]| ((x * x + y * y).sqrt() - 40.0).abs() > 0.001));
        let way = way.map(f64::from);
        let plain = answer::<f64>(gains, way, &seen);
        prop_assert!((answer::<f32>(gains, way, &seen) - plain).norm() < 1e-3);
        prop_assert!((answer::<Q16>(gains, way, &seen) - plain).norm() < 1e-2);
    }

    #[test]
    fn the_result_is_finite_and_within_the_speed_for_any_bits(bits: [u32; 9]) {
        let f = bits.map(f32::from_bits);
        let params = GoalParams { goal_gain: f[0], center_gain: f[1], repulsion_gain: f[2], ..params([0.0; 3]) };
        let other = Nearby { offset_m: Vec3::new(f[3], f[4], f[5]), ..near(2, [0.0; 3], [0.0; 3]) };
        let own = Body { max_speed_mps: f[6], step_s: f[7], ..body([0.0; 3]) };
        let goal = Some(Position::from_mm([bits[8].cast_signed(), 1, 2]));
        let got = wish(&params, &own, HERE, goal, &[other, other]);
        prop_assert!(got.is_finite() && got.norm() <= 2.001);
    }
}

#[test]
fn strangers_push_but_do_not_count_for_the_middle() {
    let stranger = |x, y| Nearby { is_stranger: true, ..at(x, y) };
    assert_eq!(wished([0.0, 1.0, 0.0], None, &[stranger(30.0, 0.0)]), V::ZERO);
    assert_eq!(wished([0.0, 1.0, 0.0], None, &[stranger(30.0, 0.0), at(0.0, 30.0)]).x, 0.0);
    assert_eq!(wished([0.0, 0.0, 1.0], None, &[stranger(8.0, 0.0)]), wished([0.0, 0.0, 1.0], None, &[at(8.0, 0.0)]));
}
