//! Sent requests (A. V. Kuznetsov 2017, KUZ, section 7): each is resent until it is acknowledged,
//! replaced or abandoned. The receiving side is [`Orders`](super::Orders).

use super::{Ack, Request, RequestKind};
use crate::list::SparseVec;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

const PURPOSE: u32 = u32::from_be_bytes(*b"rsnd");

impl RequestKind {
    /// Whether it concerns stopping. Of `Stop` and `Resume` the newer one cancels the older one.
    #[must_use]
    pub const fn is_standing(self) -> bool {
        matches!(self, Self::Stop | Self::Resume)
    }
}

/// How often and when a request is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Retry {
    /// Total number of sends; 0 counts as 1. With packet loss p, request or acknowledgement fails
    /// in all attempts with probability (1 - (1 - p)^2)^attempts: 4 % at p = 0.3 and 5 attempts.
    pub attempts: u8,
    /// Time between two sends, plus a random quarter at most, which prevents repeated collisions of
    /// two robots. It must exceed the round-trip time, or each request is sent twice.
    pub interval: Duration,
}

impl Default for Retry {
    fn default() -> Self {
        Self { attempts: 5, interval: Duration::from_millis(200) }
    }
}

/// Why a request was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AskError {
    /// The maximum number of requests is pending.
    Full,
    /// The addressee is [`RobotId::NONE`], which cannot acknowledge.
    NoAddressee,
}

impl core::fmt::Display for AskError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Full => "too many requests are pending; wait until some are acknowledged or expire",
            Self::NoAddressee => "the request has no addressee; robot numbers begin at 1",
        })
    }
}

impl core::error::Error for AskError {}

/// The next action of [`Requests::poll`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "a request that is not sent counts as one lost in the air"]
pub enum Due {
    /// Send this request now; it counts as lost in transmission if it does not fit into the outbox.
    Send(Request),
    /// No acknowledgement arrived in time; the request is dropped.
    Expired(Request),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Pending {
    request: Request,
    sent: u8,
    due: Instant,
    expiry: Instant,
}

const _: () = assert!(size_of::<Pending>() == 24);

impl Pending {
    fn is_due(&self, retry: Retry, now: Instant) -> bool {
        let interval = retry.interval.as_micros();
        let longest = interval.saturating_add(interval >> 2);
        now.has_reached(self.due, Duration::from_micros(longest))
    }
}

/// The requests of one robot to others, at most `P` at a time; 24 bytes each. Pauses of any length
/// are allowed: see [`Instant::has_reached`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Requests<const P: usize> {
    pending: SparseVec<Pending, P>,
    retry: Retry,
    own: RobotId,
    boot: u8,
    next: u8,
}

impl<const P: usize> Requests<P> {
    /// Half of the numbers are always free, so that requests remain distinguishable.
    const FITS: () = assert!(P <= 128, "at most 128 requests at a time");

    /// Sets the boot number that the robot's frames have from now on.
    pub const fn set_boot(&mut self, boot: u8) {
        self.boot = boot;
    }

    /// Creates a table without requests, for frames with this robot number and boot number.
    #[must_use]
    pub const fn new(own: RobotId, boot: u8, retry: Retry) -> Self {
        let () = Self::FITS;
        Self { pending: SparseVec::new(), retry, own, boot, next: 0 }
    }

    /// Adds a request to `to` and returns its number; the next [`Requests::poll`] sends it.
    ///
    /// `origin` is this robot, or the follower whose request it passes on. A pending request with
    /// the same addressee and origin is kept if it is identical (its number is returned), and
    /// replaced if it is the opposite. The request is abandoned after `valid_ms`, or the interval
    /// after the last send, but never before its first send.
    ///
    /// # Errors
    /// [`AskError::Full`] if `P` requests are pending, [`AskError::NoAddressee`] for
    /// [`RobotId::NONE`].
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn ask(
        &mut self,
        to: RobotId,
        origin: RobotId,
        kind: RequestKind,
        valid_ms: u16,
        now: Instant,
    ) -> Result<u8, AskError> {
        if !to.is_some() {
            return Err(AskError::NoAddressee);
        }
        let number = self.free_number();
        let new = Pending {
            request: Request { to, origin, number, kind, valid_ms },
            sent: 0,
            due: now,
            expiry: now + Duration::from_millis(valid_ms.into()),
        };
        let same_matter = |p: &&mut Pending| {
            let old = p.request;
            old.to == to && old.origin == origin && old.kind.is_standing() == kind.is_standing()
        };
        match self.pending.iter_mut().find(same_matter) {
            Some(old) if old.request.kind == kind => return Ok(old.request.number),
            Some(old) => *old = new,
            None => self.pending.push(new).map_err(|_| AskError::Full)?,
        }
        self.next = number.wrapping_add(1);
        Ok(number)
    }

    /// Returns the next action at `now`. Call it until it returns `None`, at most 2 `P` times if
    /// [`Retry::interval`] is above 0. O(`P`) each.
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn poll(&mut self, now: Instant) -> Option<Due> {
        let retry = self.retry;
        let pending = self.pending.iter_mut().find(|pending| pending.is_due(retry, now))?;
        let request = pending.request;
        let valid = Duration::from_millis(request.valid_ms.into());
        let is_over = pending.sent >= retry.attempts || now.has_reached(pending.expiry, valid);
        if pending.sent > 0 && is_over {
            self.remove(request.number);
            return Some(Due::Expired(request));
        }
        pending.sent = pending.sent.saturating_add(1);
        let again = now + retry.interval + jitter(retry, self.own, request, pending.sent);
        pending.due = if again.is_before(pending.expiry) { again } else { pending.expiry };
        Some(Due::Send(request))
    }

    /// When [`Requests::poll`] will have an action, seen from `now`; `None` without requests.
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

    /// Processes an acknowledgement by `from` and returns the request that it ends, if any. O(`P`).
    pub fn acknowledged(&mut self, from: RobotId, ack: &Ack) -> Option<Request> {
        let &Ack { to, boot, number, .. } = ack;
        if (to, boot) != (self.own, self.boot) {
            return None;
        }
        let request = self
            .pending
            .iter()
            .map(|pending| pending.request)
            .find(|request| request.to == from && request.number == number)?;
        self.remove(number);
        Some(request)
    }

    /// The number of pending requests.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pending.len()
    }

    /// Whether no request is pending.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pending.is_empty()
    }

    fn remove(&mut self, number: u8) {
        self.pending.retain(|p| p.request.number != number);
    }

    fn free_number(&self) -> u8 {
        let mut number = self.next;
        // As many steps as there are requests skip all of their numbers.
        for _ in &self.pending {
            if self.pending.iter().all(|p| p.request.number != number) {
                break;
            }
            number = number.wrapping_add(1);
        }
        number
    }
}

/// Up to a quarter of the interval; a function of robot, request and number of sends.
fn jitter(retry: Retry, own: RobotId, request: Request, sent: u8) -> Duration {
    let quarter = (retry.interval.as_micros() >> 2).max(0);
    let send = u32::from_be_bytes([0, 0, request.number, sent]);
    let drawn = Rng::keyed(0, PURPOSE, own.0, send).below(quarter.cast_unsigned());
    Duration::from_micros(drawn.cast_signed())
}

#[cfg(test)]
mod tests;
