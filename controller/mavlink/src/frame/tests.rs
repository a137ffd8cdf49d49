use super::*;
use crate::dialect::{HEARTBEAT_DATA, MISSION_COUNT_DATA, MavMessage, STAYA_GOAL_DATA};
use mavlink_core::{MAVLinkV1MessageRaw, MavHeader, MavlinkReader};
use proptest::collection::vec;
use proptest::prelude::*;

const SENDER: Sender = Sender { system: 7, component: 191, sequence: 250 };

fn goal(x: i16) -> STAYA_GOAL_DATA {
    STAYA_GOAL_DATA { sequence: 0xFDFD, target_x: x, target_y: -3, boot: 1, target_system: 9, version: 4 }
}

fn framed(data: &impl MessageData) -> Vec<u8, MAX_FRAME_LEN> {
    let mut out = Vec::new();
    let len = encode(SENDER, data, &mut out);
    assert_eq!(len, Ok(out.len()));
    out
}

#[test]
fn encoded_frames_are_found() {
    let bytes = framed(&goal(5));
    let frame = RawFrame::new(&bytes).unwrap();
    assert_eq!(frame.sender(), SENDER);
    assert_eq!(frame.message_id(), STAYA_GOAL_DATA::ID);
    assert_eq!(frame.get(), Some(goal(5)));
    assert_eq!(frame.get::<HEARTBEAT_DATA>(), None);
    assert_eq!(frame.message(), Some(MavMessage::STAYA_GOAL(goal(5))));
    assert_eq!((frame.version(), frame.is_known()), (2, true));
    assert_eq!(frame.signature(), None);
    let mut other = Vec::<u8, MAX_FRAME_LEN>::new();
    encode_message(SENDER, &MavMessage::STAYA_GOAL(goal(5)), &mut other).unwrap();
    assert_eq!(other, bytes);
}

#[test]
fn mavlink_core_reads_the_same_message() {
    let bytes = framed(&goal(-1));
    let mut reader = MavlinkReader::new(bytes.as_slice());
    let read = reader.read_message::<MavMessage>(MavlinkVersion::V2);
    let Ok((header, message)) = read else { panic!("not read") };
    assert_eq!(message, MavMessage::STAYA_GOAL(goal(-1)));
    assert_eq!((header.system_id, header.component_id), (7, 191));
}

#[test]
fn trailing_zeros_are_omitted_and_restored() {
    let empty = MISSION_COUNT_DATA::DEFAULT;
    let bytes = framed(&empty);
    assert_eq!(bytes.len(), 10 + 1 + 2);
    assert_eq!(RawFrame::new(&bytes).unwrap().get(), Some(empty));
}

#[test]
fn mavlink_1_is_understood() {
    let mut raw = MAVLinkV1MessageRaw::new();
    let header = MavHeader { system_id: 3, component_id: 1, sequence: 8 };
    raw.serialize_message(header, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT));
    let frame = RawFrame::new(raw.raw_bytes()).unwrap();
    assert_eq!((frame.version(), frame.sender().system), (1, 3));
    assert_eq!(frame.get(), Some(HEARTBEAT_DATA::DEFAULT));
}

#[test]
fn no_known_message_has_the_extra_crc_of_unknown_ones() {
    for id in MavMessage::all_ids() {
        assert_ne!(MavMessage::extra_crc(*id), 0, "{id}");
    }
}

fn foreign() -> [u8; 15] {
    [START_V2, 3, 0, 0, 1, 1, 1, 0x30, 0xFA, 0x00, 1, 2, 3, 9, 9]
}

#[test]
fn foreign_message_is_a_frame_before_another_frame_or_the_end() {
    let mut bytes = std::vec::Vec::from(foreign());
    assert!(RawFrame::new(&bytes).is_some_and(|frame| !frame.is_known() && frame.message().is_none()));
    bytes.extend_from_slice(&framed(&goal(1)));
    let mut rest = bytes.as_slice();
    assert_eq!(next_frame(&mut rest).map(|frame| frame.is_known()), Some(false));
    assert_eq!(next_frame(&mut rest).and_then(|frame| frame.get()), Some(goal(1)));
    assert_eq!((next_frame(&mut rest), rest.len()), (None, 0));
}

#[test]
fn foreign_message_before_junk_is_rejected() {
    let mut bytes = std::vec::Vec::from(foreign());
    bytes.push(0);
    assert!(matches!(scan(&bytes, true), Scan::Nothing { junk: 16 }));
}

#[test]
fn unknown_flag_is_refused() {
    let mut bytes = framed(&goal(1));
    bytes[2] = 2;
    assert!(RawFrame::new(&bytes).is_none());
}

#[test]
fn full_buffer_is_unchanged() {
    let len = framed(&goal(1)).len();
    let mut out = Vec::<u8, 32>::new();
    out.resize(32 - len + 1, 0).unwrap();
    assert_eq!(encode(SENDER, &goal(1), &mut out), Err(Full));
    assert_eq!(out.len(), 32 - len + 1);
    out.truncate(32 - len);
    assert_eq!(encode(SENDER, &goal(1), &mut out), Ok(len));
}

proptest! {
    #[test]
    fn frames_are_found_after_junk(junk in vec(vec(any::<u8>().prop_filter("looks like a frame's start", |b| !matches!(*b, START_V1 | START_V2)), 0..40), 20)) {
        let mut bytes = std::vec::Vec::new();
        for (x, junk) in (0..).zip(&junk) {
            bytes.extend_from_slice(junk);
            bytes.extend_from_slice(&framed(&goal(x)));
        }
        let mut rest = bytes.as_slice();
        for x in 0..20 {
            prop_assert_eq!(next_frame(&mut rest).and_then(|frame| frame.get()), Some(goal(x)));
        }
        prop_assert_eq!(next_frame(&mut rest), None);
    }

    #[test]
    fn stream_in_pieces_loses_nothing(cuts in vec(1..40_usize, 1..30)) {
        let mut stream = std::vec::Vec::new();
        for x in 0..10 {
            stream.extend_from_slice(&framed(&goal(x)));
        }
        let (mut buffer, mut found, mut at) = (std::vec::Vec::new(), 0, 0);
        for cut in cuts.iter().cycle() {
            if at == stream.len() {
                break;
            }
            let end = (at + cut).min(stream.len());
            buffer.extend_from_slice(&stream[at..end]);
            at = end;
            while let Scan::Frame { junk, frame } = scan(&buffer, false) {
                prop_assert_eq!((junk, frame.get()), (0, Some(goal(found))));
                found += 1;
                let used = frame.bytes().len();
                buffer.drain(..used);
            }
        }
        prop_assert_eq!((found, buffer.len()), (10, 0));
    }

    #[test]
    fn flipped_bit_is_detected(bit in 0..(8 * 21_usize)) {
        let mut bytes = framed(&goal(77));
        prop_assume!(bit < 8 * bytes.len());
        bytes[bit >> 3] ^= 1 << (bit & 7);
        let read = RawFrame::new(&bytes).filter(RawFrame::is_known).and_then(|frame| frame.get::<STAYA_GOAL_DATA>());
        prop_assert_eq!(read, None);
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in vec(prop_oneof![Just(START_V2), Just(START_V1), any::<u8>()], 0..600)) {
        let mut rest = bytes.as_slice();
        while let Some(frame) = next_frame(&mut rest) {
            let _ = (frame.message(), frame.signature());
        }
    }
}
