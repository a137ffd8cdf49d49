use super::*;
use crate::dialect::{HEARTBEAT_DATA, MavMessage};
use crate::frame::{MAX_FRAME_LEN, Sender, encode, encode_message};
use heapless::Vec;
use proptest::prelude::*;

/// Made by pymavlink with the key 0, 1, 2, ... 31; see tests/python/test_signing.py.
const GOLDEN: &str = include_str!("../../../../tests/golden/signed-frames.txt");
const NOW: u64 = 37_000_000_000_000;

fn key() -> Key {
    let mut bytes = [0; 32];
    for (byte, number) in bytes.iter_mut().zip(0..) {
        *byte = number;
    }
    Key::new(bytes)
}

type Bytes = Vec<u8, MAX_FRAME_LEN>;

fn golden() -> impl Iterator<Item = (&'static str, Bytes)> {
    let lines = GOLDEN.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| {
        let (name, hex) = line.split_once(' ').unwrap();
        let byte = |at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
        (name, (0..hex.len()).step_by(2).map(byte).collect())
    })
}

fn heartbeat(system: u8, sequence: u8) -> Bytes {
    let sender = Sender { system, component: 1, sequence };
    let data = HEARTBEAT_DATA { custom_mode: sequence.into(), ..HEARTBEAT_DATA::default() };
    let mut frame = Bytes::new();
    encode(sender, &data, &mut frame).unwrap();
    frame
}

fn signed<const N: usize>(by: &mut Signing<N>, frame: &Bytes) -> Bytes {
    let mut frame = frame.clone();
    let signature = by.sign(&mut frame).unwrap();
    frame.extend_from_slice(&signature).unwrap();
    frame
}

fn judged<const N: usize>(by: &mut Signing<N>, frame: &[u8]) -> Verdict {
    by.verify(&RawFrame::new(frame).expect("a sound frame"))
}

#[test]
fn signed_frames_match_pymavlink() {
    let mut sender = Signing::<4>::new(key(), 3, NOW);
    let mut receiver = Signing::<4>::new(key(), 0, NOW - MINUTE);
    let mut stranger = Signing::<4>::new(Key::of_passphrase(b"another"), 0, 0);
    let mut count = 0;
    for (name, want) in golden() {
        let raw = RawFrame::new(&want).expect("a sound frame");
        let mut plain = Bytes::new();
        encode_message(raw.sender(), &raw.message().unwrap(), &mut plain).unwrap();
        assert_eq!(signed(&mut sender, &plain), want, "{name}");
        assert_eq!(receiver.verify(&raw), Verdict::Authentic, "{name}");
        assert_eq!(stranger.verify(&raw), Verdict::Forged, "{name}");
        assert_eq!(receiver.verify(&raw), Verdict::Replayed, "{name}");
        count += 1;
    }
    assert!(count >= 4);
    assert_eq!(receiver.timestamp(), NOW + u64::from(count) - 1);
    let counts = receiver.counts();
    assert_eq!((counts.authentic, counts.refused()), (count, count));
    assert_eq!((stranger.counts().forged, counts.replayed), (count, count));
}

#[test]
fn a_signed_frame_keeps_its_message_and_a_valid_checksum() {
    let frame = signed(&mut Signing::<1>::new(key(), 0, 5), &heartbeat(1, 9));
    let raw = RawFrame::new(&frame).expect("the checksum covers the flag");
    assert!(raw.is_known());
    assert!(matches!(raw.message(), Some(MavMessage::HEARTBEAT(data)) if data.custom_mode == 9));
}

#[test]
fn only_unsigned_frames_are_signed() {
    let mut signing = Signing::<1>::new(key(), 0, 5);
    let mut twice = signed(&mut signing, &heartbeat(1, 0));
    let mut v1 = [0xFE, 0, 0, 1, 1, 0, 0, 0];
    let mut cut = heartbeat(1, 0);
    cut.pop();
    for frame in [&mut twice[..], &mut v1, &mut cut, &mut [], &mut [0xFD]] {
        let before = std::vec::Vec::from(&*frame);
        assert_eq!(signing.sign(frame), Err(SignError::NotAFrame));
        assert_eq!(before, frame);
    }
    assert_eq!(signing.timestamp(), 6);
}

#[test]
fn timestamps_end() {
    let mut signing = Signing::<1>::new(key(), 0, LAST_TIMESTAMP);
    assert_eq!(signing.left(), 1);
    assert!(signing.sign(&mut heartbeat(1, 0)).is_ok());
    assert_eq!(signing.left(), 0);
    let mut frame = heartbeat(1, 1);
    assert_eq!(signing.sign(&mut frame), Err(SignError::Exhausted));
    assert_eq!(frame, heartbeat(1, 1));
}

#[test]
fn unsigned_frames_are_refused() {
    let mut signing = Signing::<1>::new(key(), 0, 0);
    assert_eq!(judged(&mut signing, &heartbeat(1, 0)), Verdict::Unsigned);
    assert!(!Verdict::Unsigned.is_accepted());
    assert_eq!((signing.counts().unsigned, signing.counts().refused()), (1, 1));
}

#[test]
fn a_new_stream_is_at_most_a_minute_old() {
    for (timestamp, want) in [(NOW - MINUTE - 1, Verdict::Replayed), (NOW - MINUTE, Verdict::Authentic)] {
        let frame = signed(&mut Signing::<1>::new(key(), 0, timestamp), &heartbeat(1, 0));
        let mut receiver = Signing::<1>::new(key(), 0, NOW);
        assert_eq!(judged(&mut receiver, &frame), want);
    }
}

#[test]
fn timestamps_catch_up_with_received_ones() {
    let (mut old, mut young) = (Signing::<2>::new(key(), 0, NOW), Signing::<2>::new(key(), 0, NOW - MONTH));
    let refused = signed(&mut young, &heartbeat(2, 0));
    assert_eq!(judged(&mut old, &refused), Verdict::Replayed);
    let heard = signed(&mut old, &heartbeat(1, 0));
    assert_eq!(judged(&mut young, &heard), Verdict::Authentic);
    let accepted = signed(&mut young, &heartbeat(2, 1));
    assert_eq!(judged(&mut old, &accepted), Verdict::Authentic);
    let mut liar = Signing::<2>::new(Key::of_passphrase(b"another"), 0, NOW + MINUTE);
    let before = young.timestamp();
    assert_eq!(judged(&mut young, &signed(&mut liar, &heartbeat(3, 0))), Verdict::Forged);
    assert_eq!(young.timestamp(), before);
}

#[test]
fn a_properly_restarted_sender_is_accepted_and_its_old_frames_are_not() {
    let mut receiver = Signing::<2>::new(key(), 0, 0);
    let mut sender = Signing::<2>::new(key(), 0, 100);
    let recorded: std::vec::Vec<_> = (0..40).map(|n| signed(&mut sender, &heartbeat(1, n))).collect();
    for frame in &recorded {
        assert_eq!(judged(&mut receiver, frame), Verdict::Authentic);
    }
    let mut sender = Signing::<2>::new(key(), 0, 100 + MINUTE);
    let later = signed(&mut sender, &heartbeat(1, 0));
    assert_eq!(judged(&mut receiver, &later), Verdict::Authentic);
    for frame in &recorded {
        assert_eq!(judged(&mut receiver, frame), Verdict::Replayed);
    }
}

#[test]
fn links_and_components_are_separate_streams_and_a_full_table_refuses_new_ones() {
    let mut receiver = Signing::<2>::new(key(), 0, 0);
    for link in 0..2 {
        let frame = signed(&mut Signing::<1>::new(key(), link, 50), &heartbeat(1, 0));
        assert_eq!(judged(&mut receiver, &frame), Verdict::Authentic);
    }
    let frame = signed(&mut Signing::<1>::new(key(), 2, 50), &heartbeat(1, 0));
    assert_eq!(judged(&mut receiver, &frame), Verdict::NoRoom);
    let next = signed(&mut Signing::<1>::new(key(), 1, 51), &heartbeat(1, 1));
    assert_eq!(judged(&mut receiver, &next), Verdict::Authentic);
}

#[test]
fn the_state_does_not_hold_the_key() {
    let of = |key| staya_controller::digest::digest(&Signing::<2>::new(key, 1, 2));
    assert_eq!(of(key()), of(Key::of_passphrase(b"another")));
    assert_ne!(of(key()), staya_controller::digest::digest(&Signing::<2>::new(key(), 1, 3)));
}

/// A frame with the last timestamp, made with the key, is replayed after each restart without it.
#[test]
fn a_frame_of_the_far_future_silences_and_locks_out_no_robot() {
    let evil = signed(&mut Signing::<1>::new(key(), 0, LAST_TIMESTAMP), &heartbeat(7, 0));
    for clock in [None, Some(NOW)] {
        for _ in 0..3 {
            let mut receiver = Signing::<2>::new(key(), 0, NOW);
            receiver.advance_to(clock.unwrap_or(0));
            let mut true_sender = Signing::<1>::new(key(), 0, NOW);
            for n in 0..3 {
                assert_eq!(judged(&mut receiver, &evil), Verdict::Ahead);
                assert!(receiver.sign(&mut heartbeat(1, n)).is_ok());
                let heard = signed(&mut true_sender, &heartbeat(7, n));
                assert_eq!(judged(&mut receiver, &heard), Verdict::Authentic);
            }
            assert_eq!((receiver.counts().ahead, receiver.counts().refused()), (3, 3));
            assert!(receiver.timestamp() < NOW + 10);
        }
    }
}

#[test]
fn the_lead_is_a_minute_with_a_clock_a_month_without_or_as_set() {
    let with = |clock: Option<u64>, lead: Option<u64>| {
        let mut receiver = Signing::<2>::new(key(), 0, NOW);
        receiver.advance_to(clock.unwrap_or(0));
        match lead {
            Some(lead) => receiver.with_lead(lead),
            None => receiver,
        }
    };
    for (clock, lead, last) in [
        (None, None, NOW + MONTH),
        (Some(0), None, NOW + MONTH),
        (Some(NOW), None, NOW + MINUTE),
        (Some(NOW + 5), None, NOW + 5 + MINUTE),
        (Some(NOW - MINUTE), None, NOW),
        (None, Some(7), NOW + 7),
        (Some(NOW), Some(7), NOW + 7),
        (None, Some(u64::MAX), LAST_TIMESTAMP),
    ] {
        let said = |timestamp| signed(&mut Signing::<1>::new(key(), 0, timestamp), &heartbeat(1, 0));
        let mut receiver = with(clock, lead);
        assert_eq!(judged(&mut receiver, &said(last)), Verdict::Authentic, "{clock:?} {lead:?}");
        assert_eq!(receiver.timestamp(), last);
        if last < LAST_TIMESTAMP {
            assert_eq!(judged(&mut with(clock, lead), &said(last + 1)), Verdict::Ahead, "{clock:?} {lead:?}");
        }
    }
}

proptest! {
    #[test]
    fn every_flipped_bit_is_refused(bit in 0_usize..34 * 8, sequence: u8) {
        let mut frame = signed(&mut Signing::<2>::new(key(), 3, NOW), &heartbeat(1, sequence));
        let bit = bit % (frame.len() * 8);
        frame[bit / 8] ^= 1 << (bit % 8);
        if let Some(raw) = RawFrame::new(&frame) {
            prop_assert!(!Signing::<2>::new(key(), 0, NOW).verify(&raw).is_accepted());
        }
        let end = frame.len() - SIGNATURE_LEN;
        let signature: [u8; SIGNATURE_LEN] = frame[end..].try_into().unwrap();
        // An attack without the key: an intact frame with the signature of another one.
        let mut forged = heartbeat(1, sequence.wrapping_add(1));
        Signing::<2>::new(Key::new([0; 32]), 3, 0).sign(&mut forged).unwrap();
        forged.extend_from_slice(&signature).unwrap();
        prop_assert_eq!(judged(&mut Signing::<2>::new(key(), 0, NOW), &forged), Verdict::Forged);
    }
}
