//! Frames that only who has the key can make, and nobody can repeat: [`Sealed`].

use super::frame::{decode_verified, encode_tagged};
use super::{
    Beacon, DecodeError, EncodeError, Frame, Header, KeyPhase, Message, Postcard, Ring, Signer, TAG_LEN, Wire,
};
use crate::auth::{Freshness, Key, Mac, ReplayGuard, is_same};
use crate::robot::RobotId;
use heapless::Vec;
use serde::{Deserialize, Serialize};

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
/// Serde sees the whole state, the key included; digests do not count the key.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Sealed<const N: usize = PEERS> {
    ring: Ring,
    /// The own number, where the robot has a key of its own.
    own: RobotId,
    epochs: Epochs,
    guard: ReplayGuard<N>,
}

impl<const N: usize> Sealed<N> {
    /// For a robot at its start number `starts`, counted in lasting memory from 0; `None` from 2^20 on.
    #[must_use]
    pub fn at_start(key: &Key, starts: u32) -> Option<Self> {
        Self::with_ring(Ring::new(key), RobotId::NOBODY, starts)
    }

    /// The same for robot `own` with these keys. If one of them is its own, it takes orders ([`Message::is_order`]) and keys from nobody but who has that, and
    /// hears what others say to each other under theirs as somebody else's.
    #[must_use]
    pub fn with_ring(ring: Ring, own: RobotId, starts: u32) -> Option<Self> {
        Some(Self { ring, own, epochs: Epochs::at_start(starts)?, guard: ReplayGuard::new() })
    }

    /// The keys that it has.
    #[must_use]
    pub const fn ring(&self) -> &Ring {
        &self.ring
    }

    /// The same, for hosts that change them by other ways than the radio.
    pub const fn ring_mut(&mut self) -> &mut Ring {
        &mut self.ring
    }

    /// Refuses frames of unknown robots from before their start number `starts`. From 2^20 on nothing changes.
    pub fn refuse_before(&mut self, starts: u32) {
        if let Some(epoch) = epoch_of(starts) {
            self.guard.set_floor(domain(Signer::Swarm(self.ring.generation())) | counter(epoch, 0));
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

    /// The latest counter that is believed of a sender, whatever the key.
    fn latest(&self, sender: RobotId) -> u64 {
        let known = self.guard.newest(sender.0).unwrap_or(self.guard.floor()) & COUNTED;
        known.max(counter(self.epochs.epoch, 0)).saturating_add(counter(REACH_STARTS << WRAP_BITS, 0))
    }

    /// Whether somebody who has the key by which it was made may say this, to this robot.
    fn judge(&self, frame: &Frame, signer: Option<Signer>) -> Result<Signer, DecodeError> {
        let own = self.ring.own();
        let is_elses = frame.message.addressee().is_some_and(|to| to != self.own);
        match signer {
            Some(Signer::Swarm(_)) if own.is_some() && frame.message.is_order() => Err(DecodeError::Forged),
            Some(signer) => Ok(signer),
            // Under somebody else's own key.
            None if own.is_some() && is_elses => Err(DecodeError::Foreign),
            None => Err(DecodeError::Forged),
        }
    }
}

/// The numbers under which frames are sealed: none comes twice.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Epochs {
    epoch: u32,
    /// The sequence number of the last frame.
    last: u16,
}

impl Epochs {
    /// `None` from 2^20 starts on.
    pub(super) fn at_start(starts: u32) -> Option<Self> {
        Some(Self { epoch: epoch_of(starts)?, last: 0 })
    }

    /// Appends a frame sealed with a key. Also [`EncodeError::Exhausted`] when the sequence has wrapped 4095 times since the start.
    pub(super) fn seal<const M: usize>(
        &mut self,
        mac: &Mac,
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
            let ([a, b, c, d], [e, f, g, h]) = (epoch, code(mac, content, epoch));
            [a, b, c, d, e, f, g, h]
        };
        let len = encode_tagged(header, message, seal, out)?;
        (self.epoch, self.last) = (epoch, header.sequence);
        Ok(len)
    }
}

/// The first bytes of the code.
pub(super) fn code(mac: &Mac, content: &[u8], epoch: [u8; EPOCH_LEN]) -> [u8; TAG_LEN - EPOCH_LEN] {
    let [a, b, c, d, ..] = mac.of(&[content, &epoch]);
    [a, b, c, d]
}

/// The first epoch of a start.
const fn epoch_of(starts: u32) -> Option<u32> {
    if starts >> (u32::BITS - WRAP_BITS) == 0 { Some(starts << WRAP_BITS) } else { None }
}

/// The part of a counter that a sender counts; above it is the generation of the key, so that nothing that was made with an earlier one is fresh after
/// it, and nobody can use up the numbers of a key that he does not have.
const COUNTED: u64 = (1 << 48) - 1;

/// What is counted above [`COUNTED`].
const fn domain(signer: Signer) -> u64 {
    let number = match signer {
        Signer::Swarm(generation) => generation,
        Signer::Operator => u16::MAX,
    };
    (number as u64) << 48
}

/// What never comes twice.
pub(super) const fn counter(epoch: u32, sequence: u16) -> u64 {
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
        let mac = match message {
            Message::KeyHeld(_) => self.ring.own().unwrap_or(self.ring.speaks()),
            _ => self.ring.speaks(),
        };
        self.epochs.seal(mac, header, message, out)
    }

    /// A key that it was sent is in use when the frame is returned. Bounded work: [`Mac::of`] once for who speaks the same key, up to three times else, and
    /// twelve blocks of SHA-256 for a key.
    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        let (mut epoch, mut signer) = (0, None);
        let frame = decode_verified(frame, |content, tag| {
            let [a, b, c, d, sent @ ..] = tag.ok_or(DecodeError::Unsigned)?;
            let bytes = [a, b, c, d];
            epoch = u32::from_le_bytes(bytes);
            signer = self.ring.signer(|mac| is_same(&code(mac, content, bytes), &sent));
            // Who it is for is said in what cannot be verified here.
            if signer.is_some() || self.ring.own().is_some() { Ok(()) } else { Err(DecodeError::Forged) }
        })?;
        let signer = self.judge(&frame, signer)?;
        let Header { sender, sequence, .. } = frame.header;
        let counted = counter(epoch, sequence);
        if counted > self.latest(sender) {
            return Err(DecodeError::Ahead);
        }
        match self.guard.admit(sender.0, domain(signer) | counted) {
            Freshness::New | Freshness::Late => {}
            Freshness::Replayed => return Err(DecodeError::Replayed),
            Freshness::NoRoom => return Err(DecodeError::NoRoom),
        }
        match &frame.message {
            Message::Key(told) if self.ring.own().is_some() && !self.ring.apply(told) => Err(DecodeError::Forged),
            _ => Ok(frame),
        }
    }

    fn held(&self) -> Option<(u16, KeyPhase)> {
        self.ring.own().map(|_| self.ring.held())
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        Postcard.next_frame(rest)
    }
}

#[cfg(test)]
mod tests;
