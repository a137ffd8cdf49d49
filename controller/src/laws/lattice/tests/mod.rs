mod properties;
mod reference;
mod simulation;

use super::{Algorithm, Gain, LatticeParams, Reference, acceleration};
use crate::body::Body;
use crate::flock::action::{PhiAlpha, PhiBeta, bump, phi, sigma_1, sigma_norm, sigmoid_shift};
use crate::flock::beta::beta_agent;
use crate::flock::fixtures::{self, body, near, vec3};
use crate::geom::{Vec2, Vec3};
use crate::neighbor::{Nearby, tie};
use crate::obstacle::Obstacle;
use crate::robot::RobotId;
use crate::scalar::{Q16, Scalar};

type V = Vec3<f64>;

/// ||7||, ||8.4|| and ||4.2|| in the sigma norm.
const D_ALPHA: f64 = 14.289_915_602_982_237;
const R_ALPHA: f64 = 18.383_093_559_370_867;
const D_BETA: f64 = 6.625_281_952_496_325;

fn phi_alpha() -> PhiAlpha<f64> {
    PhiAlpha { r_alpha: R_ALPHA, d_alpha: D_ALPHA, a: 5.0, b: 5.0, c: 0.0 }
}

fn is_close(got: f64, expected: f64) -> bool {
    (got - expected).abs() <= 1e-9 * expected.abs().max(1.0)
}

/// d = 7 and all gains 1, 1, so that forces are the bare formulas.
fn bare(algorithm: Algorithm) -> LatticeParams<f64> {
    LatticeParams { algorithm, alpha: Gain::one(), beta: Gain::one(), gamma: Gain::one(), ..LatticeParams::new(7.0) }
}

fn pair(params: &LatticeParams<f64>, offset: [f64; 3]) -> V {
    acceleration(params, &body([0.0; 3]), &[near(2, offset, [0.0; 3])], &[], None)
}

fn ball(x: f64, radius_m: f64) -> Obstacle<f64> {
    Obstacle::Ball { center_m: Vec3::new(x, 0.0, 0.0), radius_m }
}

fn facing(params: &LatticeParams<f64>, velocity: [f64; 3], obstacle: Obstacle<f64>) -> V {
    acceleration(params, &body(velocity), &[], &[obstacle], None)
}

#[test]
fn sigma_norm_of_the_lattice_distances_is_that_of_the_formula() {
    assert!(is_close(sigma_norm(49.0).sigma, D_ALPHA));
    assert!(is_close(sigma_norm(70.56).sigma, R_ALPHA));
    assert!(is_close(sigma_norm(17.64).sigma, D_BETA));
    assert_eq!(sigma_norm(0.0).sigma, 0.0);
    assert_eq!(sigma_norm(0.0).slope, 1.0);
    assert!(is_close(sigma_norm(30.0).sigma, 10.0) && is_close(sigma_norm(30.0).slope, 0.5));
}

#[test]
fn bump_is_one_then_falls_to_zero_and_stays() {
    for (z, expected) in [(0.0, 1.0), (0.199, 1.0), (0.2, 1.0), (0.6, 0.5), (1.0, 0.0), (1.01, 0.0)] {
        assert!(is_close(bump(z, 0.2), expected), "{z}");
    }
    assert_eq!(bump(f64::NAN, 0.2), 0.0);
    assert_eq!((bump(0.99, 1.0), bump(1.0, 1.0)), (1.0, 0.0));
    for k in 0..=1000 {
        let z = Q16::from_ratio(k, 1000);
        let value = bump(z, Q16::from_ratio(1, 5));
        assert!(value >= Q16::ZERO && value <= Q16::ONE);
    }
}

#[test]
fn sigmoids_have_their_known_values_and_bounds() {
    assert!(is_close(sigma_1(0.75), 0.6) && is_close(sigma_1(-0.75), -0.6));
    assert!(is_close(sigma_1(4.0 / 3.0), 0.8));
    assert_eq!(sigma_1(f64::INFINITY), 1.0);
    assert_eq!(sigma_1(-Q16::MAX), -Q16::ONE);
    let c = sigmoid_shift(5.0, 10.0).unwrap();
    assert!(is_close(c, 0.353_553_390_593_273_8));
    assert!(phi(0.0, 5.0, 10.0, c).abs() < 1e-12);
    assert!(is_close(phi(-2.0, 5.0, 10.0, c), -8.910_264_284_766_406));
    assert!((phi(-1e9, 5.0, 10.0, c) + 10.0).abs() < 1e-6);
    assert!((phi(1e9, 5.0, 10.0, c) - 5.0).abs() < 1e-6);
    for (a, b) in [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        assert_eq!(sigmoid_shift(a, b), None);
    }
}

#[test]
fn action_functions_vanish_where_the_paper_says() {
    let alpha = phi_alpha();
    let at = |z: f64| alpha.at(z, alpha.adjacency(z));
    assert!(at(D_ALPHA).abs() < 1e-12, "the lattice is an equilibrium");
    assert_eq!(at(R_ALPHA), 0.0);
    assert_eq!(at(R_ALPHA + 1.0), 0.0);
    assert!(at(D_ALPHA - 0.1) < 0.0 && at(D_ALPHA + 0.1) > 0.0);
    let beta = PhiBeta { d_beta: D_BETA };
    let at = |z: f64| beta.at(z, beta.adjacency(z));
    assert_eq!(at(D_BETA), 0.0);
    assert_eq!(at(D_BETA + 1.0), 0.0);
    assert!(at(0.0) < -1.98 && at(0.0) > -2.0);
}

/// Distances, c phi_alpha n_ij, c phi_beta n^ with c = 1, computed separately.
const ALPHA_KNOWN: [(f64, f64); 3] =
    [(1.0, -4.754_848_738_066_416), (3.5, -11.462_445_668_060_493), (7.7, 0.625_252_368_520_888)];
const BETA_KNOWN: [(f64, f64); 3] =
    [(1.0, 1.894_514_666_039_483_9), (2.1, 3.459_209_653_230_905), (4.1, 0.982_446_060_237_232_1)];

#[test]
fn force_between_two_robots_has_its_known_values() {
    let params = bare(Algorithm::One);
    for (distance, expected) in ALPHA_KNOWN {
        let got = pair(&params, [distance, 0.0, 0.0]);
        assert!((got.x - expected).abs() < 1e-8, "{distance}: {got:?}");
        assert_eq!((got.y, got.z), (0.0, 0.0));
    }
    assert!(pair(&params, [7.0, 0.0, 0.0]).norm() < 1e-12);
    assert_eq!(pair(&params, [0.0, 8.4, 0.0]), V::ZERO, "exactly at r");
    assert_eq!(pair(&params, [0.0, 8.400_001, 0.0]), V::ZERO);
    let still = near(2, [1.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
    let got = acceleration(&params, &body([0.0, 1.0, 0.0]), &[still], &[], None);
    assert!(is_close(got.y, 2.0));
}

#[test]
fn force_of_an_obstacle_has_its_known_values() {
    let params = bare(Algorithm::Three);
    for (distance, expected) in BETA_KNOWN {
        let got = facing(&params, [0.0; 3], ball(distance + 3.0, 3.0));
        assert!((got.x + expected).abs() < 1e-8, "{distance}: {got:?}");
        let plane = Obstacle::Plane { normal: Vec3::new(-1.0, 0.0, 0.0), distance_m: distance };
        assert!((facing(&params, [0.0; 3], plane).x + expected).abs() < 1e-8);
        let wall = Obstacle::Wall([Vec2::new(distance, -9.0), Vec2::new(distance, 1.0)]);
        assert!((facing(&params, [0.0; 3], wall).x + expected).abs() < 1e-8);
    }
    assert_eq!(facing(&params, [0.0; 3], ball(7.2, 3.0)), V::ZERO, "exactly at d'");
    for algorithm in [Algorithm::One, Algorithm::Two] {
        assert_eq!(facing(&bare(algorithm), [0.0; 3], ball(4.0, 3.0)), V::ZERO);
    }
}

#[test]
fn beta_agents_have_the_positions_and_velocities_of_the_lemma() {
    let v = Vec3::new(2.0, 3.0, 1.0);
    let agent = beta_agent(&ball(5.0, 2.0), v).unwrap();
    assert_eq!(agent.normal, Vec3::new(-1.0, 0.0, 0.0));
    assert!(is_close(agent.distance_m, 3.0));
    assert!((agent.velocity_mps - Vec3::new(0.0, 1.2, 0.4)).norm() < 1e-12);
    let plane = Obstacle::Plane { normal: Vec3::new(0.0, 0.0, 1.0), distance_m: 4.0 };
    let agent = beta_agent(&plane, v).unwrap();
    assert_eq!((agent.distance_m, agent.velocity_mps), (4.0, Vec3::new(2.0, 3.0, 0.0)));
    let wall = |y| Obstacle::Wall([Vec2::new(2.0, y), Vec2::new(2.0, y + 5.0)]);
    let agent = beta_agent(&wall(-1.0), v).unwrap();
    assert_eq!(agent.velocity_mps, Vec3::new(0.0, 3.0, 1.0));
    let agent = beta_agent(&wall(2.0), v).unwrap();
    assert!(is_close(agent.distance_m, 8f64.sqrt()));
    assert_eq!(agent.velocity_mps, Vec3::new(0.0, 0.0, 1.0));
}

#[test]
fn a_robot_inside_an_obstacle_is_pushed_out_along_its_normal() {
    let params = LatticeParams::new(7.0);
    // As strong as one unit in front of the border: 200 * 1.984 * 0.953.
    for depth in [0.0, 0.001, 1.0, 2.9] {
        let got = facing(&params, [0.0; 3], ball(3.0 - depth, 3.0));
        assert!(got.x < -350.0 && got.y == 0.0 && got.z == 0.0, "{depth} {got:?}");
        let plane = Obstacle::Plane { normal: Vec3::new(0.0, 1.0, 0.0), distance_m: -depth };
        assert!(facing(&params, [0.0; 3], plane).y > 350.0);
    }
    let got = facing(&params, [0.0, 1.0, 0.0], ball(0.0, 3.0));
    assert!(got.y < -300.0 && got.is_finite(), "{got:?}");
    assert!(facing(&params, [0.0; 3], ball(0.0, 3.0)).x > 350.0);
    let wall = Obstacle::Wall([Vec2::new(-1.0, 0.0), Vec2::new(1.0, 0.0)]);
    assert!(facing(&params, [0.0; 3], wall).y > 350.0);
    assert!(facing(&params, [0.0; 3], Obstacle::Wall([Vec2::ZERO; 2])).x > 350.0);
}

#[test]
fn a_robot_that_starts_inside_gets_out_and_stays_out() {
    let params = LatticeParams::new(7.0);
    let (mut place, mut velocity) = (V::new(-1.0, 0.5, 0.0), V::new(4.0, 0.0, 0.0));
    let mut steps = 0;
    for step in 0..1000 {
        let obstacle = Obstacle::Ball { center_m: -place, radius_m: 10.0 };
        let own = Body { velocity_mps: velocity, ..body([0.0; 3]) };
        velocity += acceleration(&params, &own, &[], &[obstacle], None) * 0.02;
        place += velocity * 0.02;
        if place.norm() < 10.0 {
            steps = step;
        }
    }
    assert!(steps < 100, "inside until step {steps}");
}

#[test]
fn reference_pulls_without_bound_in_algorithm_two_and_with_bound_in_three() {
    let reference = Reference { offset_m: Vec3::new(30.0, 40.0, 0.0), velocity_mps: Vec3::new(0.0, 0.0, 2.0) };
    let pull = |algorithm| acceleration(&bare(algorithm), &body([1.0, 0.0, 0.0]), &[], &[], Some(&reference));
    assert_eq!(pull(Algorithm::One), V::ZERO);
    assert_eq!(pull(Algorithm::Two), Vec3::new(29.0, 40.0, 2.0));
    // sigma_1 along the vector: 50 / sqrt(2501), not of each component.
    let length = 50.0 / 2501f64.sqrt();
    let expected = Vec3::new(0.6 * length - 1.0, 0.8 * length, 2.0);
    assert!((pull(Algorithm::Three) - expected).norm() < 1e-12);
}

/// The distance of two robots over the lattice's after 20 s.
fn settled(params: &LatticeParams<f64>, start: f64) -> f64 {
    let spacing = params.spacing_m;
    let mut places = [V::ZERO, V::new(start * spacing, 0.0, 0.0)];
    let mut velocities = [V::ZERO; 2];
    for _ in 0..1000 {
        let forces = [0, 1].map(|i: usize| {
            let own = Body { id: RobotId(i as u32 + 1), velocity_mps: velocities[i], ..body([0.0; 3]) };
            let other = Nearby {
                offset_m: places[1 - i] - places[i],
                velocity_mps: velocities[1 - i],
                ..near(2 - i as u32, [0.0; 3], [0.0; 3])
            };
            let reference = Reference { offset_m: -places[i], velocity_mps: V::ZERO };
            acceleration(params, &own, &[other], &[], Some(&reference))
        });
        for i in 0..2 {
            velocities[i] += forces[i] * 0.02;
            places[i] += velocities[i] * 0.02;
        }
    }
    (places[0] - places[1]).norm() / spacing
}

#[test]
fn two_robots_settle_at_the_distance_of_the_lattice_at_any_size() {
    for spacing in [0.05, 0.5, 7.0, 60.0] {
        let params = LatticeParams::new(spacing);
        let alone = LatticeParams { algorithm: Algorithm::One, ..params };
        for start in [0.97, 1.05, 1.15] {
            let distance = settled(&alone, start);
            assert!((distance - 1.0).abs() < 1e-6, "{start} {distance}");
        }
        for start in [0.0, 0.3, 2.0] {
            let distance = settled(&params, start);
            assert!((0.95..1.01).contains(&distance), "{spacing} {start} {distance}");
        }
    }
}

#[test]
fn the_law_is_the_same_at_any_size() {
    // Lengths, speeds and accelerations scale with d, time does not.
    let at = |scale: f64| {
        let params = LatticeParams::new(7.0 * scale);
        let s = |v: [f64; 3]| v.map(|c| c * scale);
        let reference = Reference { offset_m: vec3(s([90.0, 5.0, 0.0])), velocity_mps: vec3(s([1.0, 0.0, 0.0])) };
        let others = [near(2, s([3.0, 4.0, 0.0]), s([1.0, -1.0, 0.0]))];
        let obstacles = [ball(4.0 * scale, 3.0 * scale)];
        let own = body(s([0.5, 0.2, 0.0]));
        let got = acceleration(&params, &own, &others, &obstacles, Some(&reference));
        got * (1.0 / scale)
    };
    for scale in [0.01, 0.1, 3.0, 14.0] {
        assert!((at(scale) - at(1.0)).norm() < 1e-9 * at(1.0).norm());
    }
}

#[test]
fn robots_in_one_place_separate_in_opposite_directions() {
    let params = LatticeParams::new(0.5);
    let force = |own: u32, other: u32| {
        let own = Body { id: RobotId(own), ..body([0.0; 3]) };
        acceleration(&params, &own, &[near(other, [0.0; 3], [0.0; 3])], &[], None)
    };
    assert_eq!(force(1, 2), -force(2, 1));
    assert!(force(1, 2).norm() > 1.0 && force(1, 2).z == 0.0);
    let along = force(1, 2).normalized().unwrap().xy();
    assert!((along - tie(RobotId(1), RobotId(2))).norm() < 1e-12);
    assert_eq!(force(1, 1), V::ZERO, "a robot is not its own neighbour");
}

#[test]
fn values_that_are_not_a_number_contribute_nothing() {
    let params = LatticeParams::new(7.0);
    let good = near(2, [5.0, 1.0, 0.0], [0.0; 3]);
    let own = body([1.0, 0.0, 0.0]);
    let expected = acceleration(&params, &own, &[good], &[], None);
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e200] {
        let mut lost = good;
        lost.offset_m.y = bad;
        let others = [lost, good];
        let obstacles = [
            ball(bad, 1.0),
            ball(1.0, f64::NAN),
            ball(1.0, f64::INFINITY),
            ball(1.0, -1.0),
            Obstacle::Wall([Vec2::new(bad, 0.0), Vec2::new(0.0, 3.0)]),
            Obstacle::Wall([Vec2::new(9.0, 9.0), Vec2::new(bad, 9.0)]),
            Obstacle::Plane { normal: Vec3::new(bad, 0.0, 0.0), distance_m: 1.0 },
            Obstacle::Plane { normal: Vec3::ZERO, distance_m: 1.0 },
            Obstacle::Plane { normal: Vec3::new(1.0, 0.0, 0.0), distance_m: bad.abs() },
        ];
        let got = acceleration(&params, &own, &others, &obstacles, None);
        assert_eq!(got, expected, "{bad}");
        let reference =
            Reference { offset_m: Vec3::new(f64::NAN, bad, 0.0), velocity_mps: Vec3::new(f64::NAN, 0.0, 0.0) };
        for algorithm in [Algorithm::Two, Algorithm::Three] {
            let params = LatticeParams { algorithm, ..params };
            assert_eq!(acceleration(&params, &own, &[good], &[], Some(&reference)), expected);
        }
        let mut blind = own;
        blind.velocity_mps.x = f64::NAN;
        let got = acceleration(&params, &blind, &[good], &[ball(4.0, 3.0)], None);
        assert!(got.is_finite() && got.norm() > 1.0);
    }
}

#[test]
fn invalid_parameters_give_no_force() {
    let good = LatticeParams::new(0.5);
    assert!(good.is_sound());
    let negative = Gain { position: -1.0, velocity: 1.0 };
    let bad = [
        LatticeParams::new(0.0),
        LatticeParams::new(-1.0),
        LatticeParams::new(f64::NAN),
        LatticeParams::new(f64::INFINITY),
        LatticeParams { range_ratio: 1.0, ..good },
        LatticeParams { range_ratio: f64::NAN, ..good },
        LatticeParams { obstacle_ratio: 0.0, ..good },
        LatticeParams { obstacle_ratio: 5.0, ..good },
        LatticeParams { attraction: 6.0, ..good },
        LatticeParams { repulsion: f64::NAN, ..good },
        LatticeParams { alpha: negative, ..good },
        LatticeParams { gamma: Gain::critical(f64::NAN), ..good },
    ];
    let others = [near(2, [0.1, 0.1, 0.0], [0.0; 3])];
    for params in bad {
        assert!(!params.is_sound(), "{params:?}");
        assert_eq!(acceleration(&params, &body([0.0; 3]), &others, &[], None), V::ZERO);
    }
    assert_eq!(Gain::critical(4.0).velocity, 4.0);
}

#[test]
fn strangers_push_and_do_nothing_else() {
    let params = bare(Algorithm::One);
    let of = |is_stranger, x, velocity| {
        let other = Nearby { is_stranger, ..near(2, [x, 0.0, 0.0], velocity) };
        acceleration(&params, &body([0.0; 3]), &[other], &[], None)
    };
    assert_eq!(of(true, 4.0, [0.0; 3]), of(false, 4.0, [0.0; 3]));
    assert!(of(false, 8.0, [0.0; 3]).x > 0.0);
    assert_eq!(of(true, 8.0, [0.0; 3]), V::ZERO);
    assert!(of(false, 7.0, [0.0, 1.0, 0.0]).y > 0.0);
    assert_eq!(of(true, 7.0, [0.0, 1.0, 0.0]), V::ZERO);
}

#[test]
fn strangers_in_the_way_turn_the_pull_of_the_reference_to_the_right() {
    let params = bare(Algorithm::Three);
    let reference = Reference { offset_m: vec3([1e3, 0.0, 0.0]), velocity_mps: V::ZERO };
    let pulled = |offset| {
        let [x, y, z] = offset;
        let other = Nearby { is_stranger: true, offset_m: V::new(x, y, z), ..near(2, [0.0; 3], [0.0; 3]) };
        acceleration(&params, &body([0.0; 3]), &[other], &[], Some(&reference))
    };
    let alone = acceleration(&params, &body([0.0; 3]), &[], &[], Some(&reference));
    for offset in [[21.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, -9.0, 0.0], [-9.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0]] {
        assert_eq!(pulled(offset), alone, "{offset:?}");
    }
    let [near, far] = [9.0, 20.0].map(|x| pulled([x, 0.0, 0.0]));
    assert!(near.y < far.y && far.y < 0.0 && near.x < far.x, "{near:?} {far:?}");
    let own = [fixtures::near(2, [9.0, 0.0, 0.0], [0.0; 3])];
    assert_eq!(acceleration(&params, &body([0.0; 3]), &own, &[], Some(&reference)).y, 0.0);
    let crowd = [Nearby { is_stranger: true, ..fixtures::near(2, [9.0, 0.0, 0.0], [0.0; 3]) }; 8];
    let turned = acceleration(&params, &body([0.0; 3]), &crowd, &[], Some(&reference));
    assert!(turned.x.abs() < 1e-9 && is_close(turned.y, -alone.x), "{turned:?}");
}

#[test]
fn with_turns_no_robot_pushes_one_nearer_to_the_reference() {
    let params = LatticeParams { algorithm: Algorithm::ThreeInTurn, ..LatticeParams::new(7.0) };
    let reference = Reference { offset_m: Vec3::new(80.0, 0.0, 0.0), velocity_mps: Vec3::new(6.0, 0.0, 0.0) };
    let pulled = |params: &LatticeParams<f64>, others: &[Nearby<f64>], reference: &Reference<f64>| {
        let with = acceleration(params, &body([0.0; 3]), others, &[], Some(reference));
        with - acceleration(params, &body([0.0; 3]), others, &[], None)
    };
    let behind = near(2, [-8.0, 0.0, 0.0], [0.0; 3]);
    assert!(acceleration(&params, &body([0.0; 3]), &[behind], &[], None).x < -1.0);
    assert_eq!(
        acceleration(&params, &body([0.0; 3]), &[behind], &[], Some(&reference)),
        acceleration(&params, &body([0.0; 3]), &[], &[], Some(&reference))
    );
    let alone = pulled(&params, &[], &reference);
    let three = LatticeParams { algorithm: Algorithm::Three, ..params };
    assert_eq!(alone, pulled(&three, &[], &reference));
    for (other, share) in [
        (near(2, [7.0, 0.0, 0.0], [0.0; 3]), 1.0),
        (near(2, [6.3, 0.0, 0.0], [0.0; 3]), 0.5),
        (near(2, [5.6, 0.0, 0.0], [0.0; 3]), 0.0),
        (near(2, [1.0, 0.0, 0.0], [0.0; 3]), 0.0),
        (near(2, [-3.5, 0.0, 0.0], [0.0; 3]), 1.0),
        (Nearby { is_stranger: true, ..near(2, [0.1, 6.9, 0.0], [0.0; 3]) }, 1.0),
    ] {
        let got = pulled(&params, &[other], &reference);
        let is_turned = other.is_stranger;
        assert!(is_turned || (got - alone * share).norm() < 1e-9, "{other:?} {got:?}");
        assert!(!is_turned || got.norm() > 0.9 * alone.norm(), "{got:?}");
    }
    let beside = Reference { offset_m: Vec3::new(80.0, 1.5, 0.0), ..reference };
    let other = |id| near(id, [0.0, 3.0, 0.0], [0.0; 3]);
    assert!(pulled(&params, &[other(2)], &beside).norm() > 0.9 * alone.norm());
    assert!(pulled(&params, &[other(0)], &beside).norm() < 1e-9);
    let past = Reference { offset_m: Vec3::new(-1.0, 0.0, 0.0), ..reference };
    assert_eq!(pulled(&params, &[other(2)], &past), pulled(&three, &[other(2)], &past));
}
