use super::*;
use crate::orca::fixtures::{body, robot};
use crate::rand::Rng;
use crate::robot::{Mode, RobotId};
use crate::scalar::Q16;
use proptest::prelude::*;

fn avoider() -> Avoider<f32, 16> {
    Avoider::new(AvoidParams::default())
}

fn rng() -> Rng {
    Rng::new(1)
}

#[test]
fn a_lone_robot_follows_its_wish() {
    let body = body(1, [0.1, 0.0]);
    let wish = Vec2::new(0.3, -0.2);
    let solution = avoider().velocity(&body, wish, None, &[], &[], &mut rng());
    assert_eq!(solution.velocity_mps, wish);
    assert_eq!(solution.penetration_mps, 0.0);
    let far = [robot(2, [2.9, 0.0], [0.0, 0.0])];
    let solution = avoider().velocity(&body, wish, None, &far, &[], &mut rng());
    assert_eq!(solution.velocity_mps, wish);
}

#[test]
fn robots_in_the_same_place_separate_in_opposite_directions() {
    let go = |own: u32, other: u32| {
        avoider()
            .velocity(
                &body(own, [0.0, 0.0]),
                Vec2::ZERO,
                None,
                &[robot(other, [0.0, 0.0], [0.0, 0.0])],
                &[],
                &mut rng(),
            )
            .velocity_mps
    };
    let (one, other) = (go(3, 7), go(7, 3));
    assert!(one.norm() > 0.4, "{one:?}");
    assert_eq!(one, -other);
}

#[test]
fn a_robot_that_does_not_give_way_gets_the_whole_correction() {
    let own = body(1, [0.5, 0.0]);
    let swerve = |gives_way| {
        let other = Nearby { gives_way, ..robot(2, [1.2, -0.01], [-0.5, 0.0]) };
        let mut params = AvoidParams::default();
        params.deadlock.lean_rad = 0.0;
        let mut avoider = Avoider::<f32, 16>::new(params);
        let wish = Vec2::new(0.5, 0.0);
        avoider.velocity(&own, wish, None, &[other], &[], &mut rng()).velocity_mps.y
    };
    let (half, all) = (swerve(true), swerve(false));
    assert!(half > 0.01 && all > 1.5 * half, "{half} {all}");
}

#[test]
fn walls_balls_and_planes_stop_a_robot_in_time() {
    let obstacles = [
        Obstacle::Wall([Vec2::new(0.4, -1.0), Vec2::new(0.4, 1.0)]),
        Obstacle::Ball { center_m: Vec3::new(1.4, 0.0, 0.0), radius_m: 1.0 },
        Obstacle::Plane { normal: Vec3::new(-1.0, 0.0, 0.0), distance_m: 0.4 },
    ];
    for obstacle in obstacles {
        let solution =
            avoider().velocity(&body(1, [0.5, 0.0]), Vec2::new(0.5, 0.0), None, &[], &[obstacle], &mut rng());
        let ahead = solution.velocity_mps.x;
        assert!((0.2..0.2501).contains(&ahead), "{obstacle:?} {ahead}");
    }
    let floor = Obstacle::Plane { normal: Vec3::new(0.0, 0.0, 1.0), distance_m: 0.0 };
    let wish = Vec2::new(0.5, 0.0);
    let solution = avoider().velocity(&body(1, [0.5, 0.0]), wish, None, &[], &[floor], &mut rng());
    assert_eq!(solution.velocity_mps, wish);
}

#[test]
fn a_body_with_inertia_gets_a_reachable_velocity() {
    let own = Body { max_acceleration_mps2: 1.0, ..body(1, [0.5, 0.0]) };
    let wall = Obstacle::Wall([Vec2::new(0.25, -1.0), Vec2::new(0.25, 1.0)]);
    let wish = Vec2::new(0.5, 0.0);
    let solution = avoider().velocity(&own, wish, None, &[], &[wall], &mut rng());
    // 0.096 m/s are permitted (the margin is 4 mm); it can have at least 0.45 after 0.05 s.
    assert!((solution.velocity_mps.x - 0.45).abs() < 1e-3, "{solution:?}");
    assert!((solution.penetration_mps - 0.354).abs() < 1e-3, "{solution:?}");
}

#[test]
fn a_full_avoider_keeps_the_nearest_and_capacity_zero_works() {
    let others: [Nearby<f32>; 30] =
        core::array::from_fn(|k| robot(k as u32 + 2, [0.4 + 0.1 * k as f64, 0.0], [-0.5, 0.0]));
    let walls = [Obstacle::Wall([Vec2::new(-0.3, -1.0), Vec2::new(-0.3, 1.0)]); 30];
    let wish = Vec2::new(0.5, 0.0);
    let own = body(1, [0.5, 0.0]);
    let mut few = Avoider::<f32, 4>::new(AvoidParams::default());
    let solution = few.velocity(&own, wish, None, &others, &walls, &mut rng());
    let got = solution.velocity_mps;
    assert!(got.x > -0.15 && (got - wish).norm() > 0.1, "{got:?}");
    let mut planes = Vec::new();
    let hard = few.constraints(&own, &others, &walls, &mut planes);
    assert_eq!((planes.len(), hard), (4, 2));
    let mut none = Avoider::<f32, 0>::new(AvoidParams::default());
    let solution = none.velocity(&own, wish, None, &others, &walls, &mut rng());
    assert!(solution.velocity_mps.is_finite());
}

#[test]
fn both_radii_and_the_margin_count() {
    let params = AvoidParams { margin_m: 0.1, wall_horizon_s: 2.0, ..AvoidParams::<f64>::default() };
    let own = body(1, [0.5, 0.0]);
    let planes = |nearby: &[Nearby<f64>], obstacles: &[Obstacle<f64>]| {
        let (hard, planes) = Avoider::<f64, 4>::new(params).half_spaces(&own, nearby, obstacles);
        assert_eq!(hard, obstacles.len());
        // The speed towards the obstacle that is permitted for 2 s.
        planes.iter().map(|plane| -plane.point.dot(plane.normal) * 2.0).collect::<std::vec::Vec<_>>()
    };
    let is_near = |got: std::vec::Vec<f64>, wanted: f64| got.len() == 1 && (got[0] - wanted).abs() < 1e-9;
    let wall = Obstacle::Wall([Vec2::new(0.8, -9.0), Vec2::new(0.8, 9.0)]);
    assert!(is_near(planes(&[], &[wall]), 0.8 - 0.15 - 0.1));
    let ball = Obstacle::Ball { center_m: Vec3::new(1.2, 0.0, 0.0), radius_m: 0.4 };
    assert!(is_near(planes(&[], &[ball]), 1.2 - 0.4 - 0.15 - 0.1));
    let plane = Obstacle::Plane { normal: Vec3::new(-2.0, 0.0, 0.0), distance_m: 1.6 };
    assert!(is_near(planes(&[], &[plane]), 0.8 - 0.15 - 0.1), "of any length of its normal");
    // A stationary robot that does not give way is like a ball.
    let robot = Nearby { radius_m: 0.4, gives_way: false, ..robot(2, [1.2, 0.0], [0.0; 2]) };
    assert!(is_near(planes(&[robot], &[]), 1.2 - 0.4 - 0.15 - 0.1));
}

#[test]
fn of_equally_near_obstacles_the_first_ones_count() {
    let wall = |x: f64| Obstacle::Wall([Vec2::new(x, -1.0), Vec2::new(x, 1.0)]);
    let own = body(1, [0.1, 0.0]);
    let normals = |obstacles: &[Obstacle<f64>]| {
        let (_, planes) = Avoider::<f64, 2>::new(AvoidParams::default()).half_spaces(&own, &[], obstacles);
        planes.iter().map(|plane| plane.normal.x).collect::<std::vec::Vec<_>>()
    };
    assert_eq!(normals(&[wall(0.5), wall(-0.5)]), [-1.0, 1.0]);
    assert_eq!(normals(&[wall(-0.5), wall(0.5)]), [1.0, -1.0]);
    assert_eq!(normals(&[wall(-0.5), wall(0.5), wall(0.5), wall(-0.5)]), [1.0, -1.0]);
    assert_eq!(normals(&[wall(-0.6), wall(0.7), wall(0.4)]), [-1.0, 1.0]);
    // In the centre of a ball there is no nearest point: nothing is nearer.
    let ball = Obstacle::Ball { center_m: Vec3::ZERO, radius_m: 0.2 };
    let (_, planes) =
        Avoider::<f64, 2>::new(AvoidParams::default()).half_spaces(&own, &[], &[wall(0.4), wall(-0.5), ball]);
    assert!(planes[0].penetration(Vec2::ZERO) > 1.0, "{planes:?}");
}

#[test]
fn a_robot_that_is_not_finite_does_not_hide_the_next_one() {
    let bad = Nearby { radius_m: f64::NAN, ..robot(2, [0.5, 0.0], [0.0; 2]) };
    let (_, planes) = Avoider::<f64, 4>::new(AvoidParams::default()).half_spaces(
        &body(1, [0.0; 2]),
        &[bad, robot(3, [0.6, 0.0], [0.0; 2])],
        &[],
    );
    assert_eq!(planes.len(), 1);
}

#[test]
fn a_body_that_changes_its_velocity_slowly_turns_back_slowly() {
    let reached = |acceleration: f64| {
        let own = Body { max_acceleration_mps2: acceleration, ..body(1, [-0.5, 0.0]) };
        let mut avoider = Avoider::<f64, 4>::new(AvoidParams::default());
        avoider.velocity(&own, Vec2::new(0.5, 0.0), None, &[], &[], &mut rng()).velocity_mps.x
    };
    // In a step of 0.05 s.
    for (acceleration, speed) in [(1.0, -0.45), (6.0, -0.2), (14.0, 0.2), (19.0, 0.45), (21.0, 0.5), (f64::MAX, 0.5)] {
        assert!((reached(acceleration) - speed).abs() < 1e-9, "{acceleration} {}", reached(acceleration));
    }
}

#[test]
fn parameters_keep_their_values_in_other_numbers() {
    let deadlock = crate::orca::DeadlockParams { lean_rad: 0.25, patience_radii: 7.0 };
    let params = AvoidParams { horizon_s: 3.0, wall_horizon_s: 1.5, share: 0.75, margin_m: 0.125, deadlock };
    assert_eq!(params.cast::<f32>().cast::<f64>(), params);
    let mut avoider = Avoider::<f64, 4>::new(params);
    assert_eq!(avoider.params(), &params);
    avoider.params_mut().share = 0.5;
    assert_eq!(avoider.params().share, 0.5);
}

#[test]
fn fixed_point_robots_avoid_each_other() {
    let q = |x: f64| Q16::from_f64(x).unwrap();
    let own = Body::<Q16> {
        id: RobotId(1),
        velocity_mps: Vec3::new(q(0.5), Q16::ZERO, Q16::ZERO),
        radius_m: q(0.15),
        max_speed_mps: Q16::HALF,
        max_acceleration_mps2: Q16::MAX,
        step_s: q(0.05),
    };
    let other = Nearby {
        id: RobotId(2),
        offset_m: Vec3::new(q(1.0), Q16::ZERO, Q16::ZERO),
        velocity_mps: Vec3::new(q(-0.5), Q16::ZERO, Q16::ZERO),
        radius_m: q(0.15),
        gives_way: true,
        mode: Mode::Cruise,
        is_stranger: false,
    };
    let mut avoider = Avoider::<Q16, 8>::new(AvoidParams::default());
    let wish = Vec2::new(Q16::HALF, Q16::ZERO);
    let solution = avoider.velocity(&own, wish, None, &[other], &[], &mut rng());
    assert!(solution.penetration_mps < q(1e-3), "{solution:?}");
    assert!(solution.velocity_mps.y < q(-0.05), "to the right");
}

#[test]
fn robots_do_not_lean_for_robots_that_do_not_come_nearer() {
    let own = body(1, [0.4, 0.0]);
    let wish = Vec2::new(0.4, 0.0);
    let others =
        [robot(2, [0.8, 0.0], [0.4, 0.0]), robot(3, [0.5, 0.7], [0.5, 0.1]), robot(4, [-0.6, 0.0], [0.4, 0.0])];
    let got = avoider().velocity(&own, wish, None, &others, &[], &mut rng());
    assert_eq!(got.velocity_mps, wish);
}

#[test]
fn a_robot_opposite_gets_its_turn_at_a_door() {
    let walls = [
        Obstacle::Wall([Vec2::new(0.6, 0.2), Vec2::new(0.6, 4.0)]),
        Obstacle::Wall([Vec2::new(0.6, -0.2), Vec2::new(0.6, -4.0)]),
    ];
    let own = body(5, [0.0, 0.0]);
    let wish = Vec2::new(0.5, 0.0);
    let goal = Some(Vec2::new(4.0, 0.0));
    let goes = |avoider: &mut Avoider<f32, 16>, other: Nearby<f32>| {
        avoider.velocity(&own, wish, goal, &[other], &walls, &mut rng()).velocity_mps.x > 0.05
    };
    // Equally far: the smaller number. Nearer: any number.
    assert!(!goes(&mut avoider(), robot(4, [1.2, 0.0], [0.0, 0.0])));
    assert!(goes(&mut avoider(), robot(6, [1.2, 0.0], [0.0, 0.0])));
    assert!(!goes(&mut avoider(), robot(6, [1.1, 0.3], [0.0, 0.0])));
    assert!(goes(&mut avoider(), robot(4, [1.3, 0.2], [0.0, 0.0])));
    let mut waiting = avoider();
    let first = (0..200).find(|_| goes(&mut waiting, robot(4, [1.2, 0.0], [0.0, 0.0])));
    // Five to ten times 0.15 m at 0.5 m/s, in steps of 0.05 s.
    assert!(first.is_some_and(|tick| (29..=61).contains(&tick)), "{first:?}");
}

proptest! {
    #[test]
    fn any_bits_give_a_finite_velocity_within_the_speed_limit(
        bits: [u32; 12],
        own_bits: [u32; 3],
    ) {
        let f = bits.map(f32::from_bits);
        let own = Body {
            velocity_mps: Vec3::new(f32::from_bits(own_bits[0]), f32::from_bits(own_bits[1]), 0.0),
            ..body(1, [0.0, 0.0])
        };
        let others = [
            Nearby {
                offset_m: Vec3::new(f[0], f[1], 0.0),
                velocity_mps: Vec3::new(f[2], f[3], 0.0),
                ..robot(2, [0.0; 2], [0.0; 2])
            },
            Nearby {
                velocity_mps: Vec3::new(f[5], 0.1, 0.0),
                radius_m: f[4],
                ..robot(3, [0.5, 0.1], [0.0; 2])
            },
            robot(4, [0.5, -0.4], [0.0, 0.0]),
        ];
        let obstacles = [
            Obstacle::Wall([Vec2::new(f[6], f[7]), Vec2::new(1.0, f[8])]),
            Obstacle::Ball { center_m: Vec3::new(f[9], 1.0, 0.0), radius_m: f[10] },
            Obstacle::Plane { normal: Vec3::new(f[11], f[6], f[7]), distance_m: f[8] },
        ];
        let goal = Some(Vec2::new(f[10], f[11]));
        for acceleration in [f32::MAX, 2.0] {
            let own = Body { max_acceleration_mps2: acceleration, ..own };
            let mut avoider = avoider();
            for wish in [Vec2::new(f[0], f[5]), Vec2::new(0.3, 0.1)] {
                let got = avoider.velocity(&own, wish, goal, &others, &obstacles, &mut rng());
                prop_assert!(got.velocity_mps.is_finite() && got.penetration_mps.is_finite(), "{got:?}");
                let is_bounded = got.velocity_mps.norm() < 0.501 || acceleration < 10.0;
                prop_assert!(is_bounded, "{got:?}");
            }
        }
    }

    #[test]
    fn the_result_is_permitted_if_any_velocity_is(
        places in proptest::collection::vec((-2.0_f64..2.0, -2.0_f64..2.0), 1..10),
        wish in (-0.5_f32..0.5, -0.5_f32..0.5),
    ) {
        let others: std::vec::Vec<_> = places
            .iter()
            .enumerate()
            .filter(|(_, (x, y))| x * x + y * y > 0.1)
            .map(|(k, (x, y))| robot(k as u32 + 2, [*x, *y], [-0.2 * x, -0.2 * y]))
            .collect();
        let own = body(1, [0.2, 0.1]);
        let mut avoider = avoider();
        let mut planes = Vec::new();
        let hard = avoider.constraints(&own, &others, &[], &mut planes);
        let best = solve::<_, 16>(&planes, hard, Vec2::ZERO, 0.5);
        let got = avoider.velocity(&own, Vec2::new(wish.0, wish.1), None, &others, &[], &mut rng());
        prop_assert!((got.penetration_mps - best.penetration_mps).abs() < 1e-3, "{got:?} {best:?}");
    }
}
