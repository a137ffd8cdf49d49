use super::BoidsParams;
use crate::flock::fixtures::{near, number, vec3};
use crate::geom::{Position, Torus, Vec2};
use crate::neighbor::{Nearby, tie};
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::{Fast32, Q16, Scalar};
use core::f64::consts::PI;
use proptest::prelude::*;
use std::vec::Vec;

const OWN: RobotId = RobotId(1);

fn paper() -> BoidsParams<f64> {
    BoidsParams::paper(1.0)
}

fn cos_sin(angle: f64) -> [f64; 2] {
    let (sin, cos) = Scalar::sin_cos(angle);
    [cos, sin]
}

fn flying<S: Scalar>(id: u32, x: f64, y: f64, heading: f64) -> Nearby<S> {
    let [cos, sin] = cos_sin(heading);
    near(id, [x, y, 0.0], [2.0 * cos, 2.0 * sin, 0.0])
}

fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn alone_a_boid_keeps_its_heading() {
    for heading in [0.0, 1.0, -3.0, PI] {
        assert!(is_close(paper().turn(OWN, heading, &[]), heading));
        let far = [flying(2, 150.001, 0.0, 1.0), flying(3, 0.0, -151.0, 1.0)];
        assert!(is_close(paper().turn(OWN, heading, &far), heading));
    }
    assert!(paper().turn(OWN, 0.0, &[flying(2, 0.0, 150.0, 1.0)]) > 0.0);
}

#[test]
fn far_neighbours_turn_it_by_two_largest_turns_at_most() {
    // 0.05 to their heading and 0.05 to them.
    let north = [flying(2, 0.0, 100.0, PI / 2.0)];
    assert!(is_close(paper().turn(OWN, 0.0, &north), 0.1));
    // Within reach: 0.03 from the mean, then to the middle.
    let [x, y] = cos_sin(0.04);
    let ahead = [flying(2, 100.0 * x, 100.0 * y, 0.03)];
    assert!(is_close(paper().turn(OWN, 0.0, &ahead), 0.04));
    let across = [flying(2, 0.0, -100.0, 0.03)];
    assert!(is_close(paper().turn(OWN, 0.0, &across), -0.02));
}

#[test]
fn mean_of_headings_is_taken_on_the_circle() {
    // +170 and -170 degrees have the mean 180; the listing would have turned left, from +175 to 0.
    let both = [flying(2, 50.0, 0.0, 3.0), flying(3, -50.0, 0.0, -3.0)];
    assert!(is_close(paper().turn(OWN, 3.1, &both), PI));
    assert!(is_close(paper().turn(OWN, -3.1, &both), PI), "on (-pi, pi]");
}

#[test]
fn cohesion_turns_to_the_middle_and_not_away() {
    let left = [flying(2, 0.0, 100.0, 0.0)];
    assert!(is_close(paper().turn(OWN, 0.0, &left), 0.05));
    let right = [flying(2, 60.0, -100.0, 0.0), flying(3, -60.0, -50.0, 0.0)];
    assert!(is_close(paper().turn(OWN, 0.0, &right), -0.05));
    // Straight behind: to the left.
    assert!(is_close(paper().turn(OWN, 0.0, &[flying(2, -50.0, 0.0, 0.0)]), 0.05));
    let around = [flying(2, 50.0, 50.0, 0.0), flying(3, -50.0, -50.0, 0.0)];
    assert!(is_close(paper().turn(OWN, 0.0, &around), 0.0));
    let stands = [near(2, [0.0, -90.0, 0.0], [0.0; 3])];
    assert!(is_close(paper().turn(OWN, 0.0, &stands), -0.05));
}

#[test]
fn crowded_boids_turn_away_from_the_heading_of_the_nearest() {
    let far = flying(3, 0.0, 90.0, 2.0);
    for order in [[far, flying(2, 20.0, 0.0, 1.0)], [flying(2, 20.0, 0.0, 1.0), far]] {
        assert!(is_close(paper().turn(OWN, 0.0, &order), -0.02));
    }
    assert!(is_close(paper().turn(OWN, 0.0, &[flying(2, 20.0, 0.0, -1.0)]), 0.02));
    assert!(is_close(paper().turn(OWN, 0.0, &[flying(2, 30.0, 0.0, 1.0)]), 0.0));
    assert!(is_close(paper().turn(OWN, 0.0, &[near(2, [9.0, 0.0, 0.0], [-2.0, 0.0, 0.0])]), -0.02));
}

#[test]
fn boids_of_the_same_heading_turn_away_from_each_others_side() {
    let turn = |x, y| paper().turn(OWN, 0.0, &[near(2, [x, y, 0.0], [2.0, 0.0, 0.0])]);
    assert!(is_close(turn(3.0, 5.0), -0.02) && is_close(turn(-3.0, -5.0), 0.02));
    assert!(is_close(turn(5.0, 0.0), -0.02) && is_close(turn(-5.0, 0.0), 0.02));
    let other = [near(1, [0.0; 3], [2.0, 0.0, 0.0])];
    let theirs = paper().turn(RobotId(2), 0.0, &other);
    assert!(is_close(turn(0.0, 0.0), -theirs));
    let left = tie::<f64>(RobotId(2), OWN).y > 0.0;
    assert!(is_close(turn(0.0, 0.0), if left { -0.02 } else { 0.02 }));
}

#[test]
fn invalid_input_is_ignored_and_the_result_is_a_heading() {
    let good = flying(2, 0.0, 100.0, 0.5);
    let expected = paper().turn(OWN, 0.0, &[good]);
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let mut lost = flying(3, 10.0, 0.0, 1.0);
        lost.offset_m.y = bad;
        let mut wild = flying(4, 10.0, 0.0, 1.0);
        wild.velocity_mps.x = bad;
        let own = flying(1, 10.0, 0.0, 1.0);
        assert_eq!(paper().turn(OWN, 0.0, &[lost, wild, own, good]), expected);
        assert!(is_close(paper().turn(OWN, bad, &[]), 0.0));
        assert_eq!(paper().steer(OWN, Vec2::new(bad, 1.0), &[]), Vec2::new(1.0, 0.0));
    }
    assert_eq!(paper().steer(OWN, Vec2::ZERO, &[]), Vec2::new(1.0, 0.0));
    assert_eq!(paper().steer(OWN, Vec2::new(0.0, 9.0), &[]), Vec2::new(0.0, 1.0));
    for bad in [f64::NAN, -1.0, 0.0] {
        let params = BoidsParams::new(bad, bad, bad, bad);
        assert!(is_close(params.turn(OWN, 0.7, &[flying(2, 0.0, 0.0, 0.0)]), 0.7));
        let still = BoidsParams::new(30.0, 150.0, bad, bad);
        assert!(is_close(still.turn(OWN, 0.7, &[flying(2, 0.0, 99.0, 0.0)]), 0.7));
        assert!(is_close(still.turn(OWN, 0.7, &[flying(2, 0.0, 9.0, 0.0)]), 0.7));
    }
}

#[test]
fn wide_turns_reach_the_direction_behind() {
    for (limit, expected) in [(3.0, 3.0), (PI, PI - 0.05), (9.0, PI - 0.05), (2.0, 2.0)] {
        let params = BoidsParams::new(1.0, 150.0, limit, 0.0);
        let [x, y] = cos_sin(PI - 0.05);
        let behind = [near(2, [90.0 * x, 90.0 * y, 0.0], [x, y, 0.0])];
        let got = params.turn(OWN, 0.0, &behind);
        let twice = if limit < PI - 0.05 { PI - 0.05 } else { expected };
        assert!((got - twice).abs() < 1e-9, "{limit} {got}");
    }
}

#[test]
fn torus_has_no_edges() {
    let torus = Torus { size_m: [800.0_f64, 600.0] };
    let v = Vec2::new;
    for (place, expected) in [
        (v(0.0, 0.0), v(0.0, 0.0)),
        (v(799.0, 599.0), v(799.0, 599.0)),
        (v(800.0, 600.0), v(0.0, 0.0)),
        (v(801.0, -1.0), v(1.0, 599.0)),
        (v(-1601.0, 1801.0), v(799.0, 1.0)),
        (v(-1e-30, f64::NAN), v(0.0, 0.0)),
        (v(1e300, f64::INFINITY), v(0.0, 0.0)),
    ] {
        assert_eq!(torus.wrap(place), expected, "{place:?}");
    }
    for (offset, expected) in [
        (v(399.0, -299.0), v(399.0, -299.0)),
        (v(400.0, -300.0), v(400.0, -300.0)),
        (v(-400.0, 300.0), v(-400.0, 300.0)),
        (v(401.0, -301.0), v(-399.0, 299.0)),
        (v(-799.0, 599.0), v(1.0, -1.0)),
        (v(1600.5, -1800.5), v(0.5, -0.5)),
    ] {
        assert_eq!(torus.shortest(offset), expected, "{offset:?}");
    }
    for size in [0.0, -3.0, f64::NAN] {
        let plane = Torus { size_m: [size; 2] };
        assert_eq!(plane.wrap(v(-5.0, 1e9)), v(-5.0, 1e9));
        assert_eq!(plane.shortest(v(-5.0, 1e9)), v(-5.0, 1e9));
    }
}

#[test]
fn others_are_seen_at_their_nearest_image() {
    let torus = Torus { size_m: [800.0_f32, 600.0] };
    let place = |x, y| Position::from_mm([x, y, 7]);
    for (other, own, seen) in [
        (place(5_000, 5_000), place(4_000, 9_000), place(5_000, 5_000)),
        (place(799_000, 1_000), place(1_000, 599_000), place(-1_000, 601_000)),
        (place(-1_000, 2_401_000), place(1_000, 1_000), place(-1_000, 1_000)),
        (place(500_000, 300_000), place(100_000, 0), place(500_000, 300_000)),
        (place(100_000, 0), place(500_000, 300_000), place(100_000, 0)),
        (place(i32::MAX, 0), place(i32::MIN, 0), place(i32::MAX, 0)),
    ] {
        assert_eq!(torus.image(other, own), seen, "{other:?} from {own:?}");
    }
    for size in [0.0, -3.0, f32::NAN] {
        let plane = Torus { size_m: [size; 2] };
        assert_eq!(plane.image(place(-5, 5), place(900, 900)), place(-5, 5));
    }
}

fn by_angles(heading: f64, others: &[Nearby<f64>]) -> f64 {
    let wrapped = |angle: f64| {
        let (sin, cos) = Scalar::sin_cos(angle);
        Scalar::atan2(sin, cos)
    };
    let angle = |v: Vec2<f64>| Scalar::atan2(v.y, v.x);
    let towards = |heading: f64, target: f64| heading + wrapped(target - heading).clamp(-0.05, 0.05);
    let close: Vec<_> = others.iter().filter(|o| o.offset_m.norm() <= 150.0).collect();
    let by_distance = |a: &&&Nearby<f64>, b: &&&Nearby<f64>| a.offset_m.norm().total_cmp(&b.offset_m.norm());
    let Some(nearest) = close.iter().min_by(by_distance) else {
        return heading;
    };
    if nearest.offset_m.norm() < 30.0 {
        let difference = wrapped(angle(nearest.velocity_mps.xy()) - heading);
        return wrapped(heading - 0.02 * difference.signum());
    }
    let (mut flight, mut place) = (Vec2::ZERO, Vec2::ZERO);
    for other in close {
        flight += other.velocity_mps.xy().normalized().unwrap();
        place += other.offset_m.xy();
    }
    let aligned = towards(heading, angle(flight));
    wrapped(towards(aligned, angle(place)))
}

/// The length of the mean heading of 60 boids after 400 steps.
fn order<S: Scalar>() -> f64 {
    let torus = Torus { size_m: [number::<S>(400.0), number(300.0)] };
    let params = BoidsParams::<S>::new(number(10.0), number(80.0), number(0.05), number(0.02));
    let mut rng = Rng::new(3);
    let mut draw = |n: u32| f64::from(rng.below(n * 100)) / 100.0;
    let mut boids: Vec<(Vec2<S>, Vec2<S>)> = (0..60)
        .map(|_| {
            let place = Vec2::new(number(draw(400)), number(draw(300)));
            let [cos, sin] = cos_sin(draw(6));
            (place, Vec2::new(number(cos), number(sin)))
        })
        .collect();
    for _ in 0..400 {
        let before = boids.clone();
        for (i, (place, heading)) in boids.iter_mut().enumerate() {
            let others: Vec<_> = (0..before.len())
                .filter(|j| *j != i)
                .map(|j| Nearby {
                    offset_m: torus.shortest(before[j].0 - *place).extend(S::ZERO),
                    velocity_mps: (before[j].1 * S::TWO).extend(S::ZERO),
                    ..near(j as u32 + 1, [0.0; 3], [0.0; 3])
                })
                .collect();
            *heading = params.steer(RobotId(i as u32 + 1), *heading, &others);
            *place = torus.wrap(*place + *heading * S::TWO);
        }
    }
    let mut sum = Vec2::ZERO;
    for (_, heading) in &boids {
        let heading = Vec2::new(heading.x.to_f64(), heading.y.to_f64());
        assert!((heading.norm() - 1.0).abs() < 1e-4, "headings stay unit vectors");
        sum += heading;
    }
    sum.norm() / 60.0
}

#[test]
fn boids_align_in_any_number_type() {
    for order in [order::<f32>(), order::<f64>(), order::<Q16>()] {
        assert!(order > 0.8, "{order}");
    }
}

fn others() -> impl Strategy<Value = Vec<Nearby<f64>>> {
    let other = (-160.0..160.0_f64, -160.0..160.0_f64, -3.1..3.1_f64);
    let numbered =
        |all: Vec<(f64, f64, f64)>| (2..).zip(all).map(|(id, (x, y, heading))| flying(id, x, y, heading)).collect();
    proptest::collection::vec(other, 0..10).prop_map(numbered)
}

fn difference(a: f64, b: f64) -> f64 {
    let (sin, cos) = Scalar::sin_cos(a - b);
    Scalar::atan2(sin, cos).abs()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn vectors_agree_with_angles(heading in -3.1..3.1_f64, others in others()) {
        let got = paper().turn(OWN, heading, &others);
        prop_assert!(difference(got, by_angles(heading, &others)) < 1e-9);
        prop_assert!(difference(got, heading) < 0.1 + 1e-9);
    }

    #[test]
    fn turning_and_mirroring_the_world_turns_and_mirrors_the_result(
        heading in -3.1..3.1_f64, by in -3.1..3.1_f64, others in others(),
    ) {
        let plain = paper().turn(OWN, heading, &others);
        let [cos, sin] = cos_sin(by);
        let mut turned = others.clone();
        let mut mirrored = others.clone();
        for (turned, mirrored) in turned.iter_mut().zip(&mut mirrored) {
            turned.offset_m = turned.offset_m.xy().rotate(cos, sin).extend(0.0);
            turned.velocity_mps = turned.velocity_mps.xy().rotate(cos, sin).extend(0.0);
            mirrored.offset_m.y = -mirrored.offset_m.y;
            mirrored.velocity_mps.y = -mirrored.velocity_mps.y;
        }
        prop_assert!(difference(paper().turn(OWN, heading + by, &turned), plain + by) < 1e-9);
        prop_assert!(difference(paper().turn(OWN, -heading, &mirrored), -plain) < 1e-9);
        let reversed: Vec<_> = others.iter().rev().copied().collect();
        prop_assert!(difference(paper().turn(OWN, heading, &reversed), plain) < 1e-12);
    }

    #[test]
    fn f32_q16_and_fast32_agree_with_f64(heading in -3.1..3.1_f64, others in others()) {
        fn turned<S: Scalar>(heading: f64, others: &[Nearby<f64>]) -> f64 {
            let others: Vec<_> = others
                .iter()
                .map(|o| {
                    let (p, v) = (o.offset_m, o.velocity_mps);
                    near::<S>(o.id.0, [p.x, p.y, p.z], [v.x, v.y, v.z])
                })
                .collect();
            let params = BoidsParams::<S>::paper(S::ONE);
            params.turn(OWN, number(heading), &others).to_f64()
        }
        // Excludes cases that rounding decides.
        let mut distances: Vec<_> = others.iter().map(|o| o.offset_m.norm()).collect();
        distances.sort_by(f64::total_cmp);
        prop_assume!(distances.iter().all(|d| (d - 150.0).abs() > 0.01 && (d - 30.0).abs() > 0.01));
        prop_assume!(distances.windows(2).all(|d| d[1] - d[0] > 0.01));
        // The error of `Fast32` decides which way to turn towards a middle right behind.
        let wobble = [-2e-2, 2e-2].map(|by| by_angles(heading + by, &others));
        prop_assume!(difference(wobble[0], wobble[1]) < 0.06);
        let exact = paper().turn(OWN, heading, &others);
        prop_assert!(difference(turned::<f32>(heading, &others), exact) < 1e-4);
        prop_assert!(difference(turned::<Q16>(heading, &others), exact) < 5e-3);
        prop_assert!(difference(turned::<Fast32>(heading, &others), exact) < 2e-2);
    }

    #[test]
    fn wrapped_positions_and_shortest_offsets_are_in_range(x in any::<f32>(), y in -9000.0..9000.0_f32, w in 0.1..900.0_f32) {
        fn holds<S: Scalar>(x: f64, y: f64, w: f64) -> Result<(), TestCaseError> {
            let Some(x) = S::from_f64(x) else { return Ok(()) };
            let (y, w) = (number::<S>(y), number::<S>(w));
            let torus = Torus { size_m: [w; 2] };
            let place = torus.wrap(Vec2::new(x, y));
            prop_assert!(place.x >= S::ZERO && place.x < w && place.y >= S::ZERO && place.y < w);
            let way = torus.shortest(Vec2::new(x, y));
            prop_assert!(way.x.abs() <= w && way.y.abs() <= w * S::HALF);
            Ok(())
        }
        holds::<f32>(x.into(), y.into(), w.into())?;
        holds::<f64>(x.into(), y.into(), w.into())?;
        holds::<Q16>(x.into(), y.into(), w.into())?;
    }

    #[test]
    fn the_result_is_a_unit_vector_for_any_bits(bits: [u32; 6], limits: [u32; 4]) {
        let f = bits.map(f32::from_bits);
        let [a, b, c, d] = limits.map(f32::from_bits);
        let other = Nearby { offset_m: vec3([0.0, 1.0, 0.0]), ..near(2, [0.0; 3], [0.0; 3]) };
        let wild = Nearby {
            offset_m: crate::geom::Vec3::new(f[0], f[1], 0.0),
            velocity_mps: crate::geom::Vec3::new(f[2], f[3], 0.0),
            ..other
        };
        for params in [BoidsParams::new(a, b, c, d), BoidsParams::paper(1.0_f32)] {
            let next = params.steer(OWN, Vec2::new(f[4], f[5]), &[other, wild]);
            prop_assert!((next.norm() - 1.0).abs() < 0.05, "{:?}", next);
        }
    }
}

#[test]
fn strangers_are_avoided_but_not_followed() {
    let stranger = |y| Nearby { is_stranger: true, ..flying::<f64>(2, 0.0, y, PI / 2.0) };
    assert!(is_close(paper().turn(OWN, 0.0, &[stranger(100.0)]), 0.0));
    let crowded = flying(2, 0.0, 20.0, PI / 2.0);
    assert!(is_close(paper().turn(OWN, 0.0, &[stranger(20.0)]), paper().turn(OWN, 0.0, &[crowded])));
    let friend = flying(3, 0.0, -100.0, -0.03);
    assert!(is_close(paper().turn(OWN, 0.0, &[stranger(100.0), friend]), paper().turn(OWN, 0.0, &[friend])));
}
