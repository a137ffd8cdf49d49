//! Frames that only who has the key can make, and nobody can repeat: [`Sealed`].

use super::frame::{decode_verified, encode_tagged};
use super::{Beacon, DecodeError, EncodeError, Frame, Header, Message, Postcard, TAG_LEN, Wire};
use crate::auth::{Freshness, Key, Mac, ReplayGuard, is_same};
use crate::robot::RobotId;
use heapless::Vec;
use serde::Serialize;

/// Senders that a [`Sealed`] of default capacity knows.
pub const PEERS: usize = 64;

/// How often the sequence may wrap within one start, as a power of two: 268 million frames, a month at 100 frames a second.
const WRAP_BITS: u32 = 12;
const EPOCH_LEN: usize = 4;
/// How many starts a sender may be ahead of those known of it: see [`Sealed`].
pub const REACH_STARTS: u32 = 1024;

/// [`Postcard`]'s frames with a tag, and with protection against replays.
///
/// ```text
/// tag = epoch:u32 code:4       code = the first 4 bytes of HMAC-SHA256(key, version .. message, epoch)
/// ```
///
/// It costs 8 bytes per frame and [`Mac::of`]; what each costs on a part is printed by `cargo xtask size`.
///
/// # What it protects from, and from what not
///
/// Whoever does not have the key can neither make a frame nor change one: a code that is guessed is right once in 2^32 tries. On a radio that takes 500 frames
/// per second, one forged frame passes per 99 days of nothing but guessing. It would count for one beacon, or one order, and
/// could shut its true sender out, as below. Who wants less than that takes MAVLink's signatures (48 bits).
/// A recorded frame is refused because its counter, epoch and sequence together, was seen before: see [`ReplayGuard`].
/// All robots share the key: one that is taken with its key can speak for all others. Nothing is secret: frames can be read. Noise
/// on the band, and frames held back for less than a neighbour's age, are beyond any code.
///
/// # What is too far ahead
///
/// A frame with a later counter than its sender's shuts that sender out, with who hears it and as long as that one remembers; who has recorded it can do so
/// again after each restart, without the key. So a frame is refused, and leaves no trace, that is more than [`REACH_STARTS`] starts ahead of the latest
/// of: its sender's last frame, the own start, and [`Self::refuse_before`]. What is left: who has the key can shut a sender out for up to that many of its
/// starts. Give the sender a number of starts that is greater by [`REACH_STARTS`], and a recording of such frames is worth nothing any more. A robot that is
/// started more often than that by itself is not heard by the others, nor they by it, until their numbers are brought together again.
///
/// # The rule for who starts a robot
///
/// A robot must never say two things under one counter. So lasting memory keeps one number, the starts. At each start, *before the
/// first frame*: read it (0 if there never was one), store it plus 1, and give what was read to [`Self::at_start`]. Nothing is to be stored while
/// the robot runs. If the memory is lost, the robot is refused as a replay by everybody who knows it until the number is past
/// the last one again: set it to more than it can have been, or give the swarm a new key, which makes all old frames worthless; then numbers
/// may begin anew.
///
/// A swarm whose owner starts all robots with the same, ever growing number (that of the mission) can also call
/// [`Self::refuse_before`] with it: then no frame of an earlier mission is believed, even by receivers that have forgotten everything.
/// What else survives the receiver's restart is its owner's choice: [`ReplayGuard::export`] through [`Self::guard`].
///
/// The state that serde sees does not hold the key.
#[derive(Clone, Debug, Serialize)]
pub struct Sealed<const N: usize = PEERS> {
    #[serde(skip)]
    mac: Mac,
    epoch: u32,
    /// The sequence number of the last frame.
    last: u16,
    guard: ReplayGuard<N>,
}

impl<const N: usize> Sealed<N> {
    /// For a robot at its start number `starts`, counted in lasting memory from 0; `None` from 2^20 on.
    #[must_use]
    pub fn at_start(key: &Key, starts: u32) -> Option<Self> {
        Some(Self { mac: Mac::new(key), epoch: epoch_of(starts)?, last: 0, guard: ReplayGuard::new() })
    }

    /// Refuses frames of unknown robots from before their start number `starts`. From 2^20 on nothing changes.
    pub fn refuse_before(&mut self, starts: u32) {
        if let Some(epoch) = epoch_of(starts) {
            self.guard.set_floor(counter(epoch, 0));
        }
    }

    /// What is known of others' counters: to be stored.
    #[must_use]
    pub const fn guard(&self) -> &ReplayGuard<N> {
        &self.guard
    }

    /// The same, to be filled with what was stored.
    pub const fn guard_mut(&mut self) -> &mut ReplayGuard<N> {
        &mut self.guard
    }

    /// The latest counter that is believed of a sender.
    fn latest(&self, sender: RobotId) -> u64 {
        let known = self.guard.newest(sender.0).unwrap_or(self.guard.floor());
        known.max(counter(self.epoch, 0)).saturating_add(counter(REACH_STARTS << WRAP_BITS, 0))
    }

    /// The first bytes of the code.
    fn code(&self, content: &[u8], epoch: [u8; EPOCH_LEN]) -> [u8; TAG_LEN - EPOCH_LEN] {
        let [a, b, c, d, ..] = self.mac.of(&[content, &epoch]);
        [a, b, c, d]
    }
}

/// The first epoch of a start.
const fn epoch_of(starts: u32) -> Option<u32> {
    if starts >> (u32::BITS - WRAP_BITS) == 0 { Some(starts << WRAP_BITS) } else { None }
}

/// What never comes twice.
const fn counter(epoch: u32, sequence: u16) -> u64 {
    (epoch as u64) << u16::BITS | sequence as u64
}

impl<const N: usize> Wire for Sealed<N> {
    fn beacon_len(&self) -> usize {
        Beacon::MAX_FRAME_LEN
    }

    /// Also [`EncodeError::Exhausted`] when the sequence has wrapped 4095 times since the start.
    fn encode<const M: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, M>,
    ) -> Result<usize, EncodeError> {
        let has_wrapped = header.sequence < self.last;
        let epoch = self.epoch.wrapping_add(has_wrapped.into());
        if has_wrapped && epoch & ((1 << WRAP_BITS) - 1) == 0 {
            return Err(EncodeError::Exhausted);
        }
        let seal = |content: &[u8]| {
            let epoch = epoch.to_le_bytes();
            let ([a, b, c, d], [e, f, g, h]) = (epoch, self.code(content, epoch));
            [a, b, c, d, e, f, g, h]
        };
        let len = encode_tagged(header, message, seal, out)?;
        (self.epoch, self.last) = (epoch, header.sequence);
        Ok(len)
    }

    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        let mut epoch = 0;
        let frame = decode_verified(frame, |content, tag| {
            let [a, b, c, d, code @ ..] = tag.ok_or(DecodeError::Unsigned)?;
            let bytes = [a, b, c, d];
            epoch = u32::from_le_bytes(bytes);
            if is_same(&self.code(content, bytes), &code) { Ok(()) } else { Err(DecodeError::Forged) }
        })?;
        let Header { sender, sequence, .. } = frame.header;
        let counted = counter(epoch, sequence);
        if counted > self.latest(sender) {
            return Err(DecodeError::Ahead);
        }
        match self.guard.admit(sender.0, counted) {
            Freshness::New | Freshness::Late => Ok(frame),
            Freshness::Replayed => Err(DecodeError::Replayed),
            Freshness::NoRoom => Err(DecodeError::NoRoom),
        }
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        Postcard.next_frame(rest)
    }
}

#[cfg(test)]
mod tests;
