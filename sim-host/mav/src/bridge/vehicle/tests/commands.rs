use super::*;

#[test]
fn arming_enables_motion_and_disarming_stops_it() {
    let mut bench = Bench::new(model());
    let arm = MAV_CMD_COMPONENT_ARM_DISARM;
    assert_eq!(bench.command(arm, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!((bench.wish(), bench.vehicle.is_armed), (Some(Wish::Off), false));
    assert_eq!(bench.texts(), ["disarmed"]);
    assert_eq!(bench.command(arm, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.wish(), None, "it was disarmed already");
    assert_eq!(bench.command(arm, [1.0, NAN, NAN, NAN, NAN, NAN, NAN]), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.wish(), Some(Wish::Own));
    for bad in [NAN, 2.0, -1.0, 0.5, f32::INFINITY] {
        assert_eq!(bench.command(arm, first(bad)), MAV_RESULT_DENIED, "{bad}");
    }
    assert!(bench.vehicle.is_armed);
}

#[test]
fn disarming_in_the_air_or_while_moving_needs_force() {
    let mut bench = Bench::new(flying());
    bench.tick(|sample| sample.motion.position_m[2] = 2.0);
    let arm = MAV_CMD_COMPONENT_ARM_DISARM;
    assert_eq!(bench.command(arm, NONE), MAV_RESULT_TEMPORARILY_REJECTED);
    assert_eq!(bench.command(arm, two(0.0, ARM_DISARM_FORCE)), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.wish(), Some(Wish::Off));
    let mut bench = Bench::new(model());
    bench.tick(|sample| sample.motion.velocity_mps = [0.0, -0.3, 0.0]);
    assert_eq!(bench.command(arm, NONE), MAV_RESULT_TEMPORARILY_REJECTED);
    bench.tick(|sample| sample.motion.velocity_mps = [0.01, 0.0, 0.0]);
    assert_eq!(bench.command(arm, NONE), MAV_RESULT_ACCEPTED);
}

#[test]
fn unknown_modes_are_denied_and_unknown_commands_unsupported() {
    let mut bench = Bench::new(model());
    let mode = MAV_CMD_DO_SET_MODE;
    for bad in [two(1.0, 99.0), two(1.0, 9.0), two(0.0, 15.0), two(NAN, 15.0), two(1.0, NAN)] {
        assert_eq!(bench.command(mode, bad), MAV_RESULT_DENIED, "{bad:?}");
    }
    assert_eq!(bench.vehicle.mode, FlightMode::Auto);
    for command in [MAV_CMD_NAV_TAKEOFF, MAV_CMD_NAV_LAND, 183, 0, u16::MAX] {
        assert_eq!(bench.command(command, NONE), MAV_RESULT_UNSUPPORTED, "{command}");
    }
    bench.give(MavMessage::SET_MODE(SET_MODE_DATA { custom_mode: 4, target_system: 7, base_mode: 1 }));
    assert_eq!((bench.vehicle.mode, bench.wish()), (FlightMode::Hold, Some(Wish::Hold)));
    bench.give(MavMessage::SET_MODE(SET_MODE_DATA { custom_mode: 77, target_system: 7, base_mode: 1 }));
    assert_eq!(bench.texts(), ["mode 77 is unsupported"]);
}

#[test]
fn copters_brake_and_loiter_by_command() {
    let mut bench = guided(flying());
    assert_eq!(bench.command(MAV_CMD_DO_SET_MODE, two(1.0, 17.0)), MAV_RESULT_ACCEPTED);
    assert_eq!((bench.vehicle.mode, bench.wish()), (FlightMode::Brake, Some(Wish::Hold)));
    let Some(MavMessage::HEARTBEAT(beat)) = bench.vehicle.telemetry(0) else { panic!("a heartbeat") };
    assert_eq!(beat.custom_mode, 17);
    assert_eq!(bench.command(MAV_CMD_NAV_LOITER_UNLIM, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!((bench.vehicle.mode, bench.wish()), (FlightMode::Hold, Some(Wish::Hold)));
    let mut rover = Bench::new(model());
    assert_eq!(rover.command(MAV_CMD_DO_SET_MODE, two(1.0, 17.0)), MAV_RESULT_DENIED);
    assert_eq!(rover.texts(), ["mode 17 is unsupported"]);
}

#[test]
fn requests_that_are_not_modelled_are_refused_with_a_text() {
    let mut named = 0;
    for (name, id) in MavMessage::all_messages() {
        let mut message = MavMessage::default_message_from_id(*id).expect("a message");
        let Some(system) = message.target_system_id_mut() else { continue };
        *system = 7;
        let mut bench = Bench::new(model());
        bench.give(message);
        let texts = bench.texts();
        let is_unsupported = texts.iter().any(|text| *text == format!("{name} is unsupported"));
        // Orders and answers of others have no answer.
        let is_silent = bench.vehicle.out.messages.is_empty() && bench.vehicle.out.actions.is_empty();
        let has_none = name.starts_with("STAYA_")
            || ["COMMAND_ACK", "MISSION_ACK", "TUNNEL", "PING", "PARAM_REQUEST_LIST", "REQUEST_DATA_STREAM"]
                .contains(name);
        assert_eq!(is_silent, has_none && is_silent, "{name} is ignored");
        assert!(texts.iter().all(|text| text.len() <= 50), "{texts:?}");
        named += usize::from(is_unsupported);
    }
    assert_eq!(named, 12);
    let mut bench = Bench::new(model());
    for (command, texts) in [(183, 1), (183, 0), (184, 1), (183, 1), (183, 0)] {
        bench.command(command, NONE);
        assert_eq!(bench.texts(), vec![format!("command {command} is unsupported"); texts], "each reason at once");
    }
    bench.command(MAV_CMD_REQUEST_MESSAGE, first(300.0));
    assert!(bench.texts().is_empty(), "clients try out messages");
}

#[test]
fn takeoff_and_landing_end_at_their_heights() {
    let mut bench = guided(flying());
    let takeoff = |height| [0.0, 0.0, 0.0, NAN, NAN, NAN, height];
    for bad in [NAN, 0.0, -1.0, 1e6] {
        assert_eq!(bench.command(MAV_CMD_NAV_TAKEOFF, takeoff(bad)), MAV_RESULT_DENIED, "{bad}");
    }
    assert_eq!(bench.command(MAV_CMD_NAV_TAKEOFF, takeoff(4.0)), MAV_RESULT_ACCEPTED);
    assert_eq!(place_mm(bench.wish()), [3000, 5000, 4000]);
    let above_the_sea = COMMAND_INT_DATA {
        z: 104.0,
        command: MAV_CMD_NAV_TAKEOFF,
        frame: MAV_FRAME_GLOBAL,
        ..COMMAND_INT_DATA::DEFAULT
    };
    let frame = MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME;
    assert_eq!(bench.command_int(above_the_sea), frame);
    bench.tick(|sample| sample.motion.position_m[2] = 4.0);
    let again = bench.command(MAV_CMD_NAV_TAKEOFF, takeoff(4.0));
    assert_eq!(again, MAV_RESULT_TEMPORARILY_REJECTED, "it is in the air");
    assert_eq!(bench.command(MAV_CMD_NAV_LAND, [NAN; 7]), MAV_RESULT_ACCEPTED);
    assert_eq!((bench.vehicle.mode, place_mm(bench.wish())), (FlightMode::LAND, [3000, 5000, 0]));
    bench.tick(|sample| sample.motion.position_m[2] = 1.0);
    assert_eq!(bench.wish(), None);
    bench.tick(|sample| sample.motion.position_m[2] = 0.01);
    assert_eq!((bench.wish(), bench.vehicle.is_armed), (Some(Wish::Off), false));
    let landed = bench.command(MAV_CMD_NAV_TAKEOFF, takeoff(4.0));
    assert_eq!(landed, MAV_RESULT_TEMPORARILY_REJECTED, "not armed");
}

#[test]
fn a_returning_vehicle_lands_at_home() {
    let mut bench = Bench::new(flying());
    bench.tick(|sample| sample.motion.position_m = [30.0, 40.0, 9.0]);
    assert_eq!(bench.command(MAV_CMD_NAV_RETURN_TO_LAUNCH, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!(place_mm(bench.wish()), [3000, 5000, 9000]);
    bench.tick(|sample| sample.motion.position_m = [3.0, 5.04, 9.0]);
    assert_eq!((bench.vehicle.mode, place_mm(bench.wish())[2]), (FlightMode::LAND, 0));
}

#[test]
fn messages_for_other_systems_are_ignored() {
    let mut bench = Bench::new(model());
    let command = |system, component| {
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MAV_CMD_COMPONENT_ARM_DISARM,
            target_system: system,
            target_component: component,
            ..COMMAND_LONG_DATA::DEFAULT
        })
    };
    for (system, component) in [(8, 1), (7, 2), (8, 0), (255, 0)] {
        assert!(bench.give(command(system, component)).messages.is_empty());
    }
    for (system, component) in [(7, 0), (7, 1), (0, 0), (0, 1)] {
        bench.give(command(system, component));
        assert_eq!(bench.result(), MAV_RESULT_ACCEPTED);
    }
    let set = MavMessage::PARAM_SET(PARAM_SET_DATA {
        param_id: "SPEED_MPS".into(),
        param_value: 0.5,
        target_system: 0,
        ..PARAM_SET_DATA::DEFAULT
    });
    bench.give(set);
    assert_eq!(bench.texts(), ["PARAM_SET to system 0: name one"]);
    assert!(bench.vehicle.out.actions.is_empty());
}

fn param_set(name: &str, value: f32) -> MavMessage {
    MavMessage::PARAM_SET(PARAM_SET_DATA {
        param_id: name.into(),
        param_value: value,
        target_system: 7,
        target_component: 1,
        param_type: 9,
    })
}

#[test]
fn a_parameter_is_set_within_limits_and_always_reported() {
    let mut bench = Bench::new(model());
    let told = |out: &Out| match &out.messages[..] {
        [MavMessage::PARAM_VALUE(told), ..] => told.param_value,
        other => panic!("{other:?}"),
    };
    let out = bench.give(param_set("SPEED_MPS", 0.5));
    assert_eq!(told(out), 0.5);
    assert_eq!(out.actions, [Action::Set("speed_mps", 0.5)]);
    for bad in [2.1, -0.1, NAN] {
        let out = bench.give(param_set("SPEED_MPS", bad));
        assert_eq!(told(out), 0.5, "unchanged");
        assert!(out.actions.is_empty());
        assert_eq!(bench.texts(), ["SPEED_MPS: give 0 to 2"]);
    }
    assert!(bench.give(param_set("NO_SUCH", 1.0)).actions.is_empty());
    assert_eq!(bench.texts(), ["unknown parameter"]);
    let count = bench.vehicle.parameters.count();
    let list = MavMessage::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA { target_system: 7, target_component: 1 });
    assert!(bench.give(list).messages.is_empty(), "the listing is sent one by one");
    while let Some(told) = bench.vehicle.parameters.next_listed() {
        bench.vehicle.out.messages.push(MavMessage::PARAM_VALUE(told));
    }
    assert_eq!(bench.vehicle.out.messages.len(), count);
    let read = |index| {
        MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
            param_index: index,
            target_system: 7,
            target_component: 1,
            param_id: "SPEED_MPS".into(),
        })
    };
    assert_eq!(told(bench.give(read(-1))), 0.5);
    assert!(matches!(bench.give(read(0)).messages[..], [MavMessage::PARAM_VALUE(_)]));
    bench.give(read(count as i16));
    assert!(bench.texts().is_empty(), "texts of one kind are rate-limited");
    bench.vehicle.now_us += 10_000_000;
    bench.give(read(count as i16));
    assert_eq!(bench.texts(), ["unknown parameter"]);
    let mut bench = guided(model());
    assert!(bench.give(param_set("SETPOINT_S", 0.5)).actions.is_empty());
    let Some(Wish::Velocity { valid, .. }) = set(&mut bench, local(0xDC7, 1)) else {
        panic!("a velocity");
    };
    assert_eq!(valid, Duration::from_millis(500));
}
