use super::*;
use crate::body::Body;
use crate::geom::Vec3;
use crate::obstacle::Obstacle;
use crate::orca::fixtures::{body, robot};
use crate::robot::RobotId;

type V = Vec2<f64>;

const EAST: V = V { x: 0.5, y: 0.0 };

/// The wish of a robot of radius 0.15 m that heads east at 0.5 m/s, turned by [`lean`].
fn leaned(other: Nearby<f64>, goal_m: f64, horizon_s: f64) -> V {
    let params = AvoidParams { horizon_s, ..AvoidParams::default() };
    let (body, goal) = (body(1, [0.0; 2]), V::new(goal_m, 0.0));
    let situation = Situation { body: &body, wish: EAST, goal: Some(goal), nearby: &[other], obstacles: &[] };
    lean(&params, &situation, goal)
}

#[test]
fn a_robot_turns_to_the_right_for_a_near_robot_that_comes_nearer() {
    let turns = |at: [f64; 2], velocity: [f64; 2]| leaned(robot(2, at, velocity), 9.0, 1.0) != EAST;
    // 5.333 radii between the bodies are 0.8 m, and 1.1 m between their centres.
    assert!(turns([1.09, 0.0], [0.0; 2]) && !turns([1.11, 0.0], [0.0; 2]));
    assert!(turns([0.5, 0.9], [0.0; 2]) && turns([0.5, -0.9], [0.0; 2]));
    assert!(!turns([-0.5, 0.0], [1.0, 0.0]), "behind");
    assert!(!turns([0.0, 0.5], [0.0, -0.4]), "beside");
    assert!(turns([0.6, 0.0], [0.49, 0.0]) && !turns([0.6, 0.0], [0.5, 0.0]) && !turns([0.6, 0.0], [0.6, 0.0]));
    let large = Nearby { radius_m: 0.3, ..robot(2, [1.24, 0.0], [0.0; 2]) };
    assert_ne!(leaned(large, 9.0, 1.0), EAST);
    // Fast robots, which look ahead farther, turn earlier: 0.8 of the 2 m within 4 s.
    let ahead = |x: f64| leaned(robot(2, [x, 0.0], [0.0; 2]), 9.0, 4.0) != EAST;
    assert!(ahead(1.89) && !ahead(1.91));
    // Near the goal it would circle.
    let at_goal = |goal_m: f64| leaned(robot(2, [0.6, 0.0], [0.0; 2]), goal_m, 4.0) != EAST;
    assert!(!at_goal(0.79) && at_goal(0.81));
    let got = leaned(robot(2, [0.6, 0.0], [0.0; 2]), 9.0, 2.0);
    let angle = AvoidParams::<f64>::default().deadlock.lean_rad;
    assert!((got - V::new(0.5 * libm::cos(angle), -0.5 * libm::sin(angle))).norm() < 1e-12, "{got:?}");
}

#[test]
fn a_robot_heads_for_the_corner_of_a_wall_at_the_speed_of_its_wish() {
    let wall = [Obstacle::Wall([V::new(2.0, -0.5), V::new(2.0, 1.0)])];
    let own = body(1, [0.0; 2]);
    let wishes = |wish: V, goal: V| {
        let nearby = [robot(2, [-3.0, 0.0], [0.0; 2])];
        let situation = Situation { body: &own, wish, goal: Some(goal), nearby: &nearby, obstacles: &wall };
        let mut course = Course::NEW;
        around(&mut course, &situation, goal)
    };
    let corner = V::new(2.0, -0.5 - 1.1 * 0.15);
    let got = wishes(EAST * 0.5, V::new(4.0, 0.0));
    assert!((got - corner * (0.25 / corner.norm())).norm() < 1e-12, "{got:?}");
    assert_eq!(wishes(EAST, V::new(1.5, 0.0)), EAST, "no wall in between");
    assert_eq!(wishes(V::ZERO, V::new(4.0, 0.0)), V::ZERO);
}

fn in_space(own: &Body<f64>, wish: [f64; 3], goal: Option<[f64; 3]>, other: Nearby<f64>) -> Vec3<f64> {
    let vector = |[x, y, z]: [f64; 3]| Vec3::new(x, y, z);
    let (wish, goal) = (vector(wish), goal.map(vector));
    spread(2.0, &Situation { body: own, wish, goal, nearby: &[other], obstacles: &[] })
}

#[test]
fn in_space_a_robot_turns_for_one_that_it_could_meet_within_the_horizon() {
    let own = body(1, [0.0; 3]);
    let turns = |at: [f64; 3], velocity: [f64; 3], goal| {
        let wish = [0.5, 0.0, 0.0];
        in_space(&own, wish, goal, robot(2, at, velocity)) != Vec3::new(0.5, 0.0, 0.0)
    };
    let stands = [0.0; 3];
    // Two radii, and 2 s at the own 0.5 m/s and the speed of the other one.
    assert!(turns([1.29, 0.0, 0.0], stands, None) && !turns([1.31, 0.0, 0.0], stands, None));
    assert!(turns([1.79, 0.0, 0.0], [0.0, 0.25, 0.0], None) && !turns([1.81, 0.0, 0.0], [0.0, 0.25, 0.0], None));
    // Within 45 degrees of the wish.
    assert!(turns([0.5, 0.0, 0.49], stands, None) && !turns([0.5, 0.0, 0.51], stands, None));
    assert!(turns([0.5, -0.49, 0.0], stands, None) && !turns([0.5, -0.51, 0.0], stands, None));
    assert!(!turns([-0.5, 0.0, 0.0], stands, None));
    // Not for a robot behind the goal.
    assert!(
        turns([0.5, 0.0, 0.0], stands, Some([0.51, 0.0, 0.0]))
            && !turns([0.5, 0.0, 0.0], stands, Some([0.0, 0.5, 0.0]))
    );
    assert_eq!(in_space(&own, [0.0; 3], None, robot(2, [0.5, 0.0, 0.0], stands)), Vec3::ZERO);
}

#[test]
fn in_space_robots_turn_by_25_degrees_to_the_right_and_by_their_id_up_or_down() {
    for id in [1, 2, 3, 7, 40, 1000] {
        let own = Body { id: RobotId(id), ..body(1, [0.0; 3]) };
        // Multiples of the golden ratio: from 45 degrees down to 45 degrees up.
        let part = (f64::from(id.wrapping_mul(0x9E37_79B9)) / 4_294_967_296.0 * 65_536.0).floor() / 65_536.0;
        let (up, level) = Scalar::sin_cos((part - 0.5) * core::f64::consts::FRAC_PI_2);
        let (sin, cos) = Scalar::sin_cos(25.0_f64.to_radians());
        for (wish, turned) in [
            ([0.5, 0.0, 0.0], [cos, -sin * level, sin * up]),
            ([-0.5, 0.0, 0.0], [-cos, sin * level, sin * up]),
            ([0.0, 0.0, 0.5], [sin * level, -sin * up, cos]),
            ([0.0, 0.0, -0.5], [-sin * level, -sin * up, -cos]),
        ] {
            let ahead = wish.map(|component| component * 1.2);
            let got = in_space(&own, wish, None, robot(2, ahead, [0.0; 3]));
            let off = got - Vec3::new(turned[0], turned[1], turned[2]) * 0.5;
            assert!(off.norm() < 1e-5, "{id} {wish:?}: {got:?}");
        }
    }
}
