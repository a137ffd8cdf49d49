use super::*;

const RADIUS_M: f64 = 0.2;

fn between(solids: &[Solid], from: [f64; 2], to: [f64; 2]) -> Option<Barrier> {
    Barriers::new(solids, None, RADIUS_M, 0.0).expect("few").between(from, to, RADIUS_M / 10.0)
}

fn ball(x: f64, y: f64, radius_m: f64) -> Solid {
    Solid::Ball { center_m: [x, y, 0.0], radius_m }
}

fn walls(points: &[[f64; 2]]) -> Vec<Solid> {
    points.windows(2).map(|pair| Solid::Wall([pair[0], pair[1]])).collect()
}

fn ring(gap_m: f64) -> Vec<Solid> {
    walls(&[[1.0, gap_m / 2.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, -gap_m / 2.0]])
}

#[test]
fn a_ring_encloses_those_in_it_unless_its_gap_is_wide_enough() {
    let (inside, outside) = ([0.0, 0.0], [5.0, 3.0]);
    for (gap_m, expected) in [
        (0.0, Some(Barrier::Enclosed)),
        (0.3, Some(Barrier::Enclosed)),
        (0.39, Some(Barrier::Enclosed)),
        (0.41, None),
        (0.6, None),
    ] {
        for [from, to] in [[inside, outside], [outside, inside], [inside, [-5.0, 0.0]], [[0.5, -0.5], [0.0, 9.0]]] {
            assert_eq!(between(&ring(gap_m), from, to), expected, "gap of {gap_m}, {from:?} to {to:?}");
        }
        assert_eq!(between(&ring(gap_m), inside, [0.5, -0.5]), None, "both inside");
        assert_eq!(between(&ring(gap_m), outside, [-5.0, 0.1]), None, "both outside");
    }
}

#[test]
fn rings_of_balls_walls_and_half_planes_are_alike() {
    let on_circle = |count: u32, radius_m: f64| -> Vec<Solid> {
        let angle = |index: u32| f64::from(index) * std::f64::consts::TAU / f64::from(count);
        (0..count).map(|index| ball(3.0 * libm::cos(angle(index)), 3.0 * libm::sin(angle(index)), radius_m)).collect()
    };
    // Twelve balls on a circle of 3 m are 1.553 m apart.
    assert_eq!(between(&on_circle(12, 0.6), [0.0, 0.0], [9.0, 1.0]), Some(Barrier::Enclosed));
    assert_eq!(between(&on_circle(12, 0.57), [0.0, 0.0], [9.0, 1.0]), None);
    let mut mixed = on_circle(12, 0.6);
    mixed.remove(0);
    assert_eq!(between(&mixed, [0.0, 0.0], [9.0, 1.0]), None);
    mixed.push(Solid::Wall([[3.0, -1.2], [3.0, 1.2]]));
    assert_eq!(between(&mixed, [0.0, 0.0], [9.0, 1.0]), Some(Barrier::Enclosed));
    // A wall from one half-plane to another closes the corner between them.
    let half = |normal: [f64; 3]| Solid::Plane { point_m: [0.0; 3], normal };
    let mut corner = vec![half([1.0, 0.0, 0.0]), half([0.0, 1.0, 0.0]), Solid::Wall([[0.1, 4.0], [4.0, 0.1]])];
    assert_eq!(between(&corner, [1.0, 1.0], [5.0, 5.0]), Some(Barrier::Enclosed));
    corner[2] = Solid::Wall([[0.5, 4.0], [4.0, 0.1]]);
    assert_eq!(between(&corner, [1.0, 1.0], [5.0, 5.0]), None);
    // A corridor between two half-planes is closed by a wall across, but not by a shorter one.
    let shaft = |reach: f64| {
        let sides = [([0.0; 3], [0.0, 1.0, 0.0]), ([0.0, 2.0, 0.0], [0.0, -1.0, 0.0])];
        let mut shaft: Vec<_> = sides.map(|(point_m, normal)| Solid::Plane { point_m, normal }).into();
        shaft.push(Solid::Wall([[5.0, 0.0], [5.0, reach]]));
        shaft
    };
    assert_eq!(between(&shaft(1.7), [1.0, 1.0], [9.0, 1.0]), Some(Barrier::Enclosed));
    assert_eq!(between(&shaft(1.5), [1.0, 1.0], [9.0, 1.0]), None);
}

#[test]
fn goals_in_obstacles_are_taken() {
    assert_eq!(between(&[ball(5.0, 0.0, 1.0)], [0.0, 0.0], [5.0, 0.0]), Some(Barrier::GoalTaken));
    assert_eq!(between(&[ball(5.0, 0.0, 1.0)], [0.0, 0.0], [6.15, 0.0]), Some(Barrier::GoalTaken));
    assert_eq!(between(&[ball(5.0, 0.0, 1.0)], [0.0, 0.0], [6.19, 0.0]), None);
    assert_eq!(between(&walls(&[[5.0, -1.0], [5.0, 1.0]]), [0.0, 0.0], [5.1, 0.0]), Some(Barrier::GoalTaken));
    let under = Solid::Plane { point_m: [4.0, 0.0, 0.0], normal: [-1.0, 0.0, 0.0] };
    assert_eq!(between(&[under], [0.0, 0.0], [6.0, 0.0]), Some(Barrier::GoalTaken));
}

#[test]
fn balls_block_only_at_their_height() {
    let over = Solid::Ball { center_m: [5.0, 0.0, 3.0], radius_m: 1.0 };
    assert_eq!(between(&[over], [0.0, 0.0], [5.0, 0.0]), None);
}

#[test]
fn blocked_cells_and_the_sides_of_the_map_enclose() {
    // Cells of 1 m; a wall from the south to row 4 of six.
    let mut land = Terrain::flat(9, 6);
    let between = |land: &Terrain, to: [f64; 2]| {
        Barriers::new(&[], Some(land), RADIUS_M, 0.0).expect("few").between([1.5, 1.5], to, 0.02)
    };
    for y in 0..5 {
        land.set(Cell::new(4, y), 0);
    }
    assert_eq!(between(&land, [7.5, 1.5]), None);
    assert_eq!(between(&land, [4.5, 1.5]), Some(Barrier::GoalTaken));
    assert_eq!(between(&land, [10.5, 1.5]), Some(Barrier::GoalTaken), "off the map");
    land.set(Cell::new(4, 5), 0);
    assert_eq!(between(&land, [7.5, 1.5]), Some(Barrier::Enclosed));
    assert_eq!(between(&land, [2.5, 4.5]), None);
    // Cells that touch at a corner leave no gap.
    land.set(Cell::new(4, 3), 1);
    land.set(Cell::new(5, 3), 0);
    assert_eq!(between(&land, [7.5, 1.5]), Some(Barrier::Enclosed));
    // A way of one cell.
    land.set(Cell::new(5, 3), 1);
    assert_eq!(between(&land, [7.5, 1.5]), None);
}

#[test]
fn nested_rings_and_rings_beside_the_way_do_not_confuse() {
    let shifted = |by: [f64; 2], gap_m: f64| ring(gap_m).into_iter().map(move |solid| solid.moved(by));
    let both: Vec<_> = shifted([0.0, 0.0], 0.0).chain(shifted([6.0, 0.0], 0.0)).collect();
    assert_eq!(between(&both, [0.0, 0.0], [6.0, 0.0]), Some(Barrier::Enclosed));
    assert_eq!(between(&both, [-3.0, 0.0], [3.0, 0.2]), None, "the way crosses a ring twice");
    assert_eq!(between(&both, [-3.0, 0.0], [12.0, 0.0]), None, "and two rings");
    let around = walls(&[[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0], [-3.0, -3.0]]);
    let nested: Vec<_> = shifted([0.0, 0.0], 0.0).chain(around).collect();
    assert_eq!(between(&nested, [0.0, 0.0], [9.0, 0.0]), Some(Barrier::Enclosed));
    assert_eq!(between(&nested, [2.0, 0.0], [-2.0, 0.3]), None, "between the rings");
}
