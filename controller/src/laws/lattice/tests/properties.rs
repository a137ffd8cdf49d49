use super::super::{Algorithm, LatticeParams, Reference, acceleration};
use crate::body::Body;
use crate::flock::fixtures::{body, exact, near, number, vec3};
use crate::geom::Vec3;
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::robot::RobotId;
use crate::scalar::{Fast32, Q16, Scalar};
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec3<f64>;

#[derive(Clone, Debug)]
struct Case {
    own: [f64; 3],
    others: Vec<([f64; 3], [f64; 3])>,
    center: [f64; 3],
    reference: [f64; 3],
}

fn case(height: f64) -> impl Strategy<Value = Case> {
    let place =
        move |side: f64| (-side..side, -side..side, -1.0..1.0).prop_map(move |(x, y, z)| [x, y, z * side * height]);
    let other = (place(1.2), place(2.0));
    let others = proptest::collection::vec(other, 0..10);
    (place(2.0), others, place(2.0), place(20.0)).prop_map(|(own, others, center, reference)| Case {
        own,
        others,
        center,
        reference,
    })
}

fn answer<S: Scalar>(spacing: f64, case: &Case, view: impl Fn([f64; 3]) -> [f64; 3]) -> V {
    let params = LatticeParams::new(number::<S>(spacing));
    let see = |v: [f64; 3]| view(v).map(|c| c * spacing);
    let others: Vec<_> =
        (2..).zip(&case.others).map(|(id, (offset, velocity))| near::<S>(id, see(*offset), see(*velocity))).collect();
    let obstacle = Obstacle::Ball { center_m: vec3(see(case.center)), radius_m: number(0.7 * spacing) };
    let reference = Reference { offset_m: vec3(see(case.reference)), velocity_mps: vec3(see([0.3, 0.0, 0.0])) };
    let own = body(see(case.own));
    exact(acceleration(&params, &own, &others, &[obstacle], Some(&reference))) * (1.0 / spacing)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn pair_forces_are_opposite(
        offset in [-8.0..8.0, -8.0..8.0, -8.0..8.0_f64],
        v in [-3.0..3.0, -3.0..3.0, -3.0..3.0_f64],
        w in [-3.0..3.0, -3.0..3.0, -3.0..3.0_f64],
    ) {
        let params = LatticeParams { algorithm: Algorithm::One, ..LatticeParams::new(7.0) };
        let ours = acceleration(&params, &body(v), &[near(2, offset, w)], &[], None);
        let other = Body { id: RobotId(2), ..body(w) };
        let back = offset.map(|c| -c);
        let theirs = acceleration(&params, &other, &[near(1, back, v)], &[], None);
        prop_assert_eq!(ours, -theirs);
    }

    #[test]
    fn turning_and_mirroring_the_world_turns_and_mirrors_the_result(case in case(1.0), angle in -3.1..3.1_f64) {
        let (sin, cos) = Scalar::sin_cos(angle);
        let turn = |[x, y, z]: [f64; 3]| [x * cos - z * sin, y, x * sin + z * cos];
        let mirror = |[x, y, z]: [f64; 3]| [x, -y, z];
        let plain = answer::<f64>(7.0, &case, |v| v);
        let scale = plain.norm().max(1.0);
        for got in [
            (answer::<f64>(7.0, &case, turn), turn([plain.x, plain.y, plain.z])),
            (answer::<f64>(7.0, &case, mirror), mirror([plain.x, plain.y, plain.z])),
        ] {
            prop_assert!((got.0 - vec3(got.1)).norm() < 1e-8 * scale, "{:?}", got);
        }
    }

    #[test]
    fn order_of_neighbours_changes_only_rounding(case in case(1.0)) {
        let params = LatticeParams::new(1.0);
        let others: Vec<_> = (2..).zip(&case.others).map(|(id, (o, v))| near(id, *o, *v)).collect();
        let reversed: Vec<_> = others.iter().rev().copied().collect();
        let [one, other] = [others, reversed]
            .map(|others| acceleration(&params, &body(case.own), &others, &[], None));
        prop_assert!((one - other).norm() < 1e-10 * one.norm().max(1.0));
    }

    #[test]
    fn in_the_plane_no_height_appears(case in case(0.0)) {
        prop_assert_eq!(answer::<f32>(0.5, &case, |v| v).z, 0.0);
        prop_assert_eq!(answer::<f64>(0.5, &case, |v| v).z, 0.0);
        prop_assert_eq!(answer::<Q16>(0.5, &case, |v| v).z, 0.0);
    }

    #[test]
    fn f32_q16_and_fast32_agree_with_f64(case in case(1.0)) {
        for spacing in [0.5, 7.0] {
            let plain = answer::<f64>(spacing, &case, |v| v);
            let clear = vec3::<f64>(case.center).norm() - 0.7;
            prop_assume!(clear.abs() > 0.01 && vec3::<f64>(case.center).norm() > 0.01);
            let scale = plain.norm().max(10.0);
            let error = |got: V| (got - plain).norm() / scale;
            let (single, fixed) = (answer::<f32>(spacing, &case, |v| v), answer::<Q16>(spacing, &case, |v| v));
            prop_assert!(error(single) < 1e-4, "{:?} {:?}", single, plain);
            prop_assert!(error(fixed) < 0.02, "{:?} {:?}", fixed, plain);
            let fast = answer::<Fast32>(spacing, &case, |v| v);
            prop_assert!((fast - plain).norm() < 0.3 * plain.norm().max(50.0), "{:?} {:?}", fast, plain);
        }
    }

    #[test]
    fn the_result_is_finite_for_any_bits(bits: [u32; 12], spacing in 0.0..200.0_f32) {
        let f = bits.map(f32::from_bits);
        let v = |i: usize| Vec3::new(f[i], f[i + 1], f[i + 2]);
        let other = Nearby { offset_m: v(0), velocity_mps: v(3), ..near(2, [0.0; 3], [0.0; 3]) };
        let own = Body { velocity_mps: v(6), ..body([0.0; 3]) };
        let obstacles = [
            Obstacle::Ball { center_m: v(9), radius_m: f[3] },
            Obstacle::Wall([v(0).xy(), v(9).xy()]),
            Obstacle::Plane { normal: v(6), distance_m: f[0] },
        ];
        let reference = Reference { offset_m: v(9), velocity_mps: v(0) };
        for algorithm in [Algorithm::One, Algorithm::Two, Algorithm::Three, Algorithm::ThreeInTurn] {
            let params = LatticeParams { algorithm, ..LatticeParams::new(spacing) };
            let got = acceleration(&params, &own, &[other, other], &obstacles, Some(&reference));
            prop_assert!(got.is_finite());
        }
    }
}
