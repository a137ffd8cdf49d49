use super::*;
use crate::radio::MavlinkLink;
use proptest::prelude::*;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Ack, Header, Message};
use staya_mavlink::dialect::HEARTBEAT_DATA;
use staya_mavlink::frame::{self, Sender};
use staya_mavlink::wire::{encode, next_frame};
use std::collections::VecDeque;
use std::vec::Vec;

/// A sound frame; `sequence` tells it from others.
fn frame(sequence: u16) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    let header = Header {
        boot: 1,
        sender: RobotId(7),
        sequence,
    };
    let message = Message::Ack(Ack {
        to: RobotId(9),
        boot: 1,
        number: 3,
        accepted: true,
    });
    encode(header, &message, &mut out).unwrap();
    out.to_vec()
}

/// What a robot's controller has no use for.
fn heartbeat() -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    let sender = Sender {
        system: 1,
        component: 1,
        sequence: 0,
    };
    frame::encode(sender, &HEARTBEAT_DATA::DEFAULT, &mut out).unwrap();
    out.to_vec()
}

/// The sequence numbers of the frames in an inbox, each of which must be sound.
fn sequences(mut inbox: &[u8]) -> Vec<u16> {
    let mut found = Vec::new();
    while let Some(frame) = next_frame(&mut inbox) {
        found.push(decode(frame).unwrap().header.sequence);
    }
    found
}

fn stream(sequences: impl IntoIterator<Item = u16>) -> Vec<u8> {
    sequences.into_iter().flat_map(frame).collect()
}

#[test]
fn frames_cut_anywhere_come_out_whole_and_once() {
    let mut receiver = MavlinkReceiver::<512>::new();
    let bytes = stream(0..5);
    for (first, rest) in (0..bytes.len()).map(|at| bytes.split_at(at)) {
        receiver.push(first);
        let early = sequences(receiver.take());
        receiver.push(rest);
        let late = sequences(receiver.take());
        assert_eq!([early, late].concat(), [0, 1, 2, 3, 4]);
        assert!(receiver.take().is_empty(), "given once");
    }
}

#[test]
fn noise_and_damage_cost_nothing_but_what_they_hit() {
    let mut receiver = MavlinkReceiver::<512>::new();
    receiver.push(&[0xFF, 0x13, 0]);
    receiver.push(&frame(1));
    receiver.push(&[0x55; 1000]);
    receiver.push(&frame(2));
    let mut flipped = frame(3);
    flipped[14] ^= 0x10;
    receiver.push(&flipped);
    receiver.push(&frame(4));
    assert_eq!(sequences(receiver.take()), [1, 2, 4]);
    let counts = receiver.counts();
    assert_eq!((counts.frames, counts.dropped), (3, 0));
    assert!(counts.refused >= 3);
}

#[test]
fn other_messages_on_the_line_are_passed_over() {
    let mut receiver = MavlinkReceiver::<512>::new();
    for sequence in 0..3 {
        receiver.push(&heartbeat());
        receiver.push(&frame(sequence));
    }
    assert_eq!(sequences(receiver.take()), [0, 1, 2]);
    let counts = receiver.counts();
    assert_eq!((counts.frames, counts.refused), (3, 0));
}

#[test]
fn the_newest_frames_stay_when_there_is_no_room() {
    let mut receiver = MavlinkReceiver::<300>::new();
    let each = frame(0).len();
    receiver.push(&stream(0..100));
    let kept = sequences(receiver.take());
    let room = 300 / each;
    assert_eq!(kept.last(), Some(&99));
    assert!(kept.len() + 1 >= room, "{} of {room}", kept.len());
    assert!(kept.is_sorted());
    let counts = receiver.counts();
    assert_eq!(
        (counts.frames, counts.dropped as usize),
        (100, 100 - kept.len())
    );
}

#[test]
fn what_a_failing_line_began_is_forgotten() {
    let mut receiver = MavlinkReceiver::<512>::new();
    receiver.push(&frame(1)[..9]);
    receiver.line_error();
    receiver.push(&frame(2));
    assert_eq!(sequences(receiver.take()), [2]);
    receiver.push(&frame(3)[..9]);
    receiver.push_packet(&frame(4));
    assert_eq!(sequences(receiver.take()), [4]);
    assert_eq!(receiver.counts().line_errors, 1);
}

#[test]
fn frames_that_wait_go_when_there_is_no_room_but_never_a_begun_one() {
    let each = frame(0).len();
    let mut sender = MavlinkSender::<50>::new();
    sender.send(&stream([1, 2]));
    sender.sent(3);
    sender.send(&stream([3, 4]));
    // Two frames fit; the rest of the begun one keeps its place.
    let mut line = frame(1)[..3].to_vec();
    line.extend(sender.unsent());
    assert_eq!(sequences(&line), [1, 4]);
    sender.sent(each - 3);
    sender.sent(each);
    let counts = sender.counts();
    assert_eq!((counts.frames, counts.dropped), (2, 2));
    assert!(sender.unsent().is_empty());
}

#[test]
fn a_frame_that_the_line_cut_does_not_spoil_the_next() {
    let mut sender = MavlinkSender::<128>::new();
    sender.send(&stream([1, 2]));
    let mut line = sender.unsent()[..5].to_vec();
    sender.sent(5);
    sender.line_error();
    line.extend(sender.unsent());
    let mut receiver = MavlinkReceiver::<512>::new();
    receiver.push(&line);
    assert_eq!(sequences(receiver.take()), [2]);
    assert_eq!(
        (sender.counts().dropped, sender.counts().line_errors),
        (1, 1)
    );
}

/// A line that gives back what is written, a few bytes at a time.
#[derive(Default)]
struct Loopback(VecDeque<u8>);

impl embedded_io::ErrorType for Loopback {
    type Error = core::convert::Infallible;
}

impl embedded_io::Read for Loopback {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Self::Error> {
        let count = self.0.len().min(bytes.len()).min(7);
        for (byte, read) in bytes.iter_mut().zip(self.0.drain(..count)) {
            *byte = read;
        }
        Ok(count)
    }
}

impl embedded_io::ReadReady for Loopback {
    fn read_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(!self.0.is_empty())
    }
}

impl embedded_io::Write for Loopback {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        let count = bytes.len().min(5);
        self.0.extend(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

impl embedded_io::WriteReady for Loopback {
    fn write_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(true)
    }
}

#[test]
fn what_one_end_sends_the_other_hears() {
    let mut link = MavlinkLink::<_, 512, 128>::new(Loopback::default());
    for step in 0..20 {
        link.send(&stream([2 * step, 2 * step + 1]));
        let Ok(()) = link.pump();
        let Ok(()) = link.pump();
        assert_eq!(sequences(link.take()), [2 * step, 2 * step + 1]);
    }
    let (heard, said) = link.counts();
    assert_eq!((heard.frames, said.frames), (40, 40));
}

proptest! {
    /// Whatever comes, in whatever pieces: only sound frames come out, and as many as were counted.
    #[test]
    fn any_bytes_have_an_answer(
        pieces in proptest::collection::vec(prop_oneof![
            2 => proptest::collection::vec(any::<u8>(), 0..40),
            1 => proptest::collection::vec(prop_oneof![Just(0xFD_u8), Just(0xFE), Just(0), Just(1)], 0..300),
            2 => any::<u16>().prop_map(frame),
            1 => Just(heartbeat()),
        ], 0..40),
    ) {
        let mut receiver = MavlinkReceiver::<320>::new();
        let mut found = 0;
        for (at, piece) in pieces.iter().enumerate() {
            receiver.push(piece);
            if at % 3 == 0 {
                found += sequences(receiver.take()).len();
            }
        }
        found += sequences(receiver.take()).len();
        let counts = receiver.counts();
        prop_assert_eq!(found as u32 + counts.dropped, counts.frames);
    }

    /// A line that takes a few bytes at a time sends every frame once and whole.
    #[test]
    fn frames_are_sent_in_any_pieces(cuts in proptest::collection::vec(1..30_usize, 1..20)) {
        let mut sender = MavlinkSender::<256>::new();
        sender.send(&stream(0..8));
        let (mut line, mut cuts) = (Vec::new(), cuts.iter().cycle());
        while !sender.unsent().is_empty() {
            let count = cuts.next().copied().unwrap_or(1).min(sender.unsent().len());
            line.extend_from_slice(&sender.unsent()[..count]);
            sender.sent(count);
        }
        prop_assert_eq!(sequences(&line), (0..8).collect::<Vec<_>>());
        prop_assert_eq!(sender.counts().frames, 8);
    }
}
