//! Being asked: requests are acted on once, acknowledged as often as they come, and a stop stands
//! until it is lifted or its time has passed.
//!
//! The other side is [`Requests`](super::Requests).

use super::{Ack, Header, Request, RequestKind};
use crate::list::Seldom;
use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// A request that lies this far behind a newer one on the same matter, or less, is an old one that
/// came late; one that seems to lie farther behind is a new one whose number wrapped.
const LATE: u8 = 32;

/// What to do about a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "an unacknowledged request is sent again"]
pub struct Answer {
    /// To be sent back.
    pub ack: Ack,
    /// Whether the request came for the first time and is followed: the moment to pass it on up
    /// the chain or to choose another direction.
    pub is_new: bool,
}

/// The latest request on one matter (to stand or not; the direction) of one origin by one sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Order {
    sender: RobotId,
    origin: RobotId,
    boot: u8,
    number: u8,
    kind: RequestKind,
    heard: Instant,
    /// Until when a stop stands.
    until: Instant,
}

const _: () = assert!(size_of::<Order>() == 20);

impl Order {
    fn is_stop_at(&self, now: Instant) -> bool {
        let longest = Duration::from_millis(i32::from(u16::MAX));
        self.kind == RequestKind::Stop && !now.has_reached(self.until, longest)
    }

    fn is_about(&self, header: Header, request: &Request) -> bool {
        self.sender == header.sender
            && self.origin == request.origin
            && self.kind.is_standing() == request.kind.is_standing()
    }
}

/// The requests that a robot received, at most `S` matters at a time; 20 bytes each.
///
/// Each matter (sender, origin, standing or direction) is a line of its own, so that two
/// followers, or two robots whose requests one follower passes on, stop and resume independently. In
/// a line the request sent last decides, whatever order they arrive in. A request is remembered
/// for a while after it was last heard, so that its repeats and what it replaced are recognised.
///
/// When all lines are taken, the one heard of longest ago that holds no stop makes room; when
/// all hold stops, a further stop or redirection is refused. A stop is never dropped before its
/// time.
///
/// Time is compared by wrapped difference: [`Orders::is_stopped`] should be called at least every half
/// hour. After a longer pause no stop stands, but a repeat may be taken for a new request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Orders<const S: usize> {
    lines: Seldom<Order, S>,
    memory: Duration,
}

impl<const S: usize> Orders<S> {
    /// Nothing was asked yet.
    ///
    /// `memory`: how long a request is remembered after it was last heard. More than the asker's
    /// attempts times interval plus the radio's longest delay, or a late repeat is acted on
    /// again; less than it takes the asker to use 200 numbers.
    #[must_use]
    pub const fn new(memory: Duration) -> Self {
        Self { lines: Seldom::new(), memory }
    }

    /// Judges a request to this robot that came in a frame with `header`. O(`S`).
    #[expect(clippy::arithmetic_side_effects, reason = "an `Instant` wraps, as is meant")]
    pub fn receive(&mut self, header: Header, request: &Request, now: Instant) -> Answer {
        self.forget_old(now);
        let order = Order {
            sender: header.sender,
            origin: request.origin,
            boot: header.boot,
            number: request.number,
            kind: request.kind,
            heard: now,
            until: now + Duration::from_millis(request.valid_ms.into()),
        };
        let answer = |accepted, is_new| Answer {
            ack: Ack { to: header.sender, boot: header.boot, number: request.number, accepted },
            is_new,
        };
        if let Some(line) = self.lines.iter_mut().find(|l| l.is_about(header, request)) {
            let behind = line.number.wrapping_sub(request.number);
            if line.boot == header.boot && behind <= LATE {
                line.heard = now;
                return answer(behind == 0, false);
            }
            *line = order;
            return answer(true, true);
        }
        if self.lines.is_full() {
            self.make_room(now);
        }
        match (self.lines.push(order), request.kind) {
            (Ok(()), _) => answer(true, true),
            // Nothing of this origin stands: there is nothing to lift and nothing to remember.
            (Err(_), RequestKind::Resume) => answer(true, false),
            (Err(_), _) => answer(false, false),
        }
    }

    /// Whether somebody's stop stands.
    pub fn is_stopped(&mut self, now: Instant) -> bool {
        self.stopped_until(now).is_some()
    }

    /// When the last stop that stands now will have passed; `None` when none stands.
    pub fn stopped_until(&mut self, now: Instant) -> Option<Instant> {
        self.forget_old(now);
        self.lines
            .iter()
            .filter(|line| line.is_stop_at(now))
            .map(|line| line.until)
            .max_by_key(|until| until.since(now))
    }

    /// Forgets what `sender` asked, because it started anew and no longer knows of it.
    pub fn forget(&mut self, sender: RobotId) {
        self.lines.retain(|line| line.sender != sender);
    }

    fn forget_old(&mut self, now: Instant) {
        let memory = self.memory;
        self.lines.retain(|line| {
            let age = now.since(line.heard);
            line.is_stop_at(now) || (Duration::ZERO <= age && age < memory)
        });
    }

    /// Drops the line heard of longest ago that holds no stop.
    fn make_room(&mut self, now: Instant) {
        let stalest =
            self.lines.iter().filter(|line| !line.is_stop_at(now)).max_by_key(|line| now.since(line.heard)).copied();
        self.lines.retain(|line| Some(*line) != stalest);
    }
}

#[cfg(test)]
mod tests;
