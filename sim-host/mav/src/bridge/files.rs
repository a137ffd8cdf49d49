//! Refuses file transfers: these vehicles store no files.

use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;

/// Answers a file request with "file not found", so that the client does not wait for a timeout.
pub(super) fn none(from: Sender, asked: &FILE_TRANSFER_PROTOCOL_DATA) -> Option<MavMessage> {
    const NAK: u8 = 129;
    const FILE_NOT_FOUND: u8 = 10;
    let [low, high, session, opcode, ..] = asked.payload;
    if opcode >= 128 {
        return None;
    }
    let mut payload = [0; 251];
    let sequence = u16::from_le_bytes([low, high]).wrapping_add(1);
    let [low, high] = sequence.to_le_bytes();
    // Bytes: sequence (2), session, opcode, size, requested opcode; the data begin at 12.
    payload[..6].copy_from_slice(&[low, high, session, NAK, 1, opcode]);
    payload[12] = FILE_NOT_FOUND;
    Some(MavMessage::FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA {
        target_network: 0,
        target_system: from.system,
        target_component: from.component,
        payload,
    }))
}
