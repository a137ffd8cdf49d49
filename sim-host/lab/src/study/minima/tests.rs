use super::*;
use proptest::prelude::*;
use staya_controller::body::Body;
use staya_controller::geom::Vec3;
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, Reference, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::scenario::Source;
use std::path::Path;

fn run(fields: &str, seed: u64) -> Result<Measured, String> {
    let source = Source::new(Path::new("minima.toml"), fields).unwrap();
    let measures = ["returned".to_owned()];
    let given = Given { source, measures: &measures, seed };
    Minima.read(&given).map_err(|error| error.to_string())?(&|_| true)
}

fn value(measured: &Measured, name: &str) -> f64 {
    measured.values[name].unwrap_or_else(|| panic!("{name}: {measured:?}"))
}

#[test]
fn eigenvalues_of_known_matrices() {
    let of = |matrix: &[&[f64]]| eigenvalues(matrix.iter().map(|row| row.to_vec()).collect());
    assert_eq!(of(&[]), Vec::<f64>::new());
    assert_eq!(of(&[&[4.0, 0.0], &[0.0, -1.0]]), [-1.0, 4.0]);
    let found = of(&[&[2.0, -1.0, 0.0], &[-1.0, 2.0, -1.0], &[0.0, -1.0, 2.0]]);
    let root = 2.0_f64.sqrt();
    for (found, expected) in found.iter().zip([2.0 - root, 2.0, 2.0 + root]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// The gradient is the force of the controller's algorithm 2 on robots at rest.
#[test]
fn the_gradient_is_the_laws_own_force() {
    let lambda = 0.02;
    let potential = Potential::new(lambda).unwrap();
    let mut params = LatticeParams { algorithm: Algorithm::Two, ..LatticeParams::<f64>::new(7.0) };
    params.alpha = Gain { position: 1.0, velocity: 0.0 };
    params.gamma = Gain { position: lambda, velocity: 0.0 };
    let parameters =
        Parameters { start: Shape::Cloud, robots: 12, rings: [1, 1], lambda, gathers: 0.0, deviation: 1.0 };
    let places: Vec<[f64; 2]> = parameters.starts(7, 1.0).iter().map(|place| place.map(|c| c * 7.0)).collect();
    let mut gradient = Vec::new();
    potential.gradient(&places, &mut gradient);
    let middle = [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / 12.0);
    for (robot, (here, slope)) in places.iter().zip(&gradient).enumerate() {
        let offset = |to: [f64; 2]| Vec3::new(to[0] - here[0], to[1] - here[1], 0.0);
        let others = places.iter().enumerate().filter(|(other, _)| *other != robot);
        let nearby: Vec<Nearby<f64>> = others
            .map(|(other, &to)| Nearby {
                id: RobotId(other as u32 + 1),
                offset_m: offset(to),
                velocity_mps: Vec3::ZERO,
                radius_m: 0.0,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            })
            .collect();
        let body = Body {
            id: RobotId(robot as u32 + 1),
            velocity_mps: Vec3::ZERO,
            radius_m: 0.0,
            max_speed_mps: f64::MAX,
            max_acceleration_mps2: f64::MAX,
            step_s: 0.01,
        };
        let reference = Reference { offset_m: offset(middle), velocity_mps: Vec3::ZERO };
        let force = acceleration(&params, &body, &nearby, &[], Some(&reference));
        assert!((force.x + slope[0]).abs() < 1e-9 && (force.y + slope[1]).abs() < 1e-9, "{force:?} {slope:?}");
    }
}

#[test]
fn discs_have_as_many_links_as_any_lattice() {
    // The largest number of unit distances in a lattice of n points: Harborth 1974.
    for n in [2_u32, 3, 7, 8, 10, 14, 15, 19, 24, 37] {
        let fields = format!("study = {{ start = \"disc\", robots = {n} }}");
        let measured = run(&fields, 1).unwrap();
        let most = (3.0 * f64::from(n) - f64::from(12 * n - 3).sqrt()).floor();
        assert_eq!(value(&measured, "links"), most, "{n}");
        assert!(value(&measured, "off_lattice") < 1e-9);
        assert_eq!((value(&measured, "strict"), value(&measured, "crossings")), (1.0, 0.0), "{n}");
    }
}

#[test]
fn a_ring_around_a_robot_is_a_strict_minimum_that_is_not_connected() {
    let measured = run("study = { start = \"ring\", lambda = 0.02, deviation = 0.02 }", 5).unwrap();
    for (name, expected) in [("parts", 2.0), ("null", 3.0), ("strict", 1.0), ("returned", 1.0), ("links", 60.0)] {
        assert_eq!(value(&measured, name), expected, "{name}");
    }
    // The robot against the ring: only the pull to the centroid.
    assert!((value(&measured, "least_eigenvalue") - 0.02).abs() < 1e-6);
    // A pull that is strong enough closes the ring.
    let closed = run("study = { start = \"ring\", lambda = 1.0, deviation = 0.02 }", 5).unwrap();
    assert_eq!(value(&closed, "parts"), 1.0);
}

/// Repulsion vanishes where robots meet, and six neighbours hold both.
#[test]
fn two_robots_in_the_middle_of_a_hexagon_are_a_strict_minimum() {
    let measured = run("study = { start = \"double\", robots = 8, deviation = 0.01 }", 3).unwrap();
    assert!(value(&measured, "shortest") < 1e-9);
    for (name, expected) in [("links", 19.0), ("null", 3.0), ("strict", 1.0), ("returned", 1.0), ("strained", 0.0)] {
        assert_eq!(value(&measured, name), expected, "{name}");
    }
    assert!((value(&measured, "over_collision") - 1.0).abs() < 0.2);
}

#[test]
fn a_chain_is_a_lattice_but_no_strict_minimum() {
    let potential = Potential::new(0.0).unwrap();
    let eigenvalues = eigenvalues(potential.hessian(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]));
    assert_eq!(eigenvalues.iter().filter(|value| value.abs() < NULL).count(), 4);
    assert!(eigenvalues.iter().all(|value| *value > -NULL));
}

#[test]
fn wrong_starts_are_refused() {
    for (fields, word) in [
        ("study = { start = \"cloud\" }", "study.deviation"),
        ("study = { start = \"ring\", rings = [3, 2] }", "study.rings"),
        ("study = { start = \"ring\", rings = [0, 2] }", "study.rings"),
        ("study = { start = \"disc\", robots = 1 }", "study.robots"),
    ] {
        let error = run(fields, 1).unwrap_err();
        assert!(error.contains(word), "{error}");
    }
}

proptest! {
    #[test]
    fn the_gradient_is_the_slope_of_the_potential(seed in 0_u64..1000, lambda in 0.0..0.2) {
        let potential = Potential::new(lambda).unwrap();
        let parameters =
            Parameters { start: Shape::Cloud, robots: 8, rings: [1, 1], lambda, gathers: 0.0, deviation: 1.0 };
        let places = parameters.starts(seed, 1.0);
        let scaled: Vec<[f64; 2]> = places.iter().map(|place| place.map(|c| c * 7.0)).collect();
        let mut gradient = Vec::new();
        potential.gradient(&scaled, &mut gradient);
        for robot in 0..places.len() {
            let off = |by: f64| {
                let mut places = places.clone();
                places[robot][0] += by / 7.0;
                potential.at(&places)
            };
            // The tabulated potential is within 1e-6 of the integral.
            let slope = (off(0.02) - off(-0.02)) / 0.04;
            let off = (slope - gradient[robot][0]).abs();
            prop_assert!(off < 0.02 * (1.0 + slope.abs()), "{slope} {:?}", gradient[robot]);
        }
    }
}
