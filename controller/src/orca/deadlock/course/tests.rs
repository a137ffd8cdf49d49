//! Ways around obstacles for a robot of radius 1 m in the origin.

use super::super::detour::tests::{V, ball, v, wall};
use super::*;
use crate::geom::Vec3;
use crate::scalar::Q16;
use proptest::prelude::*;
use std::vec::Vec as List;

fn polygon(x: f64, y: f64, size: f64, count: u32) -> List<Obstacle<f64>> {
    let corner = |k: u32| {
        let (sin, cos) = Scalar::sin_cos(f64::from(k) / f64::from(count) * core::f64::consts::TAU);
        v(x + size * cos, y + size * sin)
    };
    (0..count).map(|k| Obstacle::Wall([corner(k), corner(k + 1)])).collect()
}

fn ahead(obstacles: &[Obstacle<f64>], x: f64, y: f64) -> Option<V> {
    let mut course = Course::NEW;
    course.ahead(obstacles, v(x, y), 1.0)
}

fn field(obstacles: &[Obstacle<f64>], goal: V) -> Field<'_, f64> {
    let mut field = Field { obstacles, goal, room: 1.03, groups: Vec::new() };
    field.group();
    field
}

fn point(center: V) -> Bend<f64> {
    Bend { obstacle: None, center, radius: 0.0 }
}

/// The lengths with the first obstacle on the left and on the right.
fn lengths(obstacles: &[Obstacle<f64>], x: f64, y: f64) -> [Option<f64>; 2] {
    let field = field(obstacles, v(x, y));
    [true, false].map(|on_left| field.best(on_left).map(|(length, _)| length))
}

#[test]
fn a_free_way_is_straight() {
    assert_eq!(ahead(&[], 9.0, 0.0), None);
    assert_eq!(ahead(&[ball(5.0, 3.1, 2.0)], 9.0, 0.0), None, "1.1 m of room");
    assert!(ahead(&[ball(5.0, 2.9, 2.0)], 9.0, 0.0).is_some(), "0.9 m of room");
    assert_eq!(ahead(&[ball(-5.0, 0.0, 2.0), wall(-1.5, -9.0, -1.5, 9.0)], 9.0, 0.0), None, "behind");
    assert!(ahead(&[wall(5.0, 0.9, 5.0, 9.0)], 9.0, 0.0).is_some());
    assert_eq!(ahead(&[wall(5.0, 1.1, 5.0, 9.0)], 9.0, 0.0), None);
    let floor = Obstacle::Plane { normal: Vec3::new(-1.0, 0.0, 0.0), distance_m: 3.0 };
    assert_eq!(ahead(&[floor], 9.0, 0.0), None, "planes do not count");
    assert_eq!(ahead(&[ball(9.0, 0.0, 2.0)], 9.0, 0.0), None, "a goal in an obstacle");
    assert!(field(&[ball(9.0, 0.0, 2.0)], v(9.0, 0.0)).is_free());
}

#[test]
fn around_a_ball_the_way_is_its_tangent() {
    // Tangent to 3.03 m around (5, 0), and on the right of the robot if both sides are equal.
    let got = ahead(&[ball(5.0, 0.0, 2.0)], 10.0, 0.0).unwrap();
    assert!((got.y + 3.03 / 5.0).abs() < 1e-12 && got.x > 0.0, "{got:?}");
    let [left, right] = lengths(&[ball(5.0, 0.0, 2.0)], 10.0, 0.0).map(Option::unwrap);
    let tangent = libm::sqrt(25.0 - 3.03 * 3.03);
    let arc = 3.03 * 2.0 * libm::asin(3.03 / 5.0);
    assert!((left - right).abs() < 1e-9 && (left - 2.0 * tangent - arc).abs() < 1e-9, "{left} {right}");
    assert!(ahead(&[ball(5.0, -0.1, 2.0)], 10.0, 0.0).unwrap().y > 0.0, "the shorter side");
}

#[test]
fn polygons_of_many_sides_are_like_balls() {
    for count in [8, 13, 32, 64] {
        let [left, right] = lengths(&polygon(6.0, 0.0, 3.0, count), 13.0, 1.0).map(Option::unwrap);
        let [one, other] = lengths(&[ball(6.0, 0.0, 3.0)], 13.0, 1.0).map(Option::unwrap);
        let share = (left / one).max(right / other);
        assert!(share < 1.01 && left / one > 0.95 && right / other > 0.95, "{count}: {left} {one} {right} {other}");
    }
}

#[test]
fn what_leaves_no_room_between_is_passed_on_one_side() {
    let pair = |gap: f64| [ball(5.0, 2.0 + gap / 2.0, 2.0), ball(5.0, -2.0 - gap / 2.0, 2.0)];
    assert!(ahead(&pair(1.9), 10.0, 0.0).unwrap().y.abs() > 0.5);
    assert_eq!(ahead(&pair(2.1), 10.0, 0.0), None);
    let are_grouped = |gap: f64| field(&pair(gap), v(10.0, 0.0)).is_grouped(0, 1);
    assert!(are_grouped(1.9) && !are_grouped(2.1));
    // Walls that touch or cross, through others.
    let walls =
        [wall(0.0, 3.0, 3.0, 3.0), wall(9.0, 9.0, 9.0, 5.0), wall(3.0, 3.0, 9.5, 6.0), wall(20.0, 0.0, 21.0, 0.0)];
    let field = field(&walls, v(10.0, 0.0));
    assert!(field.is_grouped(0, 1) && field.is_grouped(1, 2) && !field.is_grouped(0, 3));
}

#[test]
fn out_of_a_cup_the_way_leads_past_its_end() {
    let cup = [wall(-6.0, 3.0, 3.0, 3.0), wall(3.0, 3.0, 3.0, -3.0), wall(3.0, -3.0, -9.0, -3.0)];
    let got = ahead(&cup, 12.0, -2.0).unwrap();
    // The nearer end is at (-6, 3): tangent to its disc, which is on the right.
    assert!(got.x < 0.0 && got.y > 0.0 && (got.det(v(-6.0, 3.0)) + 1.03).abs() < 1e-9, "{got:?}");
}

#[test]
fn the_side_is_kept_until_the_other_way_is_shorter_than_any_seen() {
    let mut course = Course::NEW;
    let wish = |course: &mut Course<f64>, y: f64| course.ahead(&[ball(5.0, y, 2.0)], v(10.0, 0.0), 1.0).unwrap().y;
    assert!(wish(&mut course, -0.5) > 0.0);
    assert_eq!(course.changes, 0, "the first choice");
    assert!(wish(&mut course, 0.2) > 0.0, "now the other side is shorter, but not than the first way");
    assert!(wish(&mut course, -1.5) > 0.0);
    assert!(wish(&mut course, 1.0) > 0.0, "shorter than the first way, but not than the last one");
    assert!(wish(&mut course, 1.8) < 0.0);
    assert_eq!(course.changes, 1);
    assert_eq!(course.ahead(&[], v(10.0, 0.0), 1.0), None);
    assert_eq!(course, Course::NEW);
}

/// The end of the wall is 2 m to the right, and the heading leads to the other one.
#[test]
fn a_robot_that_has_turned_often_turns_only_for_a_way_that_is_much_shorter() {
    let turns = |left_m: f64, changes: u8, least: f64| {
        let walls = [wall(3.0, -2.0, 3.0, left_m)];
        let [right, left] = lengths(&walls, 6.0, 0.0).map(Option::unwrap);
        let heading = v(0.6, 0.8);
        let mut course = Course { heading, changes, least_m: right / least };
        let ahead = course.ahead(&walls, v(6.0, 0.0), 1.0).unwrap();
        (ahead.y < 0.0, right / left)
    };
    // The other way has 0.9 of the length of the shortest one seen.
    assert!(turns(3.0, 0, 0.9).0 && turns(3.0, 3, 0.9).0 && !turns(3.0, 8, 0.9).0);
    assert!(!turns(3.0, 0, 1.0).0 && !turns(3.0, 0, 1.1).0 && !turns(3.0, 8, 1.1).0);
    // A longer one, but less than half as long as the present one, or less than 0.3 of it.
    let [(far, half), (farther, third)] = [(9.0, 0.5), (20.0, 0.3)].map(|(left_m, most)| {
        let (is_turned, share) = turns(left_m, 0, 2.0);
        assert!(is_turned && share < most && share > most - 0.2, "{share}");
        (turns(left_m, 8, 2.0).0, share)
    });
    assert!(!far && farther, "{half} {third}");
    assert!(!turns(4.0, 0, 2.0).0, "{}", turns(4.0, 0, 2.0).1);
}

#[test]
fn a_leg_with_exactly_its_room_meets_nothing() {
    let leg = Leg::between(&point(V::ZERO), &point(v(4.0, 0.0))).unwrap();
    // 5 m from its end.
    for side in [1.0, -1.0] {
        let meets = |room_m| {
            let wall = leg.meets(&wall(7.0, 4.0 * side, 7.0, 9.0 * side), room_m);
            [wall, leg.meets(&ball(7.0, 4.0 * side, 1.0), room_m - 1.0)].map(|place| place.is_some())
        };
        assert_eq!([meets(5.0), meets(5.001)], [[false; 2], [true; 2]]);
    }
}

fn string(bends: &[(f64, f64, f64)], x: f64, y: f64) -> (f64, V) {
    let bend = |&(x, y, radius): &(f64, f64, f64)| Bend { obstacle: Some(0), center: v(x, y), radius };
    let ends = [(0.0, 0.0, 0.0), (x, y, 0.0)];
    let all: List<_> = ends[..1].iter().chain(bends).chain(&ends[1..]).map(bend).collect();
    Field::measure(&all).unwrap()
}

#[test]
fn the_outermost_bend_is_around_a_connected_obstacle_on_the_leg() {
    let near = [point(V::ZERO), point(v(12.0, 0.0))];
    let leg = Leg::between(&near[0], &near[1]).unwrap();
    for (other, index) in [
        (ball(5.0, 1.9, 1.0), 1),
        // Off the leg, off the leg and not connected, and on it but not connected.
        (ball(5.0, 2.5, 1.0), 0),
        (ball(5.0, 8.0, 1.0), 0),
        (ball(8.9, 1.95, 1.0), 0),
    ] {
        let obstacles = [ball(5.0, 0.0, 1.0), other];
        let bend = field(&obstacles, v(12.0, 0.0)).outermost(0, false, &near, &leg).unwrap();
        assert_eq!(bend.obstacle, Some(index), "{other:?}");
    }
}

#[test]
fn each_wall_of_a_row_is_passed_on_its_shorter_side() {
    for side in [1.0, -1.0] {
        let wall = |ax, ay: f64, bx, by: f64| wall(ax, ay * side, bx, by * side);
        // The far end of the last one is nearer to the second one, but off the way.
        let walls = [wall(5.0, -1.0, 5.0, 6.0), wall(12.0, -9.0, 12.0, 2.0), wall(13.0, 7.0, 22.0, -1.5)];
        let room = 1.03 * side;
        let ends = [(5.0, -side, room), (12.0, 2.0 * side, -room), (22.0, -1.5 * side, room)];
        let (length, ahead) = string(&ends, 30.0, 0.0);
        let field = field(&walls, v(30.0, 0.0));
        let [best, other] = [side > 0.0, side < 0.0].map(|on_left| field.best(on_left).unwrap());
        assert!((best.0 - length).abs() < 1e-9 && (best.1 - ahead).norm() < 1e-9, "{best:?} {length}");
        assert!(other.0 > length);
    }
}

/// Obstacles, the side on which the first one is passed, and the bends of the string.
type Scene<'a> = (&'a [Obstacle<f64>], bool, &'a [(f64, f64, f64)]);

#[test]
fn around_obstacles_without_room_between_them_the_string_is_taut() {
    const R: f64 = 1.03;
    let scenes: [Scene<'_>; 9] = [
        (&[ball(7.0, -2.5, 2.5), wall(7.5, -2.5, 10.5, 1.5)], false, &[(10.5, 1.5, -R)]),
        (&[wall(2.0, -3.5, 12.0, 0.0), wall(13.0, 0.0, 4.5, 0.5)], false, &[(4.5, 0.5, -R), (13.0, 0.0, -R)]),
        (
            &[wall(3.0, 0.5, 11.5, 0.5), wall(11.5, 0.5, 5.0, 5.0), ball(12.5, 1.0, 1.0)],
            true,
            &[(3.0, 0.5, R), (12.5, 1.0, 1.0 + R)],
        ),
        (
            &[wall(13.0, 2.5, 7.5, -5.0), wall(7.5, -5.0, 5.5, 1.0), ball(9.5, 2.5, 0.5)],
            false,
            &[(9.5, 2.5, -0.5 - R), (13.0, 2.5, -R)],
        ),
        (&[wall(13.5, -6.0, 8.0, 5.5), ball(8.0, 2.0, 2.5)], false, &[(8.0, 2.0, -2.5 - R)]),
        (&[ball(9.0, -0.5, 2.5), wall(5.0, 1.0, 5.0, 4.5), wall(5.5, 2.0, 11.0, -6.0)], true, &[(9.0, -0.5, 2.5 + R)]),
        // A bend that the string no longer needs lies before the last one.
        (&[wall(4.5, -6.0, 11.5, 4.0), ball(13.5, 5.0, 2.0), wall(3.5, -0.5, 5.5, -1.0)], true, &[(4.5, -6.0, R)]),
        // There is room between the first obstacle and the others.
        (
            &[ball(5.0, 4.0, 0.5), wall(7.5, 2.5, 7.5, 2.0), ball(6.0, -0.5, 2.0)],
            false,
            &[(6.0, -0.5, -2.0 - R), (5.0, 4.0, 0.5 + R), (7.5, 2.5, -R)],
        ),
        (
            &[wall(11.0, 1.0, 7.5, -7.0), ball(8.5, 3.0, 1.5), wall(4.0, 4.0, 13.5, 4.0), wall(13.5, 4.0, 10.0, 4.5)],
            false,
            &[(4.0, 4.0, -R), (8.5, 3.0, -1.5 - R), (10.0, 4.5, -R), (13.5, 4.0, -R)],
        ),
    ];
    for (obstacles, on_left, bends) in scenes {
        for side in [1.0, -1.0] {
            let mirrored = obstacles.iter().map(|obstacle| match *obstacle {
                Obstacle::Wall([a, b]) => wall(a.x, a.y * side, b.x, b.y * side),
                Obstacle::Ball { center_m, radius_m } => ball(center_m.x, center_m.y * side, radius_m),
                Obstacle::Plane { .. } => *obstacle,
            });
            let mirrored: List<_> = mirrored.collect();
            let bends: List<_> = bends.iter().map(|(x, y, radius)| (*x, *y * side, *radius * side)).collect();
            let (length, ahead) = string(&bends, 16.0, 0.3 * side);
            let best = field(&mirrored, v(16.0, 0.3 * side)).best(on_left == (side > 0.0)).unwrap();
            assert!((best.0 - length).abs() < 1e-9, "{mirrored:?}: {} {length}", best.0);
            assert!((best.1 - ahead).norm() < 1e-9, "{mirrored:?}");
        }
    }
}

#[test]
fn a_goal_beside_an_obstacle_is_reached_around_it() {
    for obstacle in [wall(13.5, -4.0, 13.5, 1.5), ball(13.5, 1.5, 2.0)] {
        let [left, right] = lengths(&[obstacle], 16.0, 0.4).map(Option::unwrap);
        assert!(left > 16.0 && right > 16.0 && left.min(right) < 17.5, "{left} {right}");
    }
    // Nearer to the end of the wall than the string usually is.
    let (wall, goal) = ([wall(13.0, -4.0, 13.0, 0.0)], v(13.3, -0.4));
    let near = 0.5 - 0.015 * 1.03;
    let (length, _) = string(&[(13.0, 0.0, -near)], goal.x, goal.y);
    assert!((lengths(&wall, goal.x, goal.y)[1].unwrap() - length).abs() < 1e-9);
}

#[test]
fn a_turn_of_more_than_half_a_turn_counts_and_one_by_rounding_does_not() {
    let tangent = |away: f64| libm::sqrt(away * away - 1.0);
    for side in [1.0, -1.0] {
        // Around a disc and back.
        let (length, _) = string(&[(5.0, 0.0, side)], 0.0, 0.0);
        let turn = core::f64::consts::PI + 2.0 * libm::asin(0.2);
        assert!((length - 2.0 * tangent(5.0) - turn).abs() < 1e-9, "{length}");
        // The disc is on the other side of the string.
        let (length, _) = string(&[(5.0, 1.5 * side, side)], 10.0, 0.0);
        assert!((length - 2.0 * tangent(libm::hypot(5.0, 1.5))).abs() < 1e-9, "{length}");
    }
}

#[test]
fn a_string_with_too_many_bends_counts_as_longer_than_it_is_known() {
    let [one, _] = lengths(&[ball(70.0, 0.0, 65.0)], 150.0, 1.0).map(Option::unwrap);
    for length in lengths(&polygon(70.0, 0.0, 65.0, 120), 150.0, 1.0).map(Option::unwrap) {
        assert!(length > 1.5 * one && length < 2.0 * one, "{length} {one}");
    }
}

#[test]
fn a_row_of_balls_is_passed_on_its_shorter_side() {
    let best = |side: f64| {
        let row = [6.0, 14.0, 22.0, 30.0].map(|x| ball(x, -1.5 * side, 2.0));
        lengths(&row, 36.0, 0.0).into_iter().flatten().fold(f64::MAX, f64::min)
    };
    let [left, right] = [1.0, -1.0].map(best);
    assert!((left - right).abs() < 1e-9 && left < 36.5, "{left} {right}");
}

#[test]
fn walls_that_cross_leave_no_room_wherever_they_are() {
    for at in [v(0.0, 0.0), v(30.0, -7.0), v(-4.0, 50.0)] {
        let wall = |a: V, b: V| Obstacle::Wall([at + a, at + b]);
        let one = wall(v(-9.0, -3.0), v(9.0, 3.0));
        let is_closed = |other: Obstacle<f64>| {
            let pair = [one, other];
            let field = field(&pair, v(10.0, 0.0));
            assert_eq!(field.is_closed(0, 1), field.is_closed(1, 0));
            field.is_closed(0, 1)
        };
        assert!(is_closed(wall(v(-4.0, 9.0), v(5.0, -8.0))));
        assert!(!is_closed(wall(v(-4.0, 9.0), v(-1.0, 2.0))));
        assert!(is_closed(wall(v(-4.0, 9.0), v(-1.0, 1.5))));
        assert!(!is_closed(wall(v(12.0, 9.0), v(12.0, -8.0))));
    }
}

#[test]
fn a_robot_that_touches_follows_the_border() {
    for obstacles in [std::vec![ball(3.0, 0.0, 1.99)], std::vec![ball(81.0, 0.0, 79.98)], polygon(3.0, 0.0, 1.99, 64)] {
        let got = ahead(&obstacles, 200.0, 0.5).unwrap();
        assert!(got.x.abs() < 0.2 && got.y > 0.9, "{got:?}");
    }
}

#[test]
fn no_way_is_no_way() {
    let square = polygon(0.5, 0.0, 3.0, 4);
    assert_eq!(ahead(&square, 9.0, 0.0), None);
    let nowhere = [wall(f64::NAN, 0.0, 3.0, 1.0), ball(f64::INFINITY, 0.0, 1.0), wall(4.0, -2.0, 4.0, 2.0)];
    assert!(ahead(&nowhere, 9.0, 0.0).is_some());
    assert_eq!(ahead(&[wall(4.0, -2.0, 4.0, 2.0)], f64::NAN, 0.0), None);
}

fn same<S: Scalar>(obstacles: &[Obstacle<f64>], goal: V) -> Option<V> {
    let one = |at: V| Vec2::new(S::from_f64(at.x).unwrap(), S::from_f64(at.y).unwrap());
    let cast = |obstacle: &Obstacle<f64>| match *obstacle {
        Obstacle::Wall(ends) => Obstacle::Wall(ends.map(one)),
        Obstacle::Ball { center_m, radius_m } => {
            Obstacle::Ball { center_m: one(center_m.xy()).extend(S::ZERO), radius_m: S::from_f64(radius_m).unwrap() }
        }
        Obstacle::Plane { .. } => Obstacle::Ball { center_m: Vec3::ZERO, radius_m: S::ZERO },
    };
    let obstacles: List<_> = obstacles.iter().map(cast).collect();
    let mut course = Course::NEW;
    let got = course.ahead(&obstacles, one(goal), S::ONE)?;
    Some(v(got.x.to_f64(), got.y.to_f64()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_number_type_finds_the_way_around_any_ball(
        x in 3.5..9.0_f64, y in -2.0..2.0_f64, size in 0.3..2.4_f64, goal in 14.0..30.0_f64,
    ) {
        let obstacles = [ball(x, y, size)];
        let exact = same::<f64>(&obstacles, v(goal, 0.0));
        for got in [same::<f32>(&obstacles, v(goal, 0.0)), same::<Q16>(&obstacles, v(goal, 0.0))] {
            // Only at the border between two ways do they differ.
            if let Some((got, exact)) = got.zip(exact).filter(|_| y.abs() > 0.01) {
                prop_assert!((got - exact).norm() < 0.01, "{got:?} {exact:?}");
            }
        }
    }

    /// The least distance is that of many places on the leg.
    #[test]
    fn a_leg_meets_what_comes_nearer_than_its_room(
        [ax, ay, bx, by] in [-5.0..5.0_f64, -5.0..5.0, -5.0..5.0, -5.0..5.0],
        [from_x, from_y, to_x, to_y] in [-5.0..5.0_f64, -5.0..5.0, -5.0..5.0, -5.0..5.0],
        room in 0.3..2.0_f64, is_ball in any::<bool>(),
    ) {
        let obstacle = if is_ball { ball(ax, ay, bx.abs()) } else { wall(ax, ay, bx, by) };
        let [from, to] = [(from_x, from_y), (to_x, to_y)].map(|(x, y)| point(v(x, y)));
        let leg = Leg::between(&from, &to).unwrap();
        let away = |x: f64| distance(&obstacle, leg.from + leg.unit * x).unwrap();
        let least = (0..=200).map(|k| away(leg.length * f64::from(k) / 200.0)).fold(f64::MAX, f64::min);
        let met = leg.meets(&obstacle, room);
        if (least - room).abs() > 0.02 {
            prop_assert_eq!(met.is_some(), least < room, "{} {}", least, room);
        }
        let near = met.filter(|_| !is_ball).map(|x| away(x.clamp(0.0, leg.length)));
        prop_assert!(near.is_none_or(|away| away < room + 1e-9), "{near:?}");
    }

    #[test]
    fn mirrored_walls_give_mirrored_ways(
        ends in proptest::collection::vec([1.5..20.0_f64, -9.0..9.0, 1.5..20.0, -9.0..9.0], 1..3),
    ) {
        let [seen, mirrored] = [1.0, -1.0].map(|side| {
            let walls: List<_> = ends.iter().map(|[a, b, c, d]| wall(*a, *b * side, *c, *d * side)).collect();
            lengths(&walls, 24.0, 0.0)
        });
        for (one, other) in seen.iter().zip(mirrored.iter().rev()) {
            prop_assert!((one.unwrap_or(0.0) - other.unwrap_or(0.0)).abs() < 1e-9, "{seen:?} {mirrored:?}");
        }
    }

    /// A string that ends at the goal is free: no leg comes nearer to an obstacle than the body.
    #[test]
    fn walls_anywhere_give_a_unit_vector_or_none(
        ends in proptest::collection::vec([-9.0..9.0_f64, -9.0..9.0, -9.0..9.0, -9.0..9.0], 0..20),
        balls in proptest::collection::vec((-9.0..9.0_f64, -9.0..9.0_f64, 0.1..2.0_f64), 0..5),
        goal in [-20.0..20.0_f64, -20.0..20.0],
    ) {
        let mut obstacles: List<_> = ends.iter().map(|[a, b, c, d]| wall(*a, *b, *c, *d)).collect();
        obstacles.extend(balls.iter().map(|&(x, y, radius)| ball(x, y, radius)));
        for got in [same::<f64>(&obstacles, v(goal[0], goal[1])), same::<Q16>(&obstacles, v(goal[0], goal[1]))] {
            prop_assert!(got.is_none_or(|got| (got.norm() - 1.0).abs() < 0.01), "{got:?}");
        }
    }
}
