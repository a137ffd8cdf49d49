//! Received messages and orders of laws: each is given to the law once. Sender of messages:
//! [`OutgoingMessages`](super::OutgoingMessages).

use super::{Header, Newest};
use crate::list::SparseVec;
use crate::robot::RobotId;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// A message up to this far behind a newer one is late; farther behind, its number has wrapped.
const LATE: u8 = 32;

/// The latest message of a sender about one subject.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Latest {
    sender: RobotId,
    subject: u32,
    heard: Instant,
    boot: u8,
    number: u8,
}

const _: () = assert!(size_of::<Latest>() == 16);

/// The messages that a robot received, by sender and subject, at most `C`; 16 bytes each.
///
/// Of one sender and subject the message that was sent last counts, in any order of arrival. A full
/// table drops the entry that was heard longest ago, whose repeats then count as new.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct IncomingMessages<const C: usize> {
    known: SparseVec<Latest, C>,
    memory: Duration,
}

impl<const C: usize> IncomingMessages<C> {
    /// Creates an empty table. `memory`: how long a message is remembered after its last reception,
    /// to recognise repeats. It must exceed the sender's attempts times its retry interval plus the
    /// radio's longest delay, and be shorter than the time in which the sender uses 200 numbers.
    #[must_use]
    pub const fn new(memory: Duration) -> Self {
        Self { known: SparseVec::new(), memory }
    }

    /// Whether this message, from a frame with `header`, was [noted](Self::note), or is older than
    /// a noted one about the same subject: then it is remembered for longer. O(`C`).
    #[must_use = "a repeat is not given to the law"]
    pub fn is_repeat(&mut self, header: Header, number: u8, subject: u32, now: Instant) -> bool {
        let memory = self.memory;
        self.known.retain(|known| {
            let age = now.since(known.heard);
            Duration::ZERO <= age && age < memory
        });
        let is_about = |known: &&mut Latest| known.sender == header.sender && known.subject == subject;
        let known = self.known.iter_mut().find(is_about);
        let is_late = |known: &&mut Latest| known.boot == header.boot && known.number.wrapping_sub(number) <= LATE;
        known.filter(is_late).map(|known| known.heard = now).is_some()
    }

    /// Remembers a message that the law took. O(`C`).
    pub fn note(&mut self, header: Header, number: u8, subject: u32, now: Instant) {
        self.known.retain(|known| known.sender != header.sender || known.subject != subject);
        if self.known.is_full() {
            let oldest = self.known.iter().max_by_key(|known| now.since(known.heard)).copied();
            self.known.retain(|known| Some(*known) != oldest);
        }
        let latest = Latest { sender: header.sender, subject, heard: now, boot: header.boot, number };
        let _ = self.known.push(latest);
    }

    /// Drops all messages of `sender`, because it restarted.
    pub fn forget(&mut self, sender: RobotId) {
        self.known.retain(|known| known.sender != sender);
    }
}

/// The newest order about one subject.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Ordered {
    subject: u32,
    by: Operator,
    newest: Newest,
}

const _: () = assert!(size_of::<Ordered>() <= 16);

/// An operator since its last start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Operator {
    sender: RobotId,
    boot: u8,
}

/// The orders that a robot received, about at most `C` subjects; 16 bytes each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct IncomingOrders<const C: usize> {
    ordered: SparseVec<Ordered, C>,
    /// The operator of the last order without a subject.
    last: Option<Operator>,
}

impl<const C: usize> IncomingOrders<C> {
    /// Creates an empty table.
    #[must_use]
    pub const fn new() -> Self {
        Self { ordered: SparseVec::new(), last: None }
    }

    /// Whether the order must be given to the law: it is newer than all others about its subject,
    /// another operator gave those, or it has no subject. O(`C`).
    #[must_use]
    pub fn is_news(&self, header: Header, number: u8, subject: Option<u32>) -> bool {
        let by = Operator { sender: header.sender, boot: header.boot };
        let known = self.ordered.iter().find(|known| Some(known.subject) == subject);
        known.is_none_or(|known| known.by != by || known.newest.is_news(number))
    }

    /// Remembers an order that the law took. A full table drops the subject that it met first.
    pub fn note(&mut self, header: Header, number: u8, subject: u32) {
        let by = Operator { sender: header.sender, boot: header.boot };
        let mut newest = Newest::new();
        let _ = newest.admit(number);
        let ordered = Ordered { subject, by, newest };
        if let Some(known) = self.ordered.iter_mut().find(|known| known.subject == subject) {
            *known = ordered;
            return;
        }
        if self.ordered.is_full() {
            let first = self.ordered.iter().next().copied();
            self.ordered.retain(|known| Some(*known) != first);
        }
        let _ = self.ordered.push(ordered);
    }

    /// Whether an order without a subject is by another operator than the last one, or by one that
    /// restarted.
    pub fn is_restarted(&mut self, header: Header) -> bool {
        let by = Some(Operator { sender: header.sender, boot: header.boot });
        core::mem::replace(&mut self.last, by) != by
    }
}

impl<const C: usize> Default for IncomingOrders<C> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
