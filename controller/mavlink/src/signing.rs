//! MAVLink 2 signatures: who has the key is heard, everybody else is not. Read [`Signing`] first.
//!
//! The signature is the first 48 bits of SHA-256 over key, frame with checksum, link id and timestamp; 13 bytes with these two. Whoever
//! guesses is right once in 2^48 tries. See "Message Signing" in MAVLink's guide; pymavlink and MAVProxy do the same.

use crate::frame::{CRC, RawFrame, SIGNATURE_LEN};
use serde::{Deserialize, Serialize};
use staya_controller::auth::{Freshness, Key, ReplayGuard, Sha256, is_same};

/// Senders that a [`Signing`] of default capacity knows.
pub const STREAMS: usize = 64;
/// A minute of timestamps, which count tens of microseconds.
pub const MINUTE: u64 = 6_000_000;
/// Thirty days of timestamps.
pub const MONTH: u64 = 30 * 24 * 60 * MINUTE;
/// What begins with timestamp 0: the first second of 2015 (UTC), in seconds after that of 1970.
pub const EPOCH_UNIX_S: u64 = 1_420_070_400;

/// Timestamps have 48 bits.
const LAST_TIMESTAMP: u64 = (1 << 48) - 1;
const START_V2: u8 = 0xFD;
/// Incompatibility flag: a signature follows the checksum.
const SIGNED: u8 = 1;
/// Bytes of a header before the payload.
const HEADER: usize = 10;

/// Why a frame was not signed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SignError {
    /// It is no whole MAVLink 2 frame without a signature.
    NotAFrame,
    /// No timestamp is left: 89 years are over, or somebody with the key claimed so.
    Exhausted,
}

impl core::fmt::Display for SignError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotAFrame => "no whole MAVLink 2 frame without a signature",
            Self::Exhausted => "no timestamp is left to sign with; give the link a new key",
        })
    }
}

impl core::error::Error for SignError {}

/// What a frame is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Verdict {
    /// Signed with the key, and not seen before.
    Authentic,
    /// Not signed: to be dropped.
    Unsigned,
    /// Signed with another key, or changed on the way: to be dropped.
    Forged,
    /// Signed with the key, but seen before or too old: to be dropped.
    Replayed,
    /// Signed with the key, but of a time too far ahead: to be dropped. See [`Signing::with_lead`].
    Ahead,
    /// From a sender that is not known and for whom there is no room: to be dropped.
    NoRoom,
}

impl Verdict {
    /// Whether the frame is to be heard.
    #[must_use]
    pub const fn is_accepted(self) -> bool {
        matches!(self, Self::Authentic)
    }
}

/// How many frames were what; counts stay at their end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// [`Verdict::Authentic`].
    pub authentic: u32,
    /// [`Verdict::Unsigned`].
    pub unsigned: u32,
    /// [`Verdict::Forged`].
    pub forged: u32,
    /// [`Verdict::Replayed`].
    pub replayed: u32,
    /// [`Verdict::Ahead`].
    pub ahead: u32,
    /// [`Verdict::NoRoom`].
    pub no_room: u32,
}

impl Counts {
    /// Frames that were to be dropped.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        let of_key = self.replayed.saturating_add(self.ahead).saturating_add(self.no_room);
        self.unsigned.saturating_add(self.forged).saturating_add(of_key)
    }

    fn count(&mut self, verdict: Verdict) {
        let count = match verdict {
            Verdict::Authentic => &mut self.authentic,
            Verdict::Unsigned => &mut self.unsigned,
            Verdict::Forged => &mut self.forged,
            Verdict::Replayed => &mut self.replayed,
            Verdict::Ahead => &mut self.ahead,
            Verdict::NoRoom => &mut self.no_room,
        };
        *count = count.saturating_add(1);
    }
}

/// Signs what one end of a link sends, and checks what it receives from up to `N` senders.
///
/// # Timestamps
///
/// Each signed frame has a timestamp, 10 us since 2015, greater than all before it of the same system, component and link id. It
/// goes up by at least 1 per frame, and never falls behind what was accepted: so a swarm without clocks agrees on one.
///
/// - **With a clock:** give the time to [`Self::new`], and from time to time (once a second will do) to [`Self::advance_to`].
/// - **Without:** the first timestamp comes with the key, as in MAVLink's SETUP_SIGNING. Store [`Self::timestamp`] in lasting memory at least once a
///   minute, and start with what is stored plus [`MINUTE`]. A robot that starts with an older one is not heard (pymavlink, Staya and autopilots alike)
///   until it has caught up, which it does with the first frame of somebody else that it accepts; robots that all forgot theirs hear each other, but
///   not who still knows.
///
/// # What is accepted
///
/// A frame with the right signature is fresh when its timestamp is greater than all of its stream (system, component, link id), or at most 31 behind
/// and not seen before: a counter's frames may overtake each other, as with [`ReplayGuard`]; with a clock 31 are a third of a millisecond. A stream's
/// first frame must not be more than [`MINUTE`] older than the newest timestamp known. So after a restart with a proper timestamp at
/// most the last minute can be replayed, and only of who has not been heard since. A full table refuses new streams.
///
/// # What is too far ahead
///
/// MAVLink's own rule has no bound upwards: whoever signs one frame with the last timestamp there is mutes all that hear it, since they have none
/// left, and shuts its stream out; and whoever has recorded that frame does so again after each restart, without the key. So a frame is refused as
/// [`Verdict::Ahead`], and leaves no trace, when it is more than [`MINUTE`] ahead of the clock, or, for who was never told the time, more than
/// [`MONTH`] ahead of the own timestamp; [`Self::with_lead`] sets another bound. A robot without a clock that was off for longer than that, among others
/// that have one, hears none of them until its owner tells it the time. To exhaust it takes a thousand frames, each a month ahead of the last, all signed
/// with the key.
///
/// Serde sees the whole state, the key included; digests do not count the key.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Signing<const N: usize = STREAMS> {
    #[serde(with = "staya_controller::digest::uncounted")]
    key: Key,
    /// The key before or after it, while it changes.
    #[serde(with = "staya_controller::digest::uncounted")]
    also: Option<Key>,
    link: u8,
    /// Of the next frame.
    timestamp: u64,
    /// What the clock showed last, if there is one.
    clock: Option<u64>,
    lead: Option<u64>,
    streams: ReplayGuard<N>,
    counts: Counts,
}

impl<const N: usize> Signing<N> {
    /// With this key, as link number `link` of its system, from this timestamp on.
    #[must_use]
    pub const fn new(key: Key, link: u8, timestamp: u64) -> Self {
        Self {
            key,
            also: None,
            link,
            timestamp,
            clock: None,
            lead: None,
            streams: ReplayGuard::new(),
            counts: Counts { authentic: 0, unsigned: 0, forged: 0, replayed: 0, ahead: 0, no_room: 0 },
        }
    }

    /// The same, but frames may be so far ahead of the clock, or without one of the own timestamp: tens of microseconds, by default [`MINUTE`] and
    /// [`MONTH`]. A shorter lead refuses who has another time; a longer one lets who has the key, or a recording of his frames, take more of the
    /// timestamps that are left.
    #[must_use]
    pub const fn with_lead(mut self, lead: u64) -> Self {
        self.lead = Some(lead);
        self
    }

    /// From now on frames that are signed with this key are authentic too; one at most, besides that which signs.
    pub fn hear(&mut self, key: Key) {
        self.also = Some(key);
    }

    /// Signs with the key of [`Self::hear`] from now on, and goes on hearing the one before.
    pub const fn speak(&mut self) {
        if let Some(also) = &mut self.also {
            core::mem::swap(also, &mut self.key);
        }
    }

    /// Does not hear the key any more that it does not sign with.
    pub fn forget(&mut self) {
        self.also = None;
    }

    /// How many more frames can be signed at this timestamp. 0: [`SignError::Exhausted`].
    #[must_use]
    pub const fn left(&self) -> u64 {
        (LAST_TIMESTAMP + 1).saturating_sub(self.timestamp)
    }

    /// The timestamp of the next frame: what to store.
    #[must_use]
    pub const fn timestamp(&self) -> u64 {
        self.timestamp
    }

    /// Says what time it is, for who has a clock; 0, the time of a clock that was never set, changes nothing. The timestamp never goes back.
    pub const fn advance_to(&mut self, time: u64) {
        if time > 0 {
            self.clock = Some(time);
            self.follow(time);
        }
    }

    const fn follow(&mut self, timestamp: u64) {
        if timestamp > self.timestamp {
            self.timestamp = timestamp;
        }
    }

    /// The latest timestamp that is believed.
    fn latest(&self) -> u64 {
        let (base, lead) = self.clock.map_or((self.timestamp, MONTH), |clock| (clock, MINUTE));
        base.saturating_add(self.lead.unwrap_or(lead))
    }

    /// How many frames were what so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Makes a signed frame of one that is not: changes its flags and checksum in place, and returns what must be appended to it.
    ///
    /// # Errors
    /// See [`SignError`]; the frame is as it was.
    ///
    /// Bounded work: SHA-256 over at most 307 bytes.
    #[expect(clippy::arithmetic_side_effects, reason = "10, 255 and 2")]
    pub fn sign(&mut self, frame: &mut [u8]) -> Result<[u8; SIGNATURE_LEN], SignError> {
        let total = frame.len();
        let [START_V2, len, flags, .., low, high] = &mut *frame else {
            return Err(SignError::NotAFrame);
        };
        if *flags != 0 || total != HEADER + usize::from(*len) + 2 {
            return Err(SignError::NotAFrame);
        }
        if self.timestamp > LAST_TIMESTAMP {
            return Err(SignError::Exhausted);
        }
        let checksum = u16::from_le_bytes([*low, *high]) ^ flag_in_checksum(*len);
        *flags = SIGNED;
        [*low, *high] = checksum.to_le_bytes();
        let [a, b, c, d, e, f, _, _] = self.timestamp.to_le_bytes();
        self.timestamp = self.timestamp.saturating_add(1);
        let stamp = [self.link, a, b, c, d, e, f];
        let [p, q, r, s, t, u] = value_of(&self.key, frame, &stamp);
        Ok([self.link, a, b, c, d, e, f, p, q, r, s, t, u])
    }

    /// Judges a frame, counts it, and remembers it if it is authentic.
    ///
    /// Bounded work: SHA-256 over at most 307 bytes, twice while the key changes, and O(N).
    pub fn verify(&mut self, frame: &RawFrame<'_>) -> Verdict {
        let verdict = self.judge(frame);
        self.counts.count(verdict);
        verdict
    }

    fn judge(&mut self, frame: &RawFrame<'_>) -> Verdict {
        let (Some(signature), Some((signed, _))) =
            (frame.signature(), frame.bytes().split_last_chunk::<SIGNATURE_LEN>())
        else {
            return Verdict::Unsigned;
        };
        let &[link, a, b, c, d, e, f, ref value @ ..] = signature;
        let stamp = [link, a, b, c, d, e, f];
        let is_of = |key: &Key| is_same(&value_of(key, signed, &stamp), value);
        if !is_of(&self.key) && !self.also.as_ref().is_some_and(is_of) {
            return Verdict::Forged;
        }
        let timestamp = u64::from_le_bytes([a, b, c, d, e, f, 0, 0]);
        if timestamp > self.latest() {
            return Verdict::Ahead;
        }
        let sender = frame.sender();
        let stream = u32::from_le_bytes([sender.system, sender.component, link, 0]);
        let is_old = timestamp.saturating_add(MINUTE) < self.timestamp;
        if is_old && !self.streams.knows(stream) {
            return Verdict::Replayed;
        }
        match self.streams.admit(stream, timestamp) {
            Freshness::New | Freshness::Late => {
                self.follow(timestamp);
                Verdict::Authentic
            }
            Freshness::Replayed => Verdict::Replayed,
            Freshness::NoRoom => Verdict::NoRoom,
        }
    }
}

/// The value of a signature of these bytes.
fn value_of(key: &Key, frame: &[u8], stamp: &[u8; 7]) -> [u8; 6] {
    let mut hash = Sha256::new();
    hash.update(key.as_bytes());
    hash.update(frame);
    hash.update(stamp);
    let [a, b, c, d, e, f, ..] = hash.finish();
    [a, b, c, d, e, f]
}

/// How the checksum of a frame with `len` bytes of payload changes when its flag is set. A checksum is linear in the bits that it covers, so this needs
/// neither them nor the message's definition.
#[expect(clippy::arithmetic_side_effects, reason = "10 less 3, 255 and 1")]
fn flag_in_checksum(len: u8) -> u16 {
    let mut digest = CRC.digest_with_initial(0);
    digest.update(&[SIGNED]);
    // The rest of the header, the payload, and what the definition adds.
    for _ in 0..HEADER - 3 + usize::from(len) + 1 {
        digest.update(&[0]);
    }
    digest.finalize()
}

#[cfg(test)]
mod tests;
