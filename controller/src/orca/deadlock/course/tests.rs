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
    assert!(wish(&mut course, 0.2) > 0.0, "now the other side is shorter, but not than the first way");
    assert!(wish(&mut course, 1.5) < 0.0);
    assert_eq!(course.changes, 1);
    assert_eq!(course.ahead(&[], v(10.0, 0.0), 1.0), None);
    assert_eq!(course, Course::NEW);
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
