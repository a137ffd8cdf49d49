//! MAVLink frames in bytes: finding, inspecting and encoding them. Start with [`scan`].
//!
//! Unlike `mavlink-core`, which reads streams into its own buffers, this module keeps the bytes
//! unchanged (for signatures and logs) and distinguishes foreign messages from damage.

use crate::dialect::{CRC, MavMessage};
use heapless::Vec;
use mavlink_core::{MavlinkVersion, Message, MessageData};

/// Length of the longest frame in bytes: header, payload, checksum, signature.
pub const MAX_FRAME_LEN: usize = 10 + 255 + 2 + SIGNATURE_LEN;
/// Length of a signature at the end of a frame in bytes.
pub const SIGNATURE_LEN: usize = 13;

const START_V1: u8 = 0xFE;
const START_V2: u8 = 0xFD;
const SIGNED: u8 = 1;

/// The sender of a frame and the frame's sequence number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sender {
    /// System, 1 to 255 (255: a ground station).
    pub system: u8,
    /// Component of the system.
    pub component: u8,
    /// Counts the component's frames; wraps.
    pub sequence: u8,
}

/// The frame does not fit; nothing was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Full;

impl core::fmt::Display for Full {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("there is no room for the frame")
    }
}

impl core::error::Error for Full {}

/// A whole MAVLink 1 or 2 frame of correct length, and correct checksum if the message is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawFrame<'a> {
    bytes: &'a [u8],
    payload: &'a [u8],
    sender: Sender,
    message_id: u32,
    version: u8,
    is_signed: bool,
    is_known: bool,
}

/// The result of [`scan`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scan<'a> {
    /// A frame after bytes that belong to no frame.
    Frame {
        /// Number of bytes before it.
        junk: usize,
        /// The frame.
        frame: RawFrame<'a>,
    },
    /// No whole frame.
    Nothing {
        /// Number of bytes that begin no frame; a frame may begin behind them.
        junk: usize,
    },
}

enum Fault {
    Short,
    Bad,
}

/// Finds the first frame in `bytes`, after any other bytes. With `is_whole` the bytes are complete
/// (a datagram); without it more of the stream may follow.
///
/// The checksum of a message outside the dialect cannot be verified. Such a message counts as a
/// frame if another frame could begin behind it, or complete bytes end there.
///
/// Bounded work: O(n), and one checksum of at most 280 bytes per byte that could begin a header.
#[must_use]
#[expect(clippy::arithmetic_side_effects, reason = "at most the length of `bytes`")]
pub fn scan(bytes: &[u8], is_whole: bool) -> Scan<'_> {
    let mut junk = 0;
    while let Some(rest) = bytes.get(junk..).filter(|rest| !rest.is_empty()) {
        match parse(rest, is_whole) {
            Ok(frame) => return Scan::Frame { junk, frame },
            Err(Fault::Short) if !is_whole => break,
            Err(_) => junk += 1,
        }
    }
    Scan::Nothing { junk }
}

/// Removes the next frame, and the bytes before it that belong to no frame, from the complete bytes
/// `rest`. Returns `None` and empties `rest` when no frame is left. Bounded work: that of [`scan`].
#[expect(clippy::arithmetic_side_effects, reason = "both lie within `rest`")]
pub fn next_frame<'a>(rest: &mut &'a [u8]) -> Option<RawFrame<'a>> {
    match scan(rest, true) {
        Scan::Frame { junk, frame } => {
            *rest = rest.get(junk + frame.bytes.len()..).unwrap_or_default();
            Some(frame)
        }
        Scan::Nothing { .. } => {
            *rest = &[];
            None
        }
    }
}

fn parse(bytes: &[u8], is_whole: bool) -> Result<RawFrame<'_>, Fault> {
    let (frame, checked, payload, checksum) = match bytes {
        [START_V1, rest @ ..] => {
            let &[len, sequence, system, component, id] = rest.first_chunk().ok_or(Fault::Short)?;
            let sender = Sender { system, component, sequence };
            let (payload, checksum, end) = body(bytes, 6, len, false)?;
            let frame = RawFrame {
                bytes: bytes.get(..end).ok_or(Fault::Short)?,
                payload,
                sender,
                message_id: id.into(),
                version: 1,
                is_signed: false,
                is_known: true,
            };
            (frame, bytes.get(1..6), payload, checksum)
        }
        [START_V2, rest @ ..] => {
            let &[len, incompatible, _compatible, sequence, system, component, a, b, c] =
                rest.first_chunk().ok_or(Fault::Short)?;
            // MAVLink requires that frames with unknown flags are dropped.
            if incompatible & !SIGNED != 0 {
                return Err(Fault::Bad);
            }
            let is_signed = incompatible & SIGNED != 0;
            let sender = Sender { system, component, sequence };
            let (payload, checksum, end) = body(bytes, 10, len, is_signed)?;
            let frame = RawFrame {
                bytes: bytes.get(..end).ok_or(Fault::Short)?,
                payload,
                sender,
                message_id: u32::from_le_bytes([a, b, c, 0]),
                version: 2,
                is_signed,
                is_known: true,
            };
            (frame, bytes.get(1..10), payload, checksum)
        }
        _ => return Err(Fault::Bad),
    };
    let Some(extra) = extra_crc(frame.message_id) else {
        let follows = bytes.get(frame.bytes.len());
        return match follows {
            None if !is_whole => Err(Fault::Short),
            None | Some(&(START_V1 | START_V2)) => Ok(RawFrame { is_known: false, ..frame }),
            Some(_) => Err(Fault::Bad),
        };
    };
    if checksum_of(checked.ok_or(Fault::Short)?, payload, extra) == checksum { Ok(frame) } else { Err(Fault::Bad) }
}

#[expect(clippy::arithmetic_side_effects, reason = "10, 255, 2 and 13 bytes at most")]
fn body(bytes: &[u8], header: usize, len: u8, is_signed: bool) -> Result<(&[u8], u16, usize), Fault> {
    let end = header + usize::from(len);
    let payload = bytes.get(header..end).ok_or(Fault::Short)?;
    let rest = bytes.get(end..).ok_or(Fault::Short)?;
    let checksum = u16::from_le_bytes(*rest.first_chunk().ok_or(Fault::Short)?);
    let signature = if is_signed { SIGNATURE_LEN } else { 0 };
    let total = end + 2 + signature;
    if bytes.len() < total {
        return Err(Fault::Short);
    }
    Ok((payload, checksum, total))
}

/// `None` if the dialect does not have the message.
fn extra_crc(message_id: u32) -> Option<u8> {
    // No known message has 0 (verified by a test), which stands for unknown ones.
    Some(MavMessage::extra_crc(message_id)).filter(|extra| *extra != 0)
}

fn checksum_of(header: &[u8], payload: &[u8], extra: u8) -> u16 {
    let mut digest = CRC.digest();
    digest.update(header);
    digest.update(payload);
    digest.update(&[extra]);
    digest.finalize()
}

impl<'a> RawFrame<'a> {
    /// The frame in `bytes`, if they are exactly one frame.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        parse(bytes, true).ok().filter(|frame| frame.bytes.len() == bytes.len())
    }

    /// All bytes of the frame.
    #[must_use]
    pub const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The payload as transmitted: MAVLink 2 omits zeros at its end.
    #[must_use]
    pub const fn payload(&self) -> &'a [u8] {
        self.payload
    }

    /// The sender.
    #[must_use]
    pub const fn sender(&self) -> Sender {
        self.sender
    }

    /// The id of the message.
    #[must_use]
    pub const fn message_id(&self) -> u32 {
        self.message_id
    }

    /// 1 or 2.
    #[must_use]
    pub const fn version(&self) -> u8 {
        self.version
    }

    /// Whether the dialect has its message. Only then the checksum was verified.
    #[must_use]
    pub const fn is_known(&self) -> bool {
        self.is_known
    }

    /// Link id, timestamp and value of the signature; `None` without one.
    #[must_use]
    pub fn signature(&self) -> Option<&'a [u8; SIGNATURE_LEN]> {
        self.bytes.last_chunk().filter(|_| self.is_signed)
    }

    /// The message, if it is a `D`.
    #[must_use]
    pub fn get<D: MessageData>(&self) -> Option<D> {
        if self.message_id != D::ID || !self.is_known {
            return None;
        }
        D::deser(self.mavlink_version(), self.payload).ok()
    }

    /// The message; `None` if the dialect does not have it.
    #[must_use]
    pub fn message(&self) -> Option<MavMessage> {
        if !self.is_known {
            return None;
        }
        MavMessage::parse(self.mavlink_version(), self.message_id, self.payload).ok()
    }

    const fn mavlink_version(&self) -> MavlinkVersion {
        if self.version == 1 { MavlinkVersion::V1 } else { MavlinkVersion::V2 }
    }
}

/// Appends an unsigned MAVLink 2 frame and returns its length. Bounded work: O(payload).
///
/// # Errors
/// [`Full`] if it does not fit.
pub fn encode<D: MessageData, const N: usize>(sender: Sender, data: &D, out: &mut Vec<u8, N>) -> Result<usize, Full> {
    let mut payload = [0; 255];
    let len = data.ser(MavlinkVersion::V2, &mut payload);
    write(sender, D::ID, D::EXTRA_CRC, &payload, len, out)
}

/// [`encode`] for any message.
///
/// # Errors
/// [`Full`] if it does not fit.
pub fn encode_message<const N: usize>(
    sender: Sender,
    message: &MavMessage,
    out: &mut Vec<u8, N>,
) -> Result<usize, Full> {
    let mut payload = [0; 255];
    let len = message.ser(MavlinkVersion::V2, &mut payload);
    let id = message.message_id();
    write(sender, id, MavMessage::extra_crc(id), &payload, len, out)
}

#[expect(clippy::arithmetic_side_effects, reason = "lengths within a frame")]
fn write<const N: usize>(
    sender: Sender,
    id: u32,
    extra: u8,
    payload: &[u8; 255],
    len: usize,
    out: &mut Vec<u8, N>,
) -> Result<usize, Full> {
    let payload = payload.get(..len).ok_or(Full)?;
    let len = u8::try_from(len).map_err(|_| Full)?;
    let [a, b, c, _] = id.to_le_bytes();
    let header = [START_V2, len, 0, 0, sender.sequence, sender.system, sender.component, a, b, c];
    let [_, checked @ ..] = &header;
    let checksum = checksum_of(checked, payload, extra).to_le_bytes();
    let total = header.len() + payload.len() + checksum.len();
    if N.saturating_sub(out.len()) < total {
        return Err(Full);
    }
    for part in [&header[..], payload, &checksum[..]] {
        out.extend_from_slice(part).map_err(|_| Full)?;
    }
    Ok(total)
}

#[cfg(test)]
mod tests;
