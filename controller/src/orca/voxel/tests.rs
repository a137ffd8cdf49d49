use super::*;
use crate::orca::VelocityObstacle;
use crate::orca::fixtures::ball;
use crate::rand::Rng;
use crate::scalar::Q16;
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec2<f64>;

fn v(x: f64, y: f64) -> V {
    V::new(x, y)
}

const PARAMS: Params<f64> = Params { horizon_s: 2.0, separation_s: 0.05, share: 1.0 };

fn sample(rng: &mut Rng) -> (V, MovingBall<V>) {
    let mut unit = || f64::from(rng.below(1 << 20)) / f64::from(1 << 20);
    let radii = 0.2 + 0.8 * unit();
    let mut within = |least: f64, most: f64| {
        let length = (least * least + (most * most - least * least) * unit()).sqrt();
        let (sin, cos) = Scalar::sin_cos(std::f64::consts::TAU * unit());
        v(cos, sin) * length
    };
    let (offset, own, other) = (within(radii, 5.0), within(0.0, 1.5), within(0.0, 1.5));
    (own, ball(offset, other, radii))
}

/// Angles in degrees, demanded changes in (R_A + R_B) / tau.
struct Errors {
    angles: Vec<f64>,
    changes: Vec<f64>,
}

impl Errors {
    fn of(lookup: impl Fn(V, &MovingBall<V>) -> HalfPlane<f64>) -> Self {
        let mut rng = Rng::new(1);
        let (mut angles, mut changes) = (Vec::new(), Vec::new());
        for _ in 0..20_000 {
            let (own, other) = sample(&mut rng);
            let exact = half_plane(own, &other, &PARAMS).unwrap();
            let found = lookup(own, &other);
            let angle = libm::atan2(exact.normal.det(found.normal), exact.normal.dot(found.normal));
            angles.push(angle.to_degrees().abs());
            let unit = other.radii_m / PARAMS.horizon_s;
            changes.push((found.penetration(own) - exact.penetration(own)).abs() / unit);
        }
        for values in [&mut angles, &mut changes] {
            values.sort_by(f64::total_cmp);
        }
        Self { angles, changes }
    }

    fn mean_p99_max(values: &[f64]) -> [f64; 3] {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        [mean, values[values.len() * 99 / 100], values[values.len() - 1]]
    }
}

fn looked_up(own: V, other: &MovingBall<V>) -> HalfPlane<f64> {
    VoxelTable2k.half_space(own, other, &PARAMS).unwrap()
}

/// Uses the nearest direction of the level below.
fn single_node(own: V, other: &MovingBall<V>) -> HalfPlane<f64> {
    let table = VoxelTable2k::TABLE;
    let (ahead, distance) = (other.offset_m.normalized().unwrap(), other.offset_m.norm());
    let w = own - other.velocity_mps - other.offset_m * 0.5;
    let across = ahead.det(w);
    let (level, _) = table.level(other.radii_m / distance).unwrap();
    let (direction, on) = table.direction(v(w.dot(ahead), across.abs())).unwrap();
    let nearest = direction + usize::from(on > 0.5);
    let [x, y] = table.normals[level * table.directions + nearest];
    let normal = v(-f64::from(x), y.into()).normalized().unwrap();
    let side = if across > 0.0 { normal.y } else { -normal.y };
    let normal = ahead.rotate(normal.x, side);
    HalfPlane { point: own + normal * (other.radii_m * 0.5 - w.dot(normal)), normal }
}

#[test]
fn errors_against_the_analytic_form_are_bounded() {
    assert!(VoxelTable2k::TABLE.bytes() <= 2048);
    let errors = Errors::of(looked_up);
    let single = Errors::of(single_node);
    let of = Errors::mean_p99_max;
    let [angle, change] = [of(&errors.angles), of(&errors.changes)];
    // Degrees, and (R_A + R_B) / tau: mean, 99 of 100, greatest.
    let most = [[0.03, 0.5, 1.6], [0.00013, 0.0028, 0.05]];
    for (found, most) in angle.iter().chain(&change).zip(most.as_flattened()) {
        assert!(found <= most, "{found} > {most}");
    }
    assert!(of(&single.angles)[0] > 40.0 * angle[0]);
}

#[test]
fn the_series_for_unit_vectors_agrees_with_the_root() {
    for step in 0..=80 {
        let squared = 0.9 + 0.0025 * f64::from(step);
        let at = v(0.6, -0.8) * squared.sqrt();
        let found = unit(at).unwrap();
        let most = if (1.0 - squared).abs() > 1.0 / 32.0 { 1e-15 } else { 1e-8 };
        assert!((found - v(0.6, -0.8)).norm() < most, "{squared}: {found:?}");
    }
    assert_eq!(unit(V::ZERO), None);
}

#[test]
fn worked_example_of_the_paper_within_the_tables_error() {
    let other = ball(v(-4.0, 6.0), v(3.0, -1.5), 2.0);
    let plane = looked_up(v(1.5, 1.0), &other);
    let apart = (plane.point - v(1.707107, 0.792893)).norm();
    assert!(apart < 5e-4, "{apart}");
    assert!(plane.penetration(v(1.5, 1.0)) >= 0.292893 - 1e-6);
}

#[test]
fn overlap_invalid_input_and_the_discs_centre_match_the_analytic_form() {
    let both = |own: V, other: &MovingBall<V>, params: &Params<f64>| {
        (half_plane_from_table(own, other, params), half_plane(own, other, params))
    };
    for other in [
        ball(v(0.5, 0.0), v(0.1, 0.0), 1.0),
        ball(v(1.0, 0.0), V::ZERO, 1.0),
        ball(V::ZERO, V::ZERO, 1.0),
        ball(v(3.0, f64::NAN), V::ZERO, 1.0),
        ball(v(3.0, 0.0), v(f64::INFINITY, 0.0), 1.0),
        ball(v(3.0, 0.0), V::ZERO, f64::NAN),
        ball(v(3.0, 0.0), V::ZERO, -1.0),
    ] {
        let (found, exact) = both(v(0.2, 0.1), &other, &PARAMS);
        assert_eq!(found, exact, "{other:?}");
    }
    let stopped = Params { horizon_s: 0.0, ..PARAMS };
    let other = ball(v(3.0, 0.0), V::ZERO, 1.0);
    assert_eq!(both(V::ZERO, &other, &stopped), (None, None));
    let (found, exact) = both(v(1.5, 0.0), &other, &PARAMS);
    let (found, exact) = (found.unwrap(), exact.unwrap());
    assert!((found.normal - exact.normal).norm() < 0.03 && found.normal.y < 0.0);
    assert!((found.point - exact.point).norm() < 0.02);
}

#[test]
fn stored_normals_lie_between_backwards_and_the_leg() {
    let VelocityObstacleTable { sines, directions, normals } = VoxelTable2k::TABLE;
    assert_eq!(normals.len(), sines.len() * directions);
    assert!(sines.is_sorted_by(|a, b| a < b));
    assert_eq!((sines[0], i32::from(sines[sines.len() - 1])), (0, ONE));
    for (level, nodes) in normals.chunks(directions).enumerate() {
        for &[x, y] in nodes {
            let length = v(x.into(), y.into()).norm();
            assert!((length - f64::from(ONE)).abs() < 1.0 && x >= 0 && y >= 0, "{x} {y}");
            let sine = f64::from(sines[level]) / f64::from(ONE);
            assert!(f64::from(x) / length >= sine);
        }
        assert_eq!(nodes[directions - 1], [ONE as i16, 0]);
    }
}

/// Levels are equal steps of the tangent of a quarter of the cone's angle, directions equal steps
/// of x / (x + y); behind the leg's normal the disc's does not count.
#[test]
fn each_node_is_the_nearest_integer_to_the_exact_normal() {
    let VelocityObstacleTable { sines, directions, normals } = VoxelTable2k::TABLE;
    assert_eq!(VoxelTable2k::TABLE.shape(), [20, 25]);
    assert_eq!(VoxelTable2k::TABLE.bytes(), 20 * 2 + 20 * 25 * 4);
    let one = f64::from(ONE);
    for (level, nodes) in normals.chunks(directions).enumerate() {
        let (sin, cos) = Scalar::sin_cos(2.0 * libm::atan(level as f64 / 19.0));
        let stored = v(nodes[0][0].into(), nodes[0][1].into());
        assert!((stored - v(sin, cos) * one).x.abs() <= 0.5 + 1e-9);
        assert!((stored - v(sin, cos) * one).y.abs() <= 0.5 + 1e-9);
        let sine = stored.x / stored.norm() * one;
        assert!((0.0..1.0).contains(&(sine - f64::from(sines[level]) + 1e-9)), "{level}");
        for (direction, &[x, y]) in nodes.iter().enumerate() {
            let before = direction as f64 / 24.0;
            let disc = v(before, 1.0 - before).normalized().unwrap() * one;
            let exact = if disc.x * stored.y > disc.y * stored.x { disc } else { stored };
            let off = v(x.into(), y.into()) - exact;
            assert!(off.x.abs() <= 0.5 + 1e-9 && off.y.abs() <= 0.5 + 1e-9, "{level} {direction} {off:?}");
        }
    }
}

#[test]
fn lookups_interpolate_between_levels_and_directions() {
    let table = VoxelTable2k::TABLE;
    let last = table.sines.len() - 1;
    for (below, pair) in table.sines.windows(2).enumerate() {
        let sine = |part: f64| (f64::from(pair[0]) + (f64::from(pair[1]) - f64::from(pair[0])) * part) / f64::from(ONE);
        for part in [0.0, 0.25, 0.75] {
            let (level, up) = table.level(sine(part)).unwrap();
            assert!(level == below && (up - part).abs() < 1e-9, "{below} {part}: {level} {up}");
        }
    }
    // Beyond the table, its first and last levels are extended.
    assert_eq!(table.level(-0.01_f64).map(|(level, up)| (level, up < 0.0)), Some((0, true)));
    assert_eq!(table.level(1.0_f64), Some((last - 1, 1.0)));
    assert_eq!(table.level(1.5_f64).map(|(level, up)| (level, up > 1.0)), Some((last - 1, true)));
    assert_eq!(table.level(f64::NAN), None);
    for (w, node, on) in [
        (v(0.0, 1.0), 0, 0.0),
        (v(-1.0, 0.0), 23, 1.0),
        (v(-1.0, 1.0), 12, 0.0),
        (v(-1.0, 3.0), 6, 0.0),
        (v(-5.0, 3.0), 15, 0.0),
        (v(-1.0, 9.0), 2, 0.4),
        (v(3.0, 1.0), 0, 0.0),
        (v(3.0, 0.0), 0, 0.0),
        (V::ZERO, 0, 0.0),
    ] {
        let (found, rest) = table.direction(w).unwrap();
        assert!(found == node && (rest - on).abs() < 1e-9, "{w:?}: {found} {rest}");
    }
    let middle = table.between(30, 0.25_f64).unwrap();
    let [[ax, ay], [bx, by]] = [table.normals[30], table.normals[31]].map(|node| node.map(f64::from));
    assert_eq!(middle, v(ax * 0.75 + bx * 0.25, ay * 0.75 + by * 0.25));
    assert_eq!(table.between(499, 0.0_f64), None);
    // At a node the normal is the stored one, with the axis pointing back.
    for (level, direction) in [(0, 5), (3, 12), (10, 0), (10, 20), (18, 24)] {
        let sine = f64::from(table.sines[level]) / f64::from(ONE);
        let before = f64::from(direction) / 24.0;
        let found = table.normal(sine, v(-before, 1.0 - before)).unwrap();
        let [x, y] = table.normals[level * 25 + direction as usize].map(f64::from);
        assert!((found - v(-x, y) * (1.0 / f64::from(ONE))).norm() < 1e-4, "{level} {direction} {found:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn every_half_plane_forbids_the_whole_obstacle(seed: u64) {
        let (own, other) = sample(&mut Rng::new(seed));
        let plane = looked_up(own, &other);
        prop_assert!((plane.normal.norm() - 1.0).abs() < 1e-6, "{plane:?}");
        let obstacle = VelocityObstacle::new(other.offset_m, other.radii_m, 2.0).unwrap();
        let (tip, radius) = obstacle.disc();
        let point = plane.point - other.velocity_mps;
        let gap = (point - tip).dot(plane.normal) - radius;
        prop_assert!(gap.abs() < 1e-6, "{gap}");
        for leg in obstacle.legs() {
            prop_assert!(leg.dot(plane.normal) < 1e-9, "{}", leg.dot(plane.normal));
        }
        let theirs = ball(-other.offset_m, own, other.radii_m);
        let theirs = looked_up(other.velocity_mps, &theirs);
        prop_assert!((plane.normal + theirs.normal).norm() < 1e-9);
    }

    #[test]
    fn never_demands_less_than_the_analytic_form(seed: u64) {
        let (own, other) = sample(&mut Rng::new(seed));
        let exact = half_plane(own, &other, &PARAMS).unwrap().penetration(own);
        let found = looked_up(own, &other).penetration(own);
        prop_assert!(found >= exact - 1e-6, "{found} < {exact}");
    }

    #[test]
    fn signs_agree_with_the_r_function(seed: u64) {
        let (own, other) = sample(&mut Rng::new(seed));
        let obstacle = VelocityObstacle::new(other.offset_m, other.radii_m, 2.0).unwrap();
        let value = obstacle.value(own - other.velocity_mps);
        let exact = half_plane(own, &other, &PARAMS).unwrap().penetration(own);
        prop_assert!((value > 0.0) == (exact > 0.0) || value.abs() < 1e-9, "{value} {exact}");
        let change = looked_up(own, &other).penetration(own);
        prop_assert!(value < 1e-6 || change > 0.0, "{value} {change}");
        prop_assert!(value > -0.005 || change < 0.0, "{value} {change}");
    }

    #[test]
    fn turned_and_mirrored_pairs_get_turned_and_mirrored_half_planes(
        seed: u64,
        angle in -3.0_f64..3.0,
    ) {
        let (sin, cos) = Scalar::sin_cos(angle);
        let (own, other) = sample(&mut Rng::new(seed));
        let plain = looked_up(own, &other);
        for map in [&(|at: V| at.rotate(cos, sin)) as &dyn Fn(V) -> V, &|at: V| v(at.x, -at.y)] {
            let moved = ball(map(other.offset_m), map(other.velocity_mps), other.radii_m);
            let found = looked_up(map(own), &moved);
            prop_assert!((found.normal - map(plain.normal)).norm() < 1e-6);
            prop_assert!((found.point - map(plain.point)).norm() < 1e-6);
        }
    }

    #[test]
    fn f32_and_q16_agree_with_f64(seed: u64) {
        fn asked<S: Scalar>(own: V, other: &MovingBall<V>) -> f64 {
            let near = |at: V| Vec2::new(S::from_f64(at.x).unwrap(), S::from_f64(at.y).unwrap());
            let other = MovingBall {
                offset_m: near(other.offset_m),
                velocity_mps: near(other.velocity_mps),
                radii_m: S::from_f64(other.radii_m).unwrap(),
                tie: Vec2::ZERO,
            };
            let params = Params { horizon_s: S::TWO, separation_s: S::ONE, share: S::ONE };
            let own = near(own);
            let found = half_plane_from_table(own, &other, &params);
            found.unwrap().penetration(own).to_f64()
        }
        let (own, other) = sample(&mut Rng::new(seed));
        let exact = asked::<f64>(own, &other);
        prop_assert!((asked::<f32>(own, &other) - exact).abs() < 1e-5);
        let fixed = asked::<Q16>(own, &other);
        prop_assert!((fixed - exact).abs() < 4e-3, "{fixed} {exact}");
    }
}

#[test]
fn half_planes_have_the_normals_of_the_table() {
    let (own, other) = (v(0.9, 0.3), ball(v(3.1, 0.7), v(0.2, -0.1), 1.0));
    let exact = half_plane(own, &other, &PARAMS).unwrap();
    let found = looked_up(own, &other);
    assert!(found.normal != exact.normal && (found.normal - exact.normal).norm() < 0.03, "{found:?} {exact:?}");
}

#[test]
fn a_normal_does_not_turn_past_the_one_of_the_leg() {
    let table = |normal: [i16; 2]| VelocityObstacleTable {
        sines: &[0, ONE as u16],
        directions: 2,
        normals: match normal {
            [0, _] => &[[0, ONE as i16]; 4],
            _ => &[[ONE as i16, 0]; 4],
        },
    };
    let one = ONE as i16;
    // At a sine of 0.6, the leg's normal points back by as much.
    assert!((table([0, one]).normal(0.6, v(1.0, 1.0)).unwrap() - v(-0.6, 0.8)).norm() < 1e-12);
    assert_eq!(table([one, 0]).normal(0.6, v(1.0, 1.0)), Some(v(-1.0, 0.0)));
}

#[test]
fn each_node_of_the_table_is_the_rounded_normal_of_the_disc_or_of_the_leg_beyond_it() {
    let table = VoxelTable2k::TABLE;
    assert_eq!((table.shape(), table.bytes(), ONE), ([20, 25], 20 * 2 + 20 * 25 * 4, 16_384));
    let rounded = |x: f64| libm::floor(x * 16_384.0 + 0.5);
    for level in 0..20_usize {
        let (sin, cos) = Scalar::sin_cos(2.0 * libm::atan(level as f64 / 19.0));
        let leg = [sin, cos].map(rounded);
        let sine = libm::floor(leg[0] / libm::hypot(leg[0], leg[1]) * 16_384.0);
        assert_eq!(f64::from(table.sines[level]), sine, "{level}");
        for direction in 0..25_usize {
            let x = direction as f64 / 24.0;
            let disc = [x, 1.0 - x].map(|part| rounded(part / libm::hypot(x, 1.0 - x)));
            let is_disc = disc[0] * leg[1] > disc[1] * leg[0];
            let found = table.normals[level * 25 + direction].map(f64::from);
            assert_eq!(found, if is_disc { disc } else { leg }, "{level} {direction}");
        }
    }
}
