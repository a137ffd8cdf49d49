//! Sent messages of a law: each is resent until it is acknowledged, replaced or abandoned. The
//! receiving side is [`IncomingMessages`](super::IncomingMessages).

use super::{Ack, Addressed, Bytes, MAX_MESSAGE, ProtocolId};
use crate::list::SparseVec;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

const PURPOSE: u32 = u32::from_be_bytes(*b"rsnd");

/// How often and when a message is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Retry {
    /// Total number of sends; 0 counts as 1. With packet loss p, message or acknowledgement fails
    /// in all attempts with probability (1 - (1 - p)^2)^attempts: 4 % at p = 0.3 and 5 attempts.
    pub attempts: u8,
    /// Time between two sends, plus a random quarter at most, which prevents repeated collisions of
    /// two robots. It must exceed the round-trip time, or each message is sent twice.
    pub interval: Duration,
}

impl Default for Retry {
    fn default() -> Self {
        Self { attempts: 5, interval: Duration::from_millis(200) }
    }
}

/// Why a message was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SendError {
    /// The maximum number of messages is pending.
    Full,
    /// The addressee is [`RobotId::NONE`], which cannot acknowledge.
    NoAddressee,
}

impl core::fmt::Display for SendError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Full => "too many messages are pending; wait until some are acknowledged or expire",
            Self::NoAddressee => "the message has no addressee; robot numbers begin at 1",
        })
    }
}

impl core::error::Error for SendError {}

/// The next action of [`OutgoingMessages::poll`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "a message that is not sent counts as one lost in the air"]
pub enum Due {
    /// Send this message now; it counts as lost in transmission if it does not fit into the outbox.
    Send(Addressed),
    /// No acknowledgement arrived from this robot in time; the message is dropped.
    Expired(RobotId),
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Pending {
    to: RobotId,
    subject: u32,
    due: Instant,
    expiry: Instant,
    valid: Duration,
    number: u8,
    sent: u8,
    protocol: ProtocolId,
    content: Bytes<MAX_MESSAGE>,
}

const _: () = assert!(size_of::<Pending>() == 36);

impl Pending {
    fn is_due(&self, retry: Retry, now: Instant) -> bool {
        let interval = retry.interval.as_micros();
        let longest = interval.saturating_add(interval >> 2);
        now.has_reached(self.due, Duration::from_micros(longest))
    }
}

/// The messages of one robot to others, at most `C` at a time; 36 bytes each. Pauses of any length
/// are allowed: see [`Instant::has_reached`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutgoingMessages<const C: usize> {
    pending: SparseVec<Pending, C>,
    retry: Retry,
    own: RobotId,
    boot: u8,
    next: u8,
}

impl<const C: usize> OutgoingMessages<C> {
    /// Half of the numbers are always free, so that messages remain distinguishable.
    const FITS: () = assert!(C <= 128, "at most 128 messages at a time");

    /// Sets the boot number that the robot's frames have from now on.
    pub const fn set_boot(&mut self, boot: u8) {
        self.boot = boot;
    }

    /// Creates a table without messages, for frames with this robot number and boot number.
    #[must_use]
    pub const fn new(own: RobotId, boot: u8, retry: Retry) -> Self {
        let () = Self::FITS;
        Self { pending: SparseVec::new(), retry, own, boot, next: 0 }
    }

    /// Adds a message to `to`; the next [`OutgoingMessages::poll`] sends it.
    ///
    /// A pending message to the same robot about the same subject is kept if it is identical, and
    /// replaced otherwise. The message is abandoned after `valid`, or the interval after the last
    /// send, but never before its first send. O(`C`).
    ///
    /// # Errors
    /// [`SendError::Full`] if `C` messages are pending, [`SendError::NoAddressee`] for
    /// [`RobotId::NONE`].
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn send(
        &mut self,
        to: RobotId,
        subject: u32,
        (protocol, content): (ProtocolId, &Bytes<MAX_MESSAGE>),
        valid: Duration,
        now: Instant,
    ) -> Result<(), SendError> {
        if !to.is_some() {
            return Err(SendError::NoAddressee);
        }
        let number = self.free_number();
        let expiry = now + valid;
        let content = content.clone();
        let new = Pending { to, subject, due: now, expiry, valid, number, sent: 0, protocol, content };
        let same_subject = |old: &&mut Pending| (old.to, old.protocol, old.subject) == (to, protocol, subject);
        match self.pending.iter_mut().find(same_subject) {
            Some(old) if old.content == new.content => return Ok(()),
            Some(old) => *old = new,
            None => self.pending.push(new).map_err(|_| SendError::Full)?,
        }
        self.next = number.wrapping_add(1);
        Ok(())
    }

    /// Returns the next action at `now`. Call it until it returns `None`, at most 2 `C` times if
    /// [`Retry::interval`] is above 0. O(`C`) each.
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn poll(&mut self, now: Instant) -> Option<Due> {
        let (retry, own) = (self.retry, self.own);
        let pending = self.pending.iter_mut().find(|pending| pending.is_due(retry, now))?;
        let (to, number) = (pending.to, pending.number);
        let is_over = pending.sent >= retry.attempts || now.has_reached(pending.expiry, pending.valid);
        if pending.sent > 0 && is_over {
            self.remove(number);
            return Some(Due::Expired(to));
        }
        pending.sent = pending.sent.saturating_add(1);
        let again = now + retry.interval + jitter(retry, own, number, pending.sent);
        pending.due = if again.is_before(pending.expiry) { again } else { pending.expiry };
        let content = Bytes::from_slice(&pending.content).unwrap_or_default();
        Some(Due::Send(Addressed { to, number, protocol: pending.protocol, content }))
    }

    /// When [`OutgoingMessages::poll`] will have an action, seen from `now`; `None` without
    /// messages.
    #[must_use]
    pub fn poll_at(&self, now: Instant) -> Option<Instant> {
        self.pending
            .iter()
            .map(|pending| {
                // After a long pause a due time may only seem to lie ahead.
                let has_come = pending.is_due(self.retry, now) && now.is_before(pending.due);
                if has_come { now } else { pending.due }
            })
            .min_by_key(|due| due.since(now))
    }

    /// Processes an acknowledgement by `from`. Returns whether it ends a message. O(`C`).
    pub fn acknowledged(&mut self, from: RobotId, ack: &Ack) -> bool {
        let &Ack { to, boot, number } = ack;
        let is_known = |pending: &Pending| (pending.to, pending.number) == (from, number);
        let ends = (to, boot) == (self.own, self.boot) && self.pending.iter().any(is_known);
        if ends {
            self.remove(number);
        }
        ends
    }

    /// The number of pending messages.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pending.len()
    }

    /// Whether no message is pending.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pending.is_empty()
    }

    fn remove(&mut self, number: u8) {
        self.pending.retain(|pending| pending.number != number);
    }

    fn free_number(&self) -> u8 {
        let mut number = self.next;
        // As many steps as there are messages skip all of their numbers.
        for _ in &self.pending {
            if self.pending.iter().all(|pending| pending.number != number) {
                break;
            }
            number = number.wrapping_add(1);
        }
        number
    }
}

/// Up to a quarter of the interval; a function of robot, message and number of sends.
fn jitter(retry: Retry, own: RobotId, number: u8, sent: u8) -> Duration {
    let quarter = (retry.interval.as_micros() >> 2).max(0);
    let send = u32::from_be_bytes([0, 0, number, sent]);
    let drawn = Rng::keyed(0, PURPOSE, own.0, send).below(quarter.cast_unsigned());
    Duration::from_micros(drawn.cast_signed())
}

#[cfg(test)]
mod tests;
