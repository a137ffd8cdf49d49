use super::*;

fn second(bench: &mut Bench, from_us: u64) -> Vec<MavMessage> {
    bench.vehicle.out = Out::default();
    for step in 1..500 {
        let now_us = from_us + step * 2000;
        bench.vehicle.poll(now_us);
    }
    core::mem::take(&mut bench.vehicle.out.messages)
}

fn count<D: MessageData>(messages: &[MavMessage]) -> usize {
    let is_one = |message: &&MavMessage| staya_mavlink::mavlink_core::Message::message_id(*message) == D::ID;
    messages.iter().filter(is_one).count()
}

#[test]
fn streams_have_the_requested_rates() {
    let mut bench = Bench::new(model());
    let messages = second(&mut bench, 0);
    assert_eq!(count::<HEARTBEAT_DATA>(&messages), 1);
    assert_eq!(count::<LOCAL_POSITION_NED_DATA>(&messages), 10);
    assert_eq!(count::<AUTOPILOT_VERSION_DATA>(&messages), 0);
    let set = MAV_CMD_SET_MESSAGE_INTERVAL;
    let (position, heartbeat) = (LOCAL_POSITION_NED_DATA::ID as f32, HEARTBEAT_DATA::ID as f32);
    assert_eq!(bench.command(set, two(position, 20_000.0)), MAV_RESULT_ACCEPTED);
    let attitude = ATTITUDE_DATA::ID as f32;
    assert_eq!(bench.command(set, two(attitude, -1.0)), MAV_RESULT_ACCEPTED);
    let messages = second(&mut bench, 1_000_000);
    assert_eq!(count::<LOCAL_POSITION_NED_DATA>(&messages), 50);
    assert_eq!(count::<ATTITUDE_DATA>(&messages), 0);
    assert_eq!(bench.command(set, two(attitude, 0.0)), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_GET_MESSAGE_INTERVAL, first(attitude)), MAV_RESULT_ACCEPTED);
    let told = MESSAGE_INTERVAL_DATA { interval_us: 200_000, message_id: 30 };
    assert_eq!(bench.vehicle.out.messages[1], MavMessage::MESSAGE_INTERVAL(told));
    for (bad, result) in [
        (two(position, 10.0), MAV_RESULT_DENIED),
        (two(position, -2.0), MAV_RESULT_DENIED),
        (two(position, NAN), MAV_RESULT_DENIED),
        (two(heartbeat, -1.0), MAV_RESULT_DENIED),
        (two(NAN, 1000.0), MAV_RESULT_DENIED),
        (two(12_345.0, 1000.0), MAV_RESULT_UNSUPPORTED),
    ] {
        assert_eq!(bench.command(set, bad), result, "{bad:?}");
    }
    bench.give(MavMessage::REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA {
        req_message_rate: 4,
        target_system: 7,
        target_component: 1,
        req_stream_id: 0,
        start_stop: 1,
    }));
    let messages = second(&mut bench, 2_000_000);
    assert_eq!(count::<LOCAL_POSITION_NED_DATA>(&messages), 4);
    assert_eq!(count::<HEARTBEAT_DATA>(&messages), 1);
}

#[test]
fn every_streamed_message_can_be_requested_once() {
    let mut bench = Bench::new(model());
    let request = MAV_CMD_REQUEST_MESSAGE;
    for id in [0, 1, 2, 24, 30, 32, 33, 42, 49, 74, 147, 148, 193, 242, 245_u32] {
        assert_eq!(bench.command(request, first(id as f32)), MAV_RESULT_ACCEPTED, "{id}");
        assert_eq!(bench.vehicle.out.messages.len(), 2, "{id}");
    }
    assert_eq!(bench.command(request, first(11.0)), MAV_RESULT_UNSUPPORTED);
    let version = MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES;
    assert_eq!(bench.command(version, first(1.0)), MAV_RESULT_ACCEPTED);
    assert!(matches!(bench.vehicle.out.messages[1], MavMessage::AUTOPILOT_VERSION(_)));
}

#[test]
fn positions_are_north_east_down_and_on_the_earth() {
    let mut bench = Bench::new(flying());
    bench.tick(|sample| {
        sample.motion.position_m = [100.0, 200.0, 30.0];
        sample.motion.velocity_mps = [3.0, -4.0, 1.0];
    });
    let Some(MavMessage::LOCAL_POSITION_NED(local)) = bench.vehicle.telemetry(32) else {
        panic!("a position");
    };
    assert_eq!([local.x, local.y, local.z], [200.0, 100.0, -30.0]);
    assert_eq!([local.vx, local.vy, local.vz], [-4.0, 3.0, -1.0]);
    let Some(MavMessage::GLOBAL_POSITION_INT(global)) = bench.vehicle.telemetry(33) else {
        panic!("a position");
    };
    let expected = origin().to_global([100.0, 200.0, 30.0]).expect("near").to_e7();
    assert_eq!([global.lat, global.lon, global.alt], expected);
    assert_eq!((global.relative_alt, global.vx, global.vy, global.vz), (30_000, -400, 300, -100));
    assert_eq!(global.hdg, 14_313);
    assert_eq!(bench.vehicle.uptime_us(), 100_000);
}

#[test]
fn heartbeats_report_mode_and_arming() {
    let mut bench = Bench::new(model());
    let heartbeat = |bench: &Bench| match bench.vehicle.telemetry(0) {
        Some(MavMessage::HEARTBEAT(heartbeat)) => heartbeat,
        other => panic!("{other:?}"),
    };
    let beat = heartbeat(&bench);
    assert_eq!((beat.mavtype, beat.autopilot, beat.custom_mode), (10, 3, 10));
    assert_eq!((beat.base_mode & 0x81, beat.system_status), (0x81, MAV_STATE_ACTIVE));
    bench.tick(|sample| sample.status.mode = Mode::Fault);
    assert_eq!(heartbeat(&bench).system_status, MAV_STATE_CRITICAL);
    bench.command(MAV_CMD_COMPONENT_ARM_DISARM, NONE);
    let beat = heartbeat(&bench);
    assert_eq!((beat.base_mode & 0x80, beat.system_status), (0, MAV_STATE_STANDBY));
}

/// DroneKit's `is_armable` and MAVSDK's `health_all_ok` wait for these bits.
#[test]
fn estimator_and_sensors_are_healthy_in_the_words_of_ardupilot() {
    let mut bench = Bench::new(flying());
    let Some(MavMessage::EKF_STATUS_REPORT(ekf)) = bench.vehicle.telemetry(193) else { panic!("a status") };
    let (predicted, absolute, constant) = (512, 16, 128);
    assert_eq!(ekf.flags & (predicted | absolute | constant), predicted | absolute);
    let status = |bench: &Bench| match bench.vehicle.telemetry(1) {
        Some(MavMessage::SYS_STATUS(status)) => [
            status.onboard_control_sensors_present,
            status.onboard_control_sensors_enabled,
            status.onboard_control_sensors_health,
        ],
        other => panic!("{other:?}"),
    };
    // Gyro, accelerometer, compass, GPS, AHRS, and the checks before arming.
    let needed = 0b10_0111 | 1 << 21 | 1 << 28;
    assert_eq!(status(&bench).map(|bits| bits & needed), [needed; 3]);
    bench.tick(|sample| sample.status.mode = Mode::Fault);
    let [present, _, health] = status(&bench);
    assert_eq!(present & !health, 1 << 14, "position control has failed");
}

#[test]
fn ping_timesync_and_file_requests_are_answered_at_once() {
    let mut bench = Bench::new(model());
    let ping = PING_DATA { time_usec: 77, seq: 3, ..PING_DATA::DEFAULT };
    let answer = PING_DATA { target_system: GCS.system, target_component: GCS.component, ..ping.clone() };
    let out = bench.give(MavMessage::PING(ping));
    assert_eq!(out.messages, [MavMessage::PING(answer.clone())]);
    assert!(bench.give(MavMessage::PING(answer)).messages.is_empty(), "an answer");
    bench.tick(|_| {});
    let out = bench.give(MavMessage::TIMESYNC(TIMESYNC_DATA { tc1: 0, ts1: 5 }));
    let expected = TIMESYNC_DATA { tc1: 100_000_000, ts1: 5 };
    assert_eq!(out.messages, [MavMessage::TIMESYNC(expected)]);
    let mut asked =
        FILE_TRANSFER_PROTOCOL_DATA { target_system: 7, target_component: 1, ..FILE_TRANSFER_PROTOCOL_DATA::DEFAULT };
    asked.payload[..4].copy_from_slice(&[255, 255, 9, 4]);
    let out = bench.give(MavMessage::FILE_TRANSFER_PROTOCOL(asked));
    let [MavMessage::FILE_TRANSFER_PROTOCOL(answer)] = &out.messages[..] else {
        panic!("an answer");
    };
    assert_eq!(answer.payload[..6], [0, 0, 9, 129, 1, 4]);
    assert_eq!((answer.payload[12], answer.target_system), (10, 255));
}

#[test]
fn a_robot_that_is_down_is_silent_and_loses_its_mode() {
    let mut bench = guided(model());
    assert_eq!(load(&mut bench, &[item(0, 0.0, 0.0), item(1, 1.0, 1.0)]), 0);
    bench.tick(|sample| sample.is_up = false);
    assert!(second(&mut bench, 0).is_empty());
    bench.give(MavMessage::PING(PING_DATA::DEFAULT));
    assert!(bench.vehicle.out.messages.is_empty());
    bench.sample.is_up = true;
    let parameters = bench.vehicle.parameters.clone();
    bench.vehicle.restart(parameters, (bench.time_us, bench.sample));
    assert_eq!(bench.texts(), ["restarted"]);
    assert_eq!((bench.vehicle.mode, bench.vehicle.mission.len()), (FlightMode::Auto, 2));
    assert_eq!(bench.vehicle.uptime_us(), 0);
}

#[test]
fn events_and_setpoint_timeouts_are_reported_as_texts() {
    let mut bench = guided(model());
    bench.tick(|sample| {
        sample.wish = Wish::Velocity { velocity_mps: Vec3::ZERO, valid: Duration::ZERO };
    });
    bench.tick(|sample| sample.wish = Wish::Hold);
    assert_eq!(bench.texts(), ["setpoint timed out: holding"]);
    let arrived = Event::ModeChanged { from: Mode::Cruise, to: Mode::Arrived };
    let lost = [2, 3].map(|id| Event::NeighborLost(staya_controller::robot::RobotId(id)));
    let events = [arrived, lost[0], lost[1]];
    bench.vehicle.out = Out::default();
    bench.vehicle.observe((bench.time_us, bench.sample), &events, 9_000_000);
    assert_eq!(bench.texts(), ["arrived", "robot 2 is lost"]);
}
