use super::*;
use crate::rand::Rng;
use crate::robot::Mode;
use crate::wire::arbitrary::{header, message};
use crate::wire::{Bytes, KeyPhase, ProtocolId};
use proptest::collection::vec;
use proptest::prelude::*;
use std::vec::Vec as StdVec;

type Outbox = heapless::Vec<u8, 256>;

const LAST: RobotId = MAX_TAGGED_ROBOT;
const HEADER: Header = Header { boot: 7, sender: RobotId(12), sequence: 0x0102 };

/// [`beacon`] under [`HEADER`], computed by hand from the layout: version, header, kind, place,
/// velocity, radius, mode, flock, protocol, payload with its length, CRC; then stuffed.
const GOLDEN_BEACON: [u8; 47] = [
    0x06, 0x04, 0x07, 0x0C, 0x02, 0x01, 0x03, 0x39, 0x30, 0x01, 0x05, 0x5A, 0xFD, 0xFF, 0xFF, 0x01, 0x01, 0x01, 0x02,
    0xFA, 0x01, 0x01, 0x04, 0xFF, 0xFF, 0x96, 0x06, 0x02, 0x05, 0x01, 0x0D, 0x03, 0x04, 0xFE, 0xFF, 0x62, 0x02, 0x62,
    0x08, 0x90, 0x01, 0x03, 0x04, 0x01, 0x13, 0x2C, 0x00,
];

/// The payload of a robot on the grid: in cell (3, -2) to (98, 98), busy for 400 ms, heading
/// north-west, in place 4 behind robot 1.
const PAYLOAD: [u8; 13] = [3, 0, 0xFE, 0xFF, 98, 0, 98, 0, 0x90, 0x01, 3, 4, 1];

fn beacon() -> Message {
    Message::Beacon(Beacon {
        position_mm: [12_345, -678, 0],
        velocity_mmps: [250, 0, -1],
        radius_mm: 150,
        mode: Mode::Cruise,
        flock: 5,
        protocol: ProtocolId(1),
        payload: Bytes::from_slice(&PAYLOAD).unwrap(),
    })
}

fn full<const N: usize>() -> Bytes<N> {
    Bytes::from_slice(&[0; N]).unwrap()
}

fn longest() -> [(Message, usize); 9] {
    let addressed = || Addressed { to: LAST, number: 0, protocol: ProtocolId(0), content: full() };
    let broadcast = Broadcast { protocol: ProtocolId(0), content: full() };
    [
        (Message::Beacon(Beacon { payload: full(), ..Beacon::default() }), Beacon::MAX_FRAME_LEN),
        (Message::Law(addressed()), Addressed::MAX_FRAME_LEN),
        (Message::Ack(Ack { to: LAST, boot: 0, number: 0 }), Ack::MAX_FRAME_LEN),
        (Message::Broadcast(broadcast), Broadcast::MAX_FRAME_LEN),
        (Message::Order(addressed()), Addressed::MAX_FRAME_LEN),
        (
            Message::Lost(LostRobot { id: LAST, is_lost: true, age_cs: 0, position_mm: [0; 3], radius_mm: 0 }),
            LostRobot::MAX_FRAME_LEN,
        ),
        (
            Message::Key(KeyAssignment { to: LAST, generation: 0, phase: KeyPhase::Hear, wrapped: [0; 32] }),
            KeyAssignment::MAX_FRAME_LEN,
        ),
        (Message::KeyHeld(KeyHeld { to: LAST, generation: 0, phase: KeyPhase::Hear }), KeyHeld::MAX_FRAME_LEN),
        (Message::Relayed(Relayed { id: LAST, payload: full(), ..Relayed::default() }), Relayed::MAX_FRAME_LEN),
    ]
}

fn bound(message: &Message) -> usize {
    match message {
        Message::Beacon(_) => Beacon::MAX_FRAME_LEN,
        Message::Law(_) | Message::Order(_) => Addressed::MAX_FRAME_LEN,
        Message::Ack(_) => Ack::MAX_FRAME_LEN,
        Message::Broadcast(_) => Broadcast::MAX_FRAME_LEN,
        Message::Lost(_) => LostRobot::MAX_FRAME_LEN,
        Message::Key(_) => KeyAssignment::MAX_FRAME_LEN,
        Message::KeyHeld(_) => KeyHeld::MAX_FRAME_LEN,
        Message::Relayed(_) => Relayed::MAX_FRAME_LEN,
    }
}

fn encoded(header: Header, message: &Message, tag: Option<[u8; TAG_LEN]>) -> StdVec<u8> {
    let mut out = Outbox::new();
    let len = match tag {
        Some(tag) => encode_tagged(header, message, |_| tag, &mut out),
        None => encode(header, message, &mut out),
    };
    assert_eq!(len, Ok(out.len()));
    out.to_vec()
}

fn fits(header: Header, message: &Message) -> bool {
    header.sender.max(message.addressee().unwrap_or_default()) <= MAX_TAGGED_ROBOT
}

fn seal(content: &[u8]) -> StdVec<u8> {
    let mut content = content.to_vec();
    content.extend(CRC.checksum(&content).to_le_bytes());
    let first = stuff(&mut content);
    content.insert(0, first);
    content
}

fn content(version: u8, header: Header, message: &Message) -> StdVec<u8> {
    let mut buffer = [0; MAX_FRAME_LEN];
    postcard::to_slice(&(version, header, message), &mut buffer).unwrap().to_vec()
}

#[test]
fn a_beacon_encodes_to_the_golden_bytes() {
    let frame = encoded(HEADER, &beacon(), None);
    assert_eq!(frame, GOLDEN_BEACON);
}

#[test]
fn the_crc_matches_the_x25_check_value() {
    assert_eq!(CRC.checksum(b"123456789"), 0x906E);
}

#[test]
fn the_longest_message_of_each_kind_reaches_its_bound() {
    let header = Header { sender: LAST, ..HEADER };
    for (message, bound) in longest() {
        assert_eq!(encoded(header, &message, Some([0; TAG_LEN])).len(), bound);
        assert_eq!(encoded(header, &message, None).len(), bound - TAG_LEN);
    }
    let reached = longest().map(|(_, bound)| bound).into_iter().max();
    assert_eq!(reached, Some(MAX_FRAME_LEN));
}

#[test]
fn frames_fit_into_the_packets_of_common_radios() {
    assert_eq!(Beacon::MAX_FRAME_LEN, 60);
    assert_eq!(Beacon::BARE_FRAME_LEN, 44);
    assert_eq!((Addressed::MAX_FRAME_LEN, Broadcast::MAX_FRAME_LEN), (60, 60));
    assert_eq!(Ack::MAX_FRAME_LEN - TAG_LEN, 17);
}

#[test]
fn a_full_outbox_is_unchanged() {
    let frame = encoded(HEADER, &beacon(), None);
    let mut out = heapless::Vec::<u8, 100>::new();
    for used in 0..=100 {
        out.clear();
        out.resize(used, 0xEE).unwrap();
        let fits = used + frame.len() <= 100;
        let result = encode(HEADER, &beacon(), &mut out);
        if fits {
            assert_eq!(result, Ok(frame.len()));
            assert_eq!(&out[used..], frame);
        } else {
            assert_eq!(result, Err(EncodeError::Full));
            assert_eq!(out.len(), used);
        }
        assert!(out[..used].iter().all(|byte| *byte == 0xEE));
    }
}

#[test]
fn robot_zero_can_neither_send_nor_be_received() {
    let header = Header { sender: RobotId::NONE, ..HEADER };
    let mut out = Outbox::new();
    let result = encode(header, &beacon(), &mut out);
    assert_eq!(result, Err(EncodeError::NoSender));
    assert!(out.is_empty());
    let frame = seal(&content(VERSION, header, &beacon()));
    assert_eq!(decode(&frame), Err(DecodeError::NoSender));
}

#[test]
fn each_fault_returns_its_error() {
    assert_eq!(decode(&[]), Err(DecodeError::Empty));
    assert_eq!(decode(&[1; MAX_FRAME_LEN - 1]), Err(DecodeError::Crc));
    assert_eq!(decode(&[1; MAX_FRAME_LEN]), Err(DecodeError::TooLong));
    assert_eq!(decode(&[0]), Err(DecodeError::Cobs));
    assert_eq!(decode(&[3, 9]), Err(DecodeError::Cobs));
    assert_eq!(decode(&[3, 0, 9]), Err(DecodeError::Cobs));
    assert_eq!(decode(&[255; 20]), Err(DecodeError::Cobs));
    assert_eq!(decode(&[1]), Err(DecodeError::Crc));
    assert_eq!(decode(&[2, 9]), Err(DecodeError::Crc));
    assert_eq!(decode(&seal(&[])), Err(DecodeError::Body));
    assert_eq!(decode(&seal(&[VERSION])), Err(DecodeError::Body));
    assert_eq!(decode(&seal(&[VERSION | TAGGED, 1, 2])), Err(DecodeError::Body));
    let mut sound = content(VERSION, HEADER, &beacon());
    assert!(decode(&seal(&sound)).is_ok());
    sound.push(0);
    assert_eq!(decode(&seal(&sound)), Err(DecodeError::Trailing));
}

#[test]
fn every_foreign_version_is_reported() {
    for version in (0..128).filter(|version| *version != VERSION) {
        for flag in [0, TAGGED] {
            let frame = seal(&content(version | flag, HEADER, &beacon()));
            assert_eq!(decode(&frame), Err(DecodeError::Version(version)));
        }
    }
}

#[test]
fn an_unknown_value_in_a_field_is_refused() {
    let ack = Message::Ack(Ack { to: RobotId(1), boot: 4, number: 9 });
    let held = Message::KeyHeld(KeyHeld { to: RobotId(1), generation: 9, phase: KeyPhase::Forget });
    for (message, tail, values) in [(ack, [2, 1, 4, 9], [(3, 8), (3, 255)]), (held, [1, 9, 0, 2], [(0, 3), (0, 255)])] {
        let sound = content(VERSION, HEADER, &message);
        assert!(sound.ends_with(&tail));
        for (from_end, value) in values {
            let mut strange = sound.clone();
            let place = sound.len() - 1 - from_end;
            strange[place] = value;
            assert_eq!(decode(&seal(&strange)), Err(DecodeError::Body));
        }
    }
}

#[test]
fn more_bytes_than_a_message_holds_are_refused() {
    for (message, _) in longest() {
        let limit = match message {
            Message::Beacon(_) => MAX_PAYLOAD,
            Message::Law(_) | Message::Order(_) => MAX_ORDER,
            Message::Broadcast(_) => MAX_CONTENT,
            _ => continue,
        };
        let mut longer = content(VERSION, HEADER, &message);
        let place = longer.len() - limit - 1;
        assert_eq!(usize::from(longer[place]), limit);
        longer[place] += 1;
        longer.push(0);
        assert_eq!(decode(&seal(&longer)), Err(DecodeError::Body), "{message:?}");
    }
}

#[test]
fn the_tag_covers_everything_before_it_and_is_returned() {
    let tag = [0, 0, 7, 0, 1, 2, 0, 9];
    let frame = encoded(HEADER, &beacon(), Some(tag));
    let sealed = content(VERSION | TAGGED, HEADER, &beacon());
    let frame = &frame[..frame.len() - 1];
    let read = decode_verified(frame, |span, found| {
        assert_eq!((span, found), (&sealed[..], Some(tag)));
        Ok(())
    });
    assert_eq!(read.unwrap().tag, Some(tag));
    let refused = decode_verified(frame, |_, _| Err(DecodeError::Forged));
    assert_eq!(refused, Err(DecodeError::Forged));
    let bare = encoded(HEADER, &beacon(), None);
    let bare = &bare[..bare.len() - 1];
    assert_eq!(decode(bare).unwrap().tag, None);
    let refused = decode_verified(bare, |_, found| found.map(|_| ()).ok_or(DecodeError::Unsigned));
    assert_eq!(refused, Err(DecodeError::Unsigned));
}

#[test]
fn large_robot_numbers_are_refused_in_tagged_frames() {
    let large = RobotId(MAX_TAGGED_ROBOT.0 + 1);
    let from = |sender| Header { sender, ..HEADER };
    let ack = |to| Message::Ack(Ack { to, boot: 0, number: 0 });
    let say = |sender, to| {
        let (mut out, tag) = (Outbox::new(), [0; TAG_LEN]);
        encode_tagged(from(sender), &ack(to), |_| tag, &mut out)
    };
    assert!(say(MAX_TAGGED_ROBOT, MAX_TAGGED_ROBOT).is_ok());
    assert_eq!(say(large, LAST), Err(EncodeError::Robot(large)));
    assert_eq!(say(LAST, large), Err(EncodeError::Robot(large)));
    assert!(encode(from(large), &ack(large), &mut Outbox::new()).is_ok());
}

#[test]
fn a_stream_splits_at_zeros_and_keeps_the_last_piece() {
    let pieces = |bytes| frames(bytes).collect::<StdVec<_>>();
    assert!(pieces(&[]).is_empty());
    assert!(pieces(&[0, 0, 0]).is_empty());
    assert_eq!(pieces(&[1, 2, 0, 0, 3, 0]), [&[1_u8, 2][..], &[3]]);
    assert_eq!(pieces(&[0, 1, 0, 2, 3]), [&[1_u8][..], &[2, 3]]);
}

#[test]
fn a_cut_frame_is_refused_at_every_length_but_a_lost_delimiter_is_accepted() {
    let frame = encoded(HEADER, &beacon(), Some([9; TAG_LEN]));
    let whole = frame.len() - 1;
    assert!(decode(&frame[..whole]).is_ok());
    for len in 0..whole {
        assert!(decode(&frame[..len]).is_err(), "{len} bytes");
        assert!(decode(&frame[whole - len..whole]).is_err(), "last {len}");
    }
}

fn received(stream: &[u8]) -> (StdVec<Frame>, usize) {
    let mut refused = 0;
    let read = frames(stream).filter_map(|frame| decode(frame).map_err(|_| refused += 1).ok());
    (read.collect(), refused)
}

fn flip(bytes: &mut [u8], bit: usize) {
    bytes[bit >> 3] ^= 1 << (bit & 7);
}

/// The positions of COBS' own bytes and of the delimiter.
fn links(frame: &[u8]) -> StdVec<usize> {
    let next = |at: &usize| Some(usize::from(frame[*at])).filter(|step| *step != 0).map(|step| at + step);
    core::iter::successors(Some(0), next).collect()
}

#[test]
fn every_single_bit_error_in_every_message_is_detected() {
    let messages = longest().map(|(message, _)| message);
    for message in messages.into_iter().chain([beacon()]) {
        for tag in [None, Some([0; TAG_LEN])] {
            let frame = encoded(HEADER, &message, tag);
            for bit in 0..frame.len() * 8 {
                let mut damaged = frame.clone();
                flip(&mut damaged, bit);
                assert_eq!(received(&damaged).0, [], "bit {bit} of {message:?}");
            }
        }
    }
}

#[test]
fn every_two_bit_error_is_detected_unless_it_moves_a_zero() {
    let frame = encoded(HEADER, &beacon(), None);
    let links = links(&frame);
    assert_eq!(links.len(), 16);
    let bits = frame.len() * 8;
    let mut accepted = 0;
    for first in 0..bits {
        for second in first + 1..bits {
            let mut damaged = frame.clone();
            flip(&mut damaged, first);
            flip(&mut damaged, second);
            if !received(&damaged).0.is_empty() {
                accepted += 1;
                assert!(links.contains(&(first >> 3)) || links.contains(&(second >> 3)));
            }
        }
    }
    // Of 70,500 pairs 57 % hit COBS' own bytes; 1 in 65,536 of those may pass.
    assert!(accepted <= 2, "{accepted} pairs");
}

#[test]
fn one_in_65536_random_errors_passes_the_crc_and_fewer_parse() {
    // 8 to 23 flipped bits anywhere; expected to pass the CRC: 400,000 / 65,536 = 6.
    let mut rng = Rng::new(1);
    let mut accepted = 0;
    let mut passed = 0;
    for round in 0..400_000_u32 {
        let header = Header { sequence: round as u16, ..HEADER };
        let mut out = Outbox::new();
        encode(header, &beacon(), &mut out).unwrap();
        let mut damaged = out.to_vec();
        damaged.pop();
        for _ in 0..8 + rng.below(16) {
            let bit = rng.below(damaged.len() as u32 * 8) as usize;
            flip(&mut damaged, bit);
        }
        if damaged == out[..damaged.len()] {
            continue;
        }
        match decode(&damaged) {
            Ok(_) => accepted += 1,
            Err(DecodeError::Cobs | DecodeError::Crc) => {}
            Err(_) => passed += 1,
        }
    }
    assert!(accepted + passed <= 20, "{accepted} accepted, {passed} passed");
}

#[cfg(feature = "host")]
fn by_postcard(body: &[u8]) -> Option<(Header, Message)> {
    let (read, trailing) = postcard::take_from_bytes::<(Header, Message)>(body).ok()?;
    trailing.is_empty().then_some(read)
}

#[cfg(feature = "host")]
#[test]
fn robot_numbers_of_more_than_28_bits_are_left_to_postcard() {
    for (sender, is_read) in [(1, true), ((1 << 28) - 1, true), (1 << 28, false), (u32::MAX, false)] {
        let header = Header { sender: RobotId(sender), ..HEADER };
        let body = &content(VERSION, header, &beacon())[1..];
        assert_eq!(super::beacon::read(body), is_read.then(|| (header, beacon())), "{sender}");
        assert_eq!(by_postcard(body), Some((header, beacon())));
    }
}

#[cfg(feature = "host")]
proptest! {
    #[test]
    fn the_beacon_decoder_agrees_with_postcard(
        header in header(),
        message in message(),
        hits in vec((any::<prop::sample::Index>(), any::<u8>()), 0..3),
        cut in 0..3_usize,
    ) {
        let body = &content(VERSION, header, &message)[1..];
        let is_small = |id: RobotId| id.0 < 1 << 28;
        if matches!(message, Message::Beacon(_)) && is_small(header.sender) {
            prop_assert_eq!(super::beacon::read(body), Some((header, message.clone())));
        }
        let mut damaged = body.to_vec();
        for (at, byte) in hits {
            *at.get_mut(&mut damaged[..]) = byte;
        }
        damaged.truncate(body.len() - cut);
        if let Some(read) = super::beacon::read(&damaged) {
            prop_assert_eq!(by_postcard(&damaged), Some(read));
        }
    }
}

proptest! {
    #[test]
    fn a_frame_ends_at_the_first_zero(bytes in vec(prop_oneof![Just(0_u8), Just(1), Just(0x80), any::<u8>()], 0..40)) {
        let len = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        prop_assert_eq!(frame_len(&bytes), len);
    }

    #[test]
    fn a_decoded_frame_equals_the_encoded_one(
        header in header(), message in message(), tag in any::<Option<[u8; TAG_LEN]>>()
    ) {
        let tag = tag.filter(|_| fits(header, &message));
        let frame = encoded(header, &message, tag);
        prop_assert_eq!(frame.iter().position(|byte| *byte == 0), Some(frame.len() - 1));
        let read = decode(&frame[..frame.len() - 1]);
        prop_assert_eq!(read, Ok(Frame { header, message, tag }));
    }

    #[test]
    fn no_message_is_longer_than_its_bound(header in header(), message in message()) {
        prop_assert!(encoded(header, &message, None).len() <= bound(&message));
        if fits(header, &message) {
            let frame = encoded(header, &message, Some([0; TAG_LEN]));
            prop_assert!(frame.len() <= MAX_FRAME_LEN);
        }
    }

    #[test]
    fn a_stream_returns_its_messages_in_order_despite_bytes_in_between(
        sent in vec((header(), message()), 0..5),
        noise in vec(vec(any::<u8>(), 0..100), 5),
    ) {
        let mut stream = StdVec::new();
        for ((header, message), noise) in sent.iter().zip(&noise) {
            stream.extend(noise);
            stream.push(0);
            stream.extend(encoded(*header, message, None));
        }
        let (read, _) = received(&stream);
        let read: StdVec<_> = read.into_iter().map(|f| (f.header, f.message)).collect();
        prop_assert_eq!(read, sent);
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in vec(any::<u8>(), 0..200)) {
        for piece in frames(&bytes).chain([&bytes[..]]) {
            prop_assert!(decode(piece).is_err());
        }
    }

    #[test]
    fn arbitrary_content_with_a_valid_crc_does_not_panic(bytes in vec(any::<u8>(), 0..80), kind in 0..9_u8) {
        let mut likely = StdVec::from([VERSION, 0, 1, 0, 0, kind]);
        likely.extend(&bytes);
        for content in [bytes, likely] {
            if let Ok(frame) = decode(&seal(&content)) {
                let tag = frame.tag.filter(|_| fits(frame.header, &frame.message));
                let frame = Frame { tag, ..frame };
                let again = encoded(frame.header, &frame.message, frame.tag);
                prop_assert_eq!(decode(&again[..again.len() - 1]), Ok(frame));
            }
        }
    }

    #[test]
    fn stuffing_removes_all_zeros_and_is_reversible(content in vec(0..3_u8, 0..=MAX_STUFFED)) {
        let mut stuffed = content.clone();
        let first = stuff(&mut stuffed);
        prop_assert!(first != 0 && !stuffed.contains(&0));
        prop_assert_eq!(unstuff(first, &mut stuffed), Some(()));
        prop_assert_eq!(stuffed, content);
    }
}

#[test]
fn error_texts_contain_the_number_and_the_remedy() {
    let text = std::format!("{}", DecodeError::Version(7));
    assert_eq!(text, std::format!("the frame is of version 7, not {VERSION}; update the older side"));
    let text = std::format!("{}", EncodeError::Robot(RobotId(70_000)));
    assert!(text.contains("70000") && text.contains("give the robot a smaller one"), "{text}");
}
