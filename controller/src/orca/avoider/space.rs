use super::*;
use crate::orca::fixtures::{RADIUS_M, SPEED_MPS, STEP_S, body, rng_of, robot, vector};
use proptest::prelude::*;
use std::vec::Vec as StdVec;

type V = Vec3<f64>;

fn v(x: f64, y: f64, z: f64) -> V {
    V::new(x, y, z)
}

fn xyz(at: V) -> [f64; 3] {
    [at.x, at.y, at.z]
}

fn ball(x: f64, radius_m: f64) -> Obstacle<f64> {
    Obstacle::Ball { center_m: v(x, 0.0, 0.0), radius_m }
}

fn floor(distance_m: f64) -> Obstacle<f64> {
    Obstacle::Plane { normal: v(0.0, 0.0, 1.0), distance_m }
}

fn fly<const K: usize>(
    body: &Body<f64>,
    wish: V,
    goal: Option<V>,
    nearby: &[Nearby<f64>],
    obstacles: &[Obstacle<f64>],
) -> V {
    let mut avoider = Avoider::<_, K, _>::in_space(AvoidParams::default());
    let solution = avoider.velocity(body, wish, goal, nearby, obstacles, &mut rng_of(1, 1));
    solution.velocity_mps
}

fn obstacle(own: V, obstacle: &Obstacle<f64>, radius_m: f64, horizon_s: f64) -> Option<HalfSpace<V>> {
    let params = AvoidParams { wall_horizon_s: horizon_s, margin_m: 0.0, ..AvoidParams::default() };
    let body = Body { radius_m, ..body(1, [0.0; 3]) };
    static_obstacle(&params, &body, own, obstacle, obstacle.nearest_point())
}

fn swap(starts: &[V], most_s: f64) -> (Option<f64>, f64) {
    let goals: StdVec<_> = starts.iter().map(|&start| -start).collect();
    let (mut places, mut speeds) = (starts.to_vec(), std::vec![Vec3::ZERO; starts.len()]);
    let (mut gap, mut time) = (f64::INFINITY, 0.0);
    let free_s = starts.iter().map(|s| s.norm()).fold(0.0, f64::max) * 2.0 / SPEED_MPS;
    while time < most_s {
        if places.iter().zip(&goals).all(|(&p, &g)| (g - p).norm() < 0.02) {
            return (Some(time / free_s), gap);
        }
        let wishes: StdVec<_> = (0..places.len())
            .map(|i| {
                let mut nearby: StdVec<Nearby<f64>> = (0..places.len())
                    .filter(|&j| j != i)
                    .map(|j| robot(j as u32 + 1, xyz(places[j] - places[i]), xyz(speeds[j])))
                    .collect();
                nearby.sort_by(|a, b| a.offset_m.norm().total_cmp(&b.offset_m.norm()));
                nearby.truncate(16);
                let way = goals[i] - places[i];
                let wish = way.clamp_norm(SPEED_MPS.min(way.norm() / STEP_S));
                let body = body(i as u32 + 1, xyz(speeds[i]));
                fly::<16>(&body, wish, Some(way), &nearby, &[])
            })
            .collect();
        speeds = wishes;
        for (place, speed) in places.iter_mut().zip(&speeds) {
            *place += *speed * STEP_S;
        }
        for i in 0..places.len() {
            for j in 0..i {
                gap = gap.min((places[i] - places[j]).norm() - 2.0 * RADIUS_M);
            }
        }
        time += STEP_S;
    }
    (None, gap)
}

#[test]
fn paths_that_cross_in_one_point_are_flown_without_contact() {
    let mut stars: StdVec<StdVec<V>> = StdVec::new();
    let axis = |i: usize, sign: f64| {
        let mut components = [0.0; 3];
        components[i] = sign * 2.0;
        vector(components)
    };
    stars.push(std::vec![axis(0, 1.0), axis(0, -1.0)]);
    stars.push(std::vec![axis(2, 1.0), axis(2, -1.0)]);
    stars.push((0..3).flat_map(|i| [axis(i, 1.0), axis(i, -1.0)]).collect());
    let corners = (0..8).map(|bits| {
        let sign = |bit: u32| if bits >> bit & 1 == 0 { 1.2 } else { -1.2 };
        v(sign(0), sign(1), sign(2))
    });
    stars.push(corners.collect());
    let ring = (0..12).map(|i| {
        let angle = f64::from(i) * std::f64::consts::PI / 6.0;
        let (sin, cos) = Scalar::sin_cos(angle);
        v(2.0 * cos, 2.0 * sin, 0.0)
    });
    stars.push(ring.collect());
    for star in stars {
        let (ratio, gap) = swap(&star, 60.0);
        let count = star.len();
        assert!(ratio.is_some_and(|ratio| ratio < 1.5), "{count}: {ratio:?}");
        assert!(gap >= 0.0, "{count}: {gap}");
    }
}

#[test]
fn without_neighbours_the_wish_is_unchanged() {
    let wish = v(0.3, -0.1, 0.2);
    let own = body(1, xyz(wish));
    assert_eq!(fly::<8>(&own, wish, None, &[], &[]), wish);
    let behind = [robot(2, [-3.0, 0.0], [0.0; 2])];
    assert_eq!(fly::<8>(&own, wish, None, &behind, &[]), wish);
}

#[test]
fn a_robot_that_does_not_give_way_gets_the_whole_correction() {
    let wish = v(0.5, 0.0, 0.0);
    let aside = |gives_way: bool| {
        let other = Nearby { gives_way, ..robot(2, [0.5, 0.6], [0.0, -0.5]) };
        (fly::<8>(&body(1, xyz(wish)), wish, None, &[other], &[]) - wish).norm()
    };
    assert!(aside(false) > aside(true));
}

#[test]
fn two_robots_in_one_place_separate() {
    let go = |own: u32, other: u32| {
        let other = [robot(other, [0.0; 3], [0.0; 3])];
        fly::<8>(&body(own, [0.0; 3]), V::ZERO, None, &other, &[])
    };
    assert!((go(1, 2) - go(2, 1)).norm() > 0.5);
}

#[test]
fn floors_balls_and_walls_limit_the_speed_towards_them() {
    let down = v(0.0, 0.0, -3.0);
    // 2 m up with a radius of 0.5 m: at most 0.75 m/s down for 2 s.
    let above = obstacle(down, &floor(2.0), 0.5, 2.0).unwrap();
    assert_eq!((above.point, above.normal), (v(0.0, 0.0, -0.75), v(0.0, 0.0, 1.0)));
    for distance in [0.5, 0.1, -3.0] {
        let on = obstacle(down, &floor(distance), 0.5, 2.0).unwrap();
        assert_eq!(on.penetration(V::ZERO), 0.0);
        assert!(on.penetration(v(5.0, 5.0, -0.1)) > 0.0);
    }
    let ball = |x: f64| ball(x, 1.0);
    let ahead = obstacle(v(1.0, 0.0, 0.0), &ball(4.0), 0.5, 2.0).unwrap();
    assert!((ahead.point - v(1.25, 0.0, 0.0)).norm() < 1e-12);
    let touching = obstacle(v(1.0, 0.0, 0.0), &ball(1.5), 0.5, 2.0).unwrap();
    assert_eq!(touching.normal, v(-1.0, 0.0, 0.0));
    assert!(touching.penetration(V::ZERO).abs() < 1e-12);
    let inside = obstacle(V::ZERO, &ball(0.0), 0.5, 2.0).unwrap();
    assert_eq!(inside.normal, v(0.0, 0.0, 1.0));
    let wall = Obstacle::Wall([Vec2::new(2.0, -5.0), Vec2::new(2.0, 5.0)]);
    let space = obstacle(v(3.0, 0.0, 9.0), &wall, 0.5, 1.0).unwrap();
    assert!((space.point.dot(space.normal) + 1.5).abs() < 1e-9 && space.normal.z == 0.0);
}

#[test]
fn of_many_obstacles_the_nearest_count() {
    // A ball 0.5 m ahead is the last of the slice; all others are behind and farther away.
    let east = v(SPEED_MPS, 0.0, 0.0);
    for (behind, others) in [(32, 0), (17, 16)] {
        let mut obstacles: StdVec<_> = (0..behind).map(|k| ball(-1.0 - 0.01 * f64::from(k), 0.2)).collect();
        obstacles.push(ball(0.5, 0.2));
        let nearby: StdVec<_> = (0..others).map(|k| robot(k + 2, [-3.0, f64::from(k)], [0.0; 2])).collect();
        let got = fly::<32>(&body(1, xyz(east)), east, None, &nearby, &obstacles);
        let gap = |step: i32| (got * (f64::from(step) / 100.0) - v(0.5, 0.0, 0.0)).norm() - 0.35;
        let least = (0..=100).map(gap).fold(f64::MAX, f64::min);
        assert!(least > 0.0, "{behind} {others}: {got:?}");
    }
}

#[test]
fn a_body_with_inertia_gets_the_best_reachable_velocity() {
    let east = v(SPEED_MPS, 0.0, 0.0);
    let heavy = Body { max_acceleration_mps2: 1.0, ..body(1, xyz(east)) };
    let wall = Obstacle::Wall([Vec2::new(0.25, -1.0), Vec2::new(0.25, 1.0)]);
    let got = fly::<8>(&heavy, east, None, &[], &[wall]);
    assert!((got.x - 0.45).abs() < 1e-9, "{got:?}");
    // It turns as far as it can: among the reachable velocities the preferred one is not the best.
    let ahead = [robot(2, [0.6, 0.05], [-0.5, 0.0])];
    let got = fly::<8>(&heavy, east, Some(V::ZERO), &ahead, &[]);
    assert!((got - east).norm() < 0.05 + 1e-9, "{got:?}");
    assert!(got.y < -0.01, "{got:?}");
}

#[test]
fn the_margin_applies_to_obstacles() {
    let params = AvoidParams { margin_m: 0.1, ..AvoidParams::default() };
    let mut avoider = Avoider::<f64, 8, _>::in_space(params);
    let down = v(0.0, 0.0, -SPEED_MPS);
    let own = body(1, xyz(down));
    let below = [floor(RADIUS_M + 0.3)];
    let got = avoider.velocity(&own, down, None, &[], &below, &mut rng_of(1, 1));
    assert!((got.velocity_mps.z + 0.2).abs() < 1e-9, "{got:?}");
}

#[test]
fn a_robot_in_the_centre_of_a_ball_gets_out() {
    let centre = [ball(0.0, 0.2)];
    let up = fly::<8>(&body(1, [0.0; 3]), V::ZERO, None, &[], &centre);
    assert!((up - v(0.0, 0.0, SPEED_MPS)).norm() < 1e-9, "{up:?}");
    let mut in_plane = Avoider::<f64, 8>::new(AvoidParams::default());
    let own = body(1, [0.0; 3]);
    let east = in_plane.velocity(&own, Vec2::ZERO, None, &[], &centre, &mut rng_of(1, 1));
    assert!((east.velocity_mps.x - SPEED_MPS).abs() < 1e-9, "{east:?}");
}

#[test]
fn obstacles_that_are_not_finite_forbid_nothing() {
    let ball = |center_m, radius_m| Obstacle::Ball { center_m, radius_m };
    let plane = |normal, distance_m| Obstacle::Plane { normal, distance_m };
    let ahead = v(3.0, 0.0, 0.0);
    for bad in [f64::NAN, f64::INFINITY] {
        let spoilt = v(1.0, bad, 0.0);
        for nonsense in [
            ball(spoilt, 1.0),
            ball(ahead, bad),
            plane(spoilt, 1.0),
            plane(ahead, bad),
            Obstacle::Wall([Vec2::new(bad, 0.0), Vec2::new(1.0, 1.0)]),
        ] {
            assert_eq!(obstacle(V::ZERO, &nonsense, 0.5, 2.0), None, "{nonsense:?}");
        }
    }
}

fn flat(most: f64) -> impl Strategy<Value = [f64; 2]> {
    [-most..most, -most..most]
}

fn flat_robots() -> impl Strategy<Value = StdVec<Nearby<f64>>> {
    let others = proptest::collection::vec((flat(2.0), flat(0.5), any::<bool>()), 0..10);
    others.prop_map(|others| {
        let ids = 2..;
        let mut nearby: StdVec<_> = ids
            .zip(others)
            .map(|(id, (offset, velocity, gives_way))| Nearby { gives_way, ..robot(id, offset, velocity) })
            .collect();
        nearby.sort_by_key(|other| other.offset_m.length_key());
        nearby
    })
}

fn flat_obstacles(walls: usize) -> impl Strategy<Value = StdVec<Obstacle<f64>>> {
    let ball =
        (flat(2.0), 0.05..0.4_f64).prop_map(|(center, radius_m)| Obstacle::Ball { center_m: vector(center), radius_m });
    let plane = (0.0..6.2_f64, 0.0..2.0_f64).prop_map(|(angle, distance_m)| {
        let (sin, cos) = Scalar::sin_cos(angle);
        let normal = v(cos, sin, 0.0);
        Obstacle::Plane { normal, distance_m }
    });
    let wall = [flat(2.0), flat(2.0)].prop_map(|ends| Obstacle::Wall(ends.map(|end| vector(end).xy())));
    let solids = proptest::collection::vec(prop_oneof![3 => ball, 1 => plane], 0..8);
    let walls = proptest::collection::vec(wall, 0..=walls);
    (solids, walls).prop_map(|(mut solids, walls)| {
        solids.extend(walls);
        solids
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// If the plane's velocity violates nothing, neither does that in space, and it is the same one
    /// unless rounding leaves no velocity at all. If robots alone forbid all velocities of a body
    /// without inertia, the least penetration is the same. Contradictory obstacles differ: space
    /// shares them, the plane obeys the nearest.
    #[test]
    fn space_agrees_with_the_plane_at_one_height(
        own in flat(0.4),
        wish in flat(0.6),
        acceleration in prop_oneof![Just(f64::MAX), 0.5..8.0_f64],
        nearby in flat_robots(),
        obstacles in flat_obstacles(1),
    ) {
        fn step<const K: usize>(
            body: &Body<f64>, wish: V, nearby: &[Nearby<f64>], obstacles: &[Obstacle<f64>],
        ) -> Result<(), TestCaseError> {
            let params = AvoidParams::default();
            let mut plane = Avoider::<_, K>::new(params);
            let goal = Some(Vec2::ZERO);
            let plane = plane.velocity(body, wish.xy(), goal, nearby, obstacles, &mut rng_of(1, 1));
            let mut space = Avoider::<_, K, _>::in_space(params);
            let space = space.velocity(body, wish, Some(V::ZERO), nearby, obstacles, &mut rng_of(1, 1));
            if plane.penetration_mps < 1e-9 {
                let apart = (space.velocity_mps - plane.velocity_mps.extend(0.0)).norm();
                let is_rounded = plane.penetration_mps > 0.0 || space.penetration_mps > 0.0;
                prop_assert!(space.penetration_mps < 1e-9 && (is_rounded || apart < 1e-6), "{plane:?} {space:?}");
            } else if obstacles.is_empty() && body.max_acceleration_mps2 == f64::MAX {
                let apart = (space.penetration_mps - plane.penetration_mps).abs();
                prop_assert!(apart < 1e-6, "{plane:?} {space:?}");
            }
            Ok(())
        }
        let own = Body { max_acceleration_mps2: acceleration, ..body(1, own) };
        step::<32>(&own, vector(wish), &nearby, &obstacles)?;
        step::<6>(&own, vector(wish), &nearby, &obstacles)?;
    }

    /// Results are identical, unless two obstacles are equally near.
    #[test]
    fn the_order_of_obstacles_does_not_matter(
        wish in flat(0.6),
        nearby in flat_robots(),
        obstacles in flat_obstacles(3),
        turn in 0..10_usize,
    ) {
        let mut other = obstacles.clone();
        other.rotate_left(turn.min(obstacles.len()));
        other.reverse();
        let own = body(1, wish);
        let wish: V = vector(wish);
        let space = |obstacles: &[_]| fly::<8>(&own, wish, None, &nearby, obstacles);
        prop_assert_eq!(space(&obstacles), space(&other));
        let plane = |obstacles: &[_]| {
            let mut avoider = Avoider::<_, 8>::new(AvoidParams::default());
            avoider.velocity(&own, wish.xy(), None, &nearby, obstacles, &mut rng_of(1, 1))
        };
        prop_assert_eq!(plane(&obstacles), plane(&other));
    }

    #[test]
    fn a_robot_that_obeys_a_ball_does_not_touch_it_within_the_horizon(
        center in [-4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64],
        own in [-3.0..3.0_f64, -3.0..3.0_f64, -3.0..3.0_f64],
    ) {
        let (center_m, own): (V, V) = (vector(center), vector(own));
        prop_assume!(center_m.norm() > 1.6);
        let ball = Obstacle::Ball { center_m, radius_m: 1.0 };
        let space = obstacle(own, &ball, 0.5, 2.0).unwrap();
        let obeys = solve::<_, 1>(&[space], 0, own, 20.0).velocity_mps;
        let least = (0..=400)
            .map(|k| (obeys * (2.0 * f64::from(k) / 400.0) - center_m).norm())
            .fold(f64::MAX, f64::min);
        prop_assert!(least > 1.5 - 1e-6, "{least}");
    }

    #[test]
    fn any_input_gives_a_finite_velocity_within_the_speed_limit(
        bits in any::<[u32; 15]>(), gives_way: bool,
    ) {
        let [x, y, z, vx, vy, vz, wx, wy, wz, ox, oy, oz, r, gx, gy] = bits.map(f32::from_bits);
        let own = Body { velocity_mps: Vec3::new(vx, vy, vz), ..body(1, [0.0; 3]) };
        let other = Nearby {
            offset_m: Vec3::new(x, y, z),
            velocity_mps: Vec3::new(ox, oy, oz),
            radius_m: r,
            gives_way,
            ..robot(2, [0.0; 3], [0.0; 3])
        };
        let ball = Obstacle::Ball { center_m: Vec3::new(gx, gy, z), radius_m: r };
        let goal = Some(Vec3::new(gx, gy, 0.0));
        let wish = Vec3::new(wx, wy, wz);
        for acceleration in [f32::MAX, 2.0] {
            let own = Body { max_acceleration_mps2: acceleration, ..own };
            let mut avoider = Avoider::<f32, 4, _>::in_space(AvoidParams::default());
            let got = avoider.velocity(&own, wish, goal, &[other], &[ball], &mut rng_of(1, 1));
            prop_assert!(got.velocity_mps.is_finite(), "{got:?}");
            prop_assert!(got.velocity_mps.norm() <= 0.5001 || acceleration < 10.0, "{got:?}");
        }
    }
}

#[test]
fn downwash_reduces_vertical_but_not_horizontal_distance() {
    let params = Params { horizon_s: 2.0, separation_s: STEP_S, share: 0.5 };
    let ball = |offset_m| MovingBall { offset_m, velocity_mps: V::ZERO, radii_m: 0.4, tie: V::ZERO };
    let forbids = |downwash: f64, own: V, offset_m: V| {
        let space = InSpace { downwash }.half_space(own, &ball(offset_m), &params).expect("sound");
        space.penetration(own)
    };
    let (climb, above) = (v(0.0, 0.0, 0.1), v(0.0, 0.0, 1.0));
    assert!(forbids(1.0, climb, above) < 0.0 && forbids(3.0, climb, above) > 0.0);
    let (ahead, beside) = (v(0.4, 0.0, 0.0), v(1.0, 0.0, 0.0));
    assert!((forbids(1.0, ahead, beside) - forbids(3.0, ahead, beside)).abs() < 1e-12);
    for nonsense in [0.0, -3.0, 0.5, f64::NAN] {
        assert_eq!(forbids(nonsense, climb, above), forbids(1.0, climb, above));
    }
}

proptest! {
    #[test]
    fn velocities_on_the_border_just_miss_the_ellipsoid(
        own in prop::array::uniform3(-2.0..2.0_f64), offset in prop::array::uniform3(-5.0..5.0_f64), downwash in 1.0..6.0_f64,
    ) {
        let (radii_m, own, offset) = (0.4, vector(own), vector(offset));
        let lowered = |v: V| V::new(v.x, v.y, v.z / downwash);
        prop_assume!(lowered(offset).norm() > radii_m * 1.01);
        let ball = MovingBall { offset_m: offset, velocity_mps: V::ZERO, radii_m, tie: V::ZERO };
        let params = Params { horizon_s: 2.0, separation_s: STEP_S, share: 1.0 };
        let space = InSpace { downwash }.half_space(own, &ball, &params).expect("sound");
        prop_assert!((space.normal.norm() - 1.0).abs() < 1e-9);
        for tenth in 0..=20 {
            let at = space.point * (f64::from(tenth) / 10.0) - offset;
            prop_assert!(lowered(at).norm() > radii_m * (1.0 - 1e-6), "{at:?}");
        }
    }
}
