//! MAVLink 2 signatures: frames without the key are rejected. Start with [`Signing`].
//!
//! The signature is the first 48 bits of SHA-256 over key, frame with checksum, link id and
//! timestamp; 13 bytes including the last two. A guess is right once in 2^48 tries. See "Message
//! Signing" in MAVLink's guide; pymavlink and MAVProxy work the same way.

use crate::dialect::CRC;
use crate::frame::{RawFrame, SIGNATURE_LEN};
use serde::{Deserialize, Serialize};
use staya_controller::auth::{Freshness, Key, ReplayGuard, Sha256, is_same};

/// Default number of senders that a [`Signing`] can track.
pub const STREAMS: usize = 64;
/// A minute in timestamps, which count tens of microseconds.
pub const MINUTE: u64 = 6_000_000;
/// Thirty days in timestamps.
pub const MONTH: u64 = 30 * 24 * 60 * MINUTE;
/// The time of timestamp 0: the first second of 2015 (UTC), in seconds since 1970.
pub const EPOCH_UNIX_S: u64 = 1_420_070_400;

const LAST_TIMESTAMP: u64 = (1 << 48) - 1;
const START_V2: u8 = 0xFD;
const SIGNED: u8 = 1;
const HEADER: usize = 10;

/// Why a frame was not signed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SignError {
    /// It is not a whole unsigned MAVLink 2 frame.
    NotAFrame,
    /// No timestamp is left: 89 years are over, or a holder of the key claimed so.
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

/// The result of verifying a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Verdict {
    /// Signed with the key, and not received before.
    Authentic,
    /// Not signed: drop it.
    Unsigned,
    /// Signed with another key, or modified: drop it.
    Forged,
    /// Signed with the key, but received before or too old: drop it.
    Replayed,
    /// Signed with the key, but too far ahead in time: drop it. See [`Signing::with_lead`].
    Ahead,
    /// From an unknown sender while the table is full: drop it.
    NoRoom,
}

impl Verdict {
    /// Whether the frame may be processed.
    #[must_use]
    pub const fn is_accepted(self) -> bool {
        matches!(self, Self::Authentic)
    }
}

/// Number of frames per verdict; each saturates.
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
    /// Number of frames to drop.
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

/// Signs the frames of one end of a link, and verifies frames of up to `N` senders.
///
/// # Timestamps
///
/// A timestamp counts 10 us since 2015. That of a frame is greater than all before it of the same
/// system, component and link id. It increases by at least 1 per frame and never falls behind an
/// accepted one, so that a swarm without clocks agrees on a timestamp.
///
/// - **With a clock:** pass the time to [`Self::new`], and about once a second to
///   [`Self::advance_to`].
/// - **Without a clock:** the first timestamp comes with the key, as in MAVLink's SETUP_SIGNING.
///   Store [`Self::timestamp`] persistently at least once a minute, and start with the stored one
///   plus [`MINUTE`]. A robot with an older one is rejected, also by pymavlink and autopilots,
///   until it accepts a frame and thereby catches up. Robots that all lost their timestamp receive
///   each other, but robots that still know it reject them.
///
/// # Accepted frames
///
/// A correctly signed frame is fresh if its timestamp is greater than all of its stream (system,
/// component, link id), or at most 31 behind and not received before. So frames with counters may
/// overtake each other, as with [`ReplayGuard`]; with a clock, 31 is a third of a millisecond. The
/// first frame of a stream may be at most [`MINUTE`] older than the newest known timestamp, which
/// limits replays after a restart to the last minute and to senders not received since. A full
/// table refuses new streams.
///
/// # Timestamps too far ahead
///
/// MAVLink's own rule has no upper bound. One frame with the last possible timestamp would silence
/// all receivers, since they have no timestamps left, and lock its stream out; a recording of it
/// would do so after each restart, without the key. Therefore a frame is rejected as
/// [`Verdict::Ahead`], without any effect, if it is more than [`MINUTE`] ahead of the clock, or
/// more than [`MONTH`] ahead of the own timestamp if the time was never set. A robot without a
/// clock that was off for longer rejects all robots with one until its owner sets its time.
/// Exhausting the timestamps takes a thousand frames, each a month ahead of the last, all signed
/// with the key.
///
/// Serde serializes the whole state, including the key; digests omit the key.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Signing<const N: usize = STREAMS> {
    #[serde(with = "staya_controller::digest::uncounted")]
    key: Key,
    /// The previous or next key during a key change.
    #[serde(with = "staya_controller::digest::uncounted")]
    also: Option<Key>,
    link: u8,
    timestamp: u64,
    clock: Option<u64>,
    lead: Option<u64>,
    streams: ReplayGuard<N>,
    counts: Counts,
}

impl<const N: usize> Signing<N> {
    /// Creates a signer with this key as link number `link` of its system, from `timestamp` on.
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

    /// Sets how far frames may be ahead, in tens of microseconds: of the clock (default
    /// [`MINUTE`]), or of the own timestamp without a clock ([`MONTH`]). A short lead rejects
    /// robots with another time; with a long one, an attacker with the key or a recording can use
    /// up more timestamps.
    #[must_use]
    pub const fn with_lead(mut self, lead: u64) -> Self {
        self.lead = Some(lead);
        self
    }

    /// Also accepts frames signed with this key, besides the key for sending; at most one such key.
    pub fn hear(&mut self, key: Key) {
        self.also = Some(key);
    }

    /// Signs with the key of [`Self::hear`] from now on, and still accepts the previous one.
    pub const fn speak(&mut self) {
        if let Some(also) = &mut self.also {
            core::mem::swap(also, &mut self.key);
        }
    }

    /// Accepts only the key for sending from now on.
    pub fn forget(&mut self) {
        self.also = None;
    }

    /// How many more frames can be signed from the present timestamp. 0: [`SignError::Exhausted`].
    #[must_use]
    pub const fn left(&self) -> u64 {
        (LAST_TIMESTAMP + 1).saturating_sub(self.timestamp)
    }

    /// The timestamp of the next frame, for storing it.
    #[must_use]
    pub const fn timestamp(&self) -> u64 {
        self.timestamp
    }

    /// Sets the time; 0 (a clock that was never set) has no effect. The timestamp never decreases.
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

    fn latest(&self) -> u64 {
        let (base, lead) = self.clock.map_or((self.timestamp, MONTH), |clock| (clock, MINUTE));
        base.saturating_add(self.lead.unwrap_or(lead))
    }

    /// Number of frames per verdict so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Signs an unsigned frame: changes its flags and checksum in place, and returns the signature
    /// to append. Bounded work: SHA-256 over at most 307 bytes.
    ///
    /// # Errors
    /// See [`SignError`]; the frame is then unchanged.
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

    /// Verifies and counts a frame, and records it if it is authentic. Bounded work: O(N), and
    /// SHA-256 over at most 307 bytes, twice during a key change.
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

fn value_of(key: &Key, frame: &[u8], stamp: &[u8; 7]) -> [u8; 6] {
    let mut hash = Sha256::new();
    hash.update(key.as_bytes());
    hash.update(frame);
    hash.update(stamp);
    let [a, b, c, d, e, f, ..] = hash.finish();
    [a, b, c, d, e, f]
}

/// How the checksum of a frame with `len` bytes of payload changes when its flag is set. A checksum
/// is linear in the bits that it covers, so this needs neither them nor the message's definition.
#[expect(clippy::arithmetic_side_effects, reason = "10 less 3, 255 and 1")]
fn flag_in_checksum(len: u8) -> u16 {
    let mut digest = CRC.digest_with_initial(0);
    digest.update(&[SIGNED]);
    // The rest of the header, the payload, and the extra byte of the definition.
    for _ in 0..HEADER - 3 + usize::from(len) + 1 {
        digest.update(&[0]);
    }
    digest.finalize()
}

#[cfg(test)]
mod tests;
