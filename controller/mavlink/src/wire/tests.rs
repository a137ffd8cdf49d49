use super::*;
use crate::dialect::{HEARTBEAT_DATA, MavMessage};
use crate::frame::MAX_FRAME_LEN;
use mavlink_core::Message as _;
use proptest::array::uniform;
use proptest::collection::vec;
use proptest::prelude::*;
use staya_controller::agent::GridMessage;

type Framed = Vec<u8, MAX_FRAME_LEN>;

const HEADER: Header = Header { boot: 3, sender: RobotId(7), sequence: 0x1234 };

fn framed(header: Header, message: &Message) -> Framed {
    let mut out = Vec::new();
    assert_eq!(encode(header, message, &mut out), Ok(out.len()));
    out
}

fn raw(data: &impl MessageData) -> Framed {
    let mut out = Vec::new();
    let sender = Sender { system: 7, component: COMPONENT, sequence: 0 };
    frame::encode(sender, data, &mut out).unwrap();
    out
}

fn split(mut rest: &[u8]) -> std::vec::Vec<&[u8]> {
    core::iter::from_fn(|| next_frame(&mut rest)).collect()
}

fn id() -> impl Strategy<Value = RobotId> {
    (0..=255_u32).prop_map(RobotId)
}

fn cell() -> impl Strategy<Value = Cell> {
    any::<[i16; 2]>().prop_map(|[x, y]| Cell::new(x, y))
}

fn header() -> impl Strategy<Value = Header> {
    (any::<u8>(), 1..=255_u32, any::<u16>()).prop_map(|(boot, sender, sequence)| Header {
        boot,
        sender: RobotId(sender),
        sequence,
    })
}

fn bytes<const N: usize>() -> impl Strategy<Value = Bytes<N>> {
    vec(any::<u8>(), 0..=N).prop_map(|bytes| Bytes::from_slice(&bytes).unwrap())
}

fn protocol() -> impl Strategy<Value = ProtocolId> {
    any::<u8>().prop_map(ProtocolId)
}

/// An order of a built-in protocol, with its number.
fn built_in() -> impl Strategy<Value = (u8, AnyOrder)> {
    let goal = (cell(), any::<bool>());
    let goal =
        goal.prop_map(|(cell, is_own)| if is_own { GridOrder::Goal(cell) } else { GridOrder::FormationGoal(cell) });
    let goal = (any::<u8>(), goal).prop_map(|(number, goal)| (number, AnyOrder::Grid(goal)));
    let entry = (cell(), id(), any::<u8>());
    let entry = entry.prop_map(|(offset, id, hops)| TemplateEntry { offset, id, hops });
    let template = (uniform::<_, 4>(any::<u8>()), cell(), vec(entry, 0..=TEMPLATE_PART));
    let template = template.prop_map(|([version, part, parts, slot], offset, entries)| {
        let entries = entries.into_iter().collect();
        let part = TemplatePart { version, part, parts, slot, offset, entries };
        (version, AnyOrder::Grid(GridOrder::Template { part, is_restarted: false }))
    });
    let place = (any::<[u8; 2]>(), any::<([i32; 3], [i16; 3])>());
    let place = place.prop_map(|([number, index], (position_mm, velocity_mmps))| {
        let waypoint = Waypoint {
            position: Position::from_mm(position_mm),
            velocity_mps: Vec3::from_milli(velocity_mmps.map(i32::from)),
            at: Instant::default(),
        };
        (number, AnyOrder::Waypoint(WaypointOrder { index, waypoint }))
    });
    prop_oneof![goal, template, place]
}

fn beacon() -> impl Strategy<Value = Beacon> {
    let modes = (0..7_u8).prop_map(|number| Mode::from_number(number).unwrap());
    let beacon = (any::<([i32; 3], [i16; 3], u16, u8)>(), modes, protocol(), bytes());
    beacon.prop_map(|((position_mm, velocity_mmps, radius_mm, flock), mode, protocol, payload)| Beacon {
        position_mm,
        velocity_mmps,
        radius_mm,
        mode,
        flock,
        protocol,
        payload,
    })
}

fn any_message() -> impl Strategy<Value = Message> {
    let sent = beacon().prop_map(Message::Beacon);
    let law = (id(), any::<u8>(), protocol(), bytes());
    let law = law.prop_map(|(to, number, protocol, content)| Message::Law(Addressed { to, number, protocol, content }));
    let broadcast = (protocol(), bytes());
    let broadcast = broadcast.prop_map(|(protocol, content)| Message::Broadcast(Broadcast { protocol, content }));
    let ack = (id(), any::<[u8; 2]>()).prop_map(|(to, [boot, number])| Message::Ack(Ack { to, boot, number }));
    let built_in = (id(), built_in()).prop_map(|(to, (number, order))| {
        let (protocol, content) = order.encode(ProtocolId::NONE).unwrap();
        Message::Order(Addressed { to, number, protocol, content })
    });
    let other = (id(), any::<u8>(), 64..=255_u8, bytes());
    let other = other.prop_map(|(to, number, protocol, content)| {
        Message::Order(Addressed { to, number, protocol: ProtocolId(protocol), content })
    });
    let lost = (any::<u8>(), any::<bool>(), any::<u16>(), any::<[i32; 3]>(), any::<u16>());
    let lost = lost.prop_map(|(id, is_lost, age_cs, position_mm, radius_mm)| {
        Message::Lost(LostRobot { id: robot(id), is_lost, age_cs, position_mm, radius_mm })
    });
    let relayed = (any::<u8>(), any::<u16>(), beacon()).prop_map(|(id, age_cs, beacon)| {
        let Beacon { position_mm, radius_mm, mode, flock, protocol, payload, .. } = beacon;
        let id = robot(id);
        Message::Relayed(Relayed { id, age_cs, position_mm, radius_mm, mode, flock, protocol, payload })
    });
    prop_oneof![2 => sent, 2 => law, 1 => broadcast, 1 => ack, 3 => built_in, 1 => other, 1 => lost, 1 => relayed]
}

/// Orders of built-in protocols in bytes that clients fill in by name otherwise.
fn is_unusual(message: &Message, id: u32) -> bool {
    id == STAYA_MESSAGE_DATA::ID && matches!(message, Message::Order(order) if order.protocol.0 < 64)
}

proptest! {
    #[test]
    fn every_message_round_trips(header in header(), message in any_message()) {
        let bytes = framed(header, &message);
        prop_assert_eq!(split(&bytes), [bytes.as_slice()]);
        prop_assert_eq!(decode(&bytes), Ok(Frame { header, message, tag: None }));
    }

    #[test]
    fn every_flipped_bit_is_detected(header in header(), message in any_message(), at in any::<u16>()) {
        let mut bytes = framed(header, &message);
        let bit = usize::from(at) % (8 * bytes.len());
        bytes[bit / 8] ^= 1 << (bit % 8);
        for piece in split(&bytes) {
            prop_assert!(decode(piece).is_err());
        }
    }

    #[test]
    fn arbitrary_bytes_do_not_panic_and_none_is_lost(bytes in vec(any::<u8>(), 0..400)) {
        let pieces = split(&bytes);
        for piece in &pieces {
            let _ = decode(piece);
        }
        let _ = decode(&bytes);
        prop_assert_eq!(pieces.concat(), bytes);
    }

    /// Random bytes hardly ever have the right checksum: these do.
    #[test]
    fn arbitrary_payloads_do_not_panic(payload in vec(any::<u8>(), 0..=255), id in 0..10_u32) {
        let id = 9_500_000 + id;
        let len = payload.len() as u8;
        let [a, b, c, _] = id.to_le_bytes();
        let mut bytes = std::vec![0xFD, len, 0, 0, 1, 7, COMPONENT, a, b, c];
        bytes.extend(&payload);
        let crc = mavlink_core::calculate_crc(&bytes[1..], MavMessage::extra_crc(id));
        bytes.extend(crc.to_le_bytes());
        let answer = decode(&bytes);
        prop_assert!(!matches!(answer, Err(DecodeError::Crc)), "{:?}", answer);
        if let Ok(frame) = answer
            && !is_unusual(&frame.message, id)
        {
            let again = framed(frame.header, &frame.message);
            prop_assert_eq!(decode(&again), Ok(frame));
        }
    }

    #[test]
    fn frames_are_found_between_junk(
        said in vec((any_message(), vec(any::<u8>().prop_map(|b| b & 0x7F), 0..30)), 20)
    ) {
        let mut bytes = std::vec::Vec::new();
        for (message, junk) in &said {
            bytes.extend(junk);
            bytes.extend(&framed(HEADER, message));
        }
        let heard: std::vec::Vec<_> = split(&bytes).into_iter().filter_map(|piece| decode(piece).ok()).collect();
        let sent: std::vec::Vec<_> = said.into_iter().map(|(message, _)| message).collect();
        prop_assert_eq!(heard.len(), 20);
        prop_assert!(heard.into_iter().map(|frame| frame.message).eq(sent));
    }
}

fn goal(to: u32) -> Message {
    Grid::order(RobotId(to), 1, &GridOrder::FormationGoal(Cell::new(3, -4))).unwrap()
}

fn law(to: u32) -> Message {
    let (protocol, content) = GridMessage::Redirect.encode(Grid::ID).unwrap();
    Message::Law(Addressed { to: RobotId(to), number: 9, protocol, content })
}

fn template(to: u32, id: u32) -> Message {
    let entry = TemplateEntry { offset: Cell::new(1, 2), id: RobotId(id), hops: 1 };
    let part = TemplatePart::split(5, 1, Cell::new(-3, 0), &[entry]).unwrap().next().unwrap();
    Grid::order(RobotId(to), 5, &GridOrder::Template { part, is_restarted: false }).unwrap()
}

#[test]
fn numbers_beyond_systems_are_refused_and_nothing_is_written() {
    let mut out = Framed::new();
    let from = |sender: u32| Header { sender: RobotId(sender), ..HEADER };
    let mut refused = |header, message: &Message| {
        let answer = encode(header, message, &mut out).unwrap_err();
        assert!(out.is_empty());
        answer
    };
    assert_eq!(refused(from(0), &goal(1)), EncodeError::NoSender);
    assert_eq!(refused(from(256), &goal(1)), EncodeError::Robot(RobotId(256)));
    for message in [goal(70_000), law(70_000), template(70_000, 1), template(1, 70_000)] {
        assert_eq!(refused(HEADER, &message), EncodeError::Robot(RobotId(70_000)));
    }
    let mut small = Vec::<u8, 12>::new();
    assert_eq!(encode(HEADER, &goal(1), &mut small), Err(EncodeError::Full));
    assert!(small.is_empty());
}

#[test]
fn invalid_fields_are_refused() {
    let (beacon, message) = (STAYA_BEACON_DATA::DEFAULT, STAYA_MESSAGE_DATA::DEFAULT);
    let bodies = [
        raw(&STAYA_BEACON_DATA { mode: 7, ..beacon.clone() }),
        raw(&STAYA_BEACON_DATA { count: 17, ..beacon }),
        raw(&STAYA_MESSAGE_DATA { kind: 3, ..message.clone() }),
        raw(&STAYA_MESSAGE_DATA { kind: TO_ALL, count: 39, ..message.clone() }),
        raw(&STAYA_MESSAGE_DATA { kind: TO_ONE, count: 35, ..message.clone() }),
        raw(&STAYA_MESSAGE_DATA { kind: ORDER, count: 35, ..message }),
        raw(&STAYA_LOST_DATA { is_lost: 2, ..STAYA_LOST_DATA::DEFAULT }),
        raw(&STAYA_RELAYED_DATA { mode: 7, ..STAYA_RELAYED_DATA::DEFAULT }),
        raw(&STAYA_RELAYED_DATA { count: 17, ..STAYA_RELAYED_DATA::DEFAULT }),
        raw(&STAYA_TEMPLATE_DATA { count: 3, ..STAYA_TEMPLATE_DATA::DEFAULT }),
    ];
    for bytes in bodies {
        assert_eq!(decode(&bytes), Err(DecodeError::Body));
    }
}

#[test]
fn other_messages_are_foreign_and_other_bytes_are_damage() {
    let heartbeat = raw(&HEARTBEAT_DATA::DEFAULT);
    assert_eq!(decode(&heartbeat), Err(DecodeError::Foreign));
    let mut cut = framed(HEADER, &goal(1));
    cut.pop();
    assert_eq!(decode(&cut), Err(DecodeError::Crc));
    assert_eq!(decode(&[]), Err(DecodeError::Empty));
    let mut unsent = Vec::<u8, 64>::new();
    frame::encode(Sender::default(), &STAYA_GOAL_DATA::DEFAULT, &mut unsent).unwrap();
    assert_eq!(decode(&unsent), Err(DecodeError::NoSender));
}

#[test]
fn the_frames_sequence_is_the_low_byte_of_the_message_s() {
    let bytes = framed(HEADER, &goal(1));
    let sender = RawFrame::new(&bytes).unwrap().sender();
    assert_eq!((sender.system, sender.component, sender.sequence), (7, COMPONENT, 0x34));
}

#[test]
fn orders_of_built_in_protocols_have_messages_with_named_fields() {
    let waypoint =
        Waypoint { velocity_mps: Vec3::new(0.5, -1.25, 99.0), ..Waypoint::fixed(Position::from_mm([7, -8, 9])) };
    let place = Waypoints::order(RobotId(4), 6, &WaypointOrder { index: 2, waypoint }).unwrap();
    let own = Grid::order(RobotId(0), 6, &GridOrder::Goal(Cell::new(3, -4))).unwrap();
    let get = |message: &Message| framed(HEADER, message);
    let [goal, template, place, own] = [goal(3), template(2, 8), place, own].map(|message| get(&message));
    fn read<D: MessageData>(bytes: &[u8]) -> D {
        RawFrame::new(bytes).unwrap().get().unwrap()
    }
    let (sequence, boot) = (HEADER.sequence, HEADER.boot);
    let goal: STAYA_GOAL_DATA = read(&goal);
    assert_eq!((goal.sequence, goal.boot, goal.target_system, goal.version), (sequence, boot, 3, 1));
    assert_eq!((goal.target_x, goal.target_y), (3, -4));
    let template: STAYA_TEMPLATE_DATA = read(&template);
    assert_eq!((template.target_system, template.version, template.count, template.slot), (2, 5, 1, 1));
    assert_eq!(
        (template.offset_x, template.entry_x, template.entry_y, template.entry_id),
        (-3, [1, 0], [2, 0], [8, 0])
    );
    let place: STAYA_PLACE_DATA = read(&place);
    assert_eq!((place.target_system, place.version, place.index), (4, 6, 2));
    assert_eq!((place.x_mm, place.y_mm, place.z_mm), (7, -8, 9));
    assert_eq!((place.vx_mmps, place.vy_mmps, place.vz_mmps), (500, -1250, i16::MAX));
    let own: STAYA_MESSAGE_DATA = read(&own);
    assert_eq!((own.target_system, own.kind, own.number, own.protocol, own.count), (0, 2, 6, 1, 5));
    assert_eq!(own.bytes[..6], [0, 3, 0, 0xFC, 0xFF, 0]);
}

#[test]
fn what_laws_say_is_sent_as_bytes_to_one_robot_or_to_all() {
    let read =
        |message: &Message| -> STAYA_MESSAGE_DATA { RawFrame::new(&framed(HEADER, message)).unwrap().get().unwrap() };
    let to_one = read(&law(3));
    assert_eq!((to_one.target_system, to_one.kind, to_one.number, to_one.protocol), (3, 0, 9, 1));
    assert_eq!((to_one.count, &to_one.bytes[..2]), (1, &[2, 0][..]));
    let content = Bytes::from_slice(&[7; MAX_CONTENT]).unwrap();
    let to_all = read(&Message::Broadcast(Broadcast { protocol: ProtocolId(70), content }));
    assert_eq!((to_all.target_system, to_all.kind, to_all.number, to_all.protocol), (0, 1, 0, 70));
    assert_eq!((to_all.count, to_all.bytes), (38, [7; MAX_CONTENT]));
}

/// A robot that does not know the content does not lose it.
#[test]
fn orders_of_built_in_protocols_that_do_not_decode_are_carried_as_bytes() {
    for (protocol, content) in [(1, &[9, 1][..]), (1, &[]), (2, &[0; 18]), (0, &[1]), (63, &[0; MAX_ORDER])] {
        let content = Bytes::from_slice(content).unwrap();
        let message = Message::Order(Addressed { to: RobotId(2), number: 3, protocol: ProtocolId(protocol), content });
        let frame = decode(&framed(HEADER, &message)).unwrap();
        assert_eq!(frame.message, message);
    }
}

#[test]
fn a_beacon_has_at_most_its_length() {
    let payload = Bytes::from_slice(&[255; MAX_PAYLOAD]).unwrap();
    let beacon = Beacon { mode: Mode::Fault, payload, ..Beacon::default() };
    assert_eq!(framed(HEADER, &Message::Beacon(beacon)).len(), BEACON_LEN);
    assert_eq!(Mavlink.beacon_len(), BEACON_LEN);
}

/// An order that a named message would change travels as bytes.
#[test]
fn every_order_comes_back_as_it_was_sent() {
    let entry = TemplateEntry { offset: Cell::new(3, 0), id: RobotId(1), hops: 1 };
    let part = TemplatePart {
        version: 4,
        part: 0,
        parts: 1,
        slot: 2,
        offset: Cell::new(-3, 0),
        entries: [entry].into_iter().collect(),
    };
    let template = |part: TemplatePart| GridOrder::Template { part, is_restarted: false };
    let odd = Bytes::from_slice(&[0x81, 0, 1, 0, 2, 0]).unwrap();
    let odd = Message::Order(Addressed { to: RobotId(3), number: 9, protocol: Grid::ID, content: odd });
    let orders = [
        (Grid::order(RobotId(3), 4, &template(part.clone())).unwrap(), true),
        (Grid::order(RobotId(3), 5, &template(part.clone())).unwrap(), false),
        (odd, false),
    ];
    for (order, is_named) in orders {
        let frame = framed(HEADER, &order);
        assert_eq!(decode(&frame).unwrap().message, order);
        let id = RawFrame::new(&frame).unwrap().message_id();
        assert_eq!(id == STAYA_TEMPLATE_DATA::ID, is_named);
    }
    // In its bytes too, a robot beyond all systems is refused.
    let far = GridOrder::Template {
        part: TemplatePart { entries: [TemplateEntry { id: RobotId(300), ..entry }].into_iter().collect(), ..part },
        is_restarted: false,
    };
    let (_, content) = far.encode::<MAX_CONTENT>(Grid::ID).unwrap();
    let (count, bytes) = padded(&content);
    let order = STAYA_MESSAGE_DATA {
        boot: 0,
        sequence: 0,
        target_system: 3,
        kind: ORDER,
        number: 4,
        protocol: 1,
        count,
        bytes,
    };
    assert_eq!(decode(&raw(&order)), Err(DecodeError::Body));
}
