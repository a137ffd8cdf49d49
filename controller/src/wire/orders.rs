//! Received requests: executed once, acknowledged each time. Sender: [`Requests`](super::Requests).

use super::{Ack, Header, Request, RequestKind};
use crate::list::SparseVec;
use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// A request up to this far behind a newer one is late; farther behind, its number has wrapped.
const LATE: u8 = 32;

/// How to respond to a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "an unacknowledged request is sent again"]
pub struct Answer {
    /// The acknowledgement to send back.
    pub ack: Ack,
    /// Whether to execute the request: pass it on up the leader chain, or choose another direction.
    pub is_new: bool,
}

/// The latest request on one matter: stop and resume, or direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Order {
    sender: RobotId,
    origin: RobotId,
    boot: u8,
    number: u8,
    kind: RequestKind,
    heard: Instant,
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

/// The requests that a robot received, on at most `S` matters at a time; 20 bytes each.
///
/// A matter is a sender, an origin, and either stop/resume or direction, so origins stop and resume
/// independently. On one matter the request that was sent last decides, in any order of arrival. A
/// full table evicts the entry without a stop that was received longest ago. If all entries hold
/// stops, further stops and redirections are refused. A stop is never evicted before its time.
///
/// Times are compared by wrapped difference: call [`Orders::is_stopped`] at least every half hour.
/// After a longer pause no stop is in force, but a repeat may be taken for a new request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Orders<const S: usize> {
    lines: SparseVec<Order, S>,
    memory: Duration,
}

impl<const S: usize> Orders<S> {
    /// Creates an empty table. `memory`: how long a request is remembered after its last reception,
    /// to recognise repeats. It must exceed the sender's attempts times its retry interval plus the
    /// radio's longest delay, and be shorter than the time in which the sender uses 200 numbers.
    #[must_use]
    pub const fn new(memory: Duration) -> Self {
        Self { lines: SparseVec::new(), memory }
    }

    /// Processes a request to this robot that arrived in a frame with `header`. O(`S`).
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
            // No stop is stored, so there is none to lift.
            (Err(_), RequestKind::Resume) => answer(true, false),
            (Err(_), _) => answer(false, false),
        }
    }

    /// Whether any stop is in force.
    pub fn is_stopped(&mut self, now: Instant) -> bool {
        self.stopped_until(now).is_some()
    }

    /// When the last stop in force ends, if any.
    pub fn stopped_until(&mut self, now: Instant) -> Option<Instant> {
        self.forget_old(now);
        self.lines
            .iter()
            .filter(|line| line.is_stop_at(now))
            .map(|line| line.until)
            .max_by_key(|until| until.since(now))
    }

    /// Drops all requests of `sender`, because it restarted and no longer knows them.
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

    fn make_room(&mut self, now: Instant) {
        let stalest =
            self.lines.iter().filter(|line| !line.is_stop_at(now)).max_by_key(|line| now.since(line.heard)).copied();
        self.lines.retain(|line| Some(*line) != stalest);
    }
}

#[cfg(test)]
mod tests;
