use super::*;
use crate::orca::solve;
use proptest::prelude::*;

mod land;

type V = Vec2<f64>;

fn v(x: f64, y: f64) -> V {
    V::new(x, y)
}

#[test]
fn walls_ahead_beside_and_touching() {
    let forward = v(1.0, 0.0);
    // A wall 2 m ahead across the path, radius 0.5, 1 s: at most 1.5 m/s towards it.
    let ahead = wall(forward, [v(2.0, -5.0), v(2.0, 5.0)], 0.5, 1.0).unwrap();
    assert!((ahead.point.dot(ahead.normal) + 1.5).abs() < 1e-9, "{ahead:?}");
    assert!((ahead.normal - v(-1.0, 0.0)).norm() < 1e-9);
    // A wall along the path at 1 m to the left: sideways at most 0.5 m/s.
    let beside = wall(forward, [v(-50.0, 1.0), v(50.0, 1.0)], 0.5, 1.0).unwrap();
    assert!((beside.normal - v(0.0, -1.0)).norm() < 1e-9);
    assert!(beside.penetration(v(1.0, 0.49)) < 0.0 && beside.penetration(v(1.0, 0.51)) > 0.0);
    let touching = wall(forward, [v(0.5, -1.0), v(0.5, 1.0)], 0.5, 1.0).unwrap();
    assert_eq!((touching.point, touching.normal), (V::ZERO, v(-1.0, 0.0)));
    let post = wall(v(3.0, 0.1), [v(2.0, 0.0); 2], 0.5, 10.0).unwrap();
    assert!(post.normal.y > 0.9, "pass on the left leg {post:?}");
    assert!(wall(forward, [v(f64::NAN, 0.0), v(1.0, 1.0)], 0.5, 1.0).is_none());
}

/// The velocity is nearer to the border of the disc at an end of the wall, which the side hides.
#[test]
fn beside_a_short_wall_its_side_counts() {
    for y in [0.05, 0.25, 0.45] {
        let plane = wall(v(1.9, y), [v(2.0, 0.0), v(2.0, 0.5)], 0.5, 1.0).unwrap();
        assert!((plane.normal - v(-1.0, 0.0)).norm() < 1e-9, "{plane:?}");
        assert!((plane.point.x - 1.5).abs() < 1e-9, "{plane:?}");
    }
}

#[test]
fn a_wall_without_a_radius_a_horizon_or_finite_ends_forbids_nothing() {
    let ends = [v(2.0, -1.0), v(2.0, 1.0)];
    let east = v(1.0, 0.0);
    assert!(wall(east, ends, 0.5, 1.0).is_some());
    for (radius, horizon) in [(0.0, 1.0), (-0.5, 1.0), (0.5, 0.0), (0.5, -1.0), (f64::NAN, 1.0), (0.5, f64::NAN)] {
        assert_eq!(wall(east, ends, radius, horizon), None, "{radius} {horizon}");
    }
    let bad = v(0.0, f64::INFINITY);
    assert_eq!([wall(bad, ends, 0.5, 1.0), wall(east, [bad, ends[1]], 0.5, 1.0)], [None; 2]);
    assert_eq!(wall(east, [ends[0], bad], 0.5, 1.0), None);
}

#[test]
fn a_robot_on_a_wall_may_leave_it_to_one_side() {
    let normal = |ends: [V; 2]| wall(v(1.0, 0.0), ends, 0.5, 1.0).map(|plane| (plane.point, plane.normal));
    assert_eq!(normal([v(0.0, -1.0), v(0.0, 1.0)]), Some((V::ZERO, v(-1.0, 0.0))), "to the left of its direction");
    assert_eq!(normal([v(0.0, 1.0), v(0.0, -1.0)]), Some((V::ZERO, v(1.0, 0.0))));
    assert_eq!(normal([V::ZERO; 2]), Some((V::ZERO, v(1.0, 0.0))), "a point: east");
    assert_eq!(normal([v(0.3, -1.0), v(0.3, 1.0)]), Some((V::ZERO, v(-1.0, 0.0))));
    let beyond = normal([v(0.51, -1.0), v(0.51, 1.0)]).unwrap();
    assert!((beyond.0 - v(0.01, 0.0)).norm() < 1e-9, "{beyond:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// The distance to the half-plane is the one to the nearest velocity that avoids the wall.
    #[test]
    fn a_wall_demands_the_least_change(
        a in (-4.0_f64..4.0, -4.0_f64..4.0),
        b in (-4.0_f64..4.0, -4.0_f64..4.0),
        own in (-3.0_f64..3.0, -3.0_f64..3.0),
    ) {
        let (ends, own) = ([v(a.0, a.1), v(b.0, b.1)], v(own.0, own.1));
        let (radius, horizon) = (0.5, 2.0);
        // The least distance of the wall from the way to `velocity` times the horizon.
        let clearance = |velocity: V| {
            let way = velocity * horizon;
            let from = |at: V, [a, b]: [V; 2]| {
                let along = b - a;
                let t = ((at - a).dot(along) / along.norm_squared()).clamp(0.0, 1.0);
                (at - a - along * t).norm()
            };
            let ways = [V::ZERO, way];
            let crosses = (ends[0].det(way) > 0.0) != (ends[1].det(way) > 0.0)
                && ((ends[1] - ends[0]).det(-ends[0]) > 0.0) != ((ends[1] - ends[0]).det(way - ends[0]) > 0.0);
            let least = [from(V::ZERO, ends), from(way, ends), from(ends[0], ways), from(ends[1], ways)];
            if crosses { 0.0 } else { least.into_iter().fold(f64::MAX, f64::min) }
        };
        prop_assume!((ends[1] - ends[0]).norm() > 1e-3 && own.norm() > 1e-3);
        prop_assume!(Obstacle::Wall(ends).nearest_point().is_some_and(|(_, distance)| distance > radius * 1.001));
        let plane = wall(own, ends, radius, horizon).unwrap();
        let swapped = wall(own, [ends[1], ends[0]], radius, horizon).unwrap();
        prop_assert!((plane.penetration(own) - swapped.penetration(own)).abs() < 1e-9);
        let depth = plane.penetration(own);
        prop_assert_eq!(depth > 0.0, clearance(own) < radius, "{} {}", depth, clearance(own));
        // Around the own velocity no nearer one avoids the wall, and one at that distance does.
        let around = |length: f64| {
            (0..64).map(move |k| {
                let (sin, cos) = Scalar::sin_cos(f64::from(k) * core::f64::consts::TAU / 64.0);
                own + v(cos, sin) * length
            })
        };
        if depth > 1e-6 {
            let mut inside = around(depth * 0.999);
            prop_assert!(inside.all(|velocity| clearance(velocity) < radius + 1e-6), "{plane:?}");
            prop_assert!(clearance(own + plane.normal * (depth + 1e-6)) >= radius - 1e-9, "{plane:?}");
        } else {
            let mut free = around(-depth * 0.999);
            prop_assert!(free.all(|velocity| clearance(velocity) > radius - 1e-6), "{plane:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_robot_that_obeys_a_wall_does_not_touch_it(
        a in (-4.0_f64..4.0, -4.0_f64..4.0),
        b in (-4.0_f64..4.0, -4.0_f64..4.0),
        own in (-3.0_f64..3.0, -3.0_f64..3.0),
    ) {
        let (ends, own) = ([v(a.0, a.1), v(b.0, b.1)], v(own.0, own.1));
        let (radius, horizon) = (0.5, 2.0);
        let clearance = |velocity: V| {
            (0..=400)
                .map(|k| velocity * (horizon * f64::from(k) / 400.0))
                .map(|at| {
                    let along = ends[1] - ends[0];
                    let t = ((at - ends[0]).dot(along) / along.norm_squared()).clamp(0.0, 1.0);
                    (at - ends[0] - along * t).norm()
                })
                .fold(f64::MAX, f64::min)
        };
        prop_assume!(clearance(V::ZERO) > radius && (ends[1] - ends[0]).norm() > 1e-3);
        let plane = wall(own, ends, radius, horizon).unwrap();
        prop_assert!((plane.normal.norm() - 1.0).abs() < 1e-9);
        let obeys = solve::<_, 1>(&[plane], 0, own, 20.0).velocity_mps;
        prop_assert!(clearance(obeys) > radius - 1e-6, "{plane:?} {}", clearance(obeys));
        if clearance(own) > radius + 0.02 {
            prop_assert!((obeys - own).norm() < 1e-9, "free already: {own:?} became {obeys:?}");
        }
    }
}
