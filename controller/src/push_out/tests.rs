use super::*;
use crate::geom::Vec2;
use crate::neighbor::tie;
use crate::robot::{Mode, RobotId};
use crate::scalar::Q16;
use proptest::prelude::*;
use std::vec::Vec;

type V = Vec3<f64>;

const MODELS: [Model; 2] = [Model::Radial, Model::Tangential];

fn v(x: f64, y: f64) -> V {
    V::new(x, y, 0.0)
}

fn number<S: Scalar>(value: f64) -> S {
    S::from_f64(value).unwrap()
}

fn vec3<S: Scalar>(v: V) -> Vec3<S> {
    Vec3::new(number(v.x), number(v.y), number(v.z))
}

fn params(model: Model, evasion: Evasion) -> PushOutParams<f64> {
    PushOutParams { model, evasion, min_distance_m: 2.0 }
}

/// A step of 1 s, so that velocities are steps.
fn body<S: Scalar>() -> Body<S> {
    Body {
        id: RobotId(1),
        velocity_mps: Vec3::ZERO,
        radius_m: S::ZERO,
        max_speed_mps: S::from_i32(100),
        max_acceleration_mps2: S::MAX,
        step_s: S::ONE,
    }
}

fn robot<S: Scalar>(id: u32, place: V) -> Nearby<S> {
    Nearby {
        id: RobotId(id),
        offset_m: vec3(place),
        velocity_mps: Vec3::ZERO,
        radius_m: S::ZERO,
        gives_way: true,
        mode: Mode::Cruise,
        is_stranger: false,
    }
}

fn ball(center_m: V, radius_m: f64) -> Obstacle<f64> {
    Obstacle::Ball { center_m, radius_m }
}

fn stepped(model: Model, wish: V, nearby: &[Nearby<f64>], obstacles: &[Obstacle<f64>]) -> V {
    push_out(&params(model, Evasion::Multiple), &body(), wish, nearby, obstacles)
}

fn assert_close(got: V, expected: V) {
    assert!((got - expected).norm() < 1e-5, "{got:?} {expected:?}");
}

#[test]
fn a_step_clear_of_everything_is_the_wish() {
    let around = [ball(v(10.0, 0.0), 3.0), ball(v(0.0, 9.0), 3.0)];
    let robots = [robot(2, v(-3.0, 0.0))];
    for model in MODELS {
        for wish in [v(5.0, 0.0), v(0.0, 4.0), v(-1.0, 0.0), v(1.0, -80.0), V::ZERO] {
            assert_eq!(stepped(model, wish, &robots, &around), wish);
        }
        assert_eq!(stepped(model, v(3.0, 4.0), &[], &[]), v(3.0, 4.0));
        assert_close(stepped(model, v(0.0, -300.0), &robots, &around), v(0.0, -100.0));
    }
}

#[test]
fn model_1_pushes_the_step_out_along_the_radius() {
    // Radius 3 + 2 around (10, 0); (6, 1) lies (-4, 1) from the centre.
    let around = [ball(v(10.0, 0.0), 3.0)];
    let scale = 5.0 / 17f64.sqrt();
    let expected = v(10.0 - 4.0 * scale, scale);
    assert_close(stepped(Model::Radial, v(6.0, 1.0), &[], &around), expected);
    // A jump through it, which would come out behind the horizon: to the tangent point.
    let got = stepped(Model::Radial, v(60.0, 6.0), &[], &around);
    assert_close(got, v(7.5, 0.75f64.sqrt() * 5.0));
}

#[test]
fn model_1_steps_sideways_when_it_leads_straight_at_the_centre() {
    let around = [ball(v(10.0, 0.0), 3.0)];
    assert_close(stepped(Model::Radial, v(6.0, 0.0), &[], &around), v(0.0, 6.0));
    assert_close(stepped(Model::Radial, v(6.0, 0.05), &[], &around), v(-0.05, 6.0));
    let plane = Obstacle::Plane { normal: v(0.0, -1.0), distance_m: 3.0 };
    assert_close(stepped(Model::Radial, v(0.0, 4.0), &[], &[plane]), v(-4.0, 0.0));
    let above = [ball(V::new(0.0, 0.0, 10.0), 3.0)];
    assert_close(stepped(Model::Radial, V::new(0.0, 0.0, 6.0), &[], &above), v(6.0, 0.0));
}

#[test]
fn model_2_turns_the_step_to_the_border_by_the_smaller_angle() {
    // 37 + 100 - 25 = 2 * 10 * 5.6.
    let around = [ball(v(10.0, 0.0), 3.0)];
    let height = (37.0 - 5.6 * 5.6_f64).sqrt();
    assert_close(stepped(Model::Tangential, v(6.0, 1.0), &[], &around), v(5.6, height));
    assert_close(stepped(Model::Tangential, v(6.0, -1.0), &[], &around), v(5.6, -height));
    assert_close(stepped(Model::Tangential, v(37f64.sqrt(), 0.0), &[], &around), v(5.6, height));
    let got = stepped(Model::Tangential, v(20.0, 0.1), &[], &around);
    let length = v(20.0, 0.1).norm();
    assert_close(got, v(length * 0.75f64.sqrt(), length * 0.5));
}

#[test]
fn robots_slide_along_planes_and_walls() {
    let plane = Obstacle::Plane { normal: v(0.0, -1.0), distance_m: 3.0 };
    let wall = Obstacle::Wall([Vec2::new(-9.0, 3.0), Vec2::new(9.0, 3.0)]);
    for obstacle in [plane, wall] {
        assert_close(stepped(Model::Radial, v(3.0, 4.0), &[], &[obstacle]), v(3.0, 1.0));
        let got = stepped(Model::Tangential, v(3.0, 4.0), &[], &[obstacle]);
        assert_close(got, v(24f64.sqrt(), 1.0));
    }
    let got = stepped(Model::Radial, v(12.0, 0.5), &[], &[wall]);
    assert_eq!(got, v(12.0, 0.5), "farther than 2 m");
    let got = stepped(Model::Radial, v(10.0, 3.0), &[], &[wall]);
    assert!((got - v(9.0, 3.0)).norm() > 1.999 && got.y < 3.0, "{got:?}");
    for model in MODELS {
        for x in [-6.0, -1.0, 0.0, 2.0] {
            let got = stepped(model, V::new(x, 90.0, 7.0), &[], &[wall]);
            assert!(got.y <= 1.001 || got.x.abs() > 9.0, "{model:?} {got:?}");
            assert_close(V::new(0.0, 0.0, got.z), V::new(0.0, 0.0, 7.0));
        }
    }
}

#[test]
fn bodies_may_need_more_than_the_least_distance() {
    let own = Body { radius_m: 1.5, ..body() };
    let other = Nearby { radius_m: 2.0, ..robot(2, v(10.0, 0.0)) };
    let p = params(Model::Radial, Evasion::Multiple);
    assert_eq!(push_out(&p, &own, v(6.4, 0.0), &[other], &[]), v(6.4, 0.0));
    assert_close(push_out(&p, &own, v(6.6, 0.0), &[other], &[]), v(0.0, 6.6));
    let large = Body { radius_m: 4.0, ..own };
    let around = [ball(v(10.0, 0.0), 3.0)];
    assert_eq!(push_out(&p, &large, v(2.9, 0.0), &[], &around), v(2.9, 0.0));
    assert_close(push_out(&p, &large, v(3.1, 0.0), &[], &around), v(0.0, 3.1));
}

#[test]
fn a_robot_too_near_is_pushed_out_at_its_speed() {
    let slow = Body { velocity_mps: v(0.1, 0.0), max_speed_mps: 0.5, ..body() };
    let p = |model| params(model, Evasion::Multiple);
    let other = [robot(2, v(1.0, 0.0))];
    // Model 1 also moves a robot that wants to stay; model 2 keeps its length of 0.
    assert_close(push_out(&p(Model::Radial), &slow, V::ZERO, &other, &[]), v(-0.5, 0.0));
    assert_eq!(push_out(&p(Model::Tangential), &slow, V::ZERO, &other, &[]), V::ZERO);
    for model in MODELS {
        let got = push_out(&p(model), &slow, v(0.3, 0.1), &other, &[]);
        assert!(got.x < 0.0, "{model:?} {got:?}");
        // Inside an obstacle, and in its exact centre.
        for center in [v(1.0, 0.0), V::ZERO] {
            let got = push_out(&p(model), &slow, v(0.4, 0.0), &[], &[ball(center, 3.0)]);
            assert!(got.x < -0.3, "{model:?} {got:?}");
        }
    }
}

#[test]
fn robots_in_one_place_separate_in_opposite_directions() {
    for model in MODELS {
        let step = |own: u32, other: u32| {
            let own = Body { id: RobotId(own), ..body() };
            let p = params(model, Evasion::Multiple);
            push_out(&p, &own, v(1.0, 0.5), &[robot(other, V::ZERO)], &[])
        };
        let way = tie::<f64>(RobotId(1), RobotId(2));
        assert!(step(1, 2).xy().dot(way) > 0.9, "{model:?}");
        assert!(step(2, 1).xy().dot(way) < -0.9, "{model:?}");
        assert_eq!(step(1, 1), v(1.0, 0.5), "a robot is not in its own way");
    }
}

#[test]
fn single_evasion_evades_the_nearest_and_multiple_all() {
    // A robot that evades the first to the left runs into the second.
    let robots = [robot(2, v(4.0, -0.2)), robot(3, v(4.0, 2.5))];
    let wish = v(3.5, 0.0);
    for model in MODELS {
        for robots in [robots, [robots[1], robots[0]]] {
            let step = |evasion| push_out(&params(model, evasion), &body(), wish, &robots, &[]);
            let clear = |step: V, id: usize| (robots[id].offset_m - step).norm() > 1.999;
            let (single, multiple) = (step(Evasion::Single), step(Evasion::Multiple));
            let first = usize::from(robots[1].id.0 == 2);
            assert!(clear(single, first), "{model:?} {single:?}");
            assert!(clear(multiple, 0) && clear(multiple, 1), "{model:?} {multiple:?}");
            assert!(multiple != V::ZERO);
        }
    }
    let single = params(Model::Tangential, Evasion::Single);
    let got = push_out(&single, &body(), wish, &robots, &[]);
    assert!((robots[1].offset_m - got).norm() < 2.0, "the second was not looked at");
}

#[test]
fn an_enclosed_robot_stops() {
    let ring: Vec<_> = (0..12)
        .map(|k| {
            let (sin, cos) = Scalar::sin_cos(f64::from(k) * core::f64::consts::PI / 6.0);
            robot(k + 2, v(3.0 * cos, 3.0 * sin))
        })
        .collect();
    for wish in [v(2.0, 0.1), v(-1.4, 1.4)] {
        assert_eq!(stepped(Model::Tangential, wish, &ring, &[]), V::ZERO);
        let got = stepped(Model::Radial, wish, &ring, &[]);
        assert!(got.norm() <= 1.1 && ring.iter().all(|r| (r.offset_m - got).norm() > 1.998));
    }
}

#[test]
fn invalid_input_counts_as_absent() {
    for model in MODELS {
        let p = params(model, Evasion::Multiple);
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let robots = [robot(3, v(3.0, 0.0))];
            let mut lost = robots;
            lost[0].offset_m.y = bad;
            let obstacles = [
                ball(V::new(bad, 0.0, 0.0), 1.0),
                ball(v(3.0, 0.0), bad),
                ball(v(3.0, 0.0), -9.0),
                Obstacle::Wall([Vec2::new(bad, 0.0), Vec2::new(3.0, 0.0)]),
                Obstacle::Plane { normal: v(bad, 0.0), distance_m: 0.0 },
                Obstacle::Plane { normal: v(1.0, 0.0), distance_m: bad },
            ];
            let wish = v(2.0, 1.0);
            assert_eq!(push_out(&p, &body(), wish, &lost, &obstacles), wish);
            assert_eq!(push_out(&p, &body(), v(bad, 1.0), &[], &[]), V::ZERO);
            let fat = Body { radius_m: bad, ..body() };
            let expected = push_out(&p, &body(), wish, &robots, &[]);
            assert_eq!(push_out(&p, &fat, wish, &robots, &[]), expected);
            for least in [bad, 0.0, -1.0] {
                let p = PushOutParams { min_distance_m: least, ..p };
                assert_eq!(push_out(&p, &body(), wish, &[], &[]), V::ZERO);
            }
            for step_s in [bad, 0.0, -1.0] {
                let stopped = Body { step_s, ..body() };
                assert_eq!(push_out(&p, &stopped, wish, &[], &[]), V::ZERO);
            }
        }
    }
}

/// Returns the least distance of two robots, and how many arrive.
fn walk(model: Model, robots: &mut [(V, V)], obstacles: &[(V, f64)], steps: u32) -> (f64, usize) {
    let (speed, step_s) = (1.0, 0.1);
    let own = |i: usize| Body { id: RobotId(i as u32 + 1), max_speed_mps: speed, step_s, ..body() };
    let mut least = f64::MAX;
    for _ in 0..steps {
        let before: Vec<_> = robots.to_vec();
        for (i, (place, goal)) in robots.iter_mut().enumerate() {
            let nearby: Vec<_> = (0..before.len())
                .filter(|j| *j != i && (before[*j].0 - *place).norm() < 6.0)
                .map(|j| robot(j as u32 + 1, before[j].0 - *place))
                .collect();
            let around: Vec<_> = obstacles.iter().map(|(c, r)| ball(*c - *place, *r)).collect();
            let wish = ((*goal - *place) * (1.0 / step_s)).clamp_norm(speed);
            let p = params(model, Evasion::Multiple);
            *place += push_out(&p, &own(i), wish, &nearby, &around) * step_s;
        }
        for (i, (a, _)) in robots.iter().enumerate() {
            for (b, _) in &robots[..i] {
                least = least.min((*a - *b).norm());
            }
            for (center, radius) in obstacles {
                let clearance = (*a - *center).norm() - radius;
                assert!(clearance > 1.998, "{model:?}: {clearance}");
            }
        }
    }
    let arrived = robots.iter().filter(|(place, goal)| (*place - *goal).norm() < 0.01);
    (least, arrived.count())
}

#[test]
fn single_robots_get_around_obstacles() {
    for model in MODELS {
        for y in [0.0, 0.3, -2.0] {
            let obstacles = [(v(10.0, 0.0), 3.0), (v(22.0, 1.0), 4.0), (v(22.0, -12.0), 3.0)];
            let mut robots = [(v(0.0, y), v(40.0, y))];
            let (_, arrived) = walk(model, &mut robots, &obstacles, 1000);
            assert_eq!(arrived, 1, "{model:?} {y} {robots:?}");
        }
    }
}

/// On the border to a millimetre, a step whose chord would cut deeper than that.
#[test]
fn a_robot_on_the_border_goes_on_whatever_the_length_of_its_step() {
    for (model, mm, radius, speed) in MODELS.into_iter().flat_map(|model| {
        [-0.9, -0.3, 0.0, 0.4].into_iter().flat_map(move |mm| {
            [0.15, 1.0, 4.0].into_iter().flat_map(move |radius| [0.5, 2.0, 8.0].map(|speed| (model, mm, radius, speed)))
        })
    }) {
        let case = std::format!("{model:?}, {mm} mm, a ball of {radius} m, {speed} m/s");
        let own = Body { max_speed_mps: speed, step_s: 0.1, ..body() };
        let center = v(2.0 + radius + mm / 1000.0, 0.0);
        for angle in [0.05_f64, 0.7, 1.4, -0.3, -1.2] {
            let wish = v(libm::cos(angle), libm::sin(angle)) * speed;
            let step = push_out(&params(model, Evasion::Multiple), &own, wish, &[], &[ball(center, radius)]) * 0.1;
            let least = speed * 0.1 * libm::sin(angle).abs() * 0.4;
            assert!(step.norm() >= least, "{case}, {angle} rad: {step:?}");
            let points = (0..=100).map(|k| (center - step * (f64::from(k) / 100.0)).norm() - radius);
            let nearest = points.fold(f64::MAX, f64::min);
            assert!(nearest >= 2.0 - 0.001_01, "{case}, {angle} rad: {nearest}");
        }
    }
}

#[test]
fn pairs_pass_each_other_and_keep_the_distance_to_a_step() {
    for model in MODELS {
        for y in [0.0, 0.5, 1.9] {
            let mut robots = [(v(0.0, 0.0), v(20.0, 0.0)), (v(20.0, y), v(0.0, y))];
            let (least, arrived) = walk(model, &mut robots, &[], 600);
            assert_eq!(arrived, 2, "{model:?} {y} {robots:?}");
            assert!(least > 1.89, "{model:?} {y} {least}");
        }
    }
}

fn places(height: f64) -> impl Strategy<Value = Vec<V>> {
    let place = (-9.0..9.0_f64, -9.0..9.0_f64, -9.0..9.0_f64);
    let place = place.prop_map(move |(x, y, z)| V::new(x, y, z * height));
    proptest::collection::vec(place, 0..8)
}

/// At 200 points of the step, in zones of 2 m.
fn trespass(step: V, places: &[V]) -> f64 {
    let points = (0..=200).map(|k| step * (f64::from(k) / 200.0));
    let depths = points.flat_map(|at| places.iter().map(move |place| 2.0 - (*place - at).norm()));
    depths.fold(0.0, f64::max)
}

fn answer<S: Scalar>(model: Model, wish: V, places: &[V]) -> V {
    let params = PushOutParams { model, evasion: Evasion::Multiple, min_distance_m: S::TWO };
    let body = Body { max_speed_mps: S::from_i32(5), ..body() };
    let robots: Vec<_> = (2..).zip(places).map(|(id, place)| robot::<S>(id, *place)).collect();
    let got = push_out(&params, &body, vec3(wish), &robots, &[]);
    V::new(got.x.to_f64(), got.y.to_f64(), got.z.to_f64())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_robot_that_is_clear_stays_clear(
        flat in places(0.0), deep in places(0.6),
        wish in [-4.0..4.0_f64, -4.0..4.0, -4.0..4.0],
    ) {
        for (places, z) in [(flat, 0.0), (deep, wish[2])] {
            let wish = V::new(wish[0], wish[1], z);
            let places: Vec<_> = places.into_iter().filter(|place| place.norm() > 2.01).collect();
            for model in MODELS {
                let answers = [
                    answer::<f64>(model, wish, &places),
                    answer::<f32>(model, wish, &places),
                    answer::<Q16>(model, wish, &places),
                ];
                for got in answers {
                    prop_assert!(trespass(got, &places) < 0.003, "{:?} {:?}", model, got);
                    prop_assert!(got.norm() < 5.001);
                    prop_assert!(z != 0.0 || got.z == 0.0);
                }
                if model == Model::Tangential {
                    let length = answers[0].norm();
                    let kept = (length - wish.norm().min(5.0)).abs() < 1e-6;
                    prop_assert!(kept || length == 0.0, "{}", length);
                }
            }
        }
    }

    #[test]
    fn the_result_turns_with_the_world_and_ignores_order(
        places in places(0.0), wish in [-4.0..4.0_f64, -4.0..4.0], angle in -3.1..3.1_f64,
    ) {
        let (sin, cos) = Scalar::sin_cos(angle);
        let turn = |v: V| v.xy().rotate(cos, sin).extend(0.0);
        let wish = v(wish[0], wish[1]);
        let turned: Vec<_> = places.iter().map(|place| turn(*place)).collect();
        for model in MODELS {
            let plain = answer::<f64>(model, wish, &places);
            let got = answer::<f64>(model, turn(wish), &turned);
            let way = |got: V, wish: V| (got - wish).norm();
            let is_as_good = (way(got, turn(wish)) - way(plain, wish)).abs() < 1e-6;
            let is_same = (got - turn(plain)).norm() < 1e-6;
            prop_assert!(is_same || is_as_good, "{:?} {:?}", model, got);
            let robots: Vec<_> = (2..).zip(&places).map(|(id, place)| robot(id, *place)).collect();
            let reversed: Vec<_> = robots.iter().rev().copied().collect();
            let own = Body { max_speed_mps: 5.0, ..body() };
            let got = push_out(&params(model, Evasion::Multiple), &own, wish, &reversed, &[]);
            prop_assert!((got - plain).norm() < 1e-6, "{:?} {:?}", model, got);
        }
    }

    #[test]
    fn rounding_does_not_choose_between_sides(angle in -3.1..3.1_f64) {
        let (sin, cos) = Scalar::sin_cos(angle);
        let turn = |v: V| v.xy().rotate(cos, sin).extend(0.0);
        let places = [turn(v(1.0457, -1.3649)), turn(v(-0.4132, 1.2685))];
        let wish = turn(v(1.8661, 0.5277));
        let got = answer::<f64>(Model::Tangential, wish, &places);
        prop_assert!((got - wish).norm() < 0.1, "{:?}", got);
    }

    #[test]
    fn the_result_is_finite_and_within_the_speed_for_any_bits(bits: [u32; 12]) {
        let f = bits.map(f32::from_bits);
        let at = |i: usize| Vec3::new(f[i], f[i + 1], f[i + 2]);
        let other = Nearby { offset_m: at(0), radius_m: f[3], ..robot(2, V::ZERO) };
        let own = Body { radius_m: f[4], max_speed_mps: 3.0, step_s: 0.1, ..body::<f32>() };
        let obstacles = [
            Obstacle::Ball { center_m: at(5), radius_m: f[8] },
            Obstacle::Wall([at(0).xy(), at(5).xy()]),
            Obstacle::Plane { normal: at(8), distance_m: f[11] },
        ];
        for model in MODELS {
            for evasion in [Evasion::Single, Evasion::Multiple] {
                let params = PushOutParams { model, evasion, min_distance_m: 0.5 };
                let got = push_out(&params, &own, at(9), &[other, other], &obstacles);
                prop_assert!(got.is_finite() && got.norm() <= 3.001, "{:?}", got);
            }
        }
    }
}
