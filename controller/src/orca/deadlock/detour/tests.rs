//! Ways around walls for a robot of radius 1 m in the origin.

use super::*;
use crate::geom::Vec3;
use proptest::prelude::*;

pub(in crate::orca::deadlock) type V = Vec2<f64>;

pub(in crate::orca::deadlock) fn v(x: f64, y: f64) -> V {
    V::new(x, y)
}

pub(in crate::orca::deadlock) fn wall(ax: f64, ay: f64, bx: f64, by: f64) -> Obstacle<f64> {
    Obstacle::Wall([v(ax, ay), v(bx, by)])
}

pub(in crate::orca::deadlock) fn ball(x: f64, y: f64, radius_m: f64) -> Obstacle<f64> {
    Obstacle::Ball { center_m: Vec3::new(x, y, 0.0), radius_m }
}

fn is_at(found: Option<V>, x: f64, y: f64) -> bool {
    found.is_some_and(|at| (at - v(x, y)).norm() < 1e-9)
}

fn to(obstacles: &[Obstacle<f64>], x: f64, y: f64) -> Option<V> {
    detour(obstacles, v(x, y), 1.0)
}

#[test]
fn the_way_leads_past_the_nearer_end_of_a_wall() {
    let across = wall(5.0, -1.0, 5.0, 2.0);
    assert!(is_at(to(&[across], 10.0, 0.0), 5.0, -2.1));
    assert!(is_at(to(&[across], 10.0, 2.5), 5.0, 3.1));
    assert!(is_at(to(&[wall(5.0, 2.0, 5.0, -1.0)], 10.0, 0.0), 5.0, -2.1), "of either direction");
    assert_eq!(to(&[across], 4.9, 0.0), None, "the goal is before the wall");
    assert_eq!(to(&[across], 10.0, 4.5), None, "the straight way misses the wall");
    assert_eq!(to(&[across], -10.0, 0.0), None);
    assert_eq!(to(&[], 10.0, 0.0), None);
}

#[test]
fn a_place_without_room_or_behind_another_wall_does_not_count() {
    let across = wall(5.0, -1.0, 5.0, 2.0);
    let is_lower = |solid: Obstacle<f64>| is_at(to(&[across, solid], 10.0, 0.0), 5.0, -2.1);
    assert!(is_lower(ball(5.0, -4.2, 1.0)), "1.1 m of room");
    assert!(!is_lower(ball(5.0, -4.0, 1.0)), "0.9 m of room");
    assert!(is_at(to(&[across, ball(5.0, -4.0, 1.0)], 10.0, 0.0), 5.0, 3.1));
    // The line of sight passes x = 2 at y = -0.84.
    assert!(!is_lower(wall(2.0, -0.8, 2.0, -1.5)));
    assert!(is_lower(Obstacle::Plane { normal: Vec3::new(0.0, 1.0, 0.0), distance_m: 2.5 }), "planes do not count");
    // No place is left: the robot stays on its straight way.
    assert_eq!(to(&[across, ball(5.0, -4.0, 1.0), ball(5.0, 5.0, 1.0)], 10.0, 0.0), None);
}

#[test]
fn walls_that_meet_share_one_place_beyond_the_corner() {
    let half = 1.1 * core::f64::consts::FRAC_1_SQRT_2;
    let corner = [wall(5.0, -1.0, 5.0, 2.0), wall(5.0, 2.0, 8.0, 2.0)];
    assert!(is_at(outside(&corner, v(5.0, 2.0), 1.0), 5.0 - half, 2.0 + half));
    assert!(is_at(outside(&corner, v(5.0, -1.0), 1.0), 5.0, -2.1));
    // In line there is none; ends less than a twentieth of the radius apart meet.
    for (gap, x) in [(0.0, None), (0.04, None), (-0.04, None), (0.06, Some(3.0 + 1.1))] {
        let line = [wall(0.0, 5.0, 3.0, 5.0), wall(3.0 + gap, 5.0, 6.0, 5.0)];
        assert_eq!(outside(&line, v(3.0, 5.0), 1.0), x.map(|x| v(x, 5.0)), "{gap}");
        let shifted = [wall(0.0, 5.0, 3.0, 5.0), wall(3.0, 5.0 + gap, 6.0, 5.0 + gap)];
        assert_eq!(outside(&shifted, v(3.0, 5.0), 1.0), x.map(|x| v(x, 5.0)), "{gap}");
    }
    let diagonal = |gap: f64| [wall(0.0, 5.0, 3.0, 5.0), wall(3.0 + gap, 5.0 + gap, 6.0, 5.0 + gap)];
    assert_eq!(outside(&diagonal(0.034), v(3.0, 5.0), 1.0), None);
    assert!(outside(&diagonal(0.037), v(3.0, 5.0), 1.0).is_some(), "0.052 m apart");
    for (bend, has_place) in [(0.01, false), (0.019, false), (0.021, true), (0.1, true)] {
        let bent = [wall(-3.0, 0.0, 0.0, 0.0), wall(0.0, 0.0, 3.0, bend * 3.0)];
        assert_eq!(outside(&bent, V::ZERO, 1.0).is_some(), has_place, "{bend}");
    }
}

#[test]
fn the_whole_way_counts_and_not_its_first_part() {
    // The nearer end leads into a pocket behind, whose far wall is long.
    let walls = [wall(5.0, -2.0, 5.0, 1.5), wall(9.0, 0.0, 9.0, 12.0)];
    assert!(is_at(to(&walls[..1], 14.0, 1.0), 5.0, 2.6));
    assert!(is_at(to(&walls, 14.0, 1.0), 5.0, -3.1), "{:?}", to(&walls, 14.0, 1.0));
}

#[test]
fn the_rest_of_a_way_is_its_length_around_the_next_corners() {
    let rest = |walls: &[Obstacle<f64>], x: f64, y: f64| Corners::new(walls, 1.0).rest(V::ZERO, v(x, y));
    assert!((rest(&[], 3.0, 4.0) - 5.0).abs() < 1e-12);
    let one = [wall(5.0, -1.0, 5.0, 9.0)];
    let around = v(5.0, -2.1).norm() + v(5.0, 2.1).norm();
    assert!((rest(&one, 10.0, 0.0) - around).abs() < 1e-9);
    // Walls that alternate: up, down, up. Three corners count; the rest is straight.
    let up = |x: f64| wall(x, -40.0, x, 3.9);
    let down = |x: f64| wall(x, 40.0, x, -3.9);
    let walls = [up(10.0), down(20.0), up(30.0), down(40.0)];
    let [a, b, c] = [v(10.0, 5.0), v(20.0, -5.0), v(30.0, 5.0)];
    let parts = [a.norm(), (b - a).norm(), (c - b).norm()];
    for (count, x) in [(1, 15.0), (2, 25.0), (3, 35.0), (3, 45.0)] {
        let way: f64 = parts[..count].iter().sum();
        let wanted = way + (v(x, 0.0) - [a, b, c][count - 1]).norm();
        assert!((rest(&walls, x, 0.0) - wanted).abs() < 1e-9, "{count} {x}: {}", rest(&walls, x, 0.0));
    }
    // One end is near to the robot, but the way past the other one is shorter.
    let slanted = [wall(1.406, 1.475, 4.094, -0.375)];
    assert!((rest(&slanted, 10.0, 0.0) - 2.0 * v(5.0, 1.0).norm()).abs() < 0.01, "{}", rest(&slanted, 10.0, 0.0));
    // A corner that the robot is at does not count again.
    let at_corner = [wall(0.0, -0.1, 5.0, 9.0), wall(3.0, 0.5, 3.0, -0.5)];
    assert!(rest(&at_corner, 6.0, 0.0) > 6.0);
}

#[test]
fn more_walls_than_are_remembered_give_the_same_way() {
    let across = wall(5.0, -1.0, 5.0, 2.0);
    let far = |n: usize| wall(-50.0 - n as f64, 0.0, -50.0 - n as f64, 1.0);
    for before in [0, 6, 7, 8, 9, 12] {
        let mut walls: std::vec::Vec<_> = (0..before).map(far).collect();
        walls.push(across);
        assert!(is_at(to(&walls, 10.0, 0.0), 5.0, -2.1), "{before}");
    }
}

#[test]
fn the_first_wall_on_a_way_is_the_nearest() {
    let walls =
        [wall(7.0, -1.0, 7.0, 1.0), wall(5.0, -1.0, 5.0, 1.0), wall(6.0, -1.0, 6.0, 1.0), wall(4.0, 2.0, 4.0, 3.0)];
    let first = |from: V, x: f64, y: f64| first_wall(&walls, from, v(x, y)).map(|(index, _)| index);
    assert_eq!(first(V::ZERO, 9.0, 0.0), Some(1));
    assert_eq!(first(v(5.5, 0.0), 9.0, 0.0), Some(2));
    assert_eq!(first(v(9.0, 0.5), 0.0, 0.5), Some(0), "backwards");
    assert_eq!(first(V::ZERO, 4.5, 0.0), None);
    assert_eq!(first(V::ZERO, 8.0, 5.0), Some(3));
    // A slanted wall, 7 m ahead, and one across the way behind it.
    let walls = [wall(8.0, 2.0, 8.0, 4.0), wall(8.0, 2.0, 6.0, 4.0)];
    assert_eq!(first_wall(&walls, v(0.0, 3.0), v(10.0, 3.0)).map(|(index, _)| index), Some(1));
}

#[test]
fn a_way_through_the_corner_of_two_walls_is_blocked_whatever_their_directions() {
    let (low, corner, high) = (v(5.0, -1.0), v(5.0, 0.0), v(5.0, 1.0));
    for one in [[low, corner], [corner, low]] {
        for other in [[corner, high], [high, corner]] {
            let crossed = [one, other].iter().filter(|ends| crosses(v(10.0, 0.0), **ends)).count();
            assert_eq!(crossed, 1, "{one:?} {other:?}");
        }
    }
}

#[test]
fn a_wall_hides_what_is_behind_it() {
    let walls = [wall(5.0, -1.0, 5.0, 2.0)];
    assert!(is_hidden(&walls, v(10.0, 0.0)) && is_hidden(&walls, v(5.1, 0.0)));
    assert!(!is_hidden(&walls, v(5.0, 0.0)) && !is_hidden(&walls, v(5.004, 0.0)), "on the wall");
    assert!(!is_hidden(&walls, v(10.0, 4.1)) && is_hidden(&walls, v(10.0, 3.9)));
    assert!(!is_hidden(&walls, v(10.0, -2.1)) && is_hidden(&walls, v(10.0, -1.9)));
    assert!(!is_hidden(&walls, v(-10.0, 0.0)));
    assert!(!is_hidden(&[ball(5.0, 0.0, 1.0)], v(10.0, 0.0)), "only walls hide");
}

#[test]
fn distances_are_to_the_nearest_point() {
    let from = v(1.0, 2.0);
    assert_eq!(nearest(&wall(4.0, 0.0, 4.0, 9.0), from), Some((v(3.0, 0.0), 3.0)));
    assert_eq!(nearest(&wall(4.0, 6.0, 4.0, 9.0), from), Some((v(3.0, 4.0), 5.0)));
    assert_eq!(nearest(&ball(1.0, 7.0, 2.0), from), Some((v(0.0, 3.0), 3.0)));
    let above = Obstacle::Ball { center_m: Vec3::new(1.0, 7.0, 40.0), radius_m: 2.0 };
    assert_eq!(distance(&above, from), Some(3.0), "in the plane, heights do not count");
    assert_eq!(distance(&Obstacle::Plane { normal: Vec3::new(1.0, 0.0, 0.0), distance_m: 1.0 }, from), None);
}

prop_compose! {
    fn scenes()(
        walls in proptest::collection::vec((1.0..9.0_f64, -5.0..5.0_f64, -5.0..5.0_f64, -5.0..5.0_f64), 1..5),
        solid in (1.0..9.0_f64, -6.0..6.0_f64, 0.1..0.6_f64),
        target in (9.0..14.0_f64, -6.0..6.0_f64),
    ) -> (std::vec::Vec<Obstacle<f64>>, V) {
        let mut obstacles: std::vec::Vec<_> =
            walls.into_iter().map(|(x, y, dx, dy)| wall(x, y, x + dx, y + dy)).collect();
        obstacles.push(ball(solid.0, solid.1, solid.2));
        (obstacles, v(target.0, target.1))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn turned_mirrored_and_scaled_walls_give_turned_mirrored_and_scaled_ways((obstacles, target) in scenes()) {
        let plain = detour(&obstacles, target, 1.0);
        let (turn, flip) = (|at: V| v(-at.y, at.x), |at: V| v(at.x, -at.y));
        for (map, scale) in [(&turn as &dyn Fn(V) -> V, 1.0), (&flip, 1.0), (&|at: V| at * 8.0, 8.0), (&|at: V| at * 0.25, 0.25)] {
            let change = |obstacle: &Obstacle<f64>| match *obstacle {
                Obstacle::Wall(ends) => Obstacle::Wall(ends.map(map)),
                Obstacle::Ball { center_m, radius_m } => {
                    Obstacle::Ball { center_m: map(center_m.xy()).extend(0.0), radius_m: radius_m * scale }
                }
                other => other,
            };
            let moved: std::vec::Vec<_> = obstacles.iter().map(change).collect();
            let found = detour(&moved, map(target), scale);
            prop_assert_eq!(found.is_some(), plain.is_some());
            if let Some((found, plain)) = found.zip(plain) {
                prop_assert!((found - map(plain)).norm() < 1e-9 * scale, "{plain:?} {found:?}");
            }
        }
    }

    /// The place lies at an end, is seen, and has room; no such place gives a shorter way.
    #[test]
    fn the_way_leads_to_the_best_free_place((obstacles, target) in scenes()) {
        let Some(found) = detour(&obstacles, target, 1.0) else {
            return Ok(());
        };
        prop_assert!(walls(&obstacles).any(|ends| crosses(target, ends)));
        let is_free = |place: V| {
            let is_clear = obstacles.iter().all(|one| distance(one, place).is_none_or(|distance| distance >= 1.0));
            is_clear && !walls(&obstacles).any(|ends| crosses(place * 0.999, ends))
        };
        prop_assert!(is_free(found));
        let corners = Corners::new(&obstacles, 1.0);
        let length = |place: V| place.norm() + corners.rest(place, target);
        // Ends of random walls do not meet.
        let beyond = |a: V, b: V| b + (b - a) * (1.1 / (b - a).norm());
        let places = walls(&obstacles).flat_map(|[a, b]| [beyond(a, b), beyond(b, a)]);
        // A wall without a length has no place beyond it.
        for place in places.filter(|place| place.is_finite() && is_free(*place)) {
            prop_assert!(length(found) <= length(place) + 1e-9, "{found:?} {place:?}");
        }
    }
}
