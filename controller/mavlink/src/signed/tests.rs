use super::*;
use crate::dialect::HEARTBEAT_DATA;
use crate::frame::{Sender, encode};
use proptest::prelude::*;
use staya_controller::auth::Key;
use staya_controller::robot::RobotId;
use staya_controller::wire::Beacon;

fn wire(passphrase: &[u8], timestamp: u64) -> Signed<4> {
    Signed::new(Signing::new(Key::of_passphrase(passphrase), 0, timestamp))
}

fn said<W: Wire>(by: &mut W, sender: u32, sequence: u16) -> std::vec::Vec<u8> {
    let header = Header { boot: 1, sender: RobotId(sender), sequence };
    let mut out = Vec::<u8, 256>::new();
    let len = by.encode(header, &Message::Beacon(Beacon::default()), &mut out);
    assert_eq!(len, Ok(out.len()));
    assert!(out.len() <= by.beacon_len());
    out.to_vec()
}

#[test]
fn a_frame_with_the_key_is_accepted_once_and_others_never() {
    let frame = said(&mut wire(b"swarm", 10), 1, 0);
    let mut receiver = wire(b"swarm", 0);
    assert_eq!(receiver.decode(&frame).unwrap().header.sender, RobotId(1));
    assert_eq!(receiver.decode(&frame), Err(DecodeError::Replayed));
    assert_eq!(receiver.signing().timestamp(), 10);
    let plain = said(&mut Mavlink, 1, 1);
    assert_eq!(frame.len(), plain.len() + SIGNATURE_LEN);
    assert_eq!(receiver.decode(&plain), Err(DecodeError::Unsigned));
    let forged = said(&mut wire(b"guessed", 11), 1, 1);
    assert_eq!(receiver.decode(&forged), Err(DecodeError::Forged));
    assert!(Mavlink.decode(&frame).is_ok());
}

#[test]
fn nothing_is_written_if_the_signature_does_not_fit() {
    let mut sender = wire(b"swarm", 10);
    let header = Header { boot: 1, sender: RobotId(1), sequence: 0 };
    let len = said(&mut sender, 1, 0).len();
    let mut out = Vec::<u8, 100>::new();
    for used in 0..=100 {
        out.clear();
        out.resize(used, 7).unwrap();
        let result = sender.encode(header, &Message::Beacon(Beacon::default()), &mut out);
        if used + len <= 100 {
            assert_eq!((result, out.len()), (Ok(len), used + len));
        } else {
            assert_eq!((result, out.len()), (Err(EncodeError::Full), used));
            assert!(out.iter().all(|byte| *byte == 7));
        }
    }
}

#[test]
fn other_systems_are_foreign_signed_or_not() {
    let mut heartbeat = Vec::<u8, 64>::new();
    encode(Sender::default(), &HEARTBEAT_DATA::default(), &mut heartbeat).unwrap();
    let mut receiver = wire(b"swarm", 0);
    assert_eq!(receiver.decode(&heartbeat), Err(DecodeError::Foreign));
    let mut other = Signing::<1>::new(Key::of_passphrase(b"theirs"), 0, 5);
    let signature = other.sign(&mut heartbeat).unwrap();
    heartbeat.extend_from_slice(&signature).unwrap();
    assert_eq!(receiver.decode(&heartbeat), Err(DecodeError::Foreign));
    assert_eq!(receiver.signing().counts(), Default::default());
}

#[test]
fn a_stream_with_signatures_splits_into_its_frames() {
    let mut sender = wire(b"swarm", 10);
    let frames: std::vec::Vec<_> = (0..3).map(|n| said(&mut sender, 1, n)).collect();
    let stream = frames.concat();
    let (mut rest, mut receiver) = (&stream[..], wire(b"swarm", 0));
    for frame in &frames {
        let found = receiver.next_frame(&mut rest).unwrap();
        assert_eq!(found, frame);
        assert!(receiver.decode(found).is_ok());
    }
    assert_eq!(receiver.next_frame(&mut rest), None);
}

proptest! {
    #[test]
    fn every_flipped_bit_is_refused(bit in 0_usize..8 * 80) {
        let mut frame = said(&mut wire(b"swarm", 10), 1, 3);
        let bit = bit % (frame.len() * 8);
        frame[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(wire(b"swarm", 0).decode(&frame).is_err());
    }
}
