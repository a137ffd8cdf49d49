use super::*;
use crate::bridge::mission::MAV_MISSION_INVALID_PARAM2;
use staya_controller::agent::{Grid, GridOrder, Protocol, Waypoints};
use staya_controller::wire::{Addressed, Content as _};

#[test]
fn a_mission_runs_item_by_item() {
    let mut bench = Bench::new(model());
    assert_eq!(bench.command(MAV_CMD_MISSION_START, NONE), MAV_RESULT_DENIED, "there is no mission");
    let mut wait = item(1, 10.0, 0.0);
    wait.param1 = 0.3;
    let items = [item(0, 0.0, 0.0), wait, item(2, 10.0, 10.0)];
    assert_eq!(load(&mut bench, &items), MAV_MISSION_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_MISSION_START, [NAN; 7]), MAV_RESULT_ACCEPTED);
    assert!((place_mm(bench.wish())[0] - 10_000).abs() < 10);
    let reached = |out: &Out| {
        out.messages.iter().find_map(|message| match message {
            MavMessage::MISSION_ITEM_REACHED(reached) => Some(reached.seq),
            _ => None,
        })
    };
    for expected in [None, None, None, Some(1)] {
        let out = bench.tick(|sample| sample.motion.position_m = [10.0, 0.02, 0.0]);
        assert_eq!(reached(out), expected);
    }
    assert!((place_mm(bench.wish())[1] - 10_000).abs() < 10);
    assert_eq!(reached(bench.tick(|_| {})), None);
    let out = bench.tick(|sample| sample.motion.position_m = [10.0, 10.0, 0.0]);
    assert_eq!(reached(out), Some(2));
    assert_eq!((bench.wish(), is_on_mission(&bench)), (Some(Wish::Hold), false));
    assert_eq!(bench.texts(), ["mission done: holding"]);
    assert_eq!(bench.command(MAV_CMD_DO_SET_MISSION_CURRENT, first(1.0)), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_DO_SET_MODE, two(1.0, 10.0)), MAV_RESULT_ACCEPTED);
    assert!(is_on_mission(&bench));
    assert_eq!(bench.command(MAV_CMD_DO_SET_MODE, two(1.0, 15.0)), MAV_RESULT_ACCEPTED);
    assert!(!is_on_mission(&bench));
    assert_eq!(bench.command(MAV_CMD_DO_SET_MISSION_CURRENT, first(9.0)), MAV_RESULT_DENIED);
}

fn is_on_mission(bench: &Bench) -> bool {
    matches!(bench.vehicle.mode, FlightMode::Mission { .. })
}

fn reached(out: &Out) -> Vec<u16> {
    let messages = out.messages.iter().filter_map(|message| match message {
        MavMessage::MISSION_ITEM_REACHED(reached) => Some(reached.seq),
        _ => None,
    });
    messages.collect()
}

#[test]
fn speed_wait_and_camera_items_do_not_stop_a_mission() {
    let mut bench = Bench::new(model());
    let order = |seq, command, param1, param2| MISSION_ITEM_INT_DATA {
        command,
        param1,
        param2,
        frame: 2,
        z: NAN,
        ..item(seq, 0.0, 0.0)
    };
    let items = [
        item(0, 0.0, 0.0),
        order(1, MAV_CMD_DO_CHANGE_SPEED, 1.0, 0.5),
        item(2, 10.0, 0.0),
        order(3, MAV_CMD_DO_CHANGE_SPEED, 1.0, 10.0),
        order(4, 93, 0.2, -1.0),
        order(5, 2000, 0.0, 0.0),
        order(6, MAV_CMD_DO_CHANGE_SPEED, 1.0, -1.0),
    ];
    assert_eq!(load(&mut bench, &items), MAV_MISSION_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_MISSION_START, [NAN; 7]), MAV_RESULT_ACCEPTED);
    assert_eq!(reached(&bench.vehicle.out), [1]);
    assert!(bench.vehicle.out.actions.contains(&Action::Set("speed_mps", 0.5)));
    assert!((place_mm(bench.wish())[0] - 10_000).abs() < 10);
    let out = bench.tick(|sample| sample.motion.position_m = [10.0, 0.0, 0.0]);
    assert_eq!(reached(out), [2, 3]);
    assert!(out.actions.contains(&Action::Set("speed_mps", 2.0)));
    assert_eq!(bench.texts(), ["mission speed 10 m/s limited to 2"]);
    assert_eq!(bench.wish(), Some(Wish::Hold));
    assert!(reached(bench.tick(|_| {})).is_empty());
    assert!(reached(bench.tick(|_| {})).is_empty());
    assert_eq!(reached(bench.tick(|_| {})), [4, 5, 6]);
    assert!(!is_on_mission(&bench) && bench.texts().contains(&"mission done: holding".to_owned()));
    for (bad, fault) in [
        (order(1, MAV_CMD_DO_CHANGE_SPEED, 1.0, NAN), MAV_MISSION_INVALID_PARAM2),
        (order(1, MAV_CMD_DO_CHANGE_SPEED, 1.0, 0.0), MAV_MISSION_INVALID_PARAM2),
        (order(1, 93, -1.0, 12.0), MAV_MISSION_INVALID_PARAM1),
        (order(1, 93, f32::INFINITY, 0.0), MAV_MISSION_INVALID_PARAM1),
    ] {
        assert_eq!(load(&mut bench, &[item(0, 0.0, 0.0), bad]), fault);
    }
}

/// DroneKit's examples begin a mission so.
#[test]
fn a_takeoff_without_a_place_is_where_the_vehicle_stands() {
    let mut bench = Bench::new(flying());
    let takeoff = |z| MISSION_ITEM_INT_DATA { command: MAV_CMD_NAV_TAKEOFF, x: 0, y: 0, z, ..item(1, 0.0, 0.0) };
    for bad in [-1.0, 1001.0, NAN] {
        assert_ne!(load(&mut bench, &[item(0, 0.0, 0.0), takeoff(bad)]), MAV_MISSION_ACCEPTED, "{bad}");
    }
    let items = [item(0, 0.0, 0.0), takeoff(10.0), item(2, 10.0, 0.0)];
    assert_eq!(load(&mut bench, &items), MAV_MISSION_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_MISSION_START, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!(place_mm(bench.wish()), [3000, 5000, 10_000]);
    assert!(reached(bench.tick(|_| {})).is_empty());
    assert_eq!(reached(bench.tick(|sample| sample.motion.position_m[2] = 10.0)), [1]);
}

#[test]
fn a_landing_at_the_end_of_a_mission_is_reached_on_the_ground() {
    let mut bench = Bench::new(flying());
    bench.tick(|sample| sample.motion.position_m = [0.0, 0.0, 5.0]);
    let landing = MISSION_ITEM_INT_DATA { command: MAV_CMD_NAV_LAND, ..item(1, 0.0, 0.0) };
    assert_eq!(load(&mut bench, &[item(0, 0.0, 0.0), landing]), MAV_MISSION_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_MISSION_START, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.vehicle.mode, FlightMode::Land { is_item: true });
    assert!(reached(bench.tick(|_| {})).is_empty());
    assert_eq!(reached(bench.tick(|sample| sample.motion.position_m[2] = 0.0)), [1]);
    assert!(!bench.vehicle.is_armed);
}

#[test]
fn invalid_mission_items_are_refused() {
    for (change, fault, text) in [
        (
            (|item| item.command = 82) as fn(&mut MISSION_ITEM_INT_DATA),
            MAV_MISSION_UNSUPPORTED,
            "mission item 2: unsupported command 82",
        ),
        (|item| item.command = MAV_CMD_NAV_LAND, MAV_MISSION_UNSUPPORTED, "mission item 2: unsupported command 21"),
        (|item| item.frame = 8, MAV_MISSION_UNSUPPORTED_FRAME, "mission item 2: unsupported frame 8"),
        (|item| item.x = i32::MAX, MAV_MISSION_INVALID_PARAM5_X, "mission item 2: obstacle or off the map"),
        (|item| item.param1 = -1.0, MAV_MISSION_INVALID_PARAM1, "mission item 2: param1 (wait) invalid"),
    ] {
        let mut bench = Bench::new(model());
        let mut bad = item(2, 1.0, 1.0);
        change(&mut bad);
        assert_eq!(load(&mut bench, &[item(0, 0.0, 0.0), item(1, 1.0, 1.0), bad]), fault);
        assert_eq!(bench.texts(), [text]);
        // STATUSTEXT holds 50 bytes.
        assert!(text.len() <= 50 - 3);
        assert!(bench.vehicle.mission.is_empty());
    }
}

#[test]
fn an_item_outside_an_upload_moves_the_vehicle() {
    let mut bench = guided(model());
    let there = MISSION_ITEM_DATA {
        x: 50.0001,
        y: 8.0,
        command: MAV_CMD_NAV_WAYPOINT,
        target_system: 7,
        target_component: 1,
        frame: MAV_FRAME_GLOBAL_RELATIVE_ALT,
        current: 2,
        ..MISSION_ITEM_DATA::DEFAULT
    };
    let ended = |out: &Out| match &out.messages[..] {
        [MavMessage::MISSION_ACK(ack)] => ack.mavtype,
        other => panic!("{other:?}"),
    };
    assert_eq!(ended(bench.give(MavMessage::MISSION_ITEM(there.clone()))), MAV_MISSION_ACCEPTED);
    let [_, north, _] = place_mm(bench.wish());
    assert!((north - 11_120).abs() < 500, "{north}");
    let higher = MISSION_ITEM_DATA { current: 3, ..there.clone() };
    assert_eq!(refused(&mut bench, MavMessage::MISSION_ITEM(higher)), MAV_MISSION_UNSUPPORTED);
    bench.command(MAV_CMD_DO_SET_MODE, two(1.0, 4.0));
    bench.vehicle.now_us += 3_000_000;
    assert_eq!(refused(&mut bench, MavMessage::MISSION_ITEM(there)), MAV_MISSION_ERROR);
}

/// The result of a MISSION_ACK with a text.
fn refused(bench: &mut Bench, message: MavMessage) -> u8 {
    match &bench.give(message).messages[..] {
        [MavMessage::MISSION_ACK(ack), MavMessage::STATUSTEXT(_)] => ack.mavtype,
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_item_for_system_0_moves_one_vehicle_and_is_refused_by_several() {
    let there = MISSION_ITEM_INT_DATA { target_system: 0, target_component: 0, current: 2, ..item(0, 10.0, 0.0) };
    let float = crate::bridge::mission::to_float(there.clone());
    for message in [MavMessage::MISSION_ITEM_INT(there), MavMessage::MISSION_ITEM(float)] {
        let mut alone = guided(VehicleModel { is_alone: true, ..model() });
        let answers = &alone.give(message.clone()).messages;
        assert!(matches!(&answers[..], [MavMessage::MISSION_ACK(ack)] if ack.mavtype == 0), "{answers:?}");
        assert!((place_mm(alone.wish())[0] - 10_000).abs() < 500);
        let mut several = guided(model());
        let name = message.message_name();
        assert_eq!(refused(&mut several, message), MAV_MISSION_DENIED);
        assert_eq!((several.wish(), several.texts()), (None, vec![format!("{name} to system 0: name one")]));
    }
    let mut several = Bench::new(model());
    let count = MISSION_COUNT_DATA { count: 2, ..MISSION_COUNT_DATA::DEFAULT };
    assert_eq!(refused(&mut several, MavMessage::MISSION_COUNT(count.clone())), MAV_MISSION_DENIED);
    let mut alone = Bench::new(VehicleModel { is_alone: true, ..model() });
    let asked = &alone.give(MavMessage::MISSION_COUNT(count)).messages;
    assert!(matches!(&asked[..], [MavMessage::MISSION_REQUEST_INT(_)]), "{asked:?}");
}

#[test]
fn lists_other_than_missions_are_refused_with_their_name() {
    for (mission_type, text) in [
        (MAV_MISSION_TYPE_FENCE, "geofences are unsupported: no fence is stored"),
        (MAV_MISSION_TYPE_RALLY, "rally points are unsupported"),
        (9, "mission: unsupported kind of list"),
    ] {
        let mut bench = Bench::new(model());
        let count = MISSION_COUNT_DATA { count: 4, target_system: 7, mission_type, ..MISSION_COUNT_DATA::DEFAULT };
        assert_eq!(refused(&mut bench, MavMessage::MISSION_COUNT(count)), MAV_MISSION_UNSUPPORTED);
        assert_eq!(bench.texts(), [text]);
    }
}

#[test]
fn the_list_of_a_fresh_vehicle_has_its_home() {
    let mut bench = Bench::new(model());
    let request = MISSION_REQUEST_LIST_DATA { target_system: 7, ..MISSION_REQUEST_LIST_DATA::DEFAULT };
    let answer = &bench.give(MavMessage::MISSION_REQUEST_LIST(request)).messages;
    assert!(matches!(&answer[..], [MavMessage::MISSION_COUNT(count)] if count.count == 1), "{answer:?}");
    let request = MISSION_REQUEST_INT_DATA { target_system: 7, ..MISSION_REQUEST_INT_DATA::DEFAULT };
    let answer = &bench.give(MavMessage::MISSION_REQUEST_INT(request)).messages;
    let [MavMessage::MISSION_ITEM_INT(home)] = &answer[..] else { panic!("{answer:?}") };
    let expected = origin().to_global([3.0, 5.0, 0.0]).expect("near").to_e7();
    assert_eq!(([home.x, home.y], home.command, home.seq), ([expected[0], expected[1]], 16, 0));
    assert!((home.z - 100.0).abs() < 0.01, "above sea level: {}", home.z);
    assert_eq!(bench.command(MAV_CMD_MISSION_START, NONE), MAV_RESULT_DENIED, "there is no mission");
}

#[test]
fn a_replaced_item_takes_effect_during_the_mission() {
    let mut bench = Bench::new(model());
    let items = [item(0, 0.0, 0.0), item(1, 10.0, 0.0), item(2, 10.0, 10.0)];
    assert_eq!(load(&mut bench, &items), MAV_MISSION_ACCEPTED);
    assert_eq!(bench.command(MAV_CMD_MISSION_START, NONE), MAV_RESULT_ACCEPTED);
    for (seq, east, is_current) in [(2, 30.0, false), (1, 20.0, true)] {
        let part = MISSION_WRITE_PARTIAL_LIST_DATA {
            start_index: seq,
            end_index: seq,
            target_system: 7,
            ..MISSION_WRITE_PARTIAL_LIST_DATA::DEFAULT
        };
        let asked = &bench.give(MavMessage::MISSION_WRITE_PARTIAL_LIST(part)).messages;
        assert!(matches!(&asked[..], [MavMessage::MISSION_REQUEST_INT(asked)] if asked.seq == seq as u16), "{asked:?}");
        bench.give(MavMessage::MISSION_ITEM_INT(item(seq as u16, east, 0.0)));
        assert!(is_on_mission(&bench));
        let goes = bench.wish().map(|wish| place_mm(Some(wish))[0]);
        assert_eq!(goes.is_some_and(|x| (x - 20_000).abs() < 10), is_current, "{goes:?}");
    }
    assert_eq!(bench.vehicle.mission.len(), 3);
}

/// The header, the addressee, the number and the order that the controller is told.
fn told<P: Protocol>(out: &Out) -> (Header, u8, u8, P::Order) {
    let [Action::Tell(header, Message::Order(order))] = &out.actions[..] else {
        panic!("{:?}", out.actions);
    };
    let Addressed { to, number, protocol, content } = order;
    (*header, to.0 as u8, *number, P::Order::decode(P::ID, *protocol, content).expect("an order of the protocol"))
}

#[test]
fn orders_of_the_dialect_reach_the_controller() {
    let mut bench = Bench::new(model());
    let goal = STAYA_GOAL_DATA { sequence: 4, target_x: 3, target_y: -2, boot: 1, target_system: 0, version: 9 };
    let (header, to, number, order) = told::<Grid>(bench.give(MavMessage::STAYA_GOAL(goal)));
    assert_eq!((header.boot, header.sender.0, header.sequence), (1, 255, 4));
    assert_eq!((to, number, order), (0, 9, GridOrder::FormationGoal(Cell::new(3, -2))));
    let place = STAYA_PLACE_DATA { x_mm: 5, vy_mmps: -7, version: 3, index: 2, ..STAYA_PLACE_DATA::DEFAULT };
    let place = STAYA_PLACE_DATA { target_system: 7, sequence: 6, ..place };
    let (header, to, number, order) = told::<Waypoints>(bench.give(MavMessage::STAYA_PLACE(place)));
    assert_eq!((header.sequence, to, number, order.index), (6, 7, 3, 2));
    assert_eq!(order.waypoint.position.mm, [5, 0, 0]);
    assert_eq!(order.waypoint.velocity_mps, Vec3::from_milli([0, -7, 0]));
    let template = STAYA_TEMPLATE_DATA { target_system: 7, count: 3, parts: 1, ..STAYA_TEMPLATE_DATA::DEFAULT };
    assert!(bench.give(MavMessage::STAYA_TEMPLATE(template.clone())).actions.is_empty());
    let template = STAYA_TEMPLATE_DATA { count: 1, entry_x: [5, 0], entry_id: [6, 0], ..template };
    let (_, to, _, order) = told::<Grid>(bench.give(MavMessage::STAYA_TEMPLATE(template)));
    let GridOrder::Template { part, .. } = order else {
        panic!("{order:?}");
    };
    assert_eq!((to, part.entries.len(), part.entries[0].offset.x, part.entries[0].id.0), (7, 1, 5, 6));
}

/// A ground station gives orders; messages are between robots.
#[test]
fn an_order_of_a_users_protocol_reaches_the_controller_and_a_message_does_not() {
    let mut bench = Bench::new(model());
    for (kind, is_told) in [(0, false), (1, false), (2, true), (3, false)] {
        let data = STAYA_MESSAGE_DATA { protocol: 64, number: 5, count: 2, kind, ..STAYA_MESSAGE_DATA::DEFAULT };
        let mut data = STAYA_MESSAGE_DATA { target_system: 7, ..data };
        data.bytes[..2].copy_from_slice(&[8, 9]);
        let out = bench.give(MavMessage::STAYA_MESSAGE(data));
        assert_eq!(out.actions.len(), usize::from(is_told), "kind {kind}");
        if let [Action::Tell(_, Message::Order(order))] = &out.actions[..] {
            assert_eq!((order.to.0, order.number, order.protocol.0, &order.content[..]), (7, 5, 64, &[8, 9][..]));
        }
        assert!(bench.texts().is_empty());
    }
}

#[test]
fn a_complete_formation_order_is_confirmed_once() {
    let mut bench = Bench::new(VehicleModel { in_formation: true, ..on_grid() });
    let part = |part, version| {
        let data = STAYA_TEMPLATE_DATA { part, version, parts: 2, slot: 4, count: 1, ..STAYA_TEMPLATE_DATA::DEFAULT };
        MavMessage::STAYA_TEMPLATE(STAYA_TEMPLATE_DATA { target_system: 7, ..data })
    };
    let goal = |version| {
        let data = STAYA_GOAL_DATA { target_x: 3, target_y: 4, version, ..STAYA_GOAL_DATA::DEFAULT };
        MavMessage::STAYA_GOAL(data)
    };
    for (message, texts) in [
        (part(1, 1), None),
        (part(1, 1), None),
        (part(0, 1), Some("new formation: place 5")),
        (part(0, 1), None),
        (part(0, 2), None),
        (part(1, 2), Some("new formation: place 5")),
        (goal(1), Some("goal: cell (3, 4)")),
        (goal(1), None),
        (goal(2), Some("goal: cell (3, 4)")),
        (part(200, 3), None),
    ] {
        bench.give(message);
        assert_eq!(bench.texts(), Vec::from_iter(texts));
    }
    let mut alone = Bench::new(model());
    alone.give(part(0, 1));
    assert_eq!(alone.texts(), ["STAYA_TEMPLATE: not in a formation"]);
}
