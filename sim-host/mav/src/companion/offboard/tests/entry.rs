use super::super::poll::ATTEMPTS;
use super::*;

#[test]
fn one_request_leads_to_control() {
    let mut bench = Bench::new(Kind::ArduRover, ONCE, MANUAL, ARMED);
    let sent = bench.run(1.0);
    assert_eq!(bench.state(), State::Entering);
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 1);
    assert_eq!(setpoints(&sent).len(), 0);
    bench.mode = GUIDED;
    bench.run(0.5);
    assert_eq!(bench.state(), State::Steering);
}

#[test]
fn no_request_before_the_first_position() {
    let mut bench = Bench::new(Kind::ArduRover, ONCE, MANUAL, ARMED);
    bench.fixes = false;
    let sent = bench.run(42.0);
    assert_eq!(bench.state(), State::Pilot);
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 0);
    bench.fixes = true;
    let sent = bench.run(1.0);
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 1);
}

#[test]
fn requests_end_after_the_last_retry() {
    let mut bench = Bench::new(Kind::ArduRover, ONCE, MANUAL, ARMED);
    let sent = bench.run(200.0);
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), usize::from(ATTEMPTS));
    assert_eq!(bench.state(), State::Pilot);
    assert!(bench.events().contains(&Event::GaveUp));
}

#[test]
fn any_action_of_the_pilot_ends_the_requests() {
    let mut bench = Bench::new(Kind::ArduRover, ONCE, MANUAL, ARMED);
    bench.run(1.0);
    bench.mode = 4;
    let sent = bench.run(30.0);
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 0);
    assert!(bench.events().contains(&Event::PilotActs));
    bench.mode = GUIDED;
    bench.run(1.0);
    assert_eq!(bench.state(), State::Steering);
}

#[test]
fn disarming_ends_the_entry_and_is_not_reversed() {
    let mut bench = Bench::new(Kind::ArduRover, Rules { arm: true, ..ONCE }, MANUAL, DISARMED);
    assert_eq!(commands(&bench.run(1.0), MAV_CMD_DO_SET_MODE), 1);
    bench.mode = GUIDED;
    assert_eq!(commands(&bench.run(1.0), MAV_CMD_COMPONENT_ARM_DISARM), 1);
    bench.base = ARMED;
    bench.run(1.0);
    assert_eq!(bench.state(), State::Steering);
    bench.base = DISARMED;
    let sent = bench.run(30.0);
    assert_eq!(bench.state(), State::Disarmed);
    assert_eq!(commands(&sent, MAV_CMD_COMPONENT_ARM_DISARM), 0);
}

#[test]
fn a_refusal_is_reported_once() {
    let mut bench = Bench::new(Kind::ArduRover, ONCE, MANUAL, ARMED);
    bench.run(1.0);
    bench.events();
    for result in [4, 4, 4, 0] {
        let ack = MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
            command: MAV_CMD_DO_SET_MODE,
            result,
            ..COMMAND_ACK_DATA::DEFAULT
        });
        bench.offboard.hear(&ack, bench.now);
    }
    let told = bench.events();
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].to_string(), "mode change (command 176): failed");
}

#[test]
fn a_copter_is_armed_takes_off_and_is_controlled_at_its_height() {
    let mut bench = Bench::new(Kind::ArduCopter, FLY, 0, DISARMED);
    assert_eq!(commands(&bench.run(1.0), MAV_CMD_DO_SET_MODE), 1);
    bench.mode = 4;
    assert_eq!(commands(&bench.run(1.0), MAV_CMD_COMPONENT_ARM_DISARM), 1);
    bench.base = ARMED;
    let sent = bench.run(1.0);
    assert_eq!(commands(&sent, MAV_CMD_NAV_TAKEOFF), 1);
    assert_eq!(setpoints(&sent).len(), 0, "velocities would end the take-off");
    bench.above_home_m = 8.9;
    bench.run(0.5);
    assert_eq!(bench.state(), State::Entering);
    bench.above_home_m = 9.0;
    let sent = bench.run(0.5);
    assert_eq!(bench.state(), State::Steering);
    assert_eq!(setpoints(&sent).last().unwrap().vz, -0.5, "climbs the last metre");
    bench.above_home_m = 30.0;
    assert_eq!(setpoints(&bench.run(0.5)).last().unwrap().vz, 1.0);
}

#[test]
fn in_space_the_agent_commands_the_height_after_takeoff() {
    for (kind, mode) in [(Kind::ArduCopter, 4), (Kind::Px4Copter, OFFBOARD)] {
        let mut bench = Bench::new(kind, Rules { keeps_altitude: false, ..FLY }, mode, ARMED);
        bench.down_mps = 0.7;
        let sent = bench.run(1.0);
        assert_eq!(bench.state(), State::Entering);
        assert_eq!(setpoints(&sent).last().map(|setpoint| setpoint.vz), kind.is_px4().then_some(-1.0));
        bench.above_home_m = 9.5;
        let sent = bench.run(1.0);
        assert_eq!(bench.state(), State::Steering);
        assert_eq!(setpoints(&sent).last().unwrap().vz, 0.7, "{kind:?}");
    }
}

#[test]
fn a_flying_vehicle_is_not_controlled_on_the_ground() {
    let mut bench = Bench::new(Kind::ArduCopter, RULES, 4, ARMED);
    let sent = bench.run(2.0);
    assert_eq!(bench.state(), State::Grounded);
    assert_eq!(setpoints(&sent).len(), 0);
    bench.above_home_m = 1.0;
    bench.run(0.5);
    assert_eq!(bench.state(), State::Steering);
    bench.offboard.hear(&landed(1), bench.now);
    bench.run(0.5);
    assert_eq!(bench.state(), State::Grounded);
    bench.above_home_m = 0.2;
    bench.offboard.hear(&landed(2), bench.now);
    bench.run(0.5);
    assert_eq!(bench.state(), State::Steering);
}

fn landed(landed_state: u8) -> MavMessage {
    MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA { landed_state, ..EXTENDED_SYS_STATE_DATA::DEFAULT })
}

#[test]
fn no_setpoints_during_the_pilots_takeoff_and_landing() {
    let mut bench = Bench::new(Kind::ArduCopter, RULES, 4, ARMED);
    bench.above_home_m = 5.0;
    for (landed_state, state) in
        [(1, State::Grounded), (3, State::Grounded), (2, State::Steering), (4, State::Grounded)]
    {
        bench.offboard.hear(&landed(landed_state), bench.now);
        let sent = bench.run(1.0);
        assert_eq!(bench.state(), state, "landed_state {landed_state}");
        assert_eq!(setpoints(&sent).is_empty(), state == State::Grounded, "landed_state {landed_state}");
    }
}

#[test]
fn control_begins_after_the_climb_and_continues_during_later_climbs() {
    for landed_state in [0, 2] {
        let mut bench = Bench::new(Kind::ArduCopter, RULES, 4, ARMED);
        bench.offboard.hear(&landed(landed_state), bench.now);
        (bench.above_home_m, bench.climb_mps) = (4.0, 0.31);
        bench.run(1.0);
        assert_eq!(bench.state(), State::Grounded);
        bench.climb_mps = 0.29;
        bench.run(1.0);
        assert_eq!(bench.state(), State::Steering);
        bench.climb_mps = 2.0;
        bench.run(1.0);
        assert_eq!(bench.state(), State::Steering);
    }
}

#[test]
fn a_started_takeoff_is_not_requested_again() {
    let mut bench = Bench::new(Kind::ArduCopter, FLY, 4, ARMED);
    bench.offboard.hear(&landed(1), bench.now);
    assert_eq!(commands(&bench.run(3.0), MAV_CMD_NAV_TAKEOFF), 2, "the takeoff has not started");
    bench.offboard.hear(&landed(3), bench.now);
    assert_eq!(commands(&bench.run(10.0), MAV_CMD_NAV_TAKEOFF), 0);
    let mut bench = Bench::new(Kind::ArduCopter, FLY, 4, ARMED);
    bench.run(1.0);
    bench.above_home_m = 1.0;
    assert_eq!(commands(&bench.run(10.0), MAV_CMD_NAV_TAKEOFF), 0);
}

#[test]
fn px4_gets_setpoints_before_the_mode_request() {
    let mut bench = Bench::new(Kind::Px4Rover, ONCE, POSITION_CONTROL, ARMED);
    let sent = bench.run(0.9);
    assert!(setpoints(&sent).len() >= 17 && setpoints(&sent).iter().all(stands));
    assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 0);
    let sent = bench.run(0.5);
    let request = sent.iter().find_map(|message| match message {
        MavMessage::COMMAND_LONG(data) if data.command == MAV_CMD_DO_SET_MODE => Some(data),
        _ => None,
    });
    let request = request.expect("a mode request");
    assert_eq!((request.param1, request.param2), (1.0, 6.0));
    bench.mode = OFFBOARD;
    bench.run(1.0);
    assert_eq!(bench.state(), State::Steering);
}

#[test]
fn px4_gets_setpoints_for_its_pilots_offboard_but_none_after_a_hand_over() {
    let mut bench = Bench::new(Kind::Px4Copter, RULES, POSITION_CONTROL, ARMED);
    bench.above_home_m = 5.0;
    let offered = setpoints(&bench.run(2.0));
    assert!(offered.len() >= 38 && offered.iter().all(stands));
    bench.mode = OFFBOARD;
    bench.run(2.0);
    assert_eq!(bench.state(), State::Steering);
    bench.mode = POSITION_CONTROL;
    bench.beat();
    let sent = bench.run(QUIET.as_secs_f64() - 0.01);
    assert_eq!(setpoints(&sent).len(), 0);
    let offered = setpoints(&bench.run(1.0));
    assert!(!offered.is_empty() && offered.iter().all(stands));
}

#[test]
fn a_dry_run_shows_its_requests_and_then_velocities() {
    let rules = Rules { rehearses: true, stale: Duration::from_secs(3), ..FLY };
    let mut bench = Bench::new(Kind::ArduCopter, rules, 0, DISARMED);
    bench.fixes = false;
    let mut sent = Vec::new();
    for _ in 0..10 {
        bench.fix();
        sent.extend(bench.run(1.0));
    }
    for (command, times) in
        [(MAV_CMD_DO_SET_MODE, 1), (MAV_CMD_COMPONENT_ARM_DISARM, 1), (MAV_CMD_NAV_TAKEOFF, 1), (511, 7)]
    {
        assert_eq!(commands(&sent, command), times, "{command}");
    }
    let states = bench.events().iter().filter(|event| matches!(event, Event::State(_))).count();
    assert_eq!(states, 1, "the state does not oscillate");
    assert!(setpoints(&sent).len() > 190 && setpoints(&sent).iter().any(|setpoint| setpoint.vx == 1.0));
}

#[test]
fn px4_climbs_by_its_setpoints() {
    let mut bench = Bench::new(Kind::Px4Copter, FLY, OFFBOARD, ARMED);
    let sent = bench.run(1.0);
    assert_eq!(bench.state(), State::Entering);
    assert_eq!(commands(&sent, MAV_CMD_NAV_TAKEOFF), 0);
    assert_eq!(setpoints(&sent).last().unwrap().vz, -1.0);
    bench.above_home_m = 9.5;
    bench.run(0.5);
    assert_eq!(bench.state(), State::Steering);
}
