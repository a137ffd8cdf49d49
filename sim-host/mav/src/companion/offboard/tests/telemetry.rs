use super::*;

#[test]
fn telemetry_is_requested_again_after_a_restart_or_at_a_low_rate() {
    let mut bench = Bench::rover(RULES);
    bench.reports = true;
    assert_eq!(commands(&bench.run(10.0), 511), 6, "one request each, since the rate is right");
    bench.boot_ms = 0;
    assert_eq!(commands(&bench.run(2.0), 511), 6);
    bench.fixes = false;
    assert!(commands(&bench.run(9.0), 511) >= 4);
    let mut copter = Bench::new(Kind::ArduCopter, RULES, 0, ARMED);
    assert_eq!(commands(&copter.run(2.0), 511), 7, "with the landed state");
}

#[test]
fn an_autopilot_without_estimator_status_is_asked_a_few_times_and_trusted() {
    let mut bench = Bench::rover(RULES);
    assert_eq!(commands(&bench.run(60.0), 511), 2 + 3 * 4);
    assert_eq!(bench.state(), State::Steering);
    assert_eq!(bench.events().iter().filter(|event| **event == Event::NoHealth).count(), 1);
}

#[test]
fn a_problem_stops_the_vehicle_at_once_and_for_a_time_after_its_end() {
    let mut bench = Bench::rover(RULES);
    bench.reports = true;
    bench.run(2.0);
    let known = bench.offboard.fix();
    bench.ekf_flags = 0x27;
    bench.ekf();
    assert_eq!(bench.state(), State::Distrusted);
    assert_eq!(bench.offboard.fresh_fix(bench.now), None);
    let sent = bench.run(3.0);
    let stops = setpoints(&sent);
    assert!(stops.len() >= 58 && stops.iter().all(stands));
    assert_eq!((bench.offboard.fix(), bench.offboard.tally().doubts), (known, 1));
    bench.ekf_flags = 0x33F;
    bench.run(4.7);
    assert_eq!(bench.state(), State::Distrusted);
    bench.run(0.5);
    assert_eq!(bench.state(), State::Steering);
    assert!(bench.offboard.fresh_fix(bench.now).is_some());
}

#[test]
fn an_untrusted_first_position_does_not_start_the_entry() {
    let mut bench = Bench::new(Kind::ArduRover, Rules { arm: true, ..ONCE }, MANUAL, DISARMED);
    bench.ekf_flags = 0xA7;
    bench.reports = true;
    bench.ekf();
    let sent = bench.run(10.0);
    assert_eq!(bench.state(), State::Pilot);
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 0, "no request without a trusted position");
    (bench.mode, bench.base) = (GUIDED, ARMED);
    let sent = bench.run(3.0);
    assert_eq!((bench.state(), setpoints(&sent).len()), (State::NoPosition, 0));
}

#[test]
fn reordered_messages_are_dropped_and_clocks_may_wrap() {
    let mut bench = Bench::rover(RULES);
    bench.boot_ms = u32::MAX - 500;
    bench.run(2.0);
    assert_eq!(bench.offboard.tally().restarts, 0, "the clock wrapped");
    let before = bench.offboard.tally().positions;
    bench.boot_ms -= 1000;
    bench.fix();
    assert_eq!(bench.offboard.tally().positions, before, "an old position");
    bench.boot_ms += 1000;
    // A step back of 2000 ms is reordering, of 2001 ms a restart.
    bench.fix();
    bench.boot_ms = bench.boot_ms.wrapping_sub(2000);
    bench.fix();
    assert_eq!(bench.offboard.tally().restarts, 0);
    bench.boot_ms = bench.boot_ms.wrapping_sub(1);
    bench.fix();
    assert_eq!(bench.offboard.tally().restarts, 1);
    // A restart after 30 days appears as a jump ahead.
    bench.boot_ms = 30 * 86_400_000;
    bench.fix();
    let restarts = bench.offboard.tally().restarts;
    bench.boot_ms = 1000;
    bench.fix();
    assert_eq!(bench.offboard.tally().restarts, restarts + 1);
}

#[test]
fn latitude_and_longitude_zero_are_not_a_position() {
    let mut bench = Bench::rover(RULES);
    bench.fixes = false;
    let nowhere = MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA::DEFAULT);
    bench.offboard.hear(&nowhere, bench.now);
    bench.run(1.0);
    assert_eq!(bench.state(), State::NoPosition);
    assert_eq!(bench.offboard.fix(), None);
}

#[test]
fn the_finer_velocity_is_used_while_it_is_fresh() {
    let mut bench = Bench::rover(RULES);
    let local = |vx| {
        MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
            time_boot_ms: 60_000,
            vx,
            ..LOCAL_POSITION_NED_DATA::DEFAULT
        })
    };
    bench.offboard.hear(&local(0.123), bench.now);
    bench.offboard.hear(&local(f32::NAN), bench.now);
    bench.fix();
    let velocity = |bench: &Bench| bench.offboard.fix().unwrap().velocity_ned_mps[0];
    assert!((velocity(&bench) - 0.123).abs() < 1e-6);
    bench.now += Duration::from_millis(201);
    bench.fix();
    assert!((velocity(&bench) - 1.0).abs() < 1e-9);
}

#[test]
fn a_restart_within_two_seconds_of_boot_is_not_taken_for_reordering() {
    let mut bench = Bench::rover(RULES);
    bench.boot_ms = 0;
    bench.run(1.9);
    assert_eq!((bench.state(), bench.offboard.tally().restarts), (State::Steering, 0));
    bench.boot_ms = 0;
    bench.run(1.0);
    assert_eq!((bench.state(), bench.offboard.tally().restarts), (State::Restarted, 1));
    let mut bench = Bench::rover(RULES);
    bench.run(1.0);
    for _ in 0..20 {
        let now = bench.boot_ms;
        bench.boot_ms = now - 900;
        bench.fix();
        bench.boot_ms = now + 10;
        bench.fix();
    }
    for behind in 1..20 {
        bench.boot_ms -= behind;
        bench.fix();
    }
    assert_eq!(bench.offboard.tally().restarts, 0);
}
