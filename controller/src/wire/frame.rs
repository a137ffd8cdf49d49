//! Frames: one message each, checked, delimited by zero bytes. Read this first.
//!
//! ```text
//! frame   = COBS(content) 0x00
//! content = version:u8 boot:u8 sender:varint sequence:u16 message:postcard [tag:8] crc:u16
//! ```
//!
//! - `version` holds [`VERSION`] in its low 7 bits; its top bit says that a tag is present. Every
//!   version keeps COBS, this byte in front and the CRC at the end, so that a foreign version can
//!   be told from damage.
//! - The tag authenticates everything before it ([`encode_tagged`], [`decode_verified`]). What it is made of is said in
//!   [`Sealed`](super::Sealed), which makes and checks it. A frame with a tag has at most 60 bytes too, because robots' numbers in it
//!   are below 2^21 and take 3 bytes at most instead of 5.
//! - The CRC covers everything before it. Integers are little-endian.
//! - COBS (Cheshire, Baker 1999, "Consistent overhead byte stuffing", section 3) takes out the zero
//!   bytes at the price of one byte, since no content is longer than 253 bytes. It is written here,
//!   not taken from the `cobs` crate, because these few lines visibly never panic.
//!
//! # What the CRC finds
//!
//! CRC-16/IBM-SDLC (X.25; polynomial 0x1021, reflected, start and final inversion 0xFFFF). At
//! our lengths no 16-bit polynomial guarantees more than its Hamming distance 4: every 1 to 3
//! flipped bits of a content, every odd number of them and every burst of up to 16 bits are found;
//! of anything else 1 in 65,536 passes. A bit flipped in one of COBS' own bytes moves a zero and
//! counts as "anything else". Sixteen bits suffice because what passes must also parse as a
//! message, radios check their packets before us, and a state is replaced by the next beacon: on
//! a bare UART with one wrong bit in 10^4 and 80 beacons per second, about one wrong beacon in 5
//! hours, believed for one period. Who needs more uses the tag.
//!
//! The table takes 512 bytes of flash (with the feature `host` there are 16); [`encode`] and [`decode`] with all
//! messages 7 KiB in all on a Cortex-M0 (`opt-level = "s"`, one link-time unit), and no panic is reachable from them.

use super::message::{
    Ack, Beacon, GoalAssignment, KeyAssignment, KeyHeld, Message, Request, TEMPLATE_PART, TemplateAssignment,
    WaypointAssignment,
};
use super::payload::{MAX_PAYLOAD, PayloadBytes};
use crate::land::{LandPatch, PATCH_TILES};
use crate::robot::RobotId;
use core::fmt;
use crc::{CRC_16_IBM_SDLC, Crc, Table};
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(feature = "host")]
mod beacon;

/// The version of the format that this code writes and reads, 1..=127.
pub const VERSION: u8 = 3;
/// Bytes of an authentication tag.
pub const TAG_LEN: usize = 8;
/// The greatest number of a robot in frames with a tag, as sender and as leader.
pub const MAX_TAGGED_ROBOT: RobotId = RobotId((1 << 21) - 1);

/// The flag in the version byte: a tag is present.
const TAGGED: u8 = 0x80;
const CRC_LEN: usize = 2;
/// A robot's number as a varint in a frame with a tag, at most. Without a tag it is 5, and no message has so many numbers that such a frame were longer.
const ID: usize = 3;
/// Everything but the message: version, boot, sender, sequence, tag, CRC; COBS' byte, delimiter.
const OVERHEAD: usize = 1 + 1 + ID + 2 + TAG_LEN + CRC_LEN + 2;
const CELL: usize = 4;

/// Tables that the CRC goes by: with 16 it takes 16 bytes at a time.
const TABLES: usize = if cfg!(feature = "host") { 16 } else { 1 };
static CRC: Crc<u16, Table<TABLES>> = Crc::<u16, Table<TABLES>>::new(&CRC_16_IBM_SDLC);

impl Beacon {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + 4 + 3 * 4 + 3 * 2 + 2 + CELL + 1 + 2 + ID + 1 + 1 + CELL;
}

impl Request {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + ID + 1 + 1 + 2;
}

impl Ack {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + 1 + 1;
}

impl TemplateAssignment {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + 1 + 1 + 1 + CELL + 1 + TEMPLATE_PART * (CELL + ID + 1);
}

impl GoalAssignment {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + CELL;
}

impl WaypointAssignment {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 1 + 1 + 3 * 4 + 3 * 2;
}

impl KeyAssignment {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 2 + 1 + 32;
}

impl KeyHeld {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + ID + 2 + 1;
}

impl LandPatch {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + CELL + PATCH_TILES;
}

impl PayloadBytes {
    /// Bytes of a frame that carries one, at most: tag and delimiter included.
    pub const MAX_FRAME_LEN: usize = OVERHEAD + 1 + 1 + MAX_PAYLOAD;
}

/// Bytes of any frame, at most: tag and delimiter included.
pub const MAX_FRAME_LEN: usize = {
    let lens = [
        Beacon::MAX_FRAME_LEN,
        Request::MAX_FRAME_LEN,
        Ack::MAX_FRAME_LEN,
        TemplateAssignment::MAX_FRAME_LEN,
        GoalAssignment::MAX_FRAME_LEN,
        WaypointAssignment::MAX_FRAME_LEN,
        KeyAssignment::MAX_FRAME_LEN,
        KeyHeld::MAX_FRAME_LEN,
        LandPatch::MAX_FRAME_LEN,
        PayloadBytes::MAX_FRAME_LEN,
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

/// A frame between COBS and the delimiter, at most.
const MAX_CONTENT: usize = MAX_FRAME_LEN - 2;

// Crazyflie peer-to-peer packets hold 60 bytes; COBS here knows one block.
const _: () = assert!(MAX_FRAME_LEN <= 60);
// Sender, addressee and those of a template.
const _: () = assert!((2 + TEMPLATE_PART) * (5 - ID) <= TAG_LEN);
const _: () = assert!(MAX_CONTENT <= 253);

/// Who says it, and which of its frames this is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// Changes with each start of the sender, so that its sequence may start anew.
    pub boot: u8,
    /// Who sends this frame; never nobody.
    pub sender: RobotId,
    /// Counts the sender's frames of every kind, wraps.
    #[serde(with = "crate::fixint")]
    pub sequence: u16,
}

/// What [`decode`] gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Who says it.
    pub header: Header,
    /// What it says.
    pub message: Message,
    /// The authentication tag, if there is one; [`decode`] does not check it.
    pub tag: Option<[u8; TAG_LEN]>,
}

/// Why a message was not encoded; the outbox is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EncodeError {
    /// The outbox has less room than the frame needs.
    Full,
    /// The header names nobody as the sender.
    NoSender,
    /// The format has no room for this robot's number; give the robot another one, or the swarm another format.
    Robot(RobotId),
    /// The format's counter has come to its end: the robot must start anew, or the swarm needs a new key.
    Exhausted,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Full => f.write_str("the outbox has less room than the frame needs"),
            Self::NoSender => f.write_str("the sender in the header is nobody: robots' numbers begin at 1"),
            Self::Robot(id) => {
                write!(f, "robot number {} is too large for the format; give the robot a smaller one", id.0)
            }
            Self::Exhausted => {
                f.write_str("the format's counter has ended; start the robot anew, or give the swarm a new key")
            }
        }
    }
}

impl core::error::Error for EncodeError {}

/// Why a frame was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// No bytes.
    Empty,
    /// More bytes than [`MAX_FRAME_LEN`] less the delimiter.
    TooLong,
    /// The stuffing does not end where the frame ends, or a zero byte lies within.
    Cobs,
    /// The CRC differs, or the frame is too short for one: damaged or cut.
    Crc,
    /// Sound, but another version of the format (the low 7 bits) than [`VERSION`].
    Version(u8),
    /// Sound, but without the tag or signature that is asked for.
    Unsigned,
    /// Sound, but its tag or signature is not of the key that is asked for: an order that is not of the robot's own key, too.
    Forged,
    /// Authentic, but recorded: seen before, or older than what was.
    Replayed,
    /// Authentic, but its counter or timestamp is too far ahead to be true.
    Ahead,
    /// Authentic, but there is no room to remember its sender, see [`ReplayGuard`](crate::auth::ReplayGuard).
    NoRoom,
    /// Sound, but no header and message that this code knows.
    Body,
    /// Sound, but something follows the message.
    Trailing,
    /// Sound, but the sender is nobody.
    NoSender,
    /// Sound, but none of the swarm's messages: somebody else's, on a band that is shared with others.
    Foreign,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "the frame has no bytes",
            Self::TooLong => {
                return write!(f, "the frame has more than {} bytes before its delimiter", MAX_FRAME_LEN - 1);
            }
            Self::Cobs => "the frame's stuffing does not end with it, or a zero lies within",
            Self::Crc => "the frame's CRC is wrong: damaged or cut",
            Self::Version(version) => {
                return write!(f, "the frame is of version {version}, not {VERSION}; update the older side");
            }
            Self::Unsigned => "the frame has no tag or signature; give its sender the key",
            Self::Forged => "the frame's tag or signature is not of this key",
            Self::Replayed => "the frame was recorded: seen before, or older than what was",
            Self::Ahead => "the frame is authentic, but of a time too far ahead",
            Self::NoRoom => "the frame is authentic, but there is no room to remember its sender",
            Self::Body => "the frame is sound, but has no header and message that are known",
            Self::Trailing => "bytes follow the message in the frame",
            Self::NoSender => "the frame is sound, but its sender is nobody",
            Self::Foreign => "the frame is sound, but none of the swarm's messages",
        })
    }
}

impl core::error::Error for DecodeError {}

/// Appends one frame without a tag to `out` and returns its length.
///
/// # Errors
/// [`EncodeError::Full`] when the whole frame does not fit (nothing is written),
/// [`EncodeError::NoSender`] when `header` names nobody.
///
/// Bounded work: O([`MAX_FRAME_LEN`]).
pub fn encode<const N: usize>(header: Header, message: &Message, out: &mut Vec<u8, N>) -> Result<usize, EncodeError> {
    write(header, message, None::<fn(&[u8]) -> [u8; TAG_LEN]>, out)
}

/// Like [`encode`], with the tag that `authenticate` makes of everything before it.
///
/// # Errors
/// Those of [`encode`], and [`EncodeError::Robot`] when sender or leader are greater than [`MAX_TAGGED_ROBOT`].
pub fn encode_tagged<const N: usize>(
    header: Header,
    message: &Message,
    authenticate: impl FnOnce(&[u8]) -> [u8; TAG_LEN],
    out: &mut Vec<u8, N>,
) -> Result<usize, EncodeError> {
    write(header, message, Some(authenticate), out)
}

/// Reads one frame, given without its delimiter; a tag is handed out unchecked.
///
/// # Errors
/// What is wrong with it, see [`DecodeError`]; any bytes at all give an answer.
///
/// Bounded work: O([`MAX_FRAME_LEN`]).
pub fn decode(frame: &[u8]) -> Result<Frame, DecodeError> {
    decode_verified(frame, |_, _| Ok(()))
}

/// Like [`decode`], and asks `verify` with the authenticated bytes and the tag, if there is one.
///
/// # Errors
/// Those of [`decode`], and what `verify` says.
pub fn decode_verified(
    frame: &[u8],
    verify: impl FnOnce(&[u8], Option<[u8; TAG_LEN]>) -> Result<(), DecodeError>,
) -> Result<Frame, DecodeError> {
    let (&first, stuffed) = frame.split_first().ok_or(DecodeError::Empty)?;
    let mut buffer = [0; MAX_CONTENT];
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
    if !header.sender.is_somebody() {
        return Err(DecodeError::NoSender);
    }
    Ok(Frame { header, message, tag })
}

/// The frames of a byte stream, without their delimiters; empty pieces are left out.
///
/// The bytes after the last delimiter are a frame too: if only its delimiter was lost, [`decode`]
/// accepts it, and if it was cut, [`decode`] refuses it, so that it is counted as damaged. A caller
/// that reads a serial line in pieces keeps the bytes after the last delimiter until the rest is
/// there.
pub fn frames(mut inbox: &[u8]) -> impl Iterator<Item = &[u8]> {
    core::iter::from_fn(move || next_frame(&mut inbox))
}

/// Takes the next of [`frames`] and its delimiter off `rest`.
pub(super) fn next_frame<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    while let [0, after @ ..] = *rest {
        *rest = after;
    }
    let (frame, after) = rest.split_at_checked(frame_len(rest))?;
    *rest = after.get(1..).unwrap_or_default();
    (!frame.is_empty()).then_some(frame)
}

/// Bytes before the first zero: a machine word at a time (S. E. Anderson, "Bit Twiddling Hacks", "Determine if a word has
/// a zero byte"; the lowest mark is never a false one).
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
    if !header.sender.is_somebody() {
        return Err(EncodeError::NoSender);
    }
    if authenticate.is_some() {
        let leader = match message {
            Message::Beacon(beacon) => beacon.leader,
            _ => RobotId::NOBODY,
        };
        let large = [header.sender, leader].into_iter();
        if let Some(robot) = large.max().filter(|robot| *robot > MAX_TAGGED_ROBOT) {
            return Err(EncodeError::Robot(robot));
        }
    }
    let mut frame = [0; MAX_FRAME_LEN];
    let [first, content @ .., _delimiter] = &mut frame;
    // The buffer holds the longest frame of all: `Full` cannot come from here.
    let len = fill(header, message, authenticate, content).ok_or(EncodeError::Full)?;
    let content = content.get_mut(..len).ok_or(EncodeError::Full)?;
    *first = stuff(content);
    let frame = frame.get(..len + 2).ok_or(EncodeError::Full)?;
    out.extend_from_slice(frame).map_err(|_| EncodeError::Full)?;
    Ok(frame.len())
}

/// Writes the content and returns its length; `None` when `content` is too short.
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

/// Replaces each zero by the distance to the next one (the last: to the delimiter) and returns
/// the distance to the first, counted from the byte in front. At most 253 bytes.
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

/// The inverse of [`stuff`]; `None` when the chain of distances misses the end.
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
