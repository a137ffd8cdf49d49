//! Frames with authentication and replay protection: [`Sealed`].

use super::frame::{decode_verified, encode_tagged};
use super::{
    Beacon, DecodeError, EncodeError, Frame, Header, KeyPhase, Message, Postcard, Ring, Signer, TAG_LEN, Wire,
};
use crate::auth::{Freshness, Key, Mac, ReplayGuard, is_same};
use crate::robot::RobotId;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Default number of senders that a [`Sealed`] can track.
pub const PEERS: usize = 64;

/// 268 million numbers per start. A robot takes two for a beacon: 15 days at 100 beacons a second.
const WRAP_BITS: u32 = 12;
const EPOCH_LEN: usize = 4;
/// Largest accepted lead of a sender, in starts over its latest known start: see [`Sealed`].
pub const REACH_STARTS: u32 = 1024;

/// The frames of [`Postcard`], with a tag and with replay protection.
///
/// ```text
/// tag  = epoch:u32 code:4
/// code = the first 4 bytes of HMAC-SHA256(key, version .. message, epoch)
/// ```
///
/// The cost is 8 bytes and one [`Mac::of`] per frame; `cargo xtask size` prints its run time on
/// each part. Serde serializes the whole state, including the key; digests omit the key.
///
/// # Threat model
///
/// - **Forgery.** Without the key, an attacker can neither create nor modify a frame. A guessed
///   code is right once in 2^32 tries: on a radio that takes 500 frames per second, one forged
///   frame per 99 days, which could also lock out the true sender (below). MAVLink signatures have
///   48 bits.
/// - **Replay.** A recorded frame is rejected because its counter (epoch and sequence together) was
///   received before: see [`ReplayGuard`].
/// - **Not covered.** All robots share the key, so a captured robot can impersonate all others.
///   Frames are not encrypted. No code protects against jamming.
/// - **Delay.** A frame that the receiver has not heard can be repeated later. Its number tells how
///   old it is at least, if the receiver knows an earlier frame of its sender
///   ([`SequenceWindow::periods`](super::SequenceWindow::periods)); of the first one it does not.
///
/// # Counters too far ahead
///
/// A frame with a later counter locks its sender out at each receiver that accepts it. A recording
/// of such a frame can be replayed after each restart, without the key. Therefore a frame is
/// rejected, without any effect, if it is more than [`REACH_STARTS`] starts ahead of the latest of
/// three numbers: the last frame of its sender, the receiver's own start, and
/// [`Self::refuse_before`].
///
/// Remaining risk: an attacker with the key can lock a sender out for up to that many of its
/// starts. To make such recordings worthless, increase the sender's start number by
/// [`REACH_STARTS`]. A robot that is started more often than that on its own cannot communicate
/// with the others until their start numbers are aligned again.
///
/// # Counting the starts
///
/// A robot must never send two messages with the same counter. Therefore persistent memory holds
/// the count of starts. At each start, *before the first frame*: read it (0 if it was never
/// written), store it plus 1, and pass the number read to [`Self::at_start`].
///
/// If the memory is lost, robots that know this robot reject it as a replay until its number
/// exceeds the last one. Set the number above any previous value, or give the swarm a new key;
/// numbers may then restart at 0.
///
/// An operator that starts all robots with one increasing number (that of the mission) can also
/// pass it to [`Self::refuse_before`]: then even receivers that lost their memory reject frames of
/// earlier missions. [`ReplayGuard::export`] through [`Self::guard`] gives what else can survive a
/// restart.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Sealed<const N: usize = PEERS> {
    ring: Ring,
    /// The robot's number if it has a key of its own.
    own: RobotId,
    epochs: Epochs,
    guard: ReplayGuard<N>,
}

impl<const N: usize> Sealed<N> {
    /// Creates the format for a robot with one key at its start number `starts`, below 2^20.
    #[must_use]
    pub fn at_start(key: &Key, starts: u32) -> Option<Self> {
        Self::with_ring(Ring::new(key), RobotId::NONE, starts)
    }

    /// Creates the format for robot `own` with the keys in `ring`, at its start number `starts`;
    /// `None` from 2^20 on.
    ///
    /// A robot with an own key accepts orders ([`Message::is_order`]) and keys only if they are
    /// made with that key, and reports frames made with another own key as foreign.
    #[must_use]
    pub fn with_ring(ring: Ring, own: RobotId, starts: u32) -> Option<Self> {
        Some(Self { ring, own, epochs: Epochs::at_start(starts)?, guard: ReplayGuard::new() })
    }

    /// The robot's keys.
    #[must_use]
    pub const fn ring(&self) -> &Ring {
        &self.ring
    }

    /// Mutable access to the keys, for changes by other means than the radio.
    pub const fn ring_mut(&mut self) -> &mut Ring {
        &mut self.ring
    }

    /// Rejects frames of unknown robots from before their start number `starts`, if below 2^20.
    pub fn refuse_before(&mut self, starts: u32) {
        if let Some(epoch) = epoch_of(starts) {
            self.guard.set_floor(domain(Signer::Swarm(self.ring.generation())) | counter(epoch, 0));
        }
    }

    /// The counters of other robots, to be stored.
    #[must_use]
    pub const fn guard(&self) -> &ReplayGuard<N> {
        &self.guard
    }

    /// Mutable access to the counters of other robots, to restore them.
    pub const fn guard_mut(&mut self) -> &mut ReplayGuard<N> {
        &mut self.guard
    }

    fn latest(&self, sender: RobotId) -> u64 {
        let known = self.guard.newest(sender.0).unwrap_or(self.guard.floor()) & COUNTED;
        known.max(counter(self.epochs.epoch, 0)).saturating_add(counter(REACH_STARTS << WRAP_BITS, 0))
    }

    fn judge(&self, frame: &Frame, signer: Option<Signer>) -> Result<Signer, DecodeError> {
        let own = self.ring.own();
        let is_elses = frame.message.addressee().is_some_and(|to| to != self.own);
        match signer {
            Some(Signer::Swarm(_)) if own.is_some() && frame.message.is_order() => Err(DecodeError::Forged),
            Some(signer) => Ok(signer),
            None if own.is_some() && is_elses => Err(DecodeError::Foreign),
            None => Err(DecodeError::Forged),
        }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Epochs {
    epoch: u32,
    last: u16,
}

impl Epochs {
    pub(super) fn at_start(starts: u32) -> Option<Self> {
        Some(Self { epoch: epoch_of(starts)?, last: 0 })
    }

    /// Returns [`EncodeError::Exhausted`] if the sequence has wrapped 4095 times since the start.
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

pub(super) fn code(mac: &Mac, content: &[u8], epoch: [u8; EPOCH_LEN]) -> [u8; TAG_LEN - EPOCH_LEN] {
    let [a, b, c, d, ..] = mac.of(&[content, &epoch]);
    [a, b, c, d]
}

const fn epoch_of(starts: u32) -> Option<u32> {
    if starts >> (u32::BITS - WRAP_BITS) == 0 { Some(starts << WRAP_BITS) } else { None }
}

/// The bits that the sender counts. Those above hold the generation of the key, so frames of an
/// earlier key are never fresh, and an attacker cannot use up the counters of a key that it lacks.
const COUNTED: u64 = (1 << 48) - 1;

const fn domain(signer: Signer) -> u64 {
    let number = match signer {
        Signer::Swarm(generation) => generation,
        Signer::Operator => u16::MAX,
    };
    (number as u64) << 48
}

pub(super) const fn counter(epoch: u32, sequence: u16) -> u64 {
    (epoch as u64) << u16::BITS | sequence as u64
}

impl<const N: usize> Wire for Sealed<N> {
    fn beacon_len(&self) -> usize {
        Beacon::MAX_FRAME_LEN
    }

    /// Also fails if the sequence has wrapped 4095 times since the start.
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

    /// Decodes a frame and takes over a key that it assigns. One [`Mac::of`] if the sender uses the
    /// same key, otherwise up to three; twelve blocks of SHA-256 for a key assignment.
    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        let (mut epoch, mut signer) = (0, None);
        let frame = decode_verified(frame, |content, tag| {
            let [a, b, c, d, sent @ ..] = tag.ok_or(DecodeError::Unsigned)?;
            let bytes = [a, b, c, d];
            epoch = u32::from_le_bytes(bytes);
            signer = self.ring.signer(|mac| is_same(&code(mac, content, bytes), &sent));
            // The addressee is part of the content that cannot be verified here.
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

    fn is_authenticated(&self) -> bool {
        true
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
