//! Arbitrary received bytes that may be MAVLink.

use heapless::Vec as Bounded;
use staya_controller::wire::DecodeError;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::mavlink_core::{Message as _, calculate_crc};
use staya_mavlink::wire::{COMPONENT, decode, encode, next_frame};

/// Ids of the swarm's messages.
const IDS: [u32; 8] = [9_500_000, 9_500_002, 9_500_003, 9_500_004, 9_500_005, 9_500_006, 9_500_009, 9_500_010];

/// Decodes the bytes as a radio stream and as the payload of an intact frame, without panics or
/// lost bytes. An accepted message can be encoded, and its encoding is accepted.
pub fn mavlink_decode(bytes: &[u8]) {
    let (mut rest, mut pieces) = (bytes, Vec::new());
    while let Some(piece) = next_frame(&mut rest) {
        assert!(!piece.is_empty());
        judge(piece);
        pieces.extend_from_slice(piece);
    }
    assert!(rest.is_empty() && pieces == bytes);
    judge(bytes);
    // Random bytes hardly ever have a valid checksum.
    let Some((which, payload)) = bytes.split_first() else {
        return;
    };
    let payload = &payload[..payload.len().min(255)];
    let id = IDS[usize::from(*which) % IDS.len()];
    let [a, b, c, _] = id.to_le_bytes();
    let mut frame = vec![0xFD, payload.len() as u8, 0, 0, 0, 7, COMPONENT, a, b, c];
    frame.extend(payload);
    let sum = calculate_crc(&frame[1..], MavMessage::extra_crc(id));
    frame.extend(sum.to_le_bytes());
    let answer = decode(&frame);
    assert!(matches!(answer, Ok(_) | Err(DecodeError::Body)), "{answer:?}");
    judge(&frame);
}

fn judge(piece: &[u8]) {
    let Ok(frame) = decode(piece) else { return };
    assert!(frame.header.sender.is_some() && frame.tag.is_none());
    let mut again = Bounded::<u8, 280>::new();
    let len = encode(frame.header, &frame.message, &mut again);
    assert_eq!(len, Ok(again.len()));
    assert_eq!(decode(&again), Ok(frame));
}
