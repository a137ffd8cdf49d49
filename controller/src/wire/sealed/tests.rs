use super::super::arbitrary;
use super::super::{Addressed, Bytes, ProtocolId, decode, encode};
use super::*;
use crate::digest::digest;
use crate::robot::RobotId;
use crc::{CRC_16_IBM_SDLC, Crc};
use proptest::collection::vec;
use proptest::prelude::*;
use std::vec::Vec as StdVec;

const X25: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_SDLC);

fn key() -> Key {
    Key::of_passphrase(b"test")
}

fn sealed(starts: u32) -> Sealed<4> {
    Sealed::at_start(&key(), starts).unwrap()
}

fn header(sender: u32, sequence: u16) -> Header {
    Header { boot: 3, sender: RobotId(sender), sequence }
}

fn order() -> Message {
    let content = Bytes::from_slice(&[0, 0xFD, 0xFF, 8, 0]).unwrap();
    Message::Order(Addressed { to: RobotId(2), number: 4, protocol: ProtocolId(1), content })
}

fn said<W: Wire>(by: &mut W, header: Header) -> StdVec<u8> {
    let mut out = Vec::<u8, 64>::new();
    by.encode(header, &order(), &mut out).unwrap();
    assert_eq!(out.pop(), Some(0));
    out.to_vec()
}

/// Plain loops written from the paper, like [`stuffed`].
fn unstuffed(frame: &[u8]) -> StdVec<u8> {
    let mut content = StdVec::new();
    let mut rest = frame;
    while let Some((&code, tail)) = rest.split_first() {
        let (block, next) = tail.split_at(usize::from(code) - 1);
        content.extend_from_slice(block);
        content.push(0);
        rest = next;
    }
    content.pop();
    content
}

fn stuffed(content: &[u8]) -> StdVec<u8> {
    let blocks = content.split(|byte| *byte == 0);
    let block = |block: &[u8]| [&[block.len() as u8 + 1], block].concat();
    blocks.flat_map(block).collect()
}

#[test]
fn a_sealed_frame_has_the_golden_bytes() {
    let frame = said(&mut sealed(5), header(12, 0x0102));
    let content = unstuffed(&frame);
    let (body, crc) = content.split_at(content.len() - 2);
    assert_eq!(X25.checksum(body).to_le_bytes(), crc);
    let (text, code) = body.split_at(body.len() - 4);
    // version | tagged, boot, sender, sequence; order: kind, to, number, protocol, length, content;
    // epoch.
    assert_eq!(text, [0x84, 3, 12, 2, 1, 4, 2, 4, 1, 5, 0, 0xFD, 0xFF, 8, 0, 0x00, 0x50, 0, 0]);
    assert_eq!(code, &Mac::new(&key()).of(&[text])[..4]);
    let plain = said(&mut Postcard, header(12, 0x0102));
    assert_eq!(frame.len(), plain.len() + TAG_LEN);
}

#[test]
fn a_frame_with_the_key_is_accepted_once_and_others_never() {
    let frame = said(&mut sealed(0), header(1, 0));
    let mut receiver = sealed(0);
    let heard = receiver.decode(&frame).unwrap();
    assert_eq!((heard.header, heard.message), (header(1, 0), order()));
    assert_eq!(receiver.decode(&frame), Err(DecodeError::Replayed));
    let plain = said(&mut Postcard, header(1, 1));
    assert_eq!(receiver.decode(&plain), Err(DecodeError::Unsigned));
    let other = Key::of_passphrase(b"another");
    let mut stranger = Sealed::<4>::at_start(&other, 9).unwrap();
    let forged = said(&mut stranger, header(1, 1));
    assert_eq!(receiver.decode(&forged), Err(DecodeError::Forged));
    assert_eq!(stranger.decode(&frame), Err(DecodeError::Forged));
    assert!(receiver.decode(&said(&mut sealed(0), header(1, 1))).is_ok());
}

#[test]
fn reordered_frames_are_each_accepted_once() {
    let mut sender = sealed(0);
    let frames: StdVec<_> = (0..40).map(|n| said(&mut sender, header(1, n))).collect();
    let mut receiver = sealed(0);
    for at in [8, 39, 38, 9, 10] {
        assert!(receiver.decode(&frames[at]).is_ok(), "{at}");
    }
    for at in [7, 8, 9, 10, 38, 39] {
        assert_eq!(receiver.decode(&frames[at]), Err(DecodeError::Replayed), "{at}");
    }
}

#[test]
fn the_sequence_wraps_into_the_epoch() {
    let (mut sender, mut receiver) = (sealed(7), sealed(0));
    let before = [u16::MAX - 1, u16::MAX].map(|n| said(&mut sender, header(1, n)));
    let after = [0, 0, 1].map(|n| said(&mut sender, header(1, n)));
    assert_eq!(after[0], after[1], "one that found no room is said again");
    for frame in [&before[0], &after[0], &before[1], &after[2]] {
        assert!(receiver.decode(frame).is_ok());
    }
    for frame in before.iter().chain(&after) {
        assert_eq!(receiver.decode(frame), Err(DecodeError::Replayed));
    }
}

#[test]
fn frames_per_start_and_starts_are_limited() {
    let mut sender = sealed(0);
    let mut out = Vec::<u8, 64>::new();
    for _ in 1..1 << WRAP_BITS {
        for sequence in [1, 0] {
            out.clear();
            sender.encode(header(1, sequence), &order(), &mut out).unwrap();
        }
    }
    out.clear();
    assert!(sender.encode(header(1, 1), &order(), &mut out).is_ok());
    let before = out.clone();
    let end = sender.encode(header(1, 0), &order(), &mut out);
    assert_eq!((end, &out), (Err(EncodeError::Exhausted), &before));
    let mut receiver = sealed(0);
    let first = said(&mut sealed(1), header(1, 0));
    let last = before.strip_suffix(&[0]).unwrap();
    assert!(receiver.decode(last).is_ok() && receiver.decode(&first).is_ok());
    assert!(Sealed::<4>::at_start(&key(), (1 << 20) - 1).is_some());
    assert!(Sealed::<4>::at_start(&key(), 1 << 20).is_none());
}

#[test]
fn a_restarted_sender_is_accepted_and_its_old_frames_are_not() {
    let mut receiver = sealed(0);
    let mut sender = sealed(4);
    let recorded: StdVec<_> = (100..110).map(|n| said(&mut sender, header(1, n))).collect();
    for frame in &recorded {
        assert!(receiver.decode(frame).is_ok());
    }
    assert!(receiver.decode(&said(&mut sealed(5), header(1, 0))).is_ok());
    for frame in &recorded {
        assert_eq!(receiver.decode(frame), Err(DecodeError::Replayed));
    }
    let forgotten = said(&mut sealed(0), header(1, 0));
    assert_eq!(receiver.decode(&forgotten), Err(DecodeError::Replayed));
}

#[test]
fn a_restarted_receiver_without_memory_accepts_old_frames_until_it_receives_a_live_one() {
    let mut sender = sealed(4);
    let recorded: StdVec<_> = (0..3).map(|n| said(&mut sender, header(1, n))).collect();
    let live = said(&mut sender, header(1, 100));

    let mut before = sealed(0);
    for frame in &recorded {
        assert!(before.decode(frame).is_ok());
    }
    let mut bare = sealed(1);
    assert!(bare.decode(&recorded[0]).is_ok(), "this is the gap");
    assert!(bare.decode(&live).is_ok());
    assert_eq!(bare.decode(&recorded[1]), Err(DecodeError::Replayed));

    let mut stored = sealed(1);
    for (peer, newest) in before.guard().export() {
        assert!(stored.guard_mut().import(peer, newest));
    }
    let mut mission = sealed(5);
    mission.refuse_before(5);
    for receiver in [&mut stored, &mut mission] {
        for frame in &recorded {
            assert_eq!(receiver.decode(frame), Err(DecodeError::Replayed));
        }
    }
    assert!(stored.decode(&live).is_ok());
    assert!(mission.decode(&said(&mut sealed(5), header(1, 0))).is_ok());
}

#[test]
fn a_full_table_refuses_new_senders_and_an_attacker_cannot_fill_it() {
    let mut receiver = sealed(0);
    let other = Key::of_passphrase(b"another");
    for sender in 1..100 {
        let mut stranger = Sealed::<4>::at_start(&other, 0).unwrap();
        let forged = said(&mut stranger, header(sender, 0));
        assert_eq!(receiver.decode(&forged), Err(DecodeError::Forged));
    }
    for sender in 1..=4 {
        assert!(receiver.decode(&said(&mut sealed(0), header(sender, 0))).is_ok());
    }
    let fifth = said(&mut sealed(0), header(5, 0));
    assert_eq!(receiver.decode(&fifth), Err(DecodeError::NoRoom));
    assert!(receiver.decode(&said(&mut sealed(0), header(2, 1))).is_ok());
}

/// As an attacker with the key can make it.
fn said_in(epoch: u32, header: Header) -> StdVec<u8> {
    let mut by = sealed(0);
    by.epochs.epoch = epoch;
    said(&mut by, header)
}

#[test]
fn a_frame_of_the_last_epoch_locks_no_sender_out() {
    let evil = said_in(u32::MAX, header(1, u16::MAX));
    for starts in 0..3 {
        let mut receiver = sealed(starts);
        let mut sender = sealed(2);
        for n in 0..3 {
            assert_eq!(receiver.decode(&evil), Err(DecodeError::Ahead));
            assert!(receiver.decode(&said(&mut sender, header(1, n))).is_ok());
        }
        assert!(receiver.decode(&said(&mut sealed(3), header(1, 0))).is_ok());
    }
}

#[test]
fn starts_are_accepted_up_to_the_limit_ahead_of_sender_receiver_or_mission() {
    let last = |starts: u32| said_in((starts + REACH_STARTS) << WRAP_BITS, header(1, 0));
    let beyond = |starts: u32| said_in((starts + REACH_STARTS) << WRAP_BITS, header(1, 1));
    let mut stranger = sealed(5);
    assert_eq!(stranger.decode(&beyond(5)), Err(DecodeError::Ahead));
    assert!(stranger.decode(&last(5)).is_ok());
    let mut mission = sealed(5);
    mission.refuse_before(900);
    assert_eq!(mission.decode(&beyond(900)), Err(DecodeError::Ahead));
    assert!(mission.decode(&last(900)).is_ok());
    let mut known = sealed(5);
    assert!(known.decode(&said(&mut sealed(700), header(1, 0))).is_ok());
    assert_eq!(known.decode(&beyond(700)), Err(DecodeError::Ahead));
    assert!(known.decode(&last(700)).is_ok());
    // The owner's remedy for a sender that was locked out.
    assert!(known.decode(&said(&mut sealed(701 + REACH_STARTS), header(1, 0))).is_ok());
    let mut end = sealed((1 << 20) - 1);
    assert!(end.decode(&said_in(u32::MAX, header(1, 0))).is_ok());
}

#[test]
fn a_mission_is_refused_in_the_present_generation_of_the_key() {
    let rolled = |starts: u32| {
        let mut robot = sealed(starts);
        robot.ring_mut().hear_key(3, &Key::of_passphrase(b"third"));
        robot.ring_mut().speak(3);
        robot.ring_mut().forget_before(3);
        robot
    };
    let mut receiver = rolled(0);
    receiver.refuse_before(5);
    assert_eq!(receiver.decode(&said(&mut rolled(4), header(1, 9))), Err(DecodeError::Replayed));
    assert!(receiver.decode(&said(&mut rolled(5), header(1, 0))).is_ok());
}

#[test]
fn the_state_does_not_hold_the_key() {
    let of = |key: &Key| digest(&Sealed::<4>::at_start(key, 1));
    assert_eq!(of(&key()), of(&Key::of_passphrase(b"another")));
    assert_ne!(digest(&sealed(1)), digest(&sealed(2)));
}

fn summed(body: &[u8]) -> StdVec<u8> {
    stuffed(&[body, &X25.checksum(body).to_le_bytes()].concat())
}

proptest! {
    #[test]
    fn every_flipped_bit_is_refused(bit in 0_usize..8 * 64, starts in 0_u32..REACH_STARTS) {
        let frame = said(&mut sealed(starts), header(12, 0x0102));
        let mut content = unstuffed(&frame);
        content.truncate(content.len() - 2);
        prop_assert!(sealed(0).decode(&summed(&content)).is_ok());
        let bit = bit % (content.len() * 8);
        content[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(sealed(0).decode(&summed(&content)).is_err());
        let mut frame = frame;
        let bit = bit % (frame.len() * 8);
        frame[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(sealed(0).decode(&frame).is_err());
    }

    #[test]
    fn sealed_and_plain_decoders_read_a_sealed_frame(
        spoken in (arbitrary::header(), arbitrary::message())
    ) {
        let (header, message) = spoken;
        let mut out = Vec::<u8, 64>::new();
        match sealed(1).encode(header, &message, &mut out) {
            Ok(len) => {
                prop_assert!(len == out.len() && len <= 60);
                let frame = sealed(0).decode(&out[..len - 1]).unwrap();
                prop_assert_eq!((frame.header, &frame.message), (header, &message));
                prop_assert_eq!(decode(&out[..len - 1]).unwrap(), frame);
            }
            Err(error) => {
                prop_assert!(matches!(error, EncodeError::Robot(robot) if robot.0 >= 1 << 21));
                prop_assert!(encode(header, &message, &mut out).is_ok());
            }
        }
    }

    #[test]
    fn any_replay_is_refused(order in vec(0_usize..20, 0..100)) {
        let mut sender = sealed(0);
        let frames: StdVec<_> = (0..20).map(|n| said(&mut sender, header(1, n))).collect();
        let mut receiver = sealed(0);
        let mut heard = [false; 20];
        for at in order {
            let is_fresh = receiver.decode(&frames[at]).is_ok();
            prop_assert_eq!(is_fresh, !heard[at]);
            heard[at] = true;
        }
    }
}
