//! Tests of waypoints that are sent by packet, and of waypoints that move.

use super::*;

fn order(to: u32, version: u8, index: u8, x_mm: i32) -> Message {
    Message::Waypoint(WaypointAssignment {
        to: RobotId(to),
        version,
        index,
        position_mm: [x_mm, 0, 0],
        velocity_mmps: [0; 3],
    })
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
        let params = crate::flock::goal::GoalParams::new(0.6, 1.0);
        GoalFlockGuidance::<f32>::new(params, 1.0, 1)
    };
    let goal = |index, position_mm| {
        Message::Waypoint(WaypointAssignment {
            to: RobotId(1),
            version: index,
            index,
            position_mm,
            velocity_mmps: [0; 3],
        })
    };
    let (first, second) = (goal(0, [40_000, 0, 0]), goal(1, [0, 40_000, 0]));
    let mut robot = Robot::new(&in_plane(1), guidance(), Unguarded, [0.0; 2]);
    for (n, message) in [second.clone(), first, second].into_iter().enumerate() {
        let _ = robot.step(step_number(n as i32), &bytes(99, 0, n as u16, &[message]));
    }
    let [vx, vy] = robot.velocity_mps;
    assert!(vx > 0.1 && (vx - vy).abs() < 0.05, "to the middle: {vx} {vy}");
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
        assert!(robot.agent.assign_waypoint(index, &place(x_mm, y_mm)));
    }
    assert!(!robot.agent.assign_waypoint(4, &place(9_000, 9_000)), "there is no number 3 yet");
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
    assert!(robot.agent.assign_waypoint(0, &place(0, 0)));
    for n in 200..300 {
        let _ = robot.step(step_number(n), &[]);
    }
    assert!(length(robot.at_m) < 0.02 && robot.agent.mode() == Mode::Arrived, "{:?}", robot.at_m);
}
