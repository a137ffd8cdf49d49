use super::*;

const GCS: Sender = Sender { system: 255, component: 190, sequence: 0 };

fn count(count: u16) -> MISSION_COUNT_DATA {
    MISSION_COUNT_DATA { count, ..MISSION_COUNT_DATA::DEFAULT }
}

fn item(x: i32) -> Item {
    Item { command: MAV_CMD_NAV_WAYPOINT, x, ..Item::DEFAULT }
}

const HOME: Item = Item { command: MAV_CMD_NAV_WAYPOINT, x: 99, ..Item::DEFAULT };

/// The requested item, or the negative result if the transfer ended.
fn wanted(answer: &MavMessage) -> i32 {
    match answer {
        MavMessage::MISSION_REQUEST(request) => request.seq.into(),
        MavMessage::MISSION_REQUEST_INT(request) => request.seq.into(),
        MavMessage::MISSION_ACK(ack) => -i32::from(ack.mavtype) - 1,
        other => panic!("{other:?}"),
    }
}

fn ended(result: u8) -> i32 {
    -i32::from(result) - 1
}

fn begin(mission: &mut Mission, from: Sender, told: &MISSION_COUNT_DATA) -> i32 {
    mission.count(from, told, 0).map_or_else(|(result, _)| ended(result), |answer| wanted(&answer))
}

/// `None` without an answer.
fn give(mission: &mut Mission, seq: u16) -> Option<i32> {
    mission.take(GCS, Item { seq, ..item(seq.into()) }, 0, |_| 0).as_ref().map(wanted)
}

fn load(mission: &mut Mission, count_of: u16) {
    assert_eq!(begin(mission, GCS, &count(count_of)), 0);
    for seq in 0..count_of {
        let next = if seq + 1 < count_of { i32::from(seq) + 1 } else { ended(MAV_MISSION_ACCEPTED) };
        assert_eq!(give(mission, seq), Some(next));
    }
}

/// The x of all items as they are read back.
fn read(mission: &Mission) -> Vec<i32> {
    let MavMessage::MISSION_COUNT(told) = mission.list(GCS, 0) else { panic!("a count") };
    let x = |seq| match mission.tell(GCS, HOME, seq, 0, true) {
        Ok(MavMessage::MISSION_ITEM_INT(item)) => item.x,
        other => panic!("{other:?}"),
    };
    (0..told.count).map(x).collect()
}

#[test]
fn an_uploaded_mission_reads_back_unchanged() {
    let mut mission = Mission::default();
    assert_eq!(begin(&mut mission, GCS, &count(3)), 0);
    assert_eq!(give(&mut mission, 0), Some(1));
    assert_eq!(give(&mut mission, 0), None, "doubled");
    assert_eq!(give(&mut mission, 2), Some(1), "too early");
    assert_eq!(give(&mut mission, 1), Some(2));
    assert!(mission.is_empty(), "the mission is replaced only after its last item");
    assert_eq!(give(&mut mission, 2), Some(ended(MAV_MISSION_ACCEPTED)));
    assert_eq!((mission.len(), mission.current), (3, 1));
    assert_eq!(give(&mut mission, 2), Some(ended(MAV_MISSION_ACCEPTED)), "the answer may have been lost");
    assert_eq!(give(&mut mission, 1), Some(ended(MAV_MISSION_INVALID_SEQUENCE)));
    let Ok(MavMessage::MISSION_ITEM_INT(told)) = mission.tell(GCS, HOME, 2, 0, true) else {
        panic!("an item");
    };
    assert_eq!((told.x, told.seq, told.current), (2, 2, 0));
    let refused = mission.tell(GCS, HOME, 3, 0, true).map_err(|(result, _)| result);
    assert_eq!(refused, Err(MAV_MISSION_INVALID_SEQUENCE));
    assert!(mission.set_current(2) && !mission.set_current(3));
    let _ = mission.clear(GCS, 0);
    assert_eq!(mission, Mission::default());
}

#[test]
fn a_missing_item_is_requested_again_until_the_upload_fails() {
    let mut mission = Mission::default();
    assert_eq!(begin(&mut mission, GCS, &count(2)), 0);
    assert_eq!(mission.poll(PATIENCE_US - 1), None);
    let mut now = 0;
    for _ in 1..TRIES {
        now += PATIENCE_US;
        let asked = mission.poll(now).expect("a request");
        assert_eq!(wanted(&asked), 0);
        let asks_float = matches!(asked, MavMessage::MISSION_REQUEST(_));
        assert_eq!(asks_float, (now / PATIENCE_US) % 2 == 1, "both kinds in turn");
    }
    now += PATIENCE_US;
    let cancelled = Some(ended(MAV_MISSION_OPERATION_CANCELLED));
    assert_eq!(mission.poll(now).as_ref().map(wanted), cancelled);
    assert_eq!(mission.poll(now + PATIENCE_US), None);
}

#[test]
fn uploads_that_are_too_long_or_invalid_or_from_another_client_are_refused() {
    let mut mission = Mission::default();
    let fences = MISSION_COUNT_DATA { mission_type: 1, ..count(2) };
    let refused = ended(MAV_MISSION_UNSUPPORTED);
    assert_eq!(begin(&mut mission, GCS, &fences), refused);
    let refused = ended(MAV_MISSION_NO_SPACE);
    assert_eq!(begin(&mut mission, GCS, &count(ITEMS + 1)), refused);
    assert_eq!(begin(&mut mission, GCS, &count(ITEMS)), 0);
    let other = Sender { system: 254, ..GCS };
    let refused = ended(MAV_MISSION_DENIED);
    assert_eq!(begin(&mut mission, other, &count(2)), refused);
    let taken = mission.take(other, item(0), 0, |_| 0);
    assert_eq!(taken.as_ref().map(wanted), Some(ended(MAV_MISSION_INVALID_SEQUENCE)));
    assert_eq!(begin(&mut mission, GCS, &count(2)), 0);
    let home = mission.take(GCS, item(0), 0, |_| MAV_MISSION_UNSUPPORTED);
    assert_eq!(home.as_ref().map(wanted), Some(1), "home may be anything");
    let bad = mission.take(GCS, Item { seq: 1, ..item(1) }, 0, |_| MAV_MISSION_UNSUPPORTED);
    assert_eq!(bad.as_ref().map(wanted), Some(ended(MAV_MISSION_UNSUPPORTED)));
    assert_eq!(mission, Mission::default());
}

#[test]
fn both_item_messages_describe_the_same_item() {
    for (frame, x) in [(MAV_FRAME_GLOBAL, 12.5), (MAV_FRAME_LOCAL_NED, -3.25)] {
        let float = MISSION_ITEM_DATA { frame, x, y: 7.0, z: 1.5, seq: 4, ..MISSION_ITEM_DATA::DEFAULT };
        let kept = from_float(&float);
        assert_eq!(kept.y, (7.0 * scale(frame)) as i32);
        let back = to_float(kept);
        assert_eq!((back.x, back.y, back.z, back.seq), (x, 7.0, 1.5, 4));
    }
    let nonsense = MISSION_ITEM_DATA { x: f32::NAN, ..MISSION_ITEM_DATA::DEFAULT };
    assert_eq!(from_float(&nonsense).x, i32::MAX);
}

#[test]
fn the_list_begins_with_home_with_and_without_a_mission() {
    let mut mission = Mission::default();
    assert_eq!((read(&mission), mission.is_empty()), (vec![99], true));
    let float = mission.tell(GCS, HOME, 0, 0, false);
    assert!(matches!(float, Ok(MavMessage::MISSION_ITEM(item)) if item.command == MAV_CMD_NAV_WAYPOINT));
    assert!(mission.tell(GCS, HOME, 0, MAV_MISSION_TYPE_FENCE, true).is_err());
    load(&mut mission, 4);
    assert_eq!(read(&mission), [99, 1, 2, 3], "an uploaded home does not move the vehicle's");
    let _ = mission.clear(GCS, MAV_MISSION_TYPE_ALL);
    assert_eq!(read(&mission), [99]);
}

/// Clients from before MISSION_REQUEST_INT, and those that know nothing else.
#[test]
fn clients_of_either_kind_of_items_upload() {
    for (knows_int, knows_float) in [(true, false), (false, true), (true, true)] {
        let mut mission = Mission::default();
        let mut asked = mission.count(GCS, &count(5), 0).ok();
        let (mut now_us, mut requests) = (0, 0);
        while let Some(message) = asked.take() {
            requests += 1;
            let seq = match &message {
                MavMessage::MISSION_REQUEST_INT(request) if knows_int => Some(request.seq),
                MavMessage::MISSION_REQUEST(request) if knows_float => Some(request.seq),
                MavMessage::MISSION_ACK(ack) => {
                    assert_eq!(ack.mavtype, MAV_MISSION_ACCEPTED);
                    None
                }
                _ => {
                    now_us += PATIENCE_US;
                    asked = mission.poll(now_us);
                    continue;
                }
            };
            asked = seq.and_then(|seq| mission.take(GCS, Item { seq, ..item(seq.into()) }, now_us, |_| 0));
        }
        assert_eq!(read(&mission), [99, 1, 2, 3, 4]);
        assert!(requests <= 7, "only the first item is asked for twice: {requests}");
    }
}

#[test]
fn some_items_are_replaced_and_others_stay() {
    let part = |start_index, end_index| MISSION_WRITE_PARTIAL_LIST_DATA {
        start_index,
        end_index,
        ..MISSION_WRITE_PARTIAL_LIST_DATA::DEFAULT
    };
    for (first, last) in [(1, 1), (2, 2), (3, 3), (1, 3), (2, 3), (0, 0), (0, 3)] {
        let mut mission = Mission::default();
        load(&mut mission, 4);
        assert!(mission.set_current(2));
        let answer = mission.replace(GCS, &part(first, last), 0).expect("it is in the list");
        assert_eq!(wanted(&answer), i32::from(first));
        for seq in first..=last {
            let before = read(&mission);
            assert_eq!(before, [99, 1, 2, 3], "replaced after the last item only");
            let seq = seq as u16;
            let answer = mission.take(GCS, Item { seq, ..item(70 + i32::from(seq)) }, 0, |_| 0);
            let next = if seq as i16 == last { ended(MAV_MISSION_ACCEPTED) } else { i32::from(seq) + 1 };
            assert_eq!(answer.as_ref().map(wanted), Some(next));
        }
        let expected: Vec<i32> = [99]
            .into_iter()
            .chain((1..4).map(|seq: i16| i32::from(seq) + if (first..=last).contains(&seq) { 70 } else { 0 }))
            .collect();
        assert_eq!((read(&mission), mission.current), (expected, 2));
    }
    let mut mission = Mission::default();
    assert!(mission.replace(GCS, &part(0, 0), 0).is_err(), "there is no mission");
    load(&mut mission, 4);
    for (first, last) in [(3, 4), (4, 4), (2, 1), (-1, 2), (-1, -1), (0, i16::MAX)] {
        let refused = mission.replace(GCS, &part(first, last), 0).map_err(|(result, _)| result);
        assert_eq!(refused, Err(MAV_MISSION_INVALID_SEQUENCE), "{first}..={last}");
    }
    assert_eq!(begin(&mut mission, GCS, &count(2)), 0);
    let other = Sender { system: 254, ..GCS };
    assert!(matches!(mission.replace(other, &part(1, 1), 0), Err((MAV_MISSION_DENIED, _))));
}
