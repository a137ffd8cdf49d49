use super::*;
use crate::geom::Vec2;
use crate::orca::fixtures::{ball, check_range, params, scalar, worst};
use crate::orca::{half_plane, solve};
use crate::scalar::Q16;
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec3<f64>;

fn v(x: f64, y: f64, z: f64) -> V {
    V::new(x, y, z)
}

fn turn(at: V, axis: V, angle: f64) -> V {
    let axis = axis.normalized().unwrap();
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    at * cos + axis.cross(at) * sin + axis * (axis.dot(at) * (1.0 - cos))
}

#[test]
fn worked_example_of_the_paper_holds_in_any_plane() {
    for (axis, angle) in [(v(0.0, 0.0, 1.0), 0.0), (v(1.0, 2.0, -0.5), 2.0)] {
        let map = |x: f64, y: f64| turn(v(x, y, 0.0), axis, angle);
        let other = ball(map(-4.0, 6.0), map(3.0, -1.5), 2.0);
        for (share, x, y) in [(1.0, 1.707107, 0.792893), (0.5, 1.603553, 0.896447)] {
            let space = half_space(map(1.5, 1.0), &other, &params(2.0, share)).unwrap();
            assert!((space.point - map(x, y)).norm() < 1e-6, "{space:?}");
        }
    }
}

#[test]
fn robots_that_fly_exactly_at_each_other_turn_to_opposite_sides() {
    for (offset, side) in [
        (v(10.0, 0.0, 0.0), v(0.0, -1.0, 0.0)),
        (v(0.0, 0.0, 10.0), v(1.0, 0.0, 0.0)),
        (v(0.0, 0.0, -10.0), v(-1.0, 0.0, 0.0)),
    ] {
        let own = offset * 0.1;
        let space = |offset: V, own: V| half_space(own, &ball(offset, -own, 1.0), &params(20.0, 0.5)).unwrap();
        let (ours, theirs) = (space(offset, own), space(-offset, -own));
        assert!(ours.normal.dot(side) > 0.9, "{ours:?}");
        assert!((ours.normal + theirs.normal).norm() < 1e-12, "reciprocal");
    }
}

#[test]
fn overlapping_and_coincident_robots_are_sent_apart() {
    let p = params(2.0, 0.5);
    let overlapping = half_space(V::ZERO, &ball(v(0.0, 0.0, 0.5), V::ZERO, 1.0), &p).unwrap();
    assert_eq!(overlapping.normal, v(0.0, 0.0, -1.0));
    assert!((overlapping.point.z + 5.0).abs() < 1e-9);
    // At the velocity of the ball's centre no direction follows but that of the other robot.
    let centre = half_space(v(0.0, 0.0, 10.0), &ball(v(0.0, 0.0, 0.5), V::ZERO, 1.0), &p).unwrap();
    assert_eq!(centre.normal, v(0.0, 0.0, -1.0));
    let tied = |tie: V| {
        let other = MovingBall { tie, ..ball(V::ZERO, V::ZERO, 1.0) };
        half_space(V::ZERO, &other, &p).unwrap().normal
    };
    assert_eq!(tied(v(0.0, 0.0, 3.0)), -tied(v(0.0, 0.0, -3.0)));
    assert_eq!(tied(V::ZERO), v(1.0, 0.0, 0.0));
}

#[test]
fn non_finite_input_gives_no_constraint_and_never_spreads() {
    let p = params(2.0, 0.5);
    for bad in [f64::NAN, f64::INFINITY] {
        let spoilt = v(1.0, bad, 0.0);
        assert!(half_space(spoilt, &ball(v(3.0, 0.0, 0.0), V::ZERO, 1.0), &p).is_none());
        assert!(half_space(V::ZERO, &ball(spoilt, V::ZERO, 1.0), &p).is_none());
        assert!(half_space(V::ZERO, &ball(v(3.0, 0.0, 0.0), spoilt, 1.0), &p).is_none());
        let solution = solve::<_, 4>(&[], 0, spoilt, 1.0);
        assert_eq!(solution.velocity_mps, V::ZERO);
    }
    let ahead = ball(v(3.0, 0.0, 0.0), V::ZERO, 1.0);
    for horizon_s in [0.0, -1.0, f64::NAN] {
        let unsound = Params { horizon_s, ..p };
        assert_eq!(half_space(V::ZERO, &ahead, &unsound), None);
    }
    let thin = ball(v(3.0, 0.0, 0.0), V::ZERO, f64::NAN);
    assert_eq!(half_space(V::ZERO, &thin, &p), None);
    for speed in [0.0, -1.0, f64::NAN] {
        let stopped = solve::<_, 4>(&[], 0, v(1.0, 1.0, 1.0), speed);
        assert_eq!(stopped.velocity_mps, V::ZERO);
    }
}

#[test]
fn contradictions_are_met_halfway_and_hard_constraints_are_obeyed() {
    let space = |z: f64, nz: f64| HalfSpace { point: v(0.3, -0.7, z), normal: v(0.0, 0.0, nz) };
    let spaces = [space(0.5, 1.0), space(-0.3, -1.0)];
    let soft = solve::<_, 4>(&spaces, 0, V::ZERO, 1.0);
    assert!((soft.velocity_mps.z - 0.1).abs() < 1e-9, "{soft:?}");
    assert!((soft.penetration_mps - 0.4).abs() < 1e-9);
    let hard = solve::<_, 4>(&spaces, 1, V::ZERO, 1.0);
    assert!((hard.velocity_mps.z - 0.5).abs() < 1e-9, "{hard:?}");
    let torn = solve::<_, 4>(&spaces, 2, V::ZERO, 1.0);
    assert!((torn.penetration_mps - 0.4).abs() < 1e-9, "{torn:?}");
    let one = solve::<_, 1>(&spaces, 0, V::ZERO, 1.0);
    assert_eq!(one.velocity_mps, v(0.0, 0.0, 0.5));
}

/// On the line through (0, 0, 0.6) along x, of which the ball of speed 1 leaves -0.8 to 0.8.
#[test]
fn each_half_space_cuts_off_its_side_of_a_line() {
    let line = Line { foot: v(0.0, 0.0, 0.6), direction: v(1.0, 0.0, 0.0) };
    let space = |point: V, normal: V| HalfSpace { point, normal };
    let rises = |x: f64| space(v(x, 3.0, -2.0), v(1.0, 0.0, 0.0));
    let falls = |x: f64| space(v(x, -1.0, 5.0), v(-1.0, 0.0, 0.0));
    let above = |z: f64| space(v(9.0, -9.0, z), v(0.0, 0.0, 1.0));
    let nearly_along = |slope: f64, gap: f64| space(v(0.0, gap, 0.6), v(slope, 1.0, 0.0));
    let oblique = space(v(0.0, 0.0, 0.9), v(0.6, 0.0, 0.8));
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
        (&[oblique], Some([0.4, 0.8])),
        (&[nearly_along(e, 0.5 * e)], None),
        (&[nearly_along(2.0 * e, e)], Some([0.5, 0.8])),
        (&[nearly_along(-2.0 * e, e)], Some([-0.8, -0.5])),
    ] {
        let best = |aim: Aim<V>| {
            best_on_line(&line, before, 1.0, aim).map(|at| (at.x, (at - line.foot).y.abs() + (at - line.foot).z.abs()))
        };
        let near = |x: f64| best(Aim::Near(v(x, 7.0, -7.0)));
        let along = |x: f64| best(Aim::Along(v(x, 1.0, 1.0)));
        check_range(range, near, along, &before);
    }
    let touches = Line { foot: v(0.0, 0.0, 1.0), ..line };
    assert_eq!(best_on_line(&touches, &[], 1.0, Aim::Near(V::ZERO)), Some(touches.foot));
    assert_eq!(best_on_line(&touches, &[], 0.999, Aim::Near(V::ZERO)), None);
}

fn vector(most: f64) -> impl Strategy<Value = V> {
    (-most..most, -most..most, -most..most).prop_map(|(x, y, z)| v(x, y, z))
}

fn crowd() -> impl Strategy<Value = (Vec<HalfSpace<V>>, V)> {
    let others = proptest::collection::vec((vector(1.0), vector(2.0), 0.1..1.0_f64), 0..10);
    let spread = 0.5..4.0_f64;
    (others, spread, vector(2.0), vector(2.0)).prop_map(|(others, spread, own, preferred)| {
        let spaces = others
            .iter()
            .filter_map(|&(offset, velocity, radii)| {
                let other = ball(offset * spread, velocity, radii);
                half_space(own, &other, &params(2.0, 0.5))
            })
            .collect();
        (spaces, preferred)
    })
}

/// The best of all candidates for the nearest point, on up to three borders and on the ball.
fn nearest_permitted(spaces: &[HalfSpace<V>], preferred: V, speed: f64) -> Option<f64> {
    let mut candidates = Vec::from([preferred, preferred.clamp_norm(speed)]);
    let onto_ball = |foot: V, flat: V| {
        let half = speed * speed - foot.norm_squared();
        let unit = flat.normalized();
        unit.filter(|_| half >= 0.0).map(|unit| foot + unit * half.sqrt())
    };
    for (i, one) in spaces.iter().enumerate() {
        let flat = |at: V| at - one.normal * one.normal.dot(at);
        candidates.push(foot(one) + flat(preferred - foot(one)));
        candidates.extend(onto_ball(foot(one), flat(preferred - foot(one))));
        for (j, two) in spaces.iter().enumerate().take(i) {
            let Some(line) = intersection(one, two) else {
                continue;
            };
            let along = line.direction * (preferred - line.foot).dot(line.direction);
            candidates.push(line.foot + along);
            candidates.extend(onto_ball(line.foot, line.direction));
            candidates.extend(onto_ball(line.foot, -line.direction));
            for three in spaces.iter().take(j) {
                let slope = line.direction.dot(three.normal);
                if slope.abs() > 1e-9 {
                    let t = three.penetration(line.foot) / slope;
                    candidates.push(line.foot + line.direction * t);
                }
            }
        }
    }
    let permitted = candidates.into_iter().filter(|at| at.norm() <= speed + 1e-9 && worst(spaces, *at) < 1e-9);
    permitted.map(|at| (at - preferred).norm()).min_by(f64::total_cmp)
}

fn least_penetration(spaces: &[HalfSpace<V>], speed: f64) -> f64 {
    let steps = 16;
    let axis = || (-steps..=steps).map(|i| speed * f64::from(i) / f64::from(steps));
    let mut least = f64::MAX;
    for x in axis() {
        for y in axis() {
            for z in axis().filter(|z| v(x, y, *z).norm() <= speed) {
                least = least.min(worst(spaces, v(x, y, z)));
            }
        }
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn answer_is_the_nearest_permitted_velocity_or_of_least_penetration(
        (spaces, preferred) in crowd(),
    ) {
        let speed = 1.5;
        let answer = solve::<_, 10>(&spaces, 0, preferred, speed);
        prop_assert!(answer.velocity_mps.norm() <= speed + 1e-9);
        prop_assert!((answer.penetration_mps - worst(&spaces, answer.velocity_mps)).abs() < 1e-9);
        match nearest_permitted(&spaces, preferred, speed) {
            Some(distance) => {
                prop_assert!(answer.penetration_mps < 1e-9, "{}", answer.penetration_mps);
                let own = (answer.velocity_mps - preferred).norm();
                prop_assert!((own - distance).abs() < 1e-6, "{own} {distance}");
            }
            None => {
                let least = least_penetration(&spaces, speed);
                prop_assert!(answer.penetration_mps <= least + 1e-9, "{answer:?} {least}");
            }
        }
    }

    #[test]
    fn hard_half_spaces_are_obeyed_if_others_contradict_them(
        (spaces, preferred) in crowd(),
        hard in 0_usize..3,
    ) {
        let answer = solve::<_, 10>(&spaces, hard, preferred, 1.0);
        let hard = &spaces[..hard.min(spaces.len())];
        if nearest_permitted(hard, preferred, 1.0).is_some() {
            let broken = worst(hard, answer.velocity_mps);
            prop_assert!(broken < 1e-7, "{broken}");
        }
    }

    #[test]
    fn turned_crowds_give_turned_answers(
        (spaces, preferred) in crowd(),
        axis in vector(1.0),
        angle in -3.0_f64..3.0,
    ) {
        prop_assume!(axis.norm() > 0.1);
        let map = |at: V| turn(at, axis, angle);
        let turned: Vec<_> = spaces
            .iter()
            .map(|s| HalfSpace { point: map(s.point), normal: map(s.normal) })
            .collect();
        let plain = solve::<_, 10>(&spaces, 0, preferred, 1.5);
        let answer = solve::<_, 10>(&turned, 0, map(preferred), 1.5);
        prop_assert!((plain.penetration_mps - answer.penetration_mps).abs() < 1e-6);
        if plain.penetration_mps < 1e-9 {
            prop_assert!((answer.velocity_mps - map(plain.velocity_mps)).norm() < 1e-6);
        }
    }

    #[test]
    fn order_of_neighbours_does_not_matter((spaces, preferred) in crowd()) {
        let answer = solve::<_, 10>(&spaces, 0, preferred, 1.5);
        let reversed: Vec<_> = spaces.iter().rev().copied().collect();
        let other = solve::<_, 10>(&reversed, 0, preferred, 1.5);
        prop_assert!((answer.penetration_mps - other.penetration_mps).abs() < 1e-6);
        if answer.penetration_mps < 1e-9 {
            prop_assert!((answer.velocity_mps - other.velocity_mps).norm() < 1e-6);
        }
    }

    #[test]
    fn pair_that_obeys_does_not_meet_within_the_horizon(
        offset in vector(4.0),
        a in vector(1.5),
        b in vector(1.5),
    ) {
        prop_assume!(offset.norm() > 1.1);
        let p = params(2.0, 0.5);
        let ours = half_space(a, &ball(offset, b, 1.0), &p).unwrap();
        let theirs = half_space(b, &ball(-offset, a, 1.0), &p).unwrap();
        prop_assert!((ours.normal + theirs.normal).norm() < 1e-9);
        let a = solve::<_, 1>(&[ours], 0, a, 10.0).velocity_mps;
        let b = solve::<_, 1>(&[theirs], 0, b, 10.0).velocity_mps;
        let least = (0..=200)
            .map(|k| (offset + (b - a) * (2.0 * f64::from(k) / 200.0)).norm())
            .fold(f64::MAX, f64::min);
        prop_assert!(least > 1.0 - 1e-6, "{least}");
    }

    #[test]
    fn space_agrees_with_the_plane_in_one_plane(
        others in proptest::collection::vec((vector(4.0), vector(2.0), 0.1_f64..1.0), 0..10),
        own in vector(2.0),
        preferred in vector(2.0),
    ) {
        let flat = |at: V| at.xy().extend(0.0);
        let p = params(2.0, 0.5);
        let mut planes = Vec::new();
        let mut spaces = Vec::new();
        for (offset, velocity, radii_m) in others {
            let plane = half_plane(
                own.xy(),
                &MovingBall {
                    offset_m: offset.xy(),
                    velocity_mps: velocity.xy(),
                    radii_m,
                    tie: Vec2::ZERO,
                },
                &p,
            ).unwrap();
            let other = ball(flat(offset), flat(velocity), radii_m);
            let space = half_space(flat(own), &other, &p).unwrap();
            prop_assert!((space.normal - plane.normal.extend(0.0)).norm() < 1e-9);
            prop_assert!((space.point - plane.point.extend(0.0)).norm() < 1e-9);
            planes.push(plane);
            spaces.push(space);
        }
        let plane = solve::<_, 10>(&planes, 0, preferred.xy(), 1.5);
        let space = solve::<_, 10>(&spaces, 0, flat(preferred), 1.5);
        prop_assert!((plane.penetration_mps - space.penetration_mps).abs() < 1e-6);
        if plane.penetration_mps < 1e-9 {
            let apart = space.velocity_mps - plane.velocity_mps.extend(0.0);
            prop_assert!(apart.norm() < 1e-6, "{apart:?}");
        }
    }

    #[test]
    fn f32_and_q16_agree_with_f64((spaces, preferred) in crowd()) {
        fn answer<S: Scalar>(spaces: &[HalfSpace<V>], preferred: V) -> (V, f64) {
            let s = scalar::<S>;
            let near = |at: V| Vec3::new(s(at.x), s(at.y), s(at.z));
            let spaces: Vec<_> = spaces
                .iter()
                .map(|space| HalfSpace { point: near(space.point), normal: near(space.normal) })
                .collect();
            let found = solve::<_, 10>(&spaces, 0, near(preferred), s(1.5));
            let [x, y, z] = [found.velocity_mps.x, found.velocity_mps.y, found.velocity_mps.z];
            (v(x.to_f64(), y.to_f64(), z.to_f64()), found.penetration_mps.to_f64())
        }
        let exact = solve::<_, 10>(&spaces, 0, preferred, 1.5);
        // Nearly parallel borders move a corner far, but not the penetration.
        let sine = |one: &HalfSpace<V>, two: &HalfSpace<V>| one.normal.cross(two.normal).norm();
        let mut pairs = spaces.iter().enumerate().flat_map(|(i, one)| spaces[..i].iter().map(move |two| (one, two)));
        let q16 = if pairs.any(|(one, two)| sine(one, two) < 0.02) { 0.1 } else { 0.02 };
        let (at, told) = answer::<f32>(&spaces, preferred);
        prop_assert!(worst(&spaces, at) <= exact.penetration_mps + 1e-3, "f32 {}", worst(&spaces, at));
        prop_assert!((worst(&spaces, at) - told).abs() < 1e-4 && at.norm() < 1.5 + 1e-3);
        let (at, told) = answer::<Q16>(&spaces, preferred);
        prop_assert!(worst(&spaces, at) <= exact.penetration_mps + q16, "Q16 {}", worst(&spaces, at));
        prop_assert!((worst(&spaces, at) - told).abs() < 2e-3 && at.norm() < 1.5 + 1e-2);
    }

    #[test]
    fn half_spaces_of_f32_and_q16_agree_with_those_of_f64(
        offset in vector(6.0),
        velocity in vector(1.5),
    ) {
        prop_assume!(offset.norm() > 1.2);
        fn asked<S: Scalar>(offset: V, velocity: V) -> f64 {
            let s = scalar::<S>;
            let near = |at: V| Vec3::new(s(at.x), s(at.y), s(at.z));
            let other = MovingBall {
                offset_m: near(offset),
                velocity_mps: near(velocity),
                radii_m: S::ONE,
                tie: Vec3::ZERO,
            };
            let params = Params { horizon_s: S::TWO, separation_s: s(0.05), share: S::HALF };
            let own = Vec3::new(S::HALF, S::HALF, S::HALF);
            half_space(own, &other, &params).unwrap().penetration(own).to_f64()
        }
        let exact = asked::<f64>(offset, velocity);
        prop_assert!((asked::<f32>(offset, velocity) - exact).abs() < 1e-5);
        prop_assert!((asked::<Q16>(offset, velocity) - exact).abs() < 2e-3);
    }
}
