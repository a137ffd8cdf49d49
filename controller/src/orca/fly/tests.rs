use super::*;
use crate::robot::RobotId;
use proptest::prelude::*;
use std::vec::Vec as StdVec;

const STEP_S: f64 = 0.05;
const RADIUS_M: f64 = 0.15;
const SPEED_MPS: f64 = 0.5;

fn body(id: u32, velocity_mps: Vec3<f64>) -> Body<f64> {
    Body {
        id: RobotId(id),
        velocity_mps,
        radius_m: RADIUS_M,
        max_speed_mps: SPEED_MPS,
        max_acceleration_mps2: f64::MAX,
        step_s: STEP_S,
    }
}

fn near(id: u32, offset_m: Vec3<f64>, velocity_mps: Vec3<f64>) -> Nearby<f64> {
    Nearby {
        id: RobotId(id),
        offset_m,
        velocity_mps,
        radius_m: RADIUS_M,
        gives_way: true,
    }
}

/// Everybody to the place opposite through the origin; the time of the last one over the free time, and the least gap.
fn swap(starts: &[Vec3<f64>], most_s: f64) -> (Option<f64>, f64) {
    let params = FlyParams::default();
    let goals: StdVec<_> = starts.iter().map(|&start| -start).collect();
    let (mut places, mut speeds) = (starts.to_vec(), std::vec![Vec3::ZERO; starts.len()]);
    let (mut gap, mut time) = (f64::INFINITY, 0.0);
    let free_s = starts.iter().map(|s| s.norm()).fold(0.0, f64::max) * 2.0 / SPEED_MPS;
    while time < most_s {
        if places
            .iter()
            .zip(&goals)
            .all(|(&p, &g)| (g - p).norm() < 0.02)
        {
            return (Some(time / free_s), gap);
        }
        let wishes: StdVec<_> = (0..places.len())
            .map(|i| {
                let mut nearby: StdVec<_> = (0..places.len())
                    .filter(|&j| j != i)
                    .map(|j| near(j as u32 + 1, places[j] - places[i], speeds[j]))
                    .collect();
                nearby.sort_by(|a, b| a.offset_m.norm().total_cmp(&b.offset_m.norm()));
                nearby.truncate(16);
                let way = goals[i] - places[i];
                let wish = way.clamp_norm(SPEED_MPS.min(way.norm() / STEP_S));
                let body = body(i as u32 + 1, speeds[i]);
                fly::<f64, 16>(&params, &body, wish, Some(way), &nearby, &[]).velocity_mps
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
fn ways_that_all_cross_in_one_point_are_flown_without_a_touch() {
    // Axes of the octahedron and of the cube, and a ring in the plane.
    let mut stars: StdVec<StdVec<Vec3<f64>>> = StdVec::new();
    let axis = |i: usize, sign: f64| {
        let mut v = [0.0; 3];
        v[i] = sign * 2.0;
        Vec3::new(v[0], v[1], v[2])
    };
    stars.push(std::vec![axis(0, 1.0), axis(0, -1.0)]);
    stars.push(std::vec![axis(2, 1.0), axis(2, -1.0)]);
    stars.push((0..3).flat_map(|i| [axis(i, 1.0), axis(i, -1.0)]).collect());
    let corners = (0..8).map(|bits| {
        let sign = |bit: u32| if bits >> bit & 1 == 0 { 1.2 } else { -1.2 };
        Vec3::new(sign(0), sign(1), sign(2))
    });
    stars.push(corners.collect());
    let ring = (0..12).map(|i| {
        let angle = f64::from(i) * std::f64::consts::PI / 6.0;
        let (sin, cos) = Scalar::sin_cos(angle);
        Vec3::new(2.0 * cos, 2.0 * sin, 0.0)
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
fn nobody_near_changes_nothing() {
    let wish = Vec3::new(0.3, -0.1, 0.2);
    let alone = fly::<f64, 8>(&FlyParams::default(), &body(1, wish), wish, None, &[], &[]);
    assert_eq!(alone.velocity_mps, wish);
    let behind = [near(2, Vec3::new(-3.0, 0.0, 0.0), Vec3::ZERO)];
    let same = fly::<f64, 8>(
        &FlyParams::default(),
        &body(1, wish),
        wish,
        None,
        &behind,
        &[],
    );
    assert_eq!(same.velocity_mps, wish);
}

#[test]
fn the_floor_is_kept_and_who_does_not_give_way_is_given_all_of_it() {
    let floor = [Obstacle::Plane {
        normal: Vec3::new(0.0, 0.0, 1.0),
        distance_m: RADIUS_M,
    }];
    let down = Vec3::new(0.0, 0.0, -0.5);
    let got = fly::<f64, 8>(
        &FlyParams::default(),
        &body(1, down),
        down,
        None,
        &[],
        &floor,
    );
    assert!(got.velocity_mps.z >= -1e-9);
    // He comes from the left; nothing leans for him.
    let ahead = Vec3::new(0.5, 0.6, 0.0);
    let wish = Vec3::new(0.5, 0.0, 0.0);
    let side = |gives_way: bool| {
        let other = Nearby {
            gives_way,
            ..near(2, ahead, Vec3::new(0.0, -0.5, 0.0))
        };
        let params = FlyParams::default();
        let got = fly::<f64, 8>(&params, &body(1, wish), wish, None, &[other], &[]).velocity_mps;
        (got - wish).norm()
    };
    assert!(side(false) > side(true));
}

#[test]
fn two_in_one_place_part() {
    let (a, b) = (body(1, Vec3::ZERO), body(2, Vec3::ZERO));
    let go = |body: &Body<f64>, other: u32| {
        let other = [near(other, Vec3::ZERO, Vec3::ZERO)];
        fly::<f64, 8>(&FlyParams::default(), body, Vec3::ZERO, None, &other, &[]).velocity_mps
    };
    let (va, vb) = (go(&a, 2), go(&b, 1));
    assert!((va - vb).norm() > 0.5, "{va:?} {vb:?}");
}

proptest! {
    #[test]
    fn any_numbers_give_a_finite_velocity_within_the_speed(
        bits in any::<[u32; 15]>(), gives_way: bool,
    ) {
        let [x, y, z, vx, vy, vz, wx, wy, wz, ox, oy, oz, r, gx, gy] = bits.map(f32::from_bits);
        let body = Body {
            id: RobotId(1),
            velocity_mps: Vec3::new(vx, vy, vz),
            radius_m: 0.1_f32,
            max_speed_mps: 0.5,
            max_acceleration_mps2: f32::MAX,
            step_s: 0.05,
        };
        let other = Nearby {
            id: RobotId(2),
            offset_m: Vec3::new(x, y, z),
            velocity_mps: Vec3::new(ox, oy, oz),
            radius_m: r,
            gives_way,
        };
        let ball = Obstacle::Ball { center_m: Vec3::new(gx, gy, z), radius_m: r };
        let way = Some(Vec3::new(gx, gy, 0.0));
        let wish = Vec3::new(wx, wy, wz);
        let got = fly::<f32, 4>(&FlyParams::default(), &body, wish, way, &[other], &[ball]);
        prop_assert!(got.velocity_mps.is_finite());
        prop_assert!(got.velocity_mps.norm() <= 0.5001);
    }
}
