use super::*;
use crate::dialect::{HEARTBEAT_DATA, MavMessage};
use crate::frame::MAX_FRAME_LEN;
use mavlink_core::Message as _;
use proptest::array::uniform;
use proptest::collection::vec;
use proptest::prelude::*;

type Bytes = Vec<u8, MAX_FRAME_LEN>;

const HEADER: Header = Header { boot: 3, sender: RobotId(7), sequence: 0x1234 };

fn framed(header: Header, message: &Message) -> Bytes {
    let mut out = Vec::new();
    assert_eq!(encode(header, message, &mut out), Ok(out.len()));
    out
}

fn raw(data: &impl MessageData) -> Bytes {
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

fn motion() -> impl Strategy<Value = ([i32; 3], [i16; 3])> {
    any::<([i32; 3], [i16; 3])>()
}

fn any_message() -> impl Strategy<Value = Message> {
    let modes = (0..6_u8).prop_map(|number| mode(number).unwrap());
    let beacon = (any::<(u32, u16, u16, u8)>(), motion(), (cell(), cell()), 0..=8_u8, id(), modes.clone());
    let beacon = beacon.prop_map(|(numbers, motion, (cell, target), heading, leader, mode)| {
        let (time, radius_mm, busy_ms, slot) = numbers;
        Message::Beacon(Beacon {
            time: Instant::from_micros(time),
            position_mm: motion.0,
            velocity_mmps: motion.1,
            radius_mm,
            cell,
            heading: dir(heading).unwrap(),
            busy_ms,
            leader,
            slot,
            mode,
            target,
        })
    });
    let kinds = prop_oneof![Just(RequestKind::Stop), Just(RequestKind::Resume), Just(RequestKind::Redirect)];
    let request = (id(), id(), any::<(u8, u16)>(), kinds);
    let request = request.prop_map(|(to, origin, (number, valid_ms), kind)| {
        Message::Request(Request { to, origin, number, kind, valid_ms })
    });
    let ack = (id(), any::<(u8, u8, bool)>())
        .prop_map(|(to, (boot, number, accepted))| Message::Ack(Ack { to, boot, number, accepted }));
    let entry = (cell(), id(), any::<u8>());
    let entry = entry.prop_map(|(offset, id, hops)| TemplateEntry { offset, id, hops });
    let template = (id(), uniform::<_, 4>(any::<u8>()), cell(), vec(entry, 0..=2));
    let template = template.prop_map(|(to, [version, part, parts, slot], offset, entries)| {
        Message::Template(TemplateAssignment {
            to,
            version,
            part,
            parts,
            slot,
            offset,
            entries: entries.into_iter().collect(),
        })
    });
    let goal = (id(), any::<u8>(), cell())
        .prop_map(|(to, version, target)| Message::Goal(GoalAssignment { to, version, target }));
    let place = (id(), any::<[u8; 2]>(), motion());
    let place = place.prop_map(|(to, [version, index], (position_mm, velocity_mmps))| {
        Message::Waypoint(WaypointAssignment { to, version, index, position_mm, velocity_mmps })
    });
    let land =
        (cell(), any::<[u8; 32]>()).prop_map(|(corner, bytes)| Message::Land(LandPatch::from_bytes(corner, bytes)));
    let payload = vec(any::<u8>(), 0..=MAX_PAYLOAD);
    let payload = payload.prop_map(|bytes| Message::Payload(PayloadBytes::new(&bytes).unwrap_or_default()));
    let lost = (any::<u8>(), any::<bool>(), any::<u16>(), any::<[i32; 3]>(), any::<u16>());
    let lost = lost.prop_map(|(id, is_lost, age_cs, position_mm, radius_mm)| {
        Message::Lost(LostRobot { id: robot(id), is_lost, age_cs, position_mm, radius_mm })
    });
    prop_oneof![beacon, request, ack, template, goal, place, land, payload, lost]
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
    fn arbitrary_payloads_do_not_panic(payload in vec(any::<u8>(), 0..=255), id in 0..8_u32) {
        let id = 9_500_000 + id;
        let len = payload.len() as u8;
        let [a, b, c, _] = id.to_le_bytes();
        let mut bytes = std::vec![0xFD, len, 0, 0, 1, 7, COMPONENT, a, b, c];
        bytes.extend(&payload);
        let crc = mavlink_core::calculate_crc(&bytes[1..], MavMessage::extra_crc(id));
        bytes.extend(crc.to_le_bytes());
        let answer = decode(&bytes);
        prop_assert!(!matches!(answer, Err(DecodeError::Crc)), "{:?}", answer);
        if let Ok(frame) = answer {
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
    Message::Goal(GoalAssignment { to: RobotId(to), version: 1, target: Cell::new(3, -4) })
}

#[test]
fn numbers_beyond_systems_are_refused_and_nothing_is_written() {
    let mut out = Bytes::new();
    let from = |sender: u32| Header { sender: RobotId(sender), ..HEADER };
    let mut refused = |header, message: &Message| {
        let answer = encode(header, message, &mut out).unwrap_err();
        assert!(out.is_empty());
        answer
    };
    assert_eq!(refused(from(0), &goal(1)), EncodeError::NoSender);
    assert_eq!(refused(from(256), &goal(1)), EncodeError::Robot(RobotId(256)));
    assert_eq!(refused(HEADER, &goal(70_000)), EncodeError::Robot(RobotId(70_000)));
    let mut small = Vec::<u8, 12>::new();
    assert_eq!(encode(HEADER, &goal(1), &mut small), Err(EncodeError::Full));
    assert!(small.is_empty());
}

#[test]
fn invalid_fields_are_refused() {
    let beacon = STAYA_BEACON_DATA::DEFAULT;
    let bodies = [
        raw(&STAYA_BEACON_DATA { mode: 7, ..beacon.clone() }),
        raw(&STAYA_BEACON_DATA { heading: 9, ..beacon }),
        raw(&STAYA_REQUEST_DATA { kind: 3, ..STAYA_REQUEST_DATA::DEFAULT }),
        raw(&STAYA_ACK_DATA { accepted: 2, ..STAYA_ACK_DATA::DEFAULT }),
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
fn a_beacon_has_at_most_its_length() {
    let beacon = Beacon { mode: Mode::Fault, ..Beacon::default() };
    assert_eq!(framed(HEADER, &Message::Beacon(beacon)).len(), BEACON_LEN);
    assert_eq!(Mavlink.beacon_len(), BEACON_LEN);
}
