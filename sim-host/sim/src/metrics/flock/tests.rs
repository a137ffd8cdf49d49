mod attitude;
mod energy;
mod planar;

use super::*;
use proptest::prelude::*;

fn lattice(d: f64) -> Vec<[f64; 2]> {
    let height = d * 3.0_f64.sqrt() / 2.0;
    (0..9)
        .map(|i| {
            let (column, row) = (f64::from(i % 3), i / 3);
            let shift = if row % 2 == 0 { 0.0 } else { d / 2.0 };
            [column * d + shift, f64::from(row) * height]
        })
        .collect()
}

fn still<const D: usize>(places: &[[f64; D]]) -> Vec<[f64; D]> {
    vec![[0.0; D]; places.len()]
}

fn look<const D: usize>(places: &[[f64; D]], velocities: &[[f64; D]]) -> FlockMeasure {
    let mut meter = FlockMeter::new(7.0, 1.2 * 7.0, Space::OPEN);
    meter.look(places, velocities).expect("robots")
}

#[test]
fn a_triangle_lattice_is_connected_and_without_deviation() {
    let places = lattice(7.0);
    let measure = look(&places, &still(&places));
    // Six along the rows, ten between them.
    assert_eq!((measure.edges, measure.components), (16, 1));
    assert_eq!(measure.connectivity, 1.0);
    assert!(measure.deviation_energy < 1e-28);
    assert_eq!((measure.velocity_mismatch, measure.polarisation), (0.0, 0.0));
}

#[test]
fn two_clusters_are_less_than_connected() {
    let mut places = lattice(7.0);
    places.extend(lattice(7.0).iter().map(|[x, y]| [x + 100.0, *y]));
    places.truncate(14);
    let measure = look(&places, &still(&places));
    assert_eq!((measure.components, measure.largest_component), (2, 9));
    assert_eq!(measure.connectivity, 12.0 / 13.0);
}

#[test]
fn energy_mismatch_radius_and_order_of_three_robots_by_hand() {
    let places = [[0.0, 0.0], [6.0, 0.0], [14.0, 0.0]];
    let velocities = [[1.0, 0.0], [0.0, 2.0], [-1.0, 1.0]];
    let mut meter = FlockMeter::new(7.0, 8.4, Space::OPEN);
    let measure = meter.look(&places, &velocities).expect("robots");
    assert_eq!(meter.edges(), [(0, 1), (1, 2)]);
    let centre = 20.0 / 3.0;
    let expected = [4.0 / 5.0 / 49.0, 14.0 - centre];
    for (got, expected) in [measure.deviation_energy, measure.radius_m].iter().zip(expected) {
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
    }
    // Mean velocity (0, 1): relative (1, -1), (0, 1), (-1, 0); half the squares 1 + 0.5 + 0.5.
    assert!((measure.velocity_mismatch - 2.0 / 3.0).abs() < 1e-12);
    let half = 0.5_f64.sqrt();
    let order = length([1.0 - half, 1.0 + half]) / 3.0;
    assert!((measure.polarisation - order).abs() < 1e-12);
}

#[test]
fn order_is_one_if_aligned_zero_if_opposed_and_ignores_stationary_robots() {
    let same = [[3.0, 4.0, 0.0], [0.3, 0.4, 0.0], [0.0; 3]];
    assert!((polarisation(&same) - 1.0).abs() < 1e-15);
    assert_eq!(polarisation(&[[1.0, 0.0], [-5.0, 0.0]]), 0.0);
    assert_eq!(polarisation::<2>(&[]), 0.0);
}

#[test]
fn one_robot_is_a_flock_and_invalid_input_is_none() {
    let one = look(&[[5.0, 5.0, 5.0]], &[[1.0, 0.0, 0.0]]);
    assert_eq!((one.connectivity, one.components, one.edges), (1.0, 1, 0));
    assert_eq!((one.radius_m, one.deviation_energy, one.polarisation), (0.0, 0.0, 1.0));
    let mut meter = FlockMeter::<2>::new(7.0, 8.4, Space::OPEN);
    assert_eq!(meter.look(&[], &[]), None);
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(meter.look(&[[bad, 0.0]], &[[0.0; 2]]), None);
        assert_eq!(meter.look(&[[0.0; 2]], &[[0.0, bad]]), None);
    }
}

#[test]
fn the_graph_crosses_the_borders_of_a_torus() {
    let space = Space::torus([21.0, 50.0]).expect("sound");
    let mut meter = FlockMeter::new(7.0, 7.5, space);
    let places = [[0.0, 1.0], [14.0, 1.0], [7.0, 49.0]];
    let measure = meter.look(&places, &still(&places)).expect("robots");
    // Distance 7 across the border; the third robot is 7 east and 2 south of the first.
    assert_eq!(measure.components, 1);
    assert_eq!(meter.edges(), [(0, 1), (0, 2), (1, 2)]);
}

fn moment(components: usize, energy: f64, mismatch: f64, radius_m: f64) -> Option<FlockMeasure> {
    Some(FlockMeasure {
        robots: 10,
        edges: 9,
        components,
        largest_component: 11 - components,
        connectivity: 1.0,
        radius_m,
        deviation_energy: energy,
        velocity_mismatch: mismatch,
        polarisation: 1.0,
    })
}

#[test]
fn the_verdict_has_the_start_of_each_condition() {
    let trace = [
        moment(3, 0.1, 0.1, 99.0),
        moment(2, 0.1, 0.1, 9.0),
        moment(2, 0.005, 0.1, 9.0),
        moment(2, 0.004, 0.001, 10.0),
        moment(1, 0.0, 0.0, 9.0),
    ];
    let limits = AlphaLimits::paper(10.0);
    let expected = AlphaVerdict {
        quasi_flock: Some(1),
        cohesive: Some(1),
        evenly_spaced: Some(2),
        of_one_velocity: Some(3),
        alpha_flocking: Some(3),
        strict: Some(4),
    };
    assert_eq!(alpha_flocking(&trace, &limits), expected);
    let broken: Vec<_> = trace.into_iter().chain([moment(5, 0.0, 0.0, 9.0)]).collect();
    let verdict = alpha_flocking(&broken, &limits);
    assert_eq!((verdict.alpha_flocking, verdict.quasi_flock), (None, None));
    assert_eq!(verdict.evenly_spaced, Some(2));
    let lost: Vec<_> = trace.into_iter().chain([None]).collect();
    assert_eq!(alpha_flocking(&lost, &limits).cohesive, None);
    assert_eq!(alpha_flocking(&[], &limits).strict, None);
}

#[test]
fn gaps_are_from_surface_to_surface() {
    let places = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.5], [20.0, 0.0]];
    let radii = [1.0, 1.0, 1.0, 0.5];
    let wall = Obstacle::Segment([[-5.0, -2.0], [5.0, -2.0]]);
    let disc = Obstacle::Disc { centre_m: [20.0, 2.0], radius_m: 1.75 };
    let all = gaps(&places, &radii, &[wall, disc], 5.0, Space::OPEN);
    let expected = Gaps {
        between_robots_m: Some(-0.5),
        overlapping_pairs: 1,
        to_obstacles_m: Some(-0.25),
        robots_in_obstacles: 1,
    };
    assert_eq!(all, expected);
    let touching = gaps(&places[..2], &[1.0, 2.0], &[], 0.0, Space::OPEN);
    assert_eq!((touching.between_robots_m, touching.overlapping_pairs), (Some(0.0), 0));
    let alone = gaps(&places[2..], &radii[2..], &[wall], 1.0, Space::OPEN);
    assert_eq!((alone.between_robots_m, alone.to_obstacles_m), (None, Some(2.5)));
}

#[test]
fn walls_are_finite_and_may_be_points() {
    let wall = Obstacle::Segment([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
    assert_eq!(wall.distance_m([2.0, 0.0, 3.0]), 3.0);
    assert_eq!(wall.distance_m([7.0, 4.0, 0.0]), 5.0);
    let point = Obstacle::Segment([[1.0, 1.0]; 2]);
    assert_eq!(point.distance_m([4.0, 5.0]), 5.0);
}

fn crowd() -> impl Strategy<Value = Vec<([f64; 2], [f64; 2])>> {
    let pair = |range: f64| (-range..range, -range..range).prop_map(|(x, y)| [x, y]);
    proptest::collection::vec((pair(30.0), pair(2.0)), 1..60)
}

proptest! {
    #[test]
    fn connectivity_and_energy_are_those_of_all_pairs(crowd in crowd()) {
        let (places, velocities): (Vec<_>, Vec<_>) = crowd.into_iter().unzip();
        let measure = look(&places, &velocities);
        let n = places.len();
        let gap = |i: usize, j: usize| length(minus(places[i], places[j]));
        let (mut left, mut components) = ((0..n).collect::<Vec<_>>(), 0);
        while let Some(first) = left.pop() {
            components += 1;
            let mut front = vec![first];
            while let Some(at) = front.pop() {
                let (near, far): (Vec<_>, Vec<_>) = left.into_iter().partition(|&j| gap(at, j) <= 8.4);
                front.extend(near);
                left = far;
            }
        }
        prop_assert_eq!(measure.components, components);
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let edges: Vec<f64> = pairs
            .filter(|(i, j)| i != j && gap(*i, *j) <= 8.4)
            .map(|(i, j)| gap(i, j))
            .collect();
        let energy: f64 = edges.iter().map(|length| (length - 7.0) * (length - 7.0)).sum();
        let expected = energy / (edges.len() + 1) as f64 / 49.0;
        prop_assert!((measure.deviation_energy - expected).abs() < 1e-9);
    }

    #[test]
    fn measures_do_not_depend_on_position_and_orientation(
        crowd in crowd(), angle in -3.0_f64..3.0, by in (-50.0_f64..50.0, -50.0_f64..50.0),
    ) {
        let (sin, cos) = libm::sincos(angle);
        let turn = |[x, y]: [f64; 2]| [x * cos - y * sin, x * sin + y * cos];
        let (places, velocities): (Vec<_>, Vec<_>) = crowd.into_iter().unzip();
        // A pair exactly at the range may be an edge or not, depending on rounding.
        let is_clear = |i: usize, j: usize| (length(minus(places[i], places[j])) - 8.4).abs() > 1e-9;
        prop_assume!((0..places.len()).all(|i| (0..i).all(|j| is_clear(i, j))));
        let plain = look(&places, &velocities);
        let moved: Vec<_> = places.iter().map(|&p| turn(p)).map(|[x, y]| [x + by.0, y + by.1]).collect();
        let turned: Vec<_> = velocities.iter().map(|&v| turn(v)).collect();
        let other = look(&moved, &turned);
        prop_assert_eq!((plain.edges, plain.components), (other.edges, other.components));
        prop_assert_eq!(plain.largest_component, other.largest_component);
        for (a, b) in [
            (plain.connectivity, other.connectivity),
            (plain.radius_m, other.radius_m),
            (plain.deviation_energy, other.deviation_energy),
            (plain.velocity_mismatch, other.velocity_mismatch),
            (plain.polarisation, other.polarisation),
        ] {
            prop_assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}
