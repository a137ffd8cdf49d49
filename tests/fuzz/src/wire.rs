//! Arbitrary received bytes.

use crc::{CRC_16_IBM_SDLC, Crc};
use heapless::Vec as Bounded;
use staya_controller::wire::{
    DecodeError, EncodeError, Frame, MAX_FRAME_LEN, TAG_LEN, decode, decode_verified, encode, encode_tagged, frames,
};

const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_SDLC);

/// Decodes the bytes as a radio stream and as the content of an intact frame, without panics. An
/// accepted message can be encoded in at most as many bytes, and its encoding is accepted.
pub fn wire_decode(bytes: &[u8]) {
    for piece in frames(bytes) {
        assert!(!piece.is_empty() && !piece.contains(&0));
        judge(piece);
    }
    judge(bytes);
    // A cut stream gives the same frames, except for the frame that was cut.
    if let Some(&at) = bytes.first() {
        let (front, back) = bytes.split_at(usize::from(at).min(bytes.len()));
        let whole = frames(bytes).count();
        let cut = frames(front).count() + frames(back).count();
        assert!(cut == whole || cut == whole + 1);
    }
    // Random bytes hardly ever have a valid checksum.
    let mut content = bytes.to_vec();
    content.extend(CRC.checksum(bytes).to_le_bytes());
    let frame = stuffed(&content);
    assert!(!matches!(decode(&frame), Err(DecodeError::Cobs | DecodeError::Crc)));
    assert_eq!(decode(&frame) == Err(DecodeError::TooLong), frame.len() >= MAX_FRAME_LEN);
    judge(&frame);
}

fn judge(piece: &[u8]) {
    let Ok(frame) = decode(piece) else {
        assert!(decode_verified(piece, |_, _| Ok(())).is_err());
        return;
    };
    assert!(piece.len() < MAX_FRAME_LEN);
    assert!(frame.header.sender.is_some());
    let refused = decode_verified(piece, |_, tag| {
        assert_eq!(tag, frame.tag);
        Err(DecodeError::Forged)
    });
    assert_eq!(refused, Err(DecodeError::Forged));
    let Some(again) = encoded(&frame) else {
        // Only a tagged frame with large robot ids can be decoded but not encoded.
        assert!(frame.tag.is_some());
        return;
    };
    assert!(again.len() <= piece.len() + 1);
    let (delimiter, again) = again.split_last().expect("a frame has bytes");
    assert_eq!(*delimiter, 0);
    assert_eq!(decode(again), Ok(frame));
}

fn encoded(frame: &Frame) -> Option<Bounded<u8, MAX_FRAME_LEN>> {
    let mut out = Bounded::new();
    let len = match frame.tag {
        None => encode(frame.header, &frame.message, &mut out),
        Some(tag) => encode_tagged(
            frame.header,
            &frame.message,
            |authenticated| {
                assert!(authenticated.len() + TAG_LEN < MAX_FRAME_LEN);
                tag
            },
            &mut out,
        ),
    };
    if matches!(len, Err(EncodeError::Robot(_))) {
        return None;
    }
    assert_eq!(len, Ok(out.len()));
    Some(out)
}

/// COBS block by block, as in its paper, without delimiter.
fn stuffed(content: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    for block in content.split(|byte| *byte == 0) {
        let mut chunks = block.chunks(254).peekable();
        if chunks.peek().is_none() {
            out.push(1);
        }
        while let Some(chunk) = chunks.next() {
            out.push(chunk.len() as u8 + 1);
            out.extend(chunk);
            // A full chunk has no zero; if it ends the block, an empty chunk follows.
            if chunk.len() == 254 && chunks.peek().is_none() {
                out.push(1);
            }
        }
    }
    out
}
