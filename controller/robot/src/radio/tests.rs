mod lines;

use self::lines::*;
use super::*;
use embedded_io::ErrorKind;
use proptest::prelude::*;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Ack, Header, Message, Postcard, Wire};
#[cfg(feature = "mavlink")]
use staya_mavlink::wire::Mavlink;
use std::vec::Vec;

fn frame<F: Format>(sequence: u16) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    let header = Header { boot: 1, sender: RobotId(7), sequence };
    let message = Message::Ack(Ack { to: RobotId(9), boot: 1, number: 3 });
    F::default().encode(header, &message, &mut out).unwrap();
    out.to_vec()
}

fn stream<F: Format>(sequences: impl IntoIterator<Item = u16>) -> Vec<u8> {
    sequences.into_iter().flat_map(frame::<F>).collect()
}

fn sequences<F: Format>(mut inbox: &[u8]) -> Vec<u16> {
    let (mut format, mut found) = (F::default(), Vec::new());
    while let Some(frame) = format.next_frame(&mut inbox) {
        found.push(format.decode(frame).unwrap().header.sequence);
    }
    found
}

trait Format: Framing + Wire + Default {}
impl<F: Framing + Wire + Default> Format for F {}

/// Creates one test per format from each function.
macro_rules! in_each_format {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            each::$name::<Postcard>();
            #[cfg(feature = "mavlink")]
            each::$name::<Mavlink>();
        }
    )*};
}

in_each_format! {
    frames_cut_anywhere_are_returned_whole_and_once
    noise_and_damage_lose_only_the_damaged_frames
    a_full_receiver_keeps_the_newest_frames
    a_packet_of_a_radio_drops_an_incomplete_frame
    a_line_error_loses_only_the_frame_in_between
    a_partly_sent_frame_is_finished_when_older_frames_are_dropped
    a_frame_cut_by_the_line_does_not_damage_the_next
    a_full_sender_drops_frames_and_continues
    the_link_never_waits
    one_call_takes_no_more_than_its_buffer
    errors_of_the_line_lose_one_frame_each_way_and_are_reported
    any_bytes_leave_the_inbox_intact
    receivers_get_a_subsequence_at_any_speed_of_the_line
}
#[cfg(feature = "async")]
in_each_format! { both_directions_run_concurrently_and_past_errors }

mod each {
    use super::*;

    pub fn frames_cut_anywhere_are_returned_whole_and_once<F: Format>() {
        let mut receiver = Receiver::<F, 512>::new();
        let bytes = stream::<F>(0..5);
        for (first, rest) in (0..bytes.len()).map(|at| bytes.split_at(at)) {
            receiver.push(first);
            let early = sequences::<F>(receiver.take());
            receiver.push(rest);
            let late = sequences::<F>(receiver.take());
            assert_eq!([early, late].concat(), [0, 1, 2, 3, 4]);
            assert!(receiver.take().is_empty(), "given once");
        }
    }

    pub fn noise_and_damage_lose_only_the_damaged_frames<F: Format>() {
        let mut receiver = Receiver::<F, 512>::new();
        let end = F::DELIMITER.unwrap_or(0);
        receiver.push(&[0xFF, 0x13, end, end, end]);
        receiver.push(&frame::<F>(1));
        receiver.push(&[0x55; 1000]);
        receiver.push(&[end]);
        receiver.push(&frame::<F>(2));
        let mut flipped = frame::<F>(3);
        let middle = flipped.len() / 2;
        flipped[middle] ^= 0x10;
        receiver.push(&flipped);
        receiver.push(&frame::<F>(4));
        assert_eq!(sequences::<F>(receiver.take()), [1, 2, 4]);
        let counts = receiver.counts();
        assert_eq!((counts.frames, counts.dropped), (3, 0));
        // Without a delimiter noise is counted in the pieces in which it arrived.
        assert!(counts.refused == 3 || F::DELIMITER.is_none() && counts.refused > 3);
    }

    pub fn a_full_receiver_keeps_the_newest_frames<F: Format>() {
        const ROOM: usize = 300;
        let mut receiver = Receiver::<F, ROOM>::new();
        let most = ROOM / frame::<F>(0).len();
        receiver.push(&stream::<F>(0..100));
        let kept = sequences::<F>(receiver.take());
        // One may have been dropped for the last one.
        assert!(kept.len() + 1 >= most, "{} of {most}", kept.len());
        let newest: Vec<u16> = (100 - kept.len() as u16..100).collect();
        assert_eq!(kept, newest);
        let counts = receiver.counts();
        assert_eq!((counts.frames, counts.dropped as usize), (100, 100 - kept.len()));
        receiver.push(&frame::<F>(100));
        assert_eq!(sequences::<F>(receiver.take()), [100]);
        assert_eq!(receiver.counts().dropped, counts.dropped);
    }

    pub fn a_packet_of_a_radio_drops_an_incomplete_frame<F: Format>() {
        let mut receiver = Receiver::<F, 512>::new();
        let whole = frame::<F>(5);
        receiver.push(&whole[..3]);
        let end = usize::from(F::DELIMITER.is_some());
        receiver.push_packet(&whole[..whole.len() - end]);
        receiver.push_packet(&stream::<F>([6, 7]));
        assert_eq!(sequences::<F>(receiver.take()), [5, 6, 7]);
        assert_eq!(receiver.counts().refused, 1);
    }

    pub fn a_line_error_loses_only_the_frame_in_between<F: Format>() {
        let mut receiver = Receiver::<F, 512>::new();
        let whole = frame::<F>(1);
        receiver.push(&whole[..5]);
        receiver.line_error();
        receiver.push(&whole[5..]);
        receiver.push(&frame::<F>(2));
        assert_eq!(sequences::<F>(receiver.take()), [2]);
        assert_eq!(receiver.counts().line_errors, 1);
    }

    pub fn a_partly_sent_frame_is_finished_when_older_frames_are_dropped<F: Format>() {
        const ROOM: usize = 64;
        let len = frame::<F>(0).len();
        let mut sender = Sender::<F, ROOM>::new();
        sender.send(&stream::<F>([0, 1]));
        sender.sent(usize::from(F::DELIMITER.is_some()) + 3);
        let rest = frame::<F>(0)[3..].to_vec();
        for sequence in 2..9 {
            sender.send(&frame::<F>(sequence));
        }
        let unsent = sender.unsent().to_vec();
        assert_eq!(&unsent[..rest.len()], rest);
        let room = (ROOM - rest.len()) / len;
        let newest: Vec<u16> = (9 - room as u16..9).collect();
        assert_eq!(sequences::<F>(&unsent[rest.len()..]), newest);
        sender.sent(unsent.len());
        let counts = sender.counts();
        assert_eq!((counts.frames as usize, counts.dropped as usize), (1 + room, 9 - 1 - room));
        assert!(sender.unsent().is_empty());
    }

    pub fn a_frame_cut_by_the_line_does_not_damage_the_next<F: Format>() {
        let mut sender = Sender::<F, 128>::new();
        sender.send(&stream::<F>([1, 2]));
        let mut line = sender.unsent()[..5].to_vec();
        sender.sent(5);
        sender.line_error();
        line.extend(sender.unsent());
        let mut receiver = Receiver::<F, 512>::new();
        receiver.push(&line);
        assert_eq!(sequences::<F>(receiver.take()), [2]);
        assert_eq!((sender.counts().dropped, sender.counts().line_errors), (1, 1));
    }

    pub fn a_full_sender_drops_frames_and_continues<F: Format>() {
        let mut sender = Sender::<F, 8>::new();
        sender.send(&stream::<F>([1, 2]));
        assert_eq!(sender.counts().dropped, 2);
        let mut sender = Sender::<F, 0>::new();
        sender.send(&stream::<F>([1]));
        assert!(sender.unsent().is_empty());
    }

    pub fn the_link_never_waits<F: Format>() {
        let mut link = PacketLink::<Uart, F, 300, 128>::new(Uart::default());
        link.pump().unwrap();
        link.send(&stream::<F>([1, 2]));
        link.pump().unwrap();
        assert!(link.take().is_empty());
        let mut uart = link.release();
        assert!(uart.outbound.is_empty());
        uart.inbound.extend(stream::<F>([3]));
        uart.room = usize::MAX;
        let mut link = PacketLink::<Uart, F, 300, 128>::new(uart);
        link.send(&stream::<F>([1, 2]));
        link.pump().unwrap();
        assert_eq!(sequences::<F>(link.take()), [3]);
        assert_eq!(sequences::<F>(&link.release().outbound), [1, 2]);
    }

    pub fn one_call_takes_no_more_than_its_buffer<F: Format>() {
        let uart = Uart { inbound: stream::<F>(0..100).into(), ..Uart::default() };
        let before = uart.inbound.len();
        let mut link = PacketLink::<Uart, F, 300>::new(uart);
        link.pump().unwrap();
        let uart = link.release();
        assert!(before - uart.inbound.len() < 300 + 5 && uart.calls <= 300);
    }

    pub fn errors_of_the_line_lose_one_frame_each_way_and_are_reported<F: Format>() {
        let (whole, next) = (frame::<F>(1), stream::<F>([2, 3]));
        let uart = Uart { inbound: whole[..6].to_vec().into(), room: 4, ..Uart::default() };
        let mut link = PacketLink::<Uart, F, 512, 256>::new(uart);
        link.send(&stream::<F>([4, 5]));
        link.pump().unwrap();
        link.line_mut().read_fails = true;
        link.line_mut().write_fails = true;
        assert_eq!(link.pump(), Err(ErrorKind::InvalidData));
        link.line_mut().inbound.extend(&whole[6..]);
        link.line_mut().inbound.extend(&next);
        link.line_mut().room = 999;
        link.pump().unwrap();
        assert_eq!(sequences::<F>(link.take()), [2, 3]);
        let (heard, said) = link.counts();
        assert_eq!((heard.line_errors, said.line_errors), (1, 1));
        assert_eq!((said.frames, said.dropped), (1, 1));
        let mut peer = Receiver::<F, 512>::new();
        peer.push(&link.release().outbound);
        assert_eq!(sequences::<F>(peer.take()), [5]);
    }

    pub fn any_bytes_leave_the_inbox_intact<F: Format>() {
        let piece = prop_oneof![
            2 => proptest::collection::vec(any::<u8>(), 0..40),
            1 => proptest::collection::vec(prop_oneof![Just(0xFD_u8), Just(0xFE), Just(0), Just(1)], 0..300),
            2 => any::<u16>().prop_map(frame::<F>),
        ];
        let pieces = proptest::collection::vec(piece, 0..40);
        proptest!(|(pieces in pieces, fails in 0_usize..40)| {
            let mut receiver = Receiver::<F, 320>::new();
            let mut found = 0;
            for (at, piece) in pieces.iter().enumerate() {
                receiver.push(piece);
                if at == fails {
                    receiver.line_error();
                }
                if at % 3 == 0 {
                    found += sequences::<F>(receiver.take()).len();
                }
            }
            receiver.push_packet(&frame::<F>(1));
            let inbox = sequences::<F>(receiver.take());
            prop_assert_eq!(inbox.last(), Some(&1));
            let counts = receiver.counts();
            prop_assert_eq!((found + inbox.len()) as u32 + counts.dropped, counts.frames);
        });
    }

    pub fn receivers_get_a_subsequence_at_any_speed_of_the_line<F: Format>() {
        let takes = proptest::collection::vec(0_usize..40, 1..60);
        proptest!(|(takes in takes, fails in 0_usize..60)| {
            let (mut sender, mut receiver) = (Sender::<F, 64>::new(), Receiver::<F, 4096>::new());
            let drain = |sender: &mut Sender<F, 64>, receiver: &mut Receiver<F, 4096>, take: usize| {
                let len = take.min(sender.unsent().len());
                receiver.push(&sender.unsent()[..len]);
                sender.sent(len);
            };
            for (number, take) in takes.iter().enumerate() {
                sender.send(&frame::<F>(number as u16));
                drain(&mut sender, &mut receiver, *take);
                if number == fails {
                    sender.line_error();
                }
            }
            let last = takes.len() as u16;
            sender.send(&frame::<F>(last));
            drain(&mut sender, &mut receiver, usize::MAX);
            let got = sequences::<F>(receiver.take());
            prop_assert!(got.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", got);
            let (counts, refused) = (sender.counts(), receiver.counts().refused);
            // Without delimiters a cut frame may take the next one with it.
            let is_exact = F::DELIMITER.is_some() || fails >= takes.len();
            let most_lost = usize::from(!is_exact);
            prop_assert!((got.len()..=got.len() + most_lost).contains(&(counts.frames as usize)));
            prop_assert!(!is_exact || got.last() == Some(&last));
            prop_assert_eq!(counts.frames + counts.dropped, takes.len() as u32 + 1);
            prop_assert!(refused == 0 || fails < takes.len());
        });
    }

    #[cfg(feature = "async")]
    pub fn both_directions_run_concurrently_and_past_errors<F: Format>() {
        use core::{future::Future, pin::pin, task::Context, task::Poll, task::Waker};
        let inbound = stream::<F>([1, 2, 3]);
        let mut reads: Vec<_> = inbound.chunks(4).map(|c| Ok(c.to_vec())).collect();
        reads.insert(inbound.len() / 8, Err(ErrorKind::Other));
        reads.push(Ok(Vec::new()));
        let room = |len: usize| Ok(std::vec![0; len]);
        let reader = half(reads);
        let writer = half([room(3), Err(ErrorKind::Other), room(9), room(0), room(99)]);
        let mut link = PacketLink::<_, F>::new((reader, writer));
        link.send(&stream::<F>([4, 5]));
        let mut context = Context::from_waker(Waker::noop());
        for _ in 0..9 {
            let mut serving = pin!(link.serve());
            let poll = serving.as_mut().poll(&mut context);
            assert!(matches!(poll, Poll::Pending));
        }
        assert_eq!(sequences::<F>(link.take()), [1, 3]);
        let (heard, said) = link.counts();
        assert_eq!((heard.line_errors, said.line_errors), (2, 2));
        assert_eq!(said.frames + said.dropped, 2);
    }
}

#[test]
fn a_lost_delimiter_loses_the_two_adjacent_frames() {
    let mut receiver = Receiver::<Postcard, 256>::new();
    let mut bytes = stream::<Postcard>([1, 2, 3]);
    bytes.remove(frame::<Postcard>(1).len() - 1);
    receiver.push(&bytes);
    assert_eq!(sequences::<Postcard>(receiver.take()), [3]);
}

#[test]
fn a_zero_byte_is_sent_after_a_pause_and_not_between_frames() {
    let mut sender = Sender::<Postcard, 256>::new();
    sender.send(&stream::<Postcard>([1, 2]));
    sender.send(&stream::<Postcard>([3]));
    let expected = [&[0][..], &stream::<Postcard>([1, 2, 3])].concat();
    assert_eq!(sender.unsent(), expected);
    sender.sent(expected.len());
    assert!(sender.unsent().is_empty());
    assert_eq!(sender.counts().frames, 3);
    sender.send(&[]);
    assert!(sender.unsent().is_empty(), "nothing to say, nothing sent");
    let mut sender = Sender::<Postcard, 64>::new();
    for sequence in 0..10 {
        sender.send(&frame::<Postcard>(sequence));
    }
    let left = sequences::<Postcard>(sender.unsent());
    assert_eq!(left.last(), Some(&9));
    assert_eq!(sender.counts().dropped as usize, 10 - left.len());
}

#[test]
fn leading_zero_bytes_do_not_evict_frames() {
    const ROOM: usize = 78;
    let len = frame::<Postcard>(0).len();
    assert_eq!(ROOM % len, 0, "{len}");
    let mut receiver = Receiver::<Postcard, ROOM>::new();
    receiver.push(&stream::<Postcard>(0..(ROOM / len) as u16));
    receiver.push(&[0; 9]);
    receiver.push_packet(&[]);
    assert_eq!(receiver.take().len(), ROOM);
    assert_eq!(receiver.counts().dropped, 0);
}

#[cfg(feature = "mavlink")]
#[test]
fn other_messages_on_the_line_are_skipped() {
    use staya_mavlink::{dialect::HEARTBEAT_DATA, frame};
    let mut heartbeat = heapless::Vec::<u8, 64>::new();
    let sender = frame::Sender { system: 1, component: 1, sequence: 0 };
    frame::encode(sender, &HEARTBEAT_DATA::DEFAULT, &mut heartbeat).unwrap();
    let mut receiver = Receiver::<Mavlink, 512>::new();
    for sequence in 0..3 {
        receiver.push(&heartbeat);
        receiver.push(&stream::<Mavlink>([sequence]));
    }
    assert_eq!(sequences::<Mavlink>(receiver.take()), [0, 1, 2]);
    let counts = receiver.counts();
    assert_eq!((counts.frames, counts.refused), (3, 0));
}
