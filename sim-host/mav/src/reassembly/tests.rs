use super::*;
use proptest::prelude::*;
use staya_controller::auth::Key;
use staya_mavlink::dialect::{HEARTBEAT_DATA, MavMessage, PING_DATA, STATUSTEXT_DATA};
use staya_mavlink::frame::Sender;
use staya_mavlink::mavlink_core::{MavlinkVersion, Message, calculate_crc};
use staya_mavlink::signing::Signing;

/// A message as MAVLink 1, or as MAVLink 2 with its zeros or signed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    V1,
    V2,
    Signed,
}

fn message(number: u8) -> MavMessage {
    match number % 4 {
        0 => MavMessage::HEARTBEAT(HEARTBEAT_DATA { custom_mode: number.into(), ..HEARTBEAT_DATA::DEFAULT }),
        // The payload contains both first bytes of frames.
        1 => MavMessage::PING(PING_DATA { time_usec: 0xFD01_FE02_FDFE, seq: number.into(), ..PING_DATA::DEFAULT }),
        2 => MavMessage::STATUSTEXT(STATUSTEXT_DATA {
            severity: number,
            text: "a frame of more than fifty bytes with its text".into(),
            ..STATUSTEXT_DATA::DEFAULT
        }),
        _ => MavMessage::HEARTBEAT(HEARTBEAT_DATA { mavtype: 0xFD, autopilot: 0xFE, ..HEARTBEAT_DATA::DEFAULT }),
    }
}

fn frame(number: u8, kind: Kind) -> Vec<u8> {
    let (message, mut sender) = (message(number), Sender { system: 7, component: 1, sequence: number });
    match kind {
        Kind::V1 => {
            let mut payload = [0; 255];
            let len = message.ser(MavlinkVersion::V1, &mut payload);
            let mut bytes = vec![0xFE, len as u8, number, 7, 1, message.message_id() as u8];
            bytes.extend(&payload[..len]);
            let crc = calculate_crc(&bytes[1..], MavMessage::extra_crc(message.message_id()));
            bytes.extend(crc.to_le_bytes());
            bytes
        }
        Kind::V2 => crate::framed::framed(&mut sender, &message, None).expect("a frame").to_vec(),
        Kind::Signed => {
            let mut signing = Signing::new(Key::of_passphrase(b"swarm"), 0, u64::from(number) + 1);
            crate::framed::framed(&mut sender, &message, Some(&mut signing)).expect("a frame").to_vec()
        }
    }
}

/// The frames found in chunks of one peer, each after `step`, and the number of junk bytes.
fn found(chunks: &[&[u8]], is_datagram: bool, step: Duration) -> (Vec<Vec<u8>>, u64) {
    let (mut stream, mut frames, mut now) = (Reassembly::default(), Vec::new(), Instant::now());
    let mut junk = 0;
    for chunk in chunks {
        junk += stream.push(chunk, is_datagram, now, &mut |frame: &[u8]| frames.push(frame.to_vec()));
        assert!(stream.waiting() < 280, "less than one frame waits");
        now += step;
    }
    (frames, junk + stream.waiting())
}

const SOON: Duration = Duration::from_millis(4);

#[test]
fn frames_cut_at_any_byte_are_found_in_streams_and_datagrams() {
    let mut cuts = 0;
    for kinds in [[Kind::V2, Kind::V2], [Kind::V1, Kind::V1], [Kind::Signed, Kind::V1], [Kind::V1, Kind::Signed]] {
        for number in 0..4 {
            let frames = [frame(number, kinds[0]), frame(number + 1, kinds[1])];
            let bytes = frames.concat();
            for cut in 0..=bytes.len() {
                for is_datagram in [false, true] {
                    let (head, tail) = bytes.split_at(cut);
                    assert_eq!(found(&[head, tail], is_datagram, SOON), (frames.to_vec(), 0), "{kinds:?} at {cut}");
                    cuts += 1;
                }
            }
            let single: Vec<&[u8]> = bytes.chunks(1).collect();
            assert_eq!(found(&single, true, SOON), (frames.to_vec(), 0), "byte by byte");
        }
    }
    assert!(cuts > 1000, "{cuts}");
}

#[test]
fn junk_between_frames_is_counted_and_costs_no_frame() {
    let junk: [&[u8]; 6] = [b"\n$GPRMC,1*00\r\n", &[0], &[0xFE], &[0xFD], &[0xFE, 0, 0, 0, 0, 0], &[0xFD, 3, 0xFF]];
    for kind in [Kind::V1, Kind::V2, Kind::Signed] {
        for between in junk {
            let frames: Vec<_> = (0..8).map(|number| frame(number, kind)).collect();
            let bytes: Vec<u8> = frames.iter().flat_map(|frame| [frame, between].concat()).collect();
            // A first byte without a frame claims the bytes behind it until they are there.
            let bytes = [bytes, vec![0; 300]].concat();
            for size in [1, 7, 30, 1000] {
                let chunks: Vec<&[u8]> = bytes.chunks(size).collect();
                let (heard, wasted) = found(&chunks, false, SOON);
                assert_eq!(heard, frames, "{kind:?} {between:?} in chunks of {size}");
                assert_eq!(wasted, (8 * between.len() + 300) as u64);
            }
        }
    }
}

#[test]
fn a_datagram_that_begins_with_a_frame_ends_the_one_before() {
    for cut in 1..frame(1, Kind::V2).len() {
        let (lost, whole) = (&frame(1, Kind::V2)[..cut], frame(2, Kind::V2));
        assert_eq!(found(&[lost, &whole], true, SOON), (vec![whole.clone()], cut as u64), "at once, {cut}");
    }
}

#[test]
fn a_first_byte_without_a_frame_delays_others_for_a_second_at_most() {
    let (mut stream, mut frames, now) = (Reassembly::default(), Vec::new(), Instant::now());
    let bytes = [&[0xFD, 255, 0, 0][..], &frame(1, Kind::V2), &frame(2, Kind::V1)].concat();
    let mut each = |frame: &[u8]| frames.push(frame.to_vec());
    assert_eq!(stream.push(&bytes, false, now, &mut each), 0);
    assert_eq!(stream.expire(now + PATIENCE - Duration::from_millis(1), &mut each), 0);
    assert_eq!(stream.expire(now + PATIENCE, &mut each), 4);
    assert_eq!((frames, stream.waiting()), (vec![frame(1, Kind::V2), frame(2, Kind::V1)], 0));
}

#[test]
fn a_frame_outside_the_dialect_is_kept_whole() {
    let mut unknown = vec![0xFD, 3, 0, 0, 9, 7, 1, 0x10, 0x27, 0, 1, 2, 3, 4, 5];
    let behind = frame(0, Kind::V2);
    unknown.extend(&behind);
    for cut in 0..unknown.len() {
        let (head, tail) = unknown.split_at(cut);
        let (frames, junk) = found(&[head, tail], true, SOON);
        assert_eq!((frames.len(), junk, &frames[1]), (2, 0, &behind), "{cut}");
    }
    let (mut stream, mut frames, now) = (Reassembly::default(), Vec::new(), Instant::now());
    let alone = &unknown[..15];
    let mut each = |frame: &[u8]| frames.push(frame.to_vec());
    assert_eq!(stream.push(alone, true, now, &mut each), 0);
    assert_eq!((stream.expire(now + PATIENCE, &mut each), stream.waiting()), (0, 0));
    assert_eq!(frames, [alone]);
}

fn kinds() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::V1), Just(Kind::V2), Just(Kind::Signed)]
}

proptest! {
    /// Peers whose pieces arrive in any order lose nothing.
    #[test]
    fn interleaved_peers_have_streams_of_their_own(
        sent in proptest::collection::vec(proptest::collection::vec((any::<u8>(), kinds()), 1..8), 1..5),
        sizes in proptest::collection::vec(1_usize..90, 1..40),
    ) {
        let frames: Vec<Vec<Vec<u8>>> =
            sent.iter().map(|peer| peer.iter().map(|(number, kind)| frame(*number, *kind)).collect()).collect();
        let mut left: Vec<Vec<u8>> = frames.iter().map(|peer| peer.concat()).collect();
        let mut streams: Vec<_> = frames.iter().map(|_| (Reassembly::default(), Vec::new())).collect();
        let (mut sizes, mut now) = (sizes.iter().cycle(), Instant::now());
        while left.iter().any(|bytes| !bytes.is_empty()) {
            for (bytes, (stream, heard)) in left.iter_mut().zip(&mut streams) {
                let size = sizes.next().copied().unwrap_or(1).min(bytes.len());
                let piece: Vec<u8> = bytes.drain(..size).collect();
                let junk = stream.push(&piece, true, now, &mut |frame: &[u8]| heard.push(frame.to_vec()));
                prop_assert_eq!(junk, 0);
                // The slowest peer sends 400 bytes a second.
                now += Duration::from_micros(500);
            }
        }
        for ((_, heard), frames) in streams.iter().zip(&frames) {
            prop_assert_eq!(heard, frames);
        }
    }

    /// Every byte is part of a frame or counted as junk.
    #[test]
    fn every_byte_is_accounted_for(
        bytes in proptest::collection::vec(prop_oneof![Just(0xFE_u8), Just(0xFD), Just(9), any::<u8>()], 0..900),
        size in 1_usize..300,
        is_datagram: bool,
    ) {
        let chunks: Vec<&[u8]> = bytes.chunks(size).collect();
        let (frames, junk) = found(&chunks, is_datagram, Duration::from_millis(300));
        let in_frames: usize = frames.iter().map(Vec::len).sum();
        prop_assert_eq!(in_frames as u64 + junk, bytes.len() as u64);
    }
}

#[test]
fn frames_of_a_serial_bridge_at_38400_baud_arrive() {
    let frames: Vec<_> = (0..200).map(|number| frame(number, Kind::V2)).collect();
    let bytes = frames.concat();
    // 4 ms are 15.4 bytes.
    let pieces: Vec<&[u8]> = bytes.chunks(15).collect();
    assert_eq!(found(&pieces, true, SOON), (frames, 0));
}
