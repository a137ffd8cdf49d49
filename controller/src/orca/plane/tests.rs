use super::*;
use crate::orca::fixtures::{ball, check_range, params, worst};
use crate::orca::solve;
use crate::scalar::Q16;
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec2<f64>;

fn v(x: f64, y: f64) -> V {
    V::new(x, y)
}

#[test]
fn worked_example_of_the_paper_to_1e_6() {
    let own = v(1.5, 1.0);
    let other = ball(v(-4.0, 6.0), v(3.0, -1.5), 2.0);
    for (share, x, y) in [(1.0, 1.707107, 0.792893), (0.5, 1.603553, 0.896447)] {
        let plane = half_plane(own, &other, &params(2.0, share)).unwrap();
        assert!((plane.point - v(x, y)).norm() < 1e-6, "{plane:?}");
        assert!((plane.normal - v(1.0, -1.0) * core::f64::consts::FRAC_1_SQRT_2).norm() < 1e-6);
    }
}

#[test]
fn head_on_robots_are_sent_to_opposite_sides() {
    let plane = |offset: V, own: V| half_plane(own, &ball(offset, -own, 1.0), &params(20.0, 0.5)).unwrap();
    let ours = plane(v(10.0, 0.1), v(1.0, 0.0));
    let theirs = plane(v(-10.0, -0.1), v(-1.0, 0.0));
    assert!(ours.normal.y < -0.9, "project on right leg {ours:?}");
    assert!((ours.normal + theirs.normal).norm() < 1e-12, "reciprocal");
    let mirrored = plane(v(10.0, -0.1), v(1.0, 0.0));
    assert!(mirrored.normal.y > 0.9, "project on left leg");
}

#[test]
fn overlapping_and_coincident_robots_are_sent_apart() {
    let p = params(2.0, 0.5);
    let overlapping = half_plane(V::ZERO, &ball(v(0.5, 0.0), V::ZERO, 1.0), &p).unwrap();
    assert_eq!(overlapping.normal, v(-1.0, 0.0));
    assert!((overlapping.point.x + 5.0).abs() < 1e-9);
    // At the velocity of the disc's centre no direction follows but that of the other robot.
    let centre = half_plane(v(10.0, 0.0), &ball(v(0.5, 0.0), V::ZERO, 1.0), &p).unwrap();
    assert_eq!(centre.normal, v(-1.0, 0.0));
    let tied = |tie: V| {
        let other = MovingBall { tie, ..ball(V::ZERO, V::ZERO, 1.0) };
        half_plane(V::ZERO, &other, &p).unwrap().normal
    };
    assert_eq!(tied(v(0.0, 3.0)), -tied(v(0.0, -3.0)));
    assert_eq!(tied(V::ZERO), v(1.0, 0.0));
    let q = |x: f64, y: f64| Vec2::new(Q16::from_f64(x).unwrap(), Q16::from_f64(y).unwrap());
    let other = MovingBall { offset_m: q(0.5, 0.0), velocity_mps: q(0.0, 0.0), radii_m: Q16::ONE, tie: q(0.0, 0.0) };
    let fixed = half_plane(q(0.0, 0.0), &other, &params(2.0, 0.5)).unwrap();
    assert!((fixed.point.x.to_f64() + 5.0).abs() < 0.01, "{fixed:?}");
    let touching = half_plane(V::ZERO, &ball(v(1.0, 0.0), V::ZERO, 1.0), &p).unwrap();
    assert!(touching.penetration(V::ZERO).abs() < 1e-9);
    assert!(touching.penetration(v(0.1, 0.0)) > 0.0);
}

#[test]
fn non_finite_input_gives_no_half_plane() {
    let p = params(2.0, 0.5);
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(half_plane(v(bad, 0.0), &ball(v(3.0, 0.0), V::ZERO, 1.0), &p).is_none());
        assert!(half_plane(V::ZERO, &ball(v(3.0, bad), V::ZERO, 1.0), &p).is_none());
        assert!(half_plane(V::ZERO, &ball(v(3.0, 0.0), v(bad, bad), 1.0), &p).is_none());
    }
    assert!(half_plane(V::ZERO, &ball(v(3.0, 0.0), V::ZERO, f64::NAN), &p).is_none());
    assert!(half_plane(V::ZERO, &ball(v(3.0, 0.0), V::ZERO, 1.0), &params(0.0, 0.5)).is_none());
    let solution = solve::<_, 4>(&[], 0, v(f64::NAN, 1.0), 1.0);
    assert_eq!(solution.velocity_mps, V::ZERO);
}

/// On the border y = 0.6, of which the disc of speed 1 leaves -0.8 to 0.8.
#[test]
fn each_half_plane_cuts_off_its_side_of_a_border() {
    let plane = |x: f64, y: f64, nx: f64, ny: f64| HalfPlane { point: v(x, y), normal: v(nx, ny) };
    let border = plane(0.3, 0.6, 0.0, 1.0);
    let rises = |x: f64| plane(x, 3.0, 1.0, 0.0);
    let falls = |x: f64| plane(x, -2.0, -1.0, 0.0);
    let above = |y: f64| plane(0.0, y, 0.0, 1.0);
    // Crosses the border at x = gap / slope, unless it counts as parallel.
    let nearly_along = |slope: f64, gap: f64| plane(0.0, 0.6 + gap, slope, 1.0);
    let e = f64::EPSILON;
    for (before, range) in [
        (&[][..], Some([-0.8, 0.8])),
        (&[rises(0.25)], Some([0.25, 0.8])),
        (&[falls(-0.5)], Some([-0.8, -0.5])),
        (&[rises(-0.5), rises(0.25), rises(-0.25)], Some([0.25, 0.8])),
        (&[falls(0.5), falls(-0.25), falls(0.25)], Some([-0.8, -0.25])),
        (&[rises(0.25), falls(0.5)], Some([0.25, 0.5])),
        (&[rises(0.25), falls(0.25)], Some([0.25, 0.25])),
        (&[rises(0.25), falls(0.125)], None),
        (&[rises(0.9)], None),
        (&[above(0.5)], Some([-0.8, 0.8])),
        (&[above(0.6)], Some([-0.8, 0.8])),
        (&[above(0.7)], None),
        (&[plane(0.0, 0.9, 0.6, 0.8)], Some([0.4, 0.8])),
        (&[nearly_along(64.0 * e, 16.0 * e)], Some([-0.8, 0.8])),
        (&[nearly_along(64.0 * e, 40.0 * e)], None),
        (&[nearly_along(-64.0 * e, 40.0 * e)], None),
        (&[nearly_along(80.0 * e, 40.0 * e)], Some([0.5, 0.8])),
        (&[nearly_along(-80.0 * e, 40.0 * e)], Some([-0.8, -0.5])),
    ] {
        let best = |aim: Aim<V>| best_on_line(&border, before, 1.0, aim).map(|at| (at.x, at.y - 0.6));
        let near = |x: f64| best(Aim::Near(v(x, -7.0)));
        let along = |x: f64| best(Aim::Along(v(x, 1.0)));
        check_range(range, near, along, &before);
    }
    let touches = plane(0.0, 1.0, 0.0, 1.0);
    for (speed, at) in [(1.0, Some(v(0.0, 1.0))), (0.999, None)] {
        assert_eq!(best_on_line(&touches, &[], speed, Aim::Near(V::ZERO)), at);
        let below = plane(0.0, -1.0, 0.0, 1.0);
        assert_eq!(best_on_line(&below, &[], speed, Aim::Near(V::ZERO)), at.map(|at| -at));
    }
}

/// A parallel border that lies farther ahead by no more than rounding is the same one.
#[test]
fn the_tolerance_of_parallel_borders_grows_with_the_numbers() {
    let e = f64::EPSILON;
    for (speed, x, y, most) in [(1.0, 0.0, 0.0, 16.0 * e), (0.5, 0.0, 0.25, 16.0 * e), (8.0, -2.0, 5.0, 240.0 * e)] {
        let border = HalfPlane { point: v(0.0, y), normal: v(0.0, 1.0) };
        for (share, is_same) in [(0.5, true), (0.9, true), (1.1, false), (2.0, false)] {
            let other = HalfPlane { point: v(x, y + share * most), ..border };
            let found = best_on_line(&border, &[other], speed, Aim::Near(V::ZERO));
            assert_eq!(found.is_some(), is_same, "{share} of {most} at {x}, {y}");
        }
    }
}

#[test]
fn a_disc_without_a_size_gives_no_half_plane() {
    for radii in [0.0, -1.0] {
        assert_eq!(half_plane(V::ZERO, &ball(v(3.0, 0.0), V::ZERO, radii), &params(2.0, 0.5)), None);
    }
}

#[test]
fn speed_limit_and_preference_alone() {
    assert_eq!(solve::<_, 4>(&[], 0, v(0.3, 0.4), 1.0).velocity_mps, v(0.3, 0.4));
    let fast = solve::<_, 4>(&[], 0, v(3.0, 4.0), 1.0).velocity_mps;
    assert!((fast - v(0.6, 0.8)).norm() < 1e-12);
}

#[test]
fn copies_of_a_half_plane_change_nothing() {
    let mut differing = 0;
    for k in 0..2000_i32 {
        let (sin, cos) = Scalar::sin_cos(<f32 as Scalar>::from_ratio(k, 300));
        let normal = Vec2::new(cos, sin);
        let twin = normal.rotate(1.0, 1e-8).normalized().unwrap();
        let plane = |normal: Vec2<f32>| HalfPlane { point: normal * 0.08, normal };
        let planes = [plane(normal), plane(twin), plane(normal)];
        let wish = Vec2::new(0.5, 0.01);
        let one = solve::<_, 4>(&planes[..1], 3, wish, 0.5);
        let all = solve::<_, 4>(&planes, 3, wish, 0.5);
        differing += u32::from((one.velocity_mps - all.velocity_mps).norm() > 1e-5);
    }
    assert_eq!(differing, 0);
}

#[test]
fn contradictions_are_met_halfway_and_hard_constraints_are_obeyed() {
    let plane = |x: f64, nx: f64| HalfPlane { point: v(x, 0.0), normal: v(nx, 0.0) };
    let planes = [plane(0.5, 1.0), plane(-0.3, -1.0)];
    let soft = solve::<_, 4>(&planes, 0, V::ZERO, 1.0);
    assert!((soft.velocity_mps.x - 0.1).abs() < 1e-9, "{soft:?}");
    assert!((soft.penetration_mps - 0.4).abs() < 1e-9);
    let hard = solve::<_, 4>(&planes, 1, V::ZERO, 1.0);
    assert!((hard.velocity_mps.x - 0.5).abs() < 1e-9, "{hard:?}");
}

#[test]
fn only_the_hard_constraints_are_obeyed_without_a_solution() {
    let plane = |x: f64, y: f64, nx: f64, ny: f64| HalfPlane { point: v(x, y), normal: v(nx, ny) };
    let planes = [plane(0.5, 0.0, 1.0, 0.0), plane(0.0, 0.3, 0.0, 1.0), plane(0.0, -0.3, 0.0, -1.0)];
    for (hard, y, depth) in [(1, 0.0, 0.3), (2, 0.3, 0.6)] {
        let got = solve::<_, 4>(&planes, hard, V::ZERO, 1.0);
        assert!((got.velocity_mps - v(0.5, y)).y.abs() < 1e-9 && got.velocity_mps.x > 0.5 - 1e-9, "{hard} {got:?}");
        assert!((got.penetration_mps - depth).abs() < 1e-9, "{hard} {got:?}");
    }
    // Those beyond the capacity do not count.
    assert_eq!(solve::<_, 2>(&planes, 1, V::ZERO, 1.0).penetration_mps, 0.0);
}

fn crowd() -> impl Strategy<Value = (Vec<HalfPlane<f64>>, V, V)> {
    let pair = || (-2.0_f64..2.0, -2.0_f64..2.0).prop_map(|(x, y)| v(x, y));
    let others = proptest::collection::vec((pair(), pair(), 0.1_f64..1.0), 0..10);
    (others, pair(), pair()).prop_map(|(others, own, preferred)| {
        let planes = others
            .iter()
            .filter_map(|&(offset, velocity, radii)| {
                half_plane(own, &ball(offset * 2.0, velocity, radii), &params(2.0, 0.5))
            })
            .collect();
        (planes, own, preferred)
    })
}

fn oracle(planes: &[HalfPlane<f64>], preferred: V, speed: f64) -> (f64, f64) {
    let steps = 120;
    let mut best = (f64::MAX, f64::MAX);
    for i in -steps..=steps {
        for j in -steps..=steps {
            let at = v(f64::from(i), f64::from(j)) * (speed / f64::from(steps));
            if at.norm() > speed {
                continue;
            }
            let found = (worst(planes, at), (at - preferred).norm());
            if found.0 < best.0 - 1e-12 || (found.0 <= best.0 + 1e-12 && found.1 < best.1) {
                best = found;
            }
        }
    }
    best
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn answer_is_the_best_within_the_disc((planes, _, preferred) in crowd()) {
        let speed = 1.5;
        let answer = solve::<_, 10>(&planes, 0, preferred, speed);
        prop_assert!(answer.velocity_mps.norm() <= speed + 1e-9);
        let (worst, distance) = oracle(&planes, preferred, speed);
        let grid = 0.02;
        prop_assert!(answer.penetration_mps <= worst + 1e-9, "{} > {worst}", answer.penetration_mps);
        if answer.penetration_mps < 1e-9 {
            let own = (answer.velocity_mps - preferred).norm();
            prop_assert!(worst > 1e-9 || own <= distance + grid, "{own} > {distance}");
        }
    }

    #[test]
    fn turned_and_mirrored_crowds_give_turned_and_mirrored_answers(
        (planes, _, preferred) in crowd(),
        angle in -3.0_f64..3.0,
    ) {
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let turn = |at: V| at.rotate(cos, sin);
        let flip = |at: V| v(at.x, -at.y);
        let plain = solve::<_, 10>(&planes, 0, preferred, 1.5).velocity_mps;
        for map in [&turn as &dyn Fn(V) -> V, &flip] {
            let moved: Vec<_> = planes
                .iter()
                .map(|p| HalfPlane { point: map(p.point), normal: map(p.normal) })
                .collect();
            let answer = solve::<_, 10>(&moved, 0, map(preferred), 1.5).velocity_mps;
            prop_assert!((answer - map(plain)).norm() < 1e-6, "{answer:?} {plain:?}");
        }
    }

    #[test]
    fn order_of_neighbours_does_not_matter((planes, _, preferred) in crowd()) {
        let answer = solve::<_, 10>(&planes, 0, preferred, 1.5);
        let reversed: Vec<_> = planes.iter().rev().copied().collect();
        let other = solve::<_, 10>(&reversed, 0, preferred, 1.5);
        prop_assert!((answer.penetration_mps - other.penetration_mps).abs() < 1e-6);
        if answer.penetration_mps < 1e-9 {
            prop_assert!((answer.velocity_mps - other.velocity_mps).norm() < 1e-6);
        }
    }

    #[test]
    fn pair_that_obeys_does_not_meet_within_the_horizon(
        x in 1.1_f64..6.0,
        own in (-1.5_f64..1.5, -1.5_f64..1.5),
        other in (-1.5_f64..1.5, -1.5_f64..1.5),
    ) {
        let (a, b) = (v(own.0, own.1), v(other.0, other.1));
        let p = params(2.0, 0.5);
        let ours = half_plane(a, &ball(v(x, 0.0), b, 1.0), &p).unwrap();
        let theirs = half_plane(b, &ball(v(-x, 0.0), a, 1.0), &p).unwrap();
        let a = solve::<_, 1>(&[ours], 0, a, 10.0).velocity_mps;
        let b = solve::<_, 1>(&[theirs], 0, b, 10.0).velocity_mps;
        let least = (0..=200)
            .map(|k| (v(x, 0.0) + (b - a) * (2.0 * f64::from(k) / 200.0)).norm())
            .fold(f64::MAX, f64::min);
        prop_assert!(least > 1.0 - 1e-6, "{least}");
    }

    #[test]
    fn f32_and_q16_agree_with_f64(
        x in -6.0_f64..6.0, y in 1.2_f64..6.0,
        vx in -1.5_f64..1.5, vy in -1.5_f64..1.5,
    ) {
        let exact = half_plane(v(0.5, 0.5), &ball(v(x, y), v(vx, vy), 1.0), &params(2.0, 0.5)).unwrap();
        fn near<S: Scalar>(exact: &HalfPlane<f64>, x: f64, y: f64, vx: f64, vy: f64) -> f64 {
            let s = |value: f64| S::from_f64(value).unwrap();
            let other = MovingBall {
                offset_m: Vec2::new(s(x), s(y)),
                velocity_mps: Vec2::new(s(vx), s(vy)),
                radii_m: S::ONE,
                tie: Vec2::ZERO,
            };
            let params = Params { horizon_s: S::TWO, separation_s: s(0.05), share: S::HALF };
            let plane = half_plane(Vec2::new(S::HALF, S::HALF), &other, &params).unwrap();
            // On the cone's axis the border may jump between legs; the demanded change does not.
            let own = plane.penetration(Vec2::new(S::HALF, S::HALF)).to_f64();
            (own - exact.penetration(v(0.5, 0.5))).abs()
        }
        prop_assert!(near::<f32>(&exact, x, y, vx, vy) < 1e-5);
        prop_assert!(near::<Q16>(&exact, x, y, vx, vy) < 2e-3);
    }
}

proptest! {
    /// Normals agree too, unless two exits are equally long.
    #[test]
    fn both_methods_to_leave_the_cone_agree(
        p in (-9.0_f64..9.0, -9.0_f64..9.0),
        v in (-3.0_f64..3.0, -3.0_f64..3.0),
        r in 0.1_f64..2.0,
        horizon in 0.1_f64..9.0,
    ) {
        let (p, v) = (Vec2::new(p.0, p.1), Vec2::new(v.0, v.1));
        prop_assume!(p.norm() > r * 1.001);
        let ahead = p.normalized().unwrap_or_default();
        let w = v - p * (1.0 / horizon);
        let is_clear = (ahead.dot(w) + r / p.norm() * w.norm()).abs() > 1e-9 && ahead.det(w).abs() > 1e-9;
        prop_assume!(is_clear);
        let squares = leave_cone(v, p, p.norm_squared(), r, 1.0 / horizon);
        let angles = leave_cone_by_angle(v, p, ahead, r, horizon);
        let (Some((u, normal)), Some((by_angle, expected))) = (squares, angles) else {
            return Err(TestCaseError::fail("no way out"));
        };
        prop_assert!((u - by_angle).abs() < 1e-9, "{u} {by_angle}");
        prop_assert!((normal - expected).norm() < 1e-6, "{normal:?} {expected:?}");
    }
}

#[test]
fn shortest_vectors_still_give_half_planes() {
    let params = params(2.0, 0.5);
    let tiny = [0.0, 1e-30, 1e-23, 1e-20, 1e-15, 1e-10];
    for (reach, off) in tiny.iter().flat_map(|reach| tiny.map(|off| (*reach, off))) {
        let disc = |offset_m: Vec2<f32>, radii_m: f32| ball(offset_m, Vec2::ZERO, radii_m);
        let own = Vec2::new(500.0 - off, off);
        let far = half_plane(own, &disc(Vec2::new(1000.0, 0.0), 1.0), &params);
        let small = half_plane(own, &disc(Vec2::new(reach * 3.0, 0.0), reach), &params);
        let is_unit = |plane: HalfPlane<f32>| (plane.normal.norm() - 1.0).abs() < 1e-5;
        assert!(far.is_some_and(is_unit), "{off}");
        assert!(reach == 0.0 || small.is_some_and(is_unit), "{reach} {off}");
    }
}

#[test]
fn rounding_grows_with_the_speed_and_the_place() {
    let at = |speed, x, y| rounding(speed, &HalfPlane { point: v(x, y), normal: v(1.0, 0.0) }) / (16.0 * f64::EPSILON);
    assert_eq!([at(3.0, 4.0, 5.0), at(3.0, -4.0, 5.0), at(3.0, 4.0, -5.0)], [12.0; 3]);
    assert_eq!(at(0.25, 0.25, 0.25), 1.0);
}
