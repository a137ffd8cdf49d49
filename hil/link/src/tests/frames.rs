use crate::frame::{Deframer, Frame, FrameError, OVERHEAD, VERSION, frame_len};
use proptest::collection::vec;
use proptest::prelude::*;
use serde::ser::{Serialize, SerializeTuple, Serializer};
use std::vec::Vec;

const N: usize = 2048;

type Found = Result<(u8, Vec<u8>), FrameError>;

fn deframe<const N: usize>(bytes: &[u8]) -> Vec<Found> {
    let mut deframer = Deframer::<N>::new();
    let found = bytes.iter().filter_map(|byte| {
        let found = deframer.push(*byte)?;
        Some(found.map(|(kind, body)| (kind, body.to_vec())))
    });
    found.collect()
}

struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|b| tuple.serialize_element(b))?;
        tuple.end()
    }
}

fn raw(kind: u8, body: &[u8]) -> Vec<u8> {
    super::frame(kind, &Raw(body))
}

fn body() -> impl Strategy<Value = Vec<u8>> {
    let run = (prop_oneof![Just(0_u8), 1..=u8::MAX], 0_usize..520);
    vec(run, 0..4).prop_map(|runs| {
        let bytes = runs.iter().flat_map(|(byte, len)| std::iter::repeat_n(*byte, *len));
        bytes.collect()
    })
}

proptest! {
    #[test]
    fn encoded_frames_decode_to_their_content(kind: u8, body in body(), random in vec(any::<u8>(), 0..1500)) {
        for body in [body, random] {
            let frame = raw(kind, &body);
            prop_assert!(frame.len() <= frame_len(body.len() + OVERHEAD));
            prop_assert_eq!(frame.iter().filter(|byte| **byte == 0).count(), 2);
            prop_assert_eq!(deframe::<N>(&frame), [Ok((kind, body))]);
        }
    }

    #[test]
    fn frames_are_compatible_with_the_cobs_crate_in_both_directions(body in body()) {
        let frame = raw(9, &body);
        let stuffed = &frame[1..frame.len() - 1];
        let content = cobs::decode_vec(stuffed).expect("stuffed");
        prop_assert_eq!(&content[..2], &[VERSION, 9]);
        prop_assert_eq!(&content[2..content.len() - 4], &body[..]);
        let mut theirs = cobs::encode_vec(&content);
        theirs.push(0);
        prop_assert_eq!(deframe::<N>(&theirs), [Ok((9, body))]);
    }

    #[test]
    fn random_bytes_are_rejected_and_the_next_frame_is_read(
        noise in vec(any::<u8>(), 0..3000),
        body in body(),
    ) {
        let mut stream = noise;
        stream.extend(raw(1, &body));
        let mut found = deframe::<N>(&stream);
        prop_assert_eq!(found.pop(), Some(Ok((1, body))));
        prop_assert!(found.iter().all(Result::is_err));
    }
}

#[test]
fn every_changed_byte_and_every_truncation_is_detected() {
    let body: Vec<u8> = (0..300_u32).map(|i| (i * i % 7 * 40) as u8).collect();
    let frame = raw(3, &body);
    for at in 1..frame.len() - 1 {
        for change in 1..=u8::MAX {
            let mut damaged = frame.clone();
            damaged[at] ^= change;
            let found = deframe::<N>(&damaged);
            assert!(found.iter().all(Result::is_err), "byte {at}, {change:#x}");
        }
        let mut cut = frame[..at].to_vec();
        cut.push(0);
        let found = deframe::<N>(&cut);
        assert!(found.iter().all(Result::is_err), "cut at {at}");
    }
}

#[test]
fn lost_delimiter_costs_only_its_own_frame() {
    let (a, b) = (raw(1, &[1, 2, 3]), raw(2, &[4, 5]));
    // The leading zero of the second ends the first.
    let mut stream = a[..a.len() - 1].to_vec();
    stream.extend(&b);
    let both = [Ok((1, std::vec![1, 2, 3])), Ok((2, std::vec![4, 5]))];
    assert_eq!(deframe::<N>(&stream), both);
}

#[test]
fn frames_of_other_versions_are_distinguished_from_damaged_ones() {
    let mut content = std::vec![VERSION + 1, 7, 1, 2, 3];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&content);
    content.extend(crc.to_le_bytes());
    let mut frame = cobs::encode_vec(&content);
    frame.push(0);
    let other = FrameError::Version(VERSION + 1);
    assert_eq!(deframe::<N>(&frame), [Err(other)]);
}

#[test]
fn one_byte_above_the_capacity_is_too_long() {
    let body = [5; 100];
    let frame = raw(3, &body);
    assert_eq!(deframe::<{ 100 + OVERHEAD }>(&frame), [Ok((3, body.to_vec()))]);
    assert_eq!(deframe::<{ 99 + OVERHEAD }>(&frame), [Err(FrameError::TooLong)]);
    let mut short = Frame::<{ frame_len(100 + OVERHEAD) - 2 }>::new();
    assert!(short.fill(3, &Raw(&body)).is_err() && short.bytes().is_empty());
    let mut frame = Frame::<{ frame_len(100 + OVERHEAD) }>::new();
    frame.fill(3, &Raw(&body)).expect("fits");
}

#[test]
fn endless_noise_never_exceeds_the_buffer() {
    let mut deframer = Deframer::<16>::new();
    for _ in 0..100_000 {
        assert!(deframer.push(0x55).is_none());
    }
    assert_eq!(deframer.push(0), Some(Err(FrameError::TooLong)));
    assert_eq!(deframer.push(0), None);
}
