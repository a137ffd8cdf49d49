//! Doors and passages before a robot of radius 1 m in the origin.

use super::*;
use crate::geom::Vec3;
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec2<f64>;

fn v(x: f64, y: f64) -> V {
    V::new(x, y)
}

const WANTED: Wanted<f64> =
    Wanted { radius_m: 1.0, least_m: 2.0, most_m: 9.0, deepest_m: 8.0, narrow_m: 4.0, past_m: 2.0 };

fn wall(ax: f64, ay: f64, bx: f64, by: f64) -> Obstacle<f64> {
    Obstacle::Wall([v(ax, ay), v(bx, by)])
}

fn ball(x: f64, y: f64, radius_m: f64) -> Obstacle<f64> {
    Obstacle::Ball { center_m: Vec3::new(x, y, 0.0), radius_m }
}

/// A wall at `x` with a door around `y`.
fn door_at(x: f64, y: f64, half: f64) -> Vec<Obstacle<f64>> {
    Vec::from([wall(x, y + half, x, 40.0), wall(x, y - half, x, -40.0)])
}

fn door(x: f64, half: f64) -> Vec<Obstacle<f64>> {
    door_at(x, 0.0, half)
}

fn with(mut walls: Vec<Obstacle<f64>>, more: &[Obstacle<f64>]) -> Vec<Obstacle<f64>> {
    walls.extend_from_slice(more);
    walls
}

fn find(obstacles: &[Obstacle<f64>], x: f64, y: f64) -> Option<Gap<f64>> {
    gap_on_way(obstacles, v(x, y), &WANTED)
}

fn gap(x: f64, y: f64, half: f64, depth: f64, is_only_way: bool) -> Option<Gap<f64>> {
    Some(Gap { middle: v(x, y), ahead: v(1.0, 0.0), half, depth, is_only_way })
}

#[test]
fn a_door_counts_before_it_in_it_and_just_behind_it() {
    assert_eq!(find(&door(5.0, 1.5), 9.0, 0.0), gap(5.0, 0.0, 1.5, 0.0, false));
    assert_eq!(find(&door(5.0, 1.5), 9.0, 6.0), gap(5.0, 0.0, 1.5, 0.0, true), "a wall blocks the straight path");
    assert_eq!(find(&door(5.0, 1.5), -9.0, 0.0), None, "it leads away from the goal");
    assert_eq!(find(&door(5.0, 1.5), 5.0, 7.0), None, "the goal is in its wall");
    assert_eq!(find(&door(5.0, 1.5), 4.0, 3.0), None, "the goal is before it");
    let west = Gap { ahead: v(-1.0, 0.0), ..gap(-5.0, 0.0, 1.5, 0.0, false).unwrap() };
    assert_eq!(find(&door(-5.0, 1.5), -9.0, 0.0), Some(west));
    assert_eq!(find(&door(0.0, 1.5), 9.0, 9.0), gap(0.0, 0.0, 1.5, 0.0, false));
    for (x, y, counts) in [
        (-1.5, 0.0, true),
        (-2.0, 0.0, true),
        (-2.01, 0.0, false),
        (-1.5, 1.5, true),
        (-1.5, 1.75, false),
        (-1.5, -1.75, false),
        (0.0, 1.75, true),
    ] {
        assert_eq!(find(&door_at(x, y, 1.5), 9.0, 0.0), gap(x, y, 1.5, 0.0, false).filter(|_| counts), "{x} {y}");
    }
    // Behind a door but before a wall, the robot need not have come through the door.
    let across = [wall(5.0, -9.0, 5.0, 9.0)];
    assert_eq!(find(&with(door(-1.5, 1.5), &across), 9.0, 0.0), None);
    assert_eq!(find(&with(door(0.0, 1.5), &across), 9.0, 0.0), gap(0.0, 0.0, 1.5, 0.0, false));
    assert_eq!(find(&[wall(5.0, 1.5, 5.0, 40.0)], 9.0, 0.0), None, "one wall is not a gap");
    assert_eq!(find(&[], 9.0, 0.0), None);
}

#[test]
fn gaps_have_a_least_and_a_greatest_width() {
    for (half, is_gap) in [(0.99, false), (1.0, true), (4.5, true), (4.51, false)] {
        assert_eq!(find(&door(5.0, half), 9.0, 0.0).is_some(), is_gap, "{half}");
    }
}

#[test]
fn a_gap_with_something_between_its_posts_does_not_count() {
    for (solid, is_gap) in [
        (ball(5.0, 0.3, 0.2), false),
        (ball(6.9, 0.0, 0.4), false),
        (ball(7.0, 0.0, 0.4), true),
        (ball(5.0, 1.9, 0.4), true),
        (ball(5.0, -1.9, 0.4), true),
        (ball(5.0, 1.6, 0.4), false),
        (wall(6.1, -1.1, 6.1, 1.1), false),
        (wall(6.6, -1.1, 6.6, 1.1), true),
        (wall(5.0, 1.5, 8.0, 9.0), true),
        (Obstacle::Plane { normal: Vec3::new(-1.0, 0.0, 0.0), distance_m: 5.0 }, true),
    ] {
        // Gaps between the additional wall and the posts are other ones.
        let found = find(&with(door(5.0, 1.5), &[solid]), 9.0, 0.0);
        let is_door = found.is_some_and(|gap| gap.middle == v(5.0, 0.0) && gap.half == 1.5);
        assert_eq!(is_door, is_gap, "{solid:?} {found:?}");
    }
}

#[test]
fn a_gap_counts_only_if_both_posts_are_seen() {
    let hides = |y: f64| find(&with(door(5.0, 1.5), &[wall(2.0, y, 2.0, y - 0.4)]), 9.0, 0.0);
    let is_door = |found: Option<Gap<f64>>| found.is_some_and(|gap| gap.middle == v(5.0, 0.0));
    // The lines of sight to the posts pass x = 2 at y = 0.6 and y = -0.6.
    assert!(!is_door(hides(0.8)) && !is_door(hides(-0.4)));
    assert!(is_door(hides(0.2)) && is_door(hides(1.2)) && is_door(hides(-0.8)));
}

#[test]
fn of_two_doors_the_one_on_the_shorter_way_counts() {
    let two = |low: f64, high: f64| {
        [wall(5.0, high + 1.5, 5.0, 40.0), wall(5.0, high - 1.5, 5.0, low + 1.5), wall(5.0, low - 1.5, 5.0, -40.0)]
    };
    let y = |low, high, target| find(&two(low, high), 9.0, target).map(|gap| gap.middle.y);
    assert_eq!([y(-6.0, 5.0, 0.0), y(-5.0, 6.0, 0.0)], [Some(5.0), Some(-5.0)]);
    assert_eq!([y(-6.0, 5.0, -6.0), y(-5.0, 6.0, 7.0)], [Some(-6.0), Some(6.0)]);
    let mut reversed = two(-6.0, 5.0);
    reversed.reverse();
    assert_eq!(find(&reversed, 9.0, 0.0).map(|gap| gap.middle.y), Some(5.0));
}

/// A door at 5 m, and the other end of a passage `deep` metres behind it, `aside` and turned by a
/// slope.
fn passage(half: f64, deep: f64, aside: f64, slope: f64, is_walled: bool) -> Option<Gap<f64>> {
    let across = v(slope, 1.0) * (1.0 / v(slope, 1.0).norm());
    let middle = v(5.0 + deep, aside);
    let (a, b) = (middle + across * half, middle - across * half);
    let (c, d) = (middle + across * 40.0, middle - across * 40.0);
    let mut walls = door(5.0, half);
    walls.extend([wall(a.x, a.y, c.x, c.y), wall(b.x, b.y, d.x, d.y)]);
    if is_walled {
        walls.extend([wall(5.0, half, a.x, a.y), wall(5.0, -half, b.x, b.y)]);
    }
    find(&walls, 40.0, 0.0)
}

#[test]
fn both_ends_of_a_passage_are_one_gap() {
    let joined = |deep: f64, half: f64| gap(5.0 + deep / 2.0, 0.0, half, deep / 2.0, false);
    let apart = |half: f64| gap(5.0, 0.0, half, 0.0, false);
    assert_eq!(passage(1.5, 2.0, 0.0, 0.0, true), joined(2.0, 1.5));
    // Up to the longest passage, ends belong together without walls between them.
    assert_eq!(passage(1.5, 8.0, 0.0, 0.0, false), joined(8.0, 1.5));
    assert_eq!(passage(1.5, 8.01, 0.0, 0.0, false), apart(1.5));
    // Narrow passages may be longer.
    assert_eq!(passage(1.5, 9.0, 0.0, 0.0, true), joined(9.0, 1.5));
    assert_eq!(passage(1.875, 9.0, 0.0, 0.0, true), joined(9.0, 1.875));
    assert_eq!(passage(2.0, 9.0, 0.0, 0.0, true), apart(2.0));
    // In line, up to half of half the width, and in one direction.
    for (aside, slope, is_joined) in [
        (0.7, 0.0, true),
        (-0.7, 0.0, true),
        (0.8, 0.0, false),
        (-0.8, 0.0, false),
        (0.0, 0.13, true),
        (0.0, 0.2, false),
    ] {
        let depth = passage(1.5, 4.0, aside, slope, false).map(|gap| gap.depth);
        assert_eq!(depth, Some(if is_joined { 2.0 } else { 0.0 }), "{aside} {slope}");
    }
}

#[test]
fn a_long_passage_needs_walls_on_both_sides() {
    let ends = || with(door(5.0, 1.5), &door(15.0, 1.5));
    let (left, right) = (wall(5.0, 1.5, 15.0, 1.5), wall(5.0, -1.5, 15.0, -1.5));
    for (walls, depth) in [(&[left, right][..], 5.0), (&[left], 0.0), (&[right], 0.0), (&[], 0.0)] {
        let found = find(&with(ends(), walls), 40.0, 0.0);
        assert_eq!(found.map(|gap| gap.depth), Some(depth), "{walls:?}");
    }
}

#[test]
fn the_depth_of_a_passage_counts_from_its_ends() {
    for (x, place) in [(2.0, -3.0), (5.0, 0.0), (6.0, 0.0), (7.0, 0.0), (8.5, 1.5)] {
        let passage = Gap { depth: 1.0, ..gap(6.0, 0.5, 1.5, 0.0, false).unwrap() };
        assert_eq!(passage.place(v(x, 0.2)), v(place, 0.3), "{x}");
    }
    let passage = Gap { depth: 1.0, ..gap(6.0, 0.5, 1.5, 0.0, false).unwrap() };
    assert_eq!(passage.way(v(0.0, 0.5)), v(5.0, 0.0), "in the gap counts as before it");
    assert_eq!(passage.way(v(2.0, -1.0)), v(9.0, 1.5));
}

#[test]
fn the_gap_between_two_ends_leads_to_the_target() {
    let between = |ax, ay, bx, by, x, y| Gap::between(v(ax, ay), v(bx, by), v(x, y));
    let east = between(3.0, 1.0, 3.0, -2.0, 9.0, 5.0).unwrap();
    assert_eq!((east.middle, east.ahead, east.half, east.depth), (v(3.0, -0.5), v(1.0, 0.0), 1.5, 0.0));
    assert_eq!(between(3.0, 1.0, 3.0, -2.0, 2.0, 5.0).map(|gap| gap.ahead), Some(v(-1.0, 0.0)));
    assert_eq!(between(3.0, -2.0, 3.0, 1.0, 9.0, 5.0), Some(east));
    assert_eq!(between(3.0, 1.0, 3.0, -2.0, 3.0, 9.0), None, "in line with both ends");
    assert_eq!(between(3.0, 1.0, 3.0, 1.0, 9.0, 5.0), None, "one point");
}

#[test]
fn a_corridor_that_this_one_crosses_is_not_part_of_it() {
    // The robot comes from the south, in a corridor 6 m wide, to one of 3 m that leads east.
    let crossing = [
        wall(3.0, 3.5, 20.0, 3.5),
        wall(3.0, 6.5, 20.0, 6.5),
        wall(-3.0, 3.5, -20.0, 3.5),
        wall(-3.0, 6.5, -20.0, 6.5),
    ];
    assert_eq!(find(&crossing, 30.0, 6.0), gap(11.5, 5.0, 1.5, 8.5, true));
    // In the corridor of 3 m, all of it is one passage.
    let inside: Vec<_> = mapped(&crossing, |at| at - v(0.0, 5.0), 1.0);
    assert_eq!(find(&inside, 30.0, 0.0), gap(0.0, 0.0, 1.5, 20.0, false));
}

prop_compose! {
    fn scenes()(
        doors in proptest::collection::vec((1.0..9.0_f64, -2.0..2.0_f64, 0.9..3.0_f64, -0.6..0.6_f64), 1..3),
        solid in (1.0..9.0_f64, -6.0..6.0_f64, 0.1..0.6_f64),
        target in (9.0..14.0_f64, -6.0..6.0_f64),
    ) -> (Vec<Obstacle<f64>>, V) {
        let mut obstacles = Vec::new();
        for (x, y, half, slope) in doors {
            let across = v(slope, 1.0);
            let at = |along: f64| v(x, y) + across * along;
            obstacles.extend([Obstacle::Wall([at(half), at(9.0)]), Obstacle::Wall([at(-half), at(-9.0)])]);
        }
        obstacles.push(ball(solid.0, solid.1, solid.2));
        (obstacles, v(target.0, target.1))
    }
}

/// Applies a map of vectors that multiplies lengths by `scale`.
fn mapped(obstacles: &[Obstacle<f64>], map: impl Fn(V) -> V, scale: f64) -> Vec<Obstacle<f64>> {
    let change = |obstacle: &Obstacle<f64>| match *obstacle {
        Obstacle::Wall(ends) => Obstacle::Wall(ends.map(&map)),
        Obstacle::Ball { center_m, radius_m } => {
            Obstacle::Ball { center_m: map(center_m.xy()).extend(0.0), radius_m: radius_m * scale }
        }
        other => other,
    };
    obstacles.iter().map(change).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn turned_mirrored_and_scaled_walls_give_turned_mirrored_and_scaled_gaps((obstacles, target) in scenes()) {
        let plain = gap_on_way(&obstacles, target, &WANTED);
        let (turn, flip) = (|at: V| v(-at.y, at.x), |at: V| v(at.x, -at.y));
        for (map, scale) in [(&turn as &dyn Fn(V) -> V, 1.0), (&flip, 1.0), (&|at: V| at * 8.0, 8.0), (&|at: V| at * 0.25, 0.25)] {
            let wanted = Wanted {
                radius_m: scale,
                least_m: WANTED.least_m * scale,
                most_m: WANTED.most_m * scale,
                deepest_m: WANTED.deepest_m * scale,
                narrow_m: WANTED.narrow_m * scale,
                past_m: WANTED.past_m * scale,
            };
            let found = gap_on_way(&mapped(&obstacles, map, scale), map(target), &wanted);
            let Some((plain, found)) = plain.zip(found) else {
                prop_assert_eq!(plain, found);
                continue;
            };
            prop_assert!((found.middle - map(plain.middle)).norm() < 1e-9 * scale, "{plain:?} {found:?}");
            prop_assert!((found.ahead * scale - map(plain.ahead)).norm() < 1e-9 * scale, "{plain:?} {found:?}");
            let off = [found.half - plain.half * scale, found.depth - plain.depth * scale];
            prop_assert!(off.iter().all(|off| off.abs() < 1e-9 * scale), "{plain:?} {found:?}");
            prop_assert_eq!(found.is_only_way, plain.is_only_way);
        }
    }

    #[test]
    fn the_order_of_walls_and_their_ends_does_not_matter((obstacles, target) in scenes()) {
        let plain = gap_on_way(&obstacles, target, &WANTED).map(|gap| (gap.middle, gap.half));
        let turned: Vec<_> = obstacles
            .iter()
            .rev()
            .map(|obstacle| match *obstacle {
                Obstacle::Wall([a, b]) => Obstacle::Wall([b, a]),
                other => other,
            })
            .collect();
        let found = gap_on_way(&turned, target, &WANTED).map(|gap| (gap.middle, gap.half));
        prop_assert_eq!(found.is_some(), plain.is_some());
        if let Some((found, plain)) = found.zip(plain) {
            prop_assert!((found.0 - plain.0).norm() < 1e-9 && (found.1 - plain.1).abs() < 1e-9, "{found:?} {plain:?}");
        }
    }

    #[test]
    fn place_and_way_are_inverse(
        middle in (-9.0..9.0_f64, -9.0..9.0_f64), angle in -3.0..3.0_f64, depth in 0.0..4.0_f64,
        place in (0.01..9.0_f64, -9.0..9.0_f64), is_before: bool,
    ) {
        let (sin, cos) = Scalar::sin_cos(angle);
        let gap = Gap { middle: v(middle.0, middle.1), ahead: v(cos, sin), half: 1.5, depth, is_only_way: false };
        let place = v(if is_before { -place.0 } else { place.0 }, place.1);
        prop_assert!((gap.place(gap.way(place)) - place).norm() < 1e-9);
        let right = gap.middle + v(sin, -cos);
        prop_assert!((gap.place(right) - v(0.0, 1.0)).norm() < 1e-9, "to the right of the axis");
    }
}

#[test]
fn a_point_as_near_to_the_middle_as_the_posts_is_beside_one_of_them() {
    let gap = gap(0.0, 0.0, 1.0, 0.0, false).unwrap();
    for (degrees, is_clear) in [(0, true), (25, true), (40, false), (70, false), (90, false)] {
        for (y, x) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0)] {
            let (sin, cos) = Scalar::sin_cos(f64::from(degrees).to_radians());
            // Its border is 1.02 m away.
            let other = ball(1.03 * sin * x, 1.03 * cos * y, 0.01);
            assert_eq!(gap.is_clear(&[other]), is_clear, "{degrees} degrees, {x} {y}");
        }
    }
    assert!(gap.is_clear(&[ball(1.07, 0.0, 0.01)]), "farther away than the posts");
    assert!(!gap.is_clear(&[ball(0.9, 0.0, 0.01)]), "nearer than the posts");
}
