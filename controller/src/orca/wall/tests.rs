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
