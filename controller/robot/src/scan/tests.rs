use super::*;
use proptest::prelude::*;
use staya_controller::grid::{BLOCKED, Cell, GridFrame};
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::RobotId;
use staya_controller::scalar::Q16;
use staya_controller::wire::{Beacon, ProtocolId};
use std::vec::Vec;

const FRAME: GridFrame<f64> = GridFrame { origin_m: Vec2::new(-10.0, 5.0), cell_m: 0.5 };
const NOW: Instant = Instant::from_micros(u32::MAX - 500_000);

fn scan(first_rad: f64, step_rad: f64, ranges_m: &[f64]) -> Scan<'_, f64> {
    Scan { first_rad, step_rad, ranges_m, min_m: 0.05, max_m: 4.0, mount_m: Vec2::ZERO }
}

fn middle() -> Vec2<f64> {
    FRAME.center(Cell::new(10, 10))
}

fn map() -> LocalMap {
    LocalMap::new(MapParams::default(), Cell::new(10, 10))
}

fn look(map: &mut LocalMap, heading: f64, scan: &Scan<'_, f64>) {
    assert!(map.observe(&FRAME, middle(), heading, scan, NOW, |_| false));
}

fn blocked<const SIDE: usize>(map: &LocalMap<SIDE>) -> Vec<(i16, i16)> {
    let window = map.window().unwrap();
    let cells = window.cells().iter().zip(0i16..);
    let blocked = cells.filter(|(cell, _)| **cell == BLOCKED);
    let side = SIDE as i16;
    blocked.map(|(_, at)| (at % side - side / 2, at / side - side / 2)).collect()
}

#[test]
fn the_second_hit_blocks_a_cell_and_the_beam_clears_it_when_it_is_gone() {
    let mut map = map();
    let (wall, open) = ([1.5], [f64::INFINITY]);
    look(&mut map, 0.0, &scan(0.0, 0.0, &wall));
    assert!(blocked(&map).is_empty(), "one range may be wrong");
    look(&mut map, 0.0, &scan(0.0, 0.0, &wall));
    assert_eq!(blocked(&map), [(3, 0)]);
    look(&mut map, 0.0, &scan(0.0, 0.0, &open));
    assert!(blocked(&map).is_empty());
    for _ in 0..50 {
        look(&mut map, 0.0, &scan(0.0, 0.0, &wall));
    }
    for gone in 0..10 {
        assert_eq!(blocked(&map), [(3, 0)], "{gone}");
        look(&mut map, 0.0, &scan(0.0, 0.0, &open));
    }
    assert!(blocked(&map).is_empty());
}

#[test]
fn bearings_start_at_the_nose_and_wrap() {
    let quarter = core::f64::consts::FRAC_PI_2;
    let cases = [
        (0.0, quarter, (0, 3)),
        (quarter, quarter, (-3, 0)),
        (3.0 * quarter, quarter, (3, 0)),
        (-quarter, -4.0 * quarter, (0, -3)),
        (5.0 * quarter, 0.0, (0, 3)),
    ];
    for (heading, bearing, cell) in cases {
        let mut map = map();
        for _ in 0..2 {
            look(&mut map, heading, &scan(0.0, bearing, &[f64::NAN, 1.5]));
        }
        assert_eq!(blocked(&map), [cell], "{heading} {bearing}");
    }
}

#[test]
fn invalid_ranges_change_nothing() {
    let mut map = map();
    for _ in 0..5 {
        look(&mut map, 0.0, &scan(0.0, 0.0, &[1.5]));
    }
    for range in [f64::NAN, 0.0, -1.0, 0.04, f64::NEG_INFINITY] {
        for _ in 0..20 {
            look(&mut map, 0.0, &scan(0.0, 0.0, &[range]));
        }
        assert_eq!(blocked(&map), [(3, 0)], "{range}");
    }
    let nowhere = Vec2::new(f64::NAN, 0.0);
    let open = [f64::INFINITY; 9];
    let scan = scan(0.0, 0.0, &open);
    assert!(!map.observe(&FRAME, nowhere, 0.0, &scan, NOW, |_| false));
    for _ in 0..20 {
        look(&mut map, f64::NAN, &scan);
    }
    assert_eq!(blocked(&map), [(3, 0)]);
}

#[test]
fn a_hit_wins_over_the_beams_that_cross_its_cell() {
    let mut map = map();
    for _ in 0..2 {
        look(&mut map, 0.0, &scan(0.0, 0.01, &[1.5, 3.0]));
        look(&mut map, 0.0, &scan(0.01, -0.01, &[3.0, 1.5]));
    }
    assert!(blocked(&map).contains(&(3, 0)));
}

#[test]
fn other_robots_do_not_block_cells() {
    let mut map = map();
    let is_robot = |place: Vec2<f64>| (place - Vec2::new(1.5, 0.0)).norm() < 0.2;
    for _ in 0..9 {
        let scan = scan(0.0, core::f64::consts::PI, &[1.5, 1.5]);
        assert!(map.observe(&FRAME, middle(), 0.0, &scan, NOW, is_robot));
    }
    assert_eq!(blocked(&map), [(-3, 0)]);
}

#[test]
fn cells_stay_in_place_when_the_robot_moves() {
    let mut map = map();
    for _ in 0..2 {
        look(&mut map, 0.0, &scan(0.0, core::f64::consts::PI, &[1.5, 2.4]));
    }
    assert_eq!(blocked(&map), [(-5, 0), (3, 0)]);
    map.follow(Cell::new(11, 9));
    assert_eq!(blocked(&map), [(2, 1)], "what left the square is forgotten");
    map.follow(Cell::new(10, 10));
    assert_eq!(blocked(&map), [(3, 0)]);
    let window = map.window().unwrap();
    assert_eq!(window.get(Cell::new(13, 10)), Some(BLOCKED));
    map.follow(Cell::new(i16::MIN, i16::MAX));
    assert!(blocked(&map).is_empty() && map.window().is_some());
}

#[test]
fn unseen_evidence_fades_even_if_the_clock_wraps() {
    let mut map = map();
    for _ in 0..9 {
        look(&mut map, 0.0, &scan(0.0, 0.0, &[1.5]));
    }
    let wait = |map: &mut LocalMap, ms: i32| {
        let now = NOW + Duration::from_millis(ms);
        assert!(map.observe(&FRAME, middle(), 0.0, &scan(0.0, 0.0, &[]), now, |_| false));
    };
    wait(&mut map, 9_999);
    assert_eq!(blocked(&map), [(3, 0)]);
    wait(&mut map, 10_000);
    assert!(blocked(&map).is_empty(), "15 less 10 is below 6");
    for _ in 0..9 {
        look(&mut map, 0.0, &scan(0.0, 0.0, &[1.5]));
    }
    wait(&mut map, 2_000_000);
    assert!(blocked(&map).is_empty());
}

#[test]
fn ground_is_set_by_other_sensors_and_ranges_do_not_change_it() {
    let mut map = map();
    assert!(map.set_ground(Cell::new(12, 10), BLOCKED));
    assert!(map.set_ground(Cell::new(10, 12), 7));
    assert!(!map.set_ground(Cell::new(99, 10), 7));
    assert!(map.set_ground(Cell::new(10, 10), BLOCKED));
    let open = [f64::INFINITY; 4];
    for _ in 0..20 {
        look(&mut map, 0.0, &scan(0.0, core::f64::consts::FRAC_PI_2, &open));
    }
    assert_eq!(blocked(&map), [(2, 0)], "a cliff; the own cell is passable");
    assert_eq!(map.window().unwrap().get(Cell::new(10, 12)), Some(7));
}

#[test]
fn the_sensor_may_be_mounted_off_centre() {
    let mut map = map();
    let mut scan = scan(0.0, 0.0, &[1.0]);
    scan.mount_m = Vec2::new(0.5, 0.5);
    for _ in 0..2 {
        look(&mut map, core::f64::consts::FRAC_PI_2, &scan);
    }
    // The nose is north: half a metre north and west of the middle, then a metre north.
    assert_eq!(blocked(&map), [(-1, 3)]);
}

#[test]
fn other_sides_and_scalars_work_too() {
    let frame = GridFrame { origin_m: Vec2::new(Q16::ZERO, Q16::ZERO), cell_m: Q16::from_ratio(1, 10) };
    let ranges = [Q16::from_ratio(3, 10)];
    let scan = Scan {
        first_rad: Q16::ZERO,
        step_rad: Q16::ZERO,
        ranges_m: &ranges,
        min_m: Q16::ZERO,
        max_m: Q16::ONE,
        mount_m: Vec2::ZERO,
    };
    let place = Vec2::new(Q16::from_ratio(5, 100), Q16::from_ratio(5, 100));
    let mut map = LocalMap::<7>::new(MapParams::default(), Cell::new(0, 0));
    for _ in 0..2 {
        assert!(map.observe(&frame, place, Q16::ZERO, &scan, NOW, |_| false));
    }
    assert_eq!(blocked(&map), [(3, 0)]);
    let mut one = LocalMap::<1>::new(MapParams::default(), Cell::new(0, 0));
    assert!(one.observe(&frame, place, Q16::ZERO, &scan, NOW, |_| false));
    assert_eq!(one.window().unwrap().cells(), [1]);
}

const OUTLINE: OutlineParams<f64> = OutlineParams { tolerance_m: 0.02, gap_m: 0.3, point_m: 0.03 };

/// Walls at x = 2, y = 1, x = -2, y = -1.
fn room<const N: usize>() -> [f64; N] {
    core::array::from_fn(|beam| {
        let (sin, cos) = Scalar::sin_cos(core::f64::consts::TAU * beam as f64 / N as f64);
        (2.0 / cos.abs()).min(1.0 / sin.abs())
    })
}

#[test]
fn a_room_becomes_its_walls_nearest_first() {
    let ranges = room::<360>();
    let scan = scan(0.0, core::f64::consts::TAU / 360.0, &ranges);
    let walls = outline::<_, 16>(&scan, 0.0, &OUTLINE, |_| false);
    // The scan begins in the middle of the east wall; each corner may add a short one.
    assert!((5..=9).contains(&walls.len()), "{walls:?}");
    let distances: Vec<f64> = walls.iter().map(|w| w.nearest_point().unwrap().1).collect();
    assert!(distances.is_sorted());
    assert!((distances[0] - 1.0).abs() < 0.03 && (distances[1] - 1.0).abs() < 0.03);
    let nearest = outline::<_, 2>(&scan, 0.0, &OUTLINE, |_| false);
    assert_eq!(nearest.as_slice(), &walls[..2], "the farthest go first");
    assert!(outline::<_, 0>(&scan, 0.0, &OUTLINE, |_| false).is_empty());
}

#[test]
fn a_gap_separates_two_walls_and_a_single_hit_is_a_ball() {
    let ranges = [1.0, 1.0, 1.0, 4.0, f64::NAN, 1.0];
    let scan = scan(-0.2, 0.1, &ranges);
    let found = outline::<_, 8>(&scan, 0.0, &OUTLINE, |_| false);
    assert_eq!(found.len(), 2);
    let balls = found.iter().filter(|o| matches!(o, Obstacle::Ball { radius_m, .. } if *radius_m == 0.03));
    assert_eq!(balls.count(), 1);
    let is_robot = |place: Vec2<f64>| place.y > 0.2;
    assert_eq!(outline::<_, 8>(&scan, 0.0, &OUTLINE, is_robot).len(), 1);
    assert!(outline::<_, 8>(&scan, f64::NAN, &OUTLINE, |_| false).is_empty());
}

#[test]
fn a_wall_includes_its_farthest_point() {
    // Almost along a wall: the second hit lies 25 cm behind the first, the third 15 cm before it.
    let ranges = [1.0, 1.25, 1.1];
    let scan = scan(0.0, 0.0035, &ranges);
    let found = outline::<_, 8>(&scan, 0.0, &OUTLINE, |_| false);
    let farthest = found.iter().filter_map(|obstacle| match obstacle {
        Obstacle::Wall(ends) => Some(ends[0].x.max(ends[1].x)),
        _ => None,
    });
    let farthest = farthest.fold(0.0, f64::max);
    assert!(farthest > 1.24, "{found:?}");
}

#[test]
fn neighbours_are_extrapolated_with_the_radius_they_sent() {
    let beacon =
        Beacon { position_mm: [3_000, 1_000, 0], velocity_mmps: [500, 0, 0], radius_mm: 200, ..Beacon::default() };
    let neighbor = Neighbor::<f32>::from_beacon(RobotId(2), &beacon, ProtocolId::NONE, NOW);
    let own = Position::from_mm([1_000, 1_000, 0]);
    let seen = |ms: i32, x: f32| {
        let now = NOW + Duration::from_millis(ms);
        let longest = Duration::from_millis(400);
        is_neighbor(&[neighbor], own, now, longest, Vec2::new(x, 0.0), 0.05)
    };
    assert!(seen(0, 2.24) && seen(0, 1.76) && !seen(0, 2.26) && !seen(0, 1.74));
    assert!(seen(200, 2.34) && !seen(200, 1.84));
    assert!(seen(9_000, 2.44) && !seen(9_000, 2.46), "not for ever");
    assert!(!is_neighbor::<f32, ()>(&[], own, NOW, Duration::ZERO, Vec2::ZERO, 9.0));
}

fn misses(found: &[Obstacle<f64>], scan: &Scan<'_, f64>, heading: f64) -> f64 {
    let hits = scan.rays(heading).flatten().filter(|ray| ray.is_hit);
    let gap = |obstacle: &Obstacle<f64>, end: Vec2<f64>| match *obstacle {
        Obstacle::Wall([a, b]) => {
            let wall = Obstacle::Wall([a - end, b - end]);
            wall.nearest_point().unwrap().1
        }
        Obstacle::Ball { center_m, .. } => (center_m.xy() - end).norm(),
        Obstacle::Plane { .. } => f64::MAX,
    };
    let missed = hits.map(|ray| {
        let gaps = found.iter().map(|obstacle| gap(obstacle, ray.end_m()));
        gaps.fold(f64::MAX, f64::min)
    });
    missed.fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn walls_miss_no_hit_by_more_than_the_tolerance(ranges in proptest::collection::vec(0.06f64..5.0, 1..60), wobble in 0.0f64..2.0, heading in -4.0f64..4.0) {
        let room = room::<60>();
        let ranges: Vec<f64> = ranges.iter().zip(room).map(|(noise, room)| room + (noise - 2.5) * wobble * wobble * wobble / 50.0).collect();
        let scan = scan(0.1, core::f64::consts::TAU / 60.0, &ranges);
        let found = outline::<_, 64>(&scan, heading, &OUTLINE, |_| false);
        prop_assert!(misses(&found, &scan, heading) <= OUTLINE.tolerance_m * 1.001);
    }

    #[test]
    fn walls_of_fine_beams_miss_no_hit_either(ranges in proptest::collection::vec(1.0f64..1.4, 1..40), step in 0.001f64..0.02) {
        let scan = scan(0.1, step, &ranges);
        let found = outline::<_, 64>(&scan, 0.0, &OUTLINE, |_| false);
        prop_assert!(misses(&found, &scan, 0.0) <= OUTLINE.tolerance_m * 1.001);
    }

    #[test]
    fn only_cells_with_a_hit_are_ever_blocked(ranges in proptest::collection::vec(any::<f32>(), 0..40), heading: f32, spot in any::<[i8; 2]>()) {
        let frame = GridFrame { origin_m: Vec2::new(0.0f32, 0.0), cell_m: 0.25 };
        let place = Vec2::new(f32::from(spot[0]) / 16.0, f32::from(spot[1]) / 16.0);
        let scan = Scan { first_rad: -1.0, step_rad: 0.1, ranges_m: &ranges, min_m: 0.1, max_m: 3.0f32, mount_m: Vec2::ZERO };
        let mut map = LocalMap::<11>::new(MapParams::default(), Cell::default());
        for _ in 0..3 {
            prop_assert!(map.observe(&frame, place, heading, &scan, NOW, |_| false));
        }
        let own = frame.cell(place).unwrap();
        let hits: Vec<Vec2<f32>> = scan.rays(heading).flatten().filter(|ray| ray.is_hit).map(|ray| ray.end_m() + place).collect();
        for (x, y) in blocked(&map) {
            let center = frame.center(own + Cell::new(x, y));
            let is_near = |hit: &Vec2<f32>| (hit.x - center.x).abs() <= 0.126 && (hit.y - center.y).abs() <= 0.126;
            prop_assert!(hits.iter().any(is_near), "{x} {y}");
        }
        let passable = map.window().unwrap().is_passable(own);
        prop_assert!(passable);
    }
}
