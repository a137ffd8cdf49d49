//! Whether others hear the own robot, from the states that they tell of each other.
//!
//! A robot that tells the state of one robot also knows each robot that it hears and that is nearer
//! to it, since full tables forget the farthest. So if others tell of robots that are farther from
//! them than the own one, but never of that, they do not hear it. And if they tell that it is lost,
//! and none corrects them, they no longer do.

use serde::{Deserialize, Serialize};

/// States of farther robots, for each known robot, after which the own one is not heard: each
/// neighbour tells in turn of all that it knows.
const DOUBTS: usize = 3;
/// How often others tell that the own robot is lost until that counts: a robot that knows a newer
/// state of it tells that one next.
const LOST: usize = 3;
/// Robots that are known at least, for this bound.
const LEAST_KNOWN: usize = 2;
/// The bound of large tables.
const MOST: usize = 254;

/// How others hear the own robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::agent) enum Hearing {
    /// Others have told of it, or nothing speaks against it.
    Heard,
    /// It has just started: others tell of farther robots only, so far.
    Unclear,
    /// No robot has ever told of it: none knows that it is there.
    Never,
    /// For others it is lost: they expect that it stands.
    NoLonger,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Audience {
    /// Until others hear it, told states of robots that are farther from the teller; then, how
    /// often they told that it is lost.
    doubts: u8,
    was_heard: bool,
}

impl Audience {
    pub(super) const NEW: Self = Self { doubts: 0, was_heard: false };

    /// Notes that another robot has heard the own one a moment ago.
    pub(super) const fn hears(&mut self) {
        *self = Self { doubts: 0, was_heard: true };
    }

    /// Notes that another robot tells of one that is farther from it.
    pub(super) const fn tells_of_farther(&mut self) {
        if !self.was_heard {
            self.doubts = self.doubts.saturating_add(1);
        }
    }

    /// Notes that another robot tells that the own one is lost.
    pub(super) const fn loses(&mut self) {
        if self.was_heard {
            self.doubts = self.doubts.saturating_add(1);
        }
    }

    /// The judgement of a robot that knows `known` others.
    pub(super) fn hearing(self, known: usize) -> Hearing {
        let most = known.max(LEAST_KNOWN).saturating_mul(DOUBTS).min(MOST);
        match usize::from(self.doubts) {
            doubts if self.was_heard && doubts >= LOST && known > 0 => Hearing::NoLonger,
            doubts if self.was_heard || doubts == 0 => Hearing::Heard,
            doubts if doubts > most => Hearing::Never,
            _ => Hearing::Unclear,
        }
    }
}
