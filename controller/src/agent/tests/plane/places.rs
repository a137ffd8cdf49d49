//! Tests of waypoints that are sent by packet, and of waypoints that move.

use super::*;

fn order(to: u32, number: u8, index: u8, x_mm: i32) -> Message {
    Waypoints::order(RobotId(to), number, &WaypointOrder { index, waypoint: place(x_mm, 0) }).unwrap()
}

#[test]
fn waypoints_are_assigned_by_packet_and_older_ones_ignored() {
    let mut robot = Robot::new(&in_plane(1), waypoint::<f32>(), orca(), [0.0; 2]);
    let (east, west) = (50_000, -50_000);
    let mut n = 0;
    let mut goes_east_after = |sender, boot, message| {
        n += 1;
        let _ = robot.step(step_number(n), &bytes(sender, boot, n as u16, &[message]));
        (robot.speed() > 0.9).then_some(robot.velocity_mps[0] > 0.0)
    };
    assert_eq!(goes_east_after(99, 0, order(2, 9, 0, east)), None, "another's");
    assert_eq!(goes_east_after(99, 0, order(1, 0, 1, east)), None, "no room");
    assert_eq!(goes_east_after(99, 0, order(1, 0, 255, east)), None, "no such place");
    assert_eq!(goes_east_after(99, 0, order(1, 5, 0, east)), Some(true));
    assert_eq!(goes_east_after(99, 0, order(1, 4, 0, west)), Some(true), "older");
    assert_eq!(goes_east_after(99, 0, order(1, 5, 0, west)), Some(true), "again");
    assert_eq!(goes_east_after(99, 0, order(0, 6, 0, west)), Some(false), "to all");
    assert_eq!(goes_east_after(99, 1, order(1, 0, 0, east)), Some(true), "restarted");
    assert_eq!(goes_east_after(98, 0, order(1, 0, 0, west)), Some(false), "another one");
}

#[test]
fn a_rejected_waypoint_is_accepted_when_it_is_repeated() {
    let guidance = || {
        let params = crate::goal_flock::GoalParams::new(0.6, 1.0);
        GoalFlockGuidance::<f32>::new(params, 1.0, 1)
    };
    let goal = |index, x_mm, y_mm| {
        let order = WaypointOrder { index, waypoint: place(x_mm, y_mm) };
        Waypoints::order(RobotId(1), index, &order).unwrap()
    };
    let (first, second) = (goal(0, 40_000, 0), goal(1, 0, 40_000));
    let mut robot = Robot::new(&in_plane(1), guidance(), Unguarded, [0.0; 2]);
    for (n, message) in [second.clone(), first, second].into_iter().enumerate() {
        let _ = robot.step(step_number(n as i32), &bytes(99, 0, n as u16, &[message]));
    }
    let [vx, vy] = robot.velocity_mps;
    assert!(vx > 0.1 && (vx - vy).abs() < 0.05, "to the middle: {vx} {vy}");
}

#[test]
fn a_moving_waypoint_is_where_it_was_when_its_frame_was_sent() {
    for latency in 0..3 {
        let config = AgentConfig { latency: STEP.saturating_mul(latency), ..in_plane(1) };
        let mut robot = Robot::new(&config, waypoint::<f32>(), Unguarded, [1.0, 0.0]);
        let velocity_mps = Vec3::new(0.5, -0.25, 0.0);
        // The sender's clock is another one.
        let waypoint = Waypoint { velocity_mps, at: step_number(77), ..place(1000, 0) };
        let order = Waypoints::order(RobotId(1), 0, &WaypointOrder::first(waypoint)).unwrap();
        for n in 10..40 {
            let inbox = if n == 10 { bytes(99, 0, 0, core::slice::from_ref(&order)) } else { vec![] };
            let _ = robot.step(step_number(n), &inbox);
        }
        let age_s = f64::from(30 + latency) * 0.1;
        let off = [robot.at_m[0] - 1.0 - 0.5 * age_s, robot.at_m[1] + 0.25 * age_s];
        assert!(length(off) < 0.02, "{latency}: {off:?} m");
    }
}

#[test]
fn a_waypoint_on_the_air_has_millimetres_and_saturated_velocities() {
    let order = |velocity_mps| {
        let waypoint = Waypoint { velocity_mps, at: step_number(77), ..place(-1234, i32::MAX) };
        WaypointOrder { index: 3, waypoint }
    };
    let received = |order: &WaypointOrder| {
        let (_, bytes) = order.encode::<{ crate::wire::MAX_ORDER }>(Waypoints::ID).unwrap();
        assert_eq!(bytes.len(), 1 + 18);
        WaypointOrder::decode(Waypoints::ID, Waypoints::ID, &bytes).unwrap()
    };
    let said = order(Vec3::new(0.25, -1.5, 0.0));
    let at = Instant::from_micros(0);
    assert_eq!(received(&said), WaypointOrder { index: 3, waypoint: Waypoint { at, ..said.waypoint } });
    let wild = received(&order(Vec3::new(f32::INFINITY, -99.0, f32::NAN))).waypoint.velocity_mps;
    assert_eq!((wild.x, wild.y, wild.z), (32.767, -32.768, 0.0));
}

#[test]
fn a_waypoint_moves_across_wraps_of_the_clock() {
    fn check<S: Scalar>(tolerance: f64) {
        let velocity_mps = Vec3::new(S::from_milli(-50), S::from_milli(125), S::ZERO);
        let mut place = Waypoint { velocity_mps, ..place::<S>(1000, 2000) };
        // Four hours: the clock wraps three times.
        for minute in 0..240 {
            let now = (0..minute).fold(step_number(0), |now, _| now + Duration::from_millis(60_000));
            let way = place.way(Position::from_mm([1000, 0, 0]), now);
            let age_s = f64::from(minute) * 60.0;
            let off = [way.x.to_f64() + 0.05 * age_s, way.y.to_f64() - 2.0 - 0.125 * age_s];
            assert!(length(off) < tolerance, "after {minute} min: {off:?} m");
        }
    }
    check::<f32>(0.02);
    check::<f64>(0.02);
    // 1/8 is exact in Q16; 0.05 has an error of up to 8e-6.
    check::<Q16>(0.15);
}

#[test]
fn a_waypoint_with_a_future_time_is_extrapolated_backwards() {
    let mut place = Waypoint { velocity_mps: Vec3::new(1.0, 0.0, 0.0), at: step_number(10), ..place::<f32>(0, 0) };
    for n in 0..20 {
        let way = place.way(Position::ORIGIN, step_number(n));
        assert!((way.x - (n as f32 - 10.0) * 0.1).abs() < 2e-3, "{n}: {way:?}");
    }
}

#[test]
fn a_course_is_followed_in_order_and_replaced_by_a_new_one() {
    let mut robot = Robot::new(&in_plane(1), waypoint::<f32>(), orca(), [0.0; 2]);
    let course = [(5_000, 0), (5_000, 5_000), (0, 5_000)];
    for (index, (x_mm, y_mm)) in (0..).zip(course) {
        assert!(robot.agent.order(&WaypointOrder { index, waypoint: place(x_mm, y_mm) }));
    }
    assert!(!robot.agent.order(&WaypointOrder { index: 4, waypoint: place(9_000, 9_000) }), "there is no number 3 yet");
    let mut nearest_m = [f64::INFINITY; 3];
    let mut arrived = Vec::new();
    for n in 0..200 {
        let _ = robot.step(step_number(n), &[]);
        for (nearest_m, (x_mm, y_mm)) in nearest_m.iter_mut().zip(course) {
            let [x, y] = robot.at_m;
            *nearest_m = nearest_m.min(length([x - f64::from(x_mm) / 1e3, y - f64::from(y_mm) / 1e3]));
        }
        if robot.agent.mode() == Mode::Arrived {
            arrived.push(n);
        }
    }
    assert!(nearest_m[0] < 0.6 && nearest_m[1] < 0.6 && nearest_m[2] < 0.01, "{nearest_m:?}");
    // 15 m minus two corners, at 1 m/s without stops.
    assert!((130..150).contains(&arrived[0]) && arrived.len() > 40, "{:?}", arrived.first());
    assert!(robot.agent.order(&WaypointOrder::first(place(0, 0))));
    for n in 200..300 {
        let _ = robot.step(step_number(n), &[]);
    }
    assert!(length(robot.at_m) < 0.02 && robot.agent.mode() == Mode::Arrived, "{:?}", robot.at_m);
}

/// The direction and speed of the first step on a course in millimetres, and the mode after it.
fn first_step(config: &AgentConfig<f32>, tolerance_m: f32, course: &[[i32; 2]], own_mps: f64) -> ([f64; 2], Mode) {
    let mut robot = Robot::new(config, WaypointGuidance::new(1.0, tolerance_m), orca(), [0.0; 2]);
    for (index, [x, y]) in (0..).zip(course) {
        assert!(robot.agent.order(&WaypointOrder { index, waypoint: place(*x, *y) }));
    }
    robot.velocity_mps = [own_mps, 0.0];
    let _ = robot.step(step_number(0), &[]);
    (robot.velocity_mps, robot.agent.mode())
}

/// The radius is 0.2 m.
#[test]
fn a_waypoint_is_passed_within_its_tolerance_or_three_radii() {
    for (tolerance_m, within, beyond) in [(1.0, 1000, 1001), (0.01, 590, 610)] {
        let goes_on = |x_mm: i32| {
            let ([x, y], mode) = first_step(&in_plane(1), tolerance_m, &[[x_mm, 0], [x_mm, 9000], [0, 9000]], 0.0);
            assert_eq!(mode, Mode::Cruise);
            y > x
        };
        assert_eq!((goes_on(within), goes_on(beyond)), (true, false), "{tolerance_m}");
        let is_there = |x_mm: i32| first_step(&in_plane(1), tolerance_m, &[[x_mm, 0]], 0.0).1 == Mode::Arrived;
        let most = (tolerance_m * 1000.0) as i32;
        assert_eq!((is_there(most), is_there(most + 1)), (true, false));
    }
}

/// Within reach of the present speed, the next one is that from which the body stops at the end.
#[test]
fn a_body_brakes_for_the_end_of_its_course_and_not_for_waypoints_before_it() {
    let config = AgentConfig { radius_m: 0.01, max_acceleration_mps2: 1.0, ..in_plane(1) };
    for (course, left_m) in [
        (&[[200, 0]][..], 0.2),
        (&[[200, 0], [200, 100]], 0.3),
        (&[[200, 0], [200, 50], [120, 50]], 0.33),
        (&[[10, 0], [310, 0], [310, 40], [350, 40]], 0.39),
    ] {
        let body = crate::body::Body {
            id: RobotId(1),
            velocity_mps: Vec3::ZERO,
            radius_m: 0.01,
            max_speed_mps: 1.0,
            max_acceleration_mps2: 1.0,
            step_s: 0.1,
        };
        let expected: f32 = body.stopping_speed(left_m);
        let ([x, y], _) = first_step(&config, 0.005, course, f64::from(expected) - 0.03);
        assert!((x - f64::from(expected)).abs() < 1e-5 && y.abs() < 1e-6, "{course:?}: {x} {y}, expected {expected}");
    }
}

/// Runs an agent whose body follows commands exactly with a lag. Returns body, velocity,
/// command and mode after each step.
fn run_lagging(
    [stated_s, lag_s]: [f64; 2],
    goal: &Waypoint<f64>,
    tolerance_m: f64,
    steps: i32,
) -> Vec<([f64; 2], [[f64; 2]; 2], Mode)> {
    let config = AgentConfig { lag_s: stated_s, max_acceleration_mps2: 1.5, ..in_plane(1) };
    let mut robot = Robot::new(&config, WaypointGuidance::new(1.0, tolerance_m), orca(), [0.0; 2]);
    assert!(robot.agent.order(&WaypointOrder::first(goal.cast())));
    let (left, mut own) = (libm::exp(-0.1 / lag_s), [0.0; 2]);
    let step = |n| {
        robot.velocity_mps = own;
        let before = robot.at_m;
        let _ = robot.step(step_number(n), &[]);
        for (axis, command) in robot.velocity_mps.into_iter().enumerate() {
            robot.at_m[axis] = before[axis] + command * 0.1 + (own[axis] - command) * lag_s * (1.0 - left);
            own[axis] = command + (own[axis] - command) * left;
        }
        (robot.at_m, [own, robot.velocity_mps], robot.agent.mode())
    };
    (0..steps).map(step).collect()
}

#[test]
fn a_body_with_a_lag_arrives_when_it_is_there_itself() {
    for (lag_s, tolerance_m) in [(0.1, 0.3), (0.4, 0.3), (1.0, 0.1), (2.0, 0.5)] {
        let moments = run_lagging([lag_s; 2], &place(4000, 3000), tolerance_m, 400);
        let off_m = |[x, y]: [f64; 2]| length([x - 4.0, y - 3.0]);
        let first = moments.iter().position(|(.., mode)| *mode == Mode::Arrived).expect("it arrives");
        // The position before the step in which it decides.
        assert!(off_m(moments[first - 1].0) <= tolerance_m + 1e-3, "lag {lag_s} s: {:?}", moments[first - 1]);
        assert!(moments[first..].iter().all(|(at, _, mode)| *mode == Mode::Arrived && off_m(*at) < tolerance_m));
    }
}

#[test]
fn a_body_with_a_lag_does_not_fall_behind_a_moving_waypoint() {
    for lag_s in [0.1, 0.4, 1.0] {
        let goal = Waypoint { velocity_mps: Vec3::new(0.3, -0.4, 0.0), ..place(1000, 500) };
        let moments = run_lagging([lag_s; 2], &goal, 0.05, 300);
        let ([x, y], [[vx, vy], _], _) = moments[299];
        let off = [x - 1.0 - 0.3 * 30.0, y - 0.5 + 0.4 * 30.0];
        assert!(length(off) < 0.06, "lag {lag_s} s: {off:?} m");
        assert!(length([vx - 0.3, vy + 0.4]) < 0.02, "lag {lag_s} s: {vx} {vy}");
    }
}

#[test]
fn a_body_slower_than_stated_is_not_turned_back_at_its_goal() {
    for (stated_s, tolerance_m, x_mm) in [(0.2, 0.05, 700), (0.3, 0.1, 700), (0.3, 0.1, 6050), (0.5, 0.2, 6000)] {
        let moments = run_lagging([stated_s, 1.1 * stated_s], &place(x_mm, 0), tolerance_m, 300);
        assert!(moments.iter().all(|(_, [_, command], _)| command[0] >= 0.0), "lag {stated_s} s");
        let ([x, _], _, mode) = moments[299];
        let off_m = (x - f64::from(x_mm) / 1000.0).abs();
        assert!(mode == Mode::Arrived && off_m < tolerance_m, "lag {stated_s} s: {mode:?}, {off_m} m off");
    }
}
