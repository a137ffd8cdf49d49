//! The layout of a frame: one message, protected by a checksum, delimited by a zero byte.
//!
//! ```text
//! frame   = COBS(content) 0x00
//! content = version:u8 boot:u8 sender:varint sequence:u16 message:postcard [tag:8] crc:u16
//! ```
//!
//! - Integers are little-endian. The top bit of `version` says that a tag is present. All versions
//!   of the format keep COBS, this byte and the CRC, so that a receiver recognises them.
//! - The tag authenticates everything before it; [`Sealed`](super::Sealed) defines it. Robot
//!   numbers in a tagged frame are below 2^21, so that it fits into 60 bytes.
//! - COBS (Cheshire, Baker 1999, "Consistent overhead byte stuffing", section 3) costs one byte for
//!   up to 253 bytes. The crate `cobs` is not used, because these few lines visibly never panic.
//! - CRC-16/IBM-SDLC covers everything before it. It detects 1 to 3 flipped bits, any odd number of
//!   them, and any burst of up to 16 bits in the content; 1 in 65,536 other errors passes, among
//!   them flips of COBS' own bytes. It suffices because an undetected error must also parse as a
//!   message, radios check their packets, and the next beacon replaces a wrong state. A bare UART
//!   with one wrong bit in 10^4 and 80 beacons per second passes about one wrong beacon in 5 hours;
//!   use the tag if that is too often.
//!
//! Flash on a Cortex-M0 (`opt-level = "s"`): CRC table 512 bytes, [`encode`] and [`decode`] 7 KiB.

use super::content::{MAX_CONTENT, MAX_ORDER, MAX_PAYLOAD};
use super::message::{Ack, Addressed, Beacon, Broadcast, KeyAssignment, KeyHeld, LostRobot, Message, Relayed};
use crate::robot::RobotId;
use core::fmt;
use crc::{CRC_16_IBM_SDLC, Crc, Table};
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(feature = "host")]
mod beacon;

/// The version of the format that this code writes and reads, 1..=127.
pub const VERSION: u8 = 4;
/// Length of an authentication tag in bytes.
pub const TAG_LEN: usize = 8;
/// The greatest robot number that a tagged frame can hold, as sender or as addressee.
pub const MAX_TAGGED_ROBOT: RobotId = RobotId((1 << 21) - 1);

const TAGGED: u8 = 0x80;
const CRC_LEN: usize = 2;
/// A robot number (a varint) in a tagged frame. Untagged it may take 5 bytes, but no message has
/// enough of them to exceed the length with a tag.
const ID: usize = 3;
/// Version, boot, sender, sequence, tag, CRC, COBS byte, delimiter.
const OVERHEAD: usize = 1 + 1 + ID + 2 + TAG_LEN + CRC_LEN + 2;

/// 16 tables process 16 bytes at a time.
const TABLES: usize = if cfg!(feature = "host") { 16 } else { 1 };
static CRC: Crc<u16, Table<TABLES>> = Crc::<u16, Table<TABLES>>::new(&CRC_16_IBM_SDLC);

impl Beacon {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = Self::BARE_FRAME_LEN + MAX_PAYLOAD;
    /// The same without a payload.
    pub const BARE_FRAME_LEN: usize = OVERHEAD + 1 + 3 * 4 + 3 * 2 + 2 + 1 + 1 + 1 + 1;
}

impl Addressed {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + 1 + 1 + MAX_ORDER;
}

impl Broadcast {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + 1 + 1 + MAX_CONTENT;
}

impl Ack {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + 1;
}

impl KeyAssignment {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 2 + 1 + 32;
}

impl KeyHeld {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 2 + 1;
}

impl LostRobot {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + 2 + 3 * 4 + 2;
}

impl Relayed {
    /// Maximum length of its frame in bytes, with tag and delimiter.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 2 + 3 * 4 + 2 + 1 + 1 + 1 + 1 + MAX_PAYLOAD;
}

/// Maximum length of any frame in bytes, with tag and delimiter.
pub const MAX_FRAME_LEN: usize = {
    let lens = [
        Beacon::MAX_FRAME_LEN,
        Addressed::MAX_FRAME_LEN,
        Broadcast::MAX_FRAME_LEN,
        Ack::MAX_FRAME_LEN,
        LostRobot::MAX_FRAME_LEN,
        KeyAssignment::MAX_FRAME_LEN,
        KeyHeld::MAX_FRAME_LEN,
        Relayed::MAX_FRAME_LEN,
    ];
    let mut max = 0;
    let mut rest = lens.as_slice();
    while let [len, others @ ..] = rest {
        if *len > max {
            max = *len;
        }
        rest = others;
    }
    max
};

const MAX_STUFFED: usize = MAX_FRAME_LEN - 2;

// Crazyflie peer-to-peer packets hold 60 bytes; this COBS handles a single block.
const _: () = assert!(MAX_FRAME_LEN <= 60);
// The numbers of sender and addressee.
const _: () = assert!(2 * (5 - ID) <= TAG_LEN);
const _: () = assert!(MAX_STUFFED <= 253);

/// The sender of a frame and the frame's place in the sender's sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// Changes with each start of the sender, so that its sequence may restart.
    pub boot: u8,
    /// The robot that sends this frame; never [`RobotId::NONE`].
    pub sender: RobotId,
    /// Counts all frames of the sender, wraps.
    #[serde(with = "crate::fixint")]
    pub sequence: u16,
}

/// A decoded frame, see [`decode`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Sender and sequence number.
    pub header: Header,
    /// The message that the frame carries.
    pub message: Message,
    /// The authentication tag, if present; [`decode`] does not check it.
    pub tag: Option<[u8; TAG_LEN]>,
}

/// Why a message was not encoded; the outbox is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EncodeError {
    /// The outbox has less free space than the frame needs.
    Full,
    /// The header's sender is [`RobotId::NONE`].
    NoSender,
    /// The format cannot represent this robot number; change the number or the format.
    Robot(RobotId),
    /// The format's counter has reached its end; restart the robot, or give the swarm a new key.
    Exhausted,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Full => f.write_str("the outbox has less room than the frame needs"),
            Self::NoSender => f.write_str("the header has no sender; robot numbers begin at 1"),
            Self::Robot(id) => {
                write!(f, "robot number {} is too large for the format; give the robot a smaller one", id.0)
            }
            Self::Exhausted => {
                f.write_str("the format's counter has ended; restart the robot, or give the swarm a new key")
            }
        }
    }
}

impl core::error::Error for EncodeError {}

/// Why a frame was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// The frame has no bytes.
    Empty,
    /// The frame is longer than [`MAX_FRAME_LEN`] less the delimiter.
    TooLong,
    /// The COBS encoding does not end where the frame ends, or a zero byte lies inside.
    Cobs,
    /// The CRC differs, or the frame is too short to hold one: damaged or cut.
    Crc,
    /// The frame is intact, but of this version (the low 7 bits) instead of [`VERSION`].
    Version(u8),
    /// The frame is intact, but lacks the required tag or signature.
    Unsigned,
    /// The frame is intact, but its tag or signature belongs to another key than the required one,
    /// such as an order that was not made with the robot's own key.
    Forged,
    /// The frame is authentic, but was received before or is older than one that was.
    Replayed,
    /// The frame is authentic, but its counter or timestamp is implausibly far ahead.
    Ahead,
    /// The frame is authentic, but the [`ReplayGuard`](crate::auth::ReplayGuard) is full.
    NoRoom,
    /// The frame is intact, but header or message are unknown to this code.
    Body,
    /// The frame is intact, but bytes follow the message.
    Trailing,
    /// The frame is intact, but its sender is [`RobotId::NONE`].
    NoSender,
    /// The frame is intact, but not a message of the swarm: it belongs to another user of the band.
    Foreign,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "the frame has no bytes",
            Self::TooLong => {
                return write!(f, "the frame has more than {} bytes before its delimiter", MAX_FRAME_LEN - 1);
            }
            Self::Cobs => "the frame's COBS encoding does not end with the frame, or contains a zero",
            Self::Crc => "the frame's CRC is wrong: damaged or cut",
            Self::Version(version) => {
                return write!(f, "the frame is of version {version}, not {VERSION}; update the older side");
            }
            Self::Unsigned => "the frame has no tag or signature; give its sender the key",
            Self::Forged => "the frame's tag or signature belongs to another key",
            Self::Replayed => "the frame is replayed: seen before, or older than a seen one",
            Self::Ahead => "the frame is authentic, but its time is too far ahead",
            Self::NoRoom => "the frame is authentic, but there is no room to remember its sender",
            Self::Body => "the frame is intact, but its header or message is unknown",
            Self::Trailing => "bytes follow the message in the frame",
            Self::NoSender => "the frame is intact, but has no sender",
            Self::Foreign => "the frame is intact, but not a message of the swarm",
        })
    }
}

impl core::error::Error for DecodeError {}

/// Appends one untagged frame to `out` and returns its length. O([`MAX_FRAME_LEN`]).
///
/// # Errors
/// [`EncodeError::Full`] if the whole frame does not fit (nothing is written),
/// [`EncodeError::NoSender`] if the header's sender is [`RobotId::NONE`].
pub fn encode<const N: usize>(header: Header, message: &Message, out: &mut Vec<u8, N>) -> Result<usize, EncodeError> {
    write(header, message, None::<fn(&[u8]) -> [u8; TAG_LEN]>, out)
}

/// Like [`encode`], with a tag: `authenticate` computes it from everything before it.
///
/// # Errors
/// Those of [`encode`], and [`EncodeError::Robot`] if a robot number exceeds [`MAX_TAGGED_ROBOT`].
pub fn encode_tagged<const N: usize>(
    header: Header,
    message: &Message,
    authenticate: impl FnOnce(&[u8]) -> [u8; TAG_LEN],
    out: &mut Vec<u8, N>,
) -> Result<usize, EncodeError> {
    write(header, message, Some(authenticate), out)
}

/// Decodes one frame, given without its delimiter; a tag is not checked. O([`MAX_FRAME_LEN`]).
///
/// # Errors
/// The reason for rejecting the frame, see [`DecodeError`].
pub fn decode(frame: &[u8]) -> Result<Frame, DecodeError> {
    decode_verified(frame, |_, _| Ok(()))
}

/// Like [`decode`], but calls `verify` with the authenticated bytes and the tag, if present.
///
/// # Errors
/// Those of [`decode`], and any error of `verify`.
pub fn decode_verified(
    frame: &[u8],
    verify: impl FnOnce(&[u8], Option<[u8; TAG_LEN]>) -> Result<(), DecodeError>,
) -> Result<Frame, DecodeError> {
    let (&first, stuffed) = frame.split_first().ok_or(DecodeError::Empty)?;
    let mut buffer = [0; MAX_STUFFED];
    let content = buffer.get_mut(..stuffed.len()).ok_or(DecodeError::TooLong)?;
    if frame_len(stuffed) < stuffed.len() {
        return Err(DecodeError::Cobs);
    }
    content.copy_from_slice(stuffed);
    unstuff(first, content).ok_or(DecodeError::Cobs)?;
    let (checked, crc) = content.split_last_chunk::<CRC_LEN>().ok_or(DecodeError::Crc)?;
    if CRC.checksum(checked) != u16::from_le_bytes(*crc) {
        return Err(DecodeError::Crc);
    }
    let version = checked.first().ok_or(DecodeError::Body)?;
    if version & !TAGGED != VERSION {
        return Err(DecodeError::Version(version & !TAGGED));
    }
    let (authenticated, tag) = if version & TAGGED == 0 {
        (checked, None)
    } else {
        let (authenticated, tag) = checked.split_last_chunk::<TAG_LEN>().ok_or(DecodeError::Body)?;
        (authenticated, Some(*tag))
    };
    verify(authenticated, tag)?;
    let body = authenticated.get(1..).ok_or(DecodeError::Body)?;
    #[cfg(feature = "host")]
    if let Some((header, message)) = beacon::read(body) {
        return Ok(Frame { header, message, tag });
    }
    let ((header, message), trailing) =
        postcard::take_from_bytes::<(Header, Message)>(body).map_err(|_| DecodeError::Body)?;
    if !trailing.is_empty() {
        return Err(DecodeError::Trailing);
    }
    if !header.sender.is_some() {
        return Err(DecodeError::NoSender);
    }
    Ok(Frame { header, message, tag })
}

/// Splits a byte stream into frames without their delimiters; empty frames are skipped.
///
/// Bytes after the last delimiter also count as a frame, so that a cut frame is counted as damaged.
/// A caller that reads a serial line in pieces must keep these bytes until the rest has arrived.
pub fn frames(mut inbox: &[u8]) -> impl Iterator<Item = &[u8]> {
    core::iter::from_fn(move || next_frame(&mut inbox))
}

pub(super) fn next_frame<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    while let [0, after @ ..] = *rest {
        *rest = after;
    }
    let (frame, after) = rest.split_at_checked(frame_len(rest))?;
    *rest = after.get(1..).unwrap_or_default();
    (!frame.is_empty()).then_some(frame)
}

/// Finds the first zero one machine word at a time (S. E. Anderson, "Bit Twiddling Hacks",
/// "Determine if a word has a zero byte"; the lowest mark is never a false one).
#[expect(clippy::arithmetic_side_effects, reason = "lengths within a slice")]
fn frame_len(bytes: &[u8]) -> usize {
    const WORD: usize = size_of::<usize>();
    const ONES: usize = usize::from_le_bytes([1; WORD]);
    let (words, rest) = bytes.as_chunks::<WORD>();
    for (at, word) in words.iter().enumerate() {
        let word = usize::from_le_bytes(*word);
        let marks = word.wrapping_sub(ONES) & !word & (ONES << 7);
        if marks != 0 {
            return at * WORD + (marks.trailing_zeros() >> 3) as usize;
        }
    }
    let within = rest.iter().take_while(|byte| **byte != 0).count();
    bytes.len() - rest.len() + within
}

#[expect(clippy::arithmetic_side_effects, reason = "lengths within a frame")]
fn write<const N: usize>(
    header: Header,
    message: &Message,
    authenticate: Option<impl FnOnce(&[u8]) -> [u8; TAG_LEN]>,
    out: &mut Vec<u8, N>,
) -> Result<usize, EncodeError> {
    if !header.sender.is_some() {
        return Err(EncodeError::NoSender);
    }
    if authenticate.is_some() {
        let robot = message.addressee().map_or(header.sender, |to| to.max(header.sender));
        if robot > MAX_TAGGED_ROBOT {
            return Err(EncodeError::Robot(robot));
        }
    }
    let mut frame = [0; MAX_FRAME_LEN];
    let [first, content @ .., _delimiter] = &mut frame;
    // The buffer holds the longest possible frame, so `Full` cannot originate here.
    let len = fill(header, message, authenticate, content).ok_or(EncodeError::Full)?;
    let content = content.get_mut(..len).ok_or(EncodeError::Full)?;
    *first = stuff(content);
    let frame = frame.get(..len + 2).ok_or(EncodeError::Full)?;
    out.extend_from_slice(frame).map_err(|_| EncodeError::Full)?;
    Ok(frame.len())
}

#[expect(clippy::arithmetic_side_effects, reason = "lengths within a frame")]
fn fill(
    header: Header,
    message: &Message,
    authenticate: Option<impl FnOnce(&[u8]) -> [u8; TAG_LEN]>,
    content: &mut [u8],
) -> Option<usize> {
    let flag = if authenticate.is_some() { TAGGED } else { 0 };
    let mut len = postcard::to_slice(&(VERSION | flag, header, message), content).ok()?.len();
    if let Some(authenticate) = authenticate {
        let (authenticated, free) = content.split_at_mut_checked(len)?;
        *free.first_chunk_mut()? = authenticate(authenticated);
        len += TAG_LEN;
    }
    let (checked, free) = content.split_at_mut_checked(len)?;
    *free.first_chunk_mut()? = CRC.checksum(checked).to_le_bytes();
    Some(len + CRC_LEN)
}

/// Replaces each zero by the distance to the next zero (the last one: to the delimiter). Returns
/// the distance from the byte in front to the first zero. At most 253 bytes.
fn stuff(content: &mut [u8]) -> u8 {
    content.iter_mut().rev().fold(1, |distance, byte| {
        if *byte == 0 {
            *byte = distance;
            1
        } else {
            distance.wrapping_add(1)
        }
    })
}

/// The inverse of [`stuff`]; `None` if the chain of distances misses the end.
#[expect(clippy::arithmetic_side_effects, reason = "`next` is within the content, and a step is at most 255")]
fn unstuff(first: u8, content: &mut [u8]) -> Option<()> {
    let mut next = usize::from(first).checked_sub(1)?;
    while let Some(byte) = content.get_mut(next) {
        let distance = core::mem::take(byte);
        if distance == 0 {
            return None;
        }
        next += usize::from(distance);
    }
    (next == content.len()).then_some(())
}

#[cfg(test)]
mod tests;
