use super::*;
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
use proptest::prelude::*;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Ack, Header, MAX_FRAME_LEN, Message, encode, frames};
use std::collections::VecDeque;
use std::vec::Vec;

/// A sound frame with its zero byte; `sequence` tells it from others.
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

/// The sequence numbers of the frames in an inbox, each of which must be sound.
fn sequences(inbox: &[u8]) -> Vec<u16> {
    let sound = |frame| staya_controller::wire::decode(frame).unwrap();
    frames(inbox)
        .map(|bytes| sound(bytes).header.sequence)
        .collect()
}

fn stream(sequences: impl IntoIterator<Item = u16>) -> Vec<u8> {
    sequences.into_iter().flat_map(frame).collect()
}

#[test]
fn frames_cut_anywhere_come_out_whole_and_once() {
    let mut receiver = Receiver::<256>::new();
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
fn noise_costs_nothing_but_what_it_hits() {
    let mut receiver = Receiver::<256>::new();
    let endless = [0x55; 1000];
    receiver.push(&[0xFF, 0x13, 0, 0, 0]);
    receiver.push(&frame(1));
    receiver.push(&endless);
    receiver.push(&[0]);
    receiver.push(&frame(2));
    let mut flipped = frame(3);
    flipped[4] ^= 0x10;
    receiver.push(&flipped);
    receiver.push(&frame(4));
    assert_eq!(sequences(receiver.take()), [1, 2, 4]);
    let counts = receiver.counts();
    assert_eq!((counts.frames, counts.refused, counts.dropped), (3, 3, 0));
}

#[test]
fn a_lost_delimiter_costs_the_two_frames_beside_it() {
    let mut receiver = Receiver::<256>::new();
    let mut bytes = stream([1, 2, 3]);
    bytes.remove(frame(1).len() - 1);
    receiver.push(&bytes);
    assert_eq!(sequences(receiver.take()), [3]);
}

#[test]
fn the_newest_frames_stay_when_there_is_no_room() {
    let len = frame(0).len();
    let mut receiver = Receiver::<64>::new();
    let room = 64 / len;
    receiver.push(&stream(0..10));
    let newest: Vec<u16> = (10 - room as u16..10).collect();
    assert_eq!(sequences(receiver.take()), newest);
    assert_eq!(receiver.counts().dropped as usize, 10 - room);
    // What was given makes room without a loss.
    receiver.push(&frame(10));
    assert_eq!(sequences(receiver.take()), [10]);
    assert_eq!(receiver.counts().dropped as usize, 10 - room);
}

#[test]
fn a_receiver_without_room_for_one_frame_counts_and_keeps_nothing() {
    let mut receiver = Receiver::<4>::new();
    receiver.push(&stream(0..3));
    assert!(receiver.take().is_empty());
    assert_eq!(receiver.counts().dropped, 3);
    assert!(Receiver::<0>::new().take().is_empty());
}

#[test]
fn packets_of_a_radio_need_no_last_zero_byte() {
    let mut receiver = Receiver::<256>::new();
    let whole = frame(5);
    receiver.push(&whole[..3]);
    receiver.push_packet(&whole[..whole.len() - 1]);
    receiver.push_packet(&stream([6, 7]));
    assert_eq!(sequences(receiver.take()), [5, 6, 7]);
    assert_eq!(receiver.counts().refused, 1);
}

#[test]
fn after_a_line_error_only_the_frame_in_between_is_gone() {
    let mut receiver = Receiver::<256>::new();
    let whole = frame(1);
    receiver.push(&whole[..5]);
    receiver.line_error();
    receiver.push(&whole[5..]);
    receiver.push(&frame(2));
    assert_eq!(sequences(receiver.take()), [2]);
    assert_eq!(receiver.counts().line_errors, 1);
}

#[test]
fn a_zero_byte_goes_first_after_a_pause_and_not_between_frames() {
    let mut sender = Sender::<256>::new();
    sender.send(&stream([1, 2]));
    sender.send(&stream([3]));
    let expected = [&[0][..], &stream([1, 2, 3])].concat();
    assert_eq!(sender.unsent(), expected);
    sender.sent(expected.len());
    assert!(sender.unsent().is_empty());
    assert_eq!(sender.counts().frames, 3);
    sender.send(&[]);
    assert!(sender.unsent().is_empty(), "nothing to say, nothing sent");
}

#[test]
fn a_frame_that_is_on_the_line_is_finished_before_older_news_goes() {
    let len = frame(0).len();
    let mut sender = Sender::<64>::new();
    sender.send(&stream([0, 1]));
    // The zero byte and the first three of frame 0.
    sender.sent(4);
    let rest = frame(0)[3..].to_vec();
    for sequence in 2..9 {
        sender.send(&frame(sequence));
    }
    let unsent = sender.unsent();
    assert_eq!(&unsent[..rest.len()], rest);
    let room = (64 - rest.len()) / len;
    let newest: Vec<u16> = (9 - room as u16..9).collect();
    assert_eq!(sequences(&unsent[rest.len()..]), newest);
    assert_eq!(sender.counts().dropped as usize, 9 - 1 - room);
}

#[test]
fn the_zero_byte_that_goes_first_is_no_lost_frame() {
    let mut sender = Sender::<64>::new();
    for sequence in 0..10 {
        sender.send(&frame(sequence));
    }
    let left = sequences(sender.unsent());
    assert_eq!(left.last(), Some(&9));
    assert_eq!(sender.counts().dropped as usize, 10 - left.len());
}

#[test]
fn a_sender_without_room_drops_and_goes_on() {
    let mut sender = Sender::<8>::new();
    sender.send(&stream([1, 2]));
    assert_eq!(sender.counts().dropped, 2);
    let mut sender = Sender::<0>::new();
    sender.send(&stream([1]));
    assert!(sender.unsent().is_empty());
}

/// A UART of which the test says when it is ready and when it fails.
#[derive(Default)]
struct Uart {
    inbound: VecDeque<u8>,
    outbound: Vec<u8>,
    /// Bytes that it takes before it is busy.
    room: usize,
    read_fails: bool,
    write_fails: bool,
    calls: usize,
}

impl ErrorType for Uart {
    type Error = ErrorKind;
}

impl Read for Uart {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, ErrorKind> {
        assert!(!self.inbound.is_empty(), "would block");
        self.calls += 1;
        let len = buf.len().min(self.inbound.len()).min(5);
        for (to, from) in buf.iter_mut().zip(self.inbound.drain(..len)) {
            *to = from;
        }
        Ok(len)
    }
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        if core::mem::take(&mut self.read_fails) {
            return Err(ErrorKind::InvalidData);
        }
        Ok(!self.inbound.is_empty())
    }
}

impl Write for Uart {
    fn write(&mut self, buf: &[u8]) -> Result<usize, ErrorKind> {
        assert!(self.room > 0, "would block");
        let len = buf.len().min(self.room).min(3);
        self.outbound.extend(&buf[..len]);
        self.room -= len;
        Ok(len)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        panic!("would block")
    }
}

impl WriteReady for Uart {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        if self.write_fails && self.room == 0 {
            self.write_fails = false;
            return Err(ErrorKind::BrokenPipe);
        }
        Ok(self.room > 0)
    }
}

#[test]
fn the_link_moves_what_it_can_and_never_waits() {
    let mut link = PacketLink::<Uart, 64, 128>::new(Uart::default());
    link.pump().unwrap();
    link.send(&stream([1, 2]));
    link.pump().unwrap();
    assert!(link.take().is_empty());
    let mut uart = link.release();
    assert!(uart.outbound.is_empty());
    uart.inbound.extend(stream([3]));
    uart.room = usize::MAX;
    let mut link = PacketLink::<Uart, 64, 128>::new(uart);
    link.send(&stream([1, 2]));
    link.pump().unwrap();
    assert_eq!(sequences(link.take()), [3]);
    assert_eq!(sequences(&link.release().outbound), [1, 2]);
}

#[test]
fn one_call_takes_no_more_than_its_buffer() {
    let uart = Uart {
        inbound: stream(0..100).into(),
        ..Uart::default()
    };
    let before = uart.inbound.len();
    let mut link = PacketLink::<Uart, 64>::new(uart);
    link.pump().unwrap();
    let uart = link.release();
    assert!(before - uart.inbound.len() < 64 + 5 && uart.calls <= 64);
}

#[test]
fn errors_of_the_line_cost_one_frame_each_way_and_are_told() {
    let (whole, next) = (frame(1), stream([2, 3]));
    let uart = Uart {
        inbound: whole[..6].to_vec().into(),
        room: 4,
        ..Uart::default()
    };
    let mut link = PacketLink::<Uart, 256, 256>::new(uart);
    link.send(&stream([4, 5]));
    link.pump().unwrap();
    // In the middle of a frame, both ways.
    link.line_mut().read_fails = true;
    link.line_mut().write_fails = true;
    assert_eq!(link.pump(), Err(ErrorKind::InvalidData));
    link.line_mut().inbound.extend(&whole[6..]);
    link.line_mut().inbound.extend(&next);
    link.line_mut().room = 999;
    link.pump().unwrap();
    assert_eq!(sequences(link.take()), [2, 3]);
    let (heard, said) = link.counts();
    assert_eq!((heard.line_errors, said.line_errors), (1, 1));
    assert_eq!((said.frames, said.dropped), (1, 1));
    let mut peer = Receiver::<256>::new();
    peer.push(&link.release().outbound);
    assert_eq!(sequences(peer.take()), [5]);
}

proptest! {
    #[test]
    fn any_bytes_leave_the_inbox_sound(pieces in proptest::collection::vec(any::<Vec<u8>>(), 0..20), at in 0usize..20) {
        let mut receiver = Receiver::<128>::new();
        for (number, piece) in pieces.iter().enumerate() {
            receiver.push(piece);
            if number == at {
                receiver.line_error();
            }
        }
        receiver.push(&[0]);
        receiver.push(&frame(1));
        let inbox = receiver.take();
        prop_assert!(inbox.len() <= 128 && frames(inbox).count() > 0);
        prop_assert_eq!(sequences(inbox).last().copied(), Some(1));
        prop_assert!(frames(inbox).all(|frame| frame.len() < MAX_FRAME_LEN));
    }

    #[test]
    fn whatever_the_line_takes_when_receivers_get_a_subsequence(takes in proptest::collection::vec(0usize..40, 1..60), fails in 0usize..60) {
        let (mut sender, mut receiver) = (Sender::<64>::new(), Receiver::<4096>::new());
        let drain = |sender: &mut Sender<64>, receiver: &mut Receiver<4096>, take: usize| {
            let len = take.min(sender.unsent().len());
            receiver.push(&sender.unsent()[..len]);
            sender.sent(len);
        };
        for (number, take) in takes.iter().enumerate() {
            sender.send(&frame(number as u16));
            drain(&mut sender, &mut receiver, *take);
            if number == fails {
                sender.line_error();
            }
        }
        // The last one, with a sound line.
        let last = takes.len() as u16;
        sender.send(&frame(last));
        drain(&mut sender, &mut receiver, usize::MAX);
        let got = sequences(receiver.take());
        prop_assert!(got.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", got);
        prop_assert_eq!(got.last().copied(), Some(last));
        let (counts, refused) = (sender.counts(), receiver.counts().refused);
        prop_assert_eq!(counts.frames as usize, got.len());
        prop_assert_eq!(counts.frames + counts.dropped, takes.len() as u32 + 1);
        // Only a frame that failed on the line arrives cut.
        prop_assert!(refused <= u32::from(fails < takes.len()));
    }
}

#[cfg(feature = "async")]
mod asynchronous {
    use super::*;
    use core::future::Future;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};

    /// Half of a line: ready as long as there is something, then pending.
    struct Half {
        script: VecDeque<Result<Vec<u8>, ErrorKind>>,
        heard: Vec<u8>,
    }

    impl ErrorType for Half {
        type Error = ErrorKind;
    }

    impl embedded_io_async::Read for Half {
        async fn read(&mut self, buf: &mut [u8]) -> Result<usize, ErrorKind> {
            match self.script.pop_front() {
                None => core::future::pending().await,
                Some(Err(error)) => Err(error),
                Some(Ok(bytes)) => {
                    buf[..bytes.len()].copy_from_slice(&bytes);
                    Ok(bytes.len())
                }
            }
        }
    }

    impl embedded_io_async::Write for Half {
        async fn write(&mut self, buf: &[u8]) -> Result<usize, ErrorKind> {
            match self.script.pop_front() {
                None => core::future::pending().await,
                Some(Err(error)) => Err(error),
                Some(Ok(room)) => {
                    let len = room.len().min(buf.len());
                    self.heard.extend(&buf[..len]);
                    Ok(len)
                }
            }
        }

        async fn flush(&mut self) -> Result<(), ErrorKind> {
            core::future::pending().await
        }
    }

    fn half(script: impl IntoIterator<Item = Result<Vec<u8>, ErrorKind>>) -> Half {
        Half {
            script: script.into_iter().collect(),
            heard: Vec::new(),
        }
    }

    #[test]
    fn both_ways_go_on_beside_each_other_and_past_errors() {
        let inbound = stream([1, 2, 3]);
        let mut reads: Vec<_> = inbound.chunks(4).map(|c| Ok(c.to_vec())).collect();
        // Within the second frame an error, and a line that says it has ended.
        reads.insert(inbound.len() / 8, Err(ErrorKind::Other));
        reads.push(Ok(Vec::new()));
        let room = |len: usize| Ok(std::vec![0; len]);
        let reader = half(reads);
        let writer = half([room(3), Err(ErrorKind::Other), room(9), room(0), room(99)]);
        let mut link = AsyncPacketLink::<_, _>::new(reader, writer);
        link.send(&stream([4, 5]));
        let mut context = Context::from_waker(Waker::noop());
        for _ in 0..9 {
            // Cancelled and begun anew, as at each step.
            let mut serving = pin!(link.serve());
            let poll = serving.as_mut().poll(&mut context);
            assert!(matches!(poll, Poll::Pending));
        }
        assert_eq!(sequences(link.take()), [1, 3]);
        let (heard, said) = link.counts();
        assert_eq!((heard.line_errors, said.line_errors), (2, 2));
        assert_eq!(said.frames + said.dropped, 2);
    }
}
