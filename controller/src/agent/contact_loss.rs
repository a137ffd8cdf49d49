//! The reaction of a robot in the plane to lost contact.

use super::AgentConfig;
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// The reaction of a robot that moves by velocities to lost contact, with a safety layer that
/// tracks silent neighbours.
///
/// | contact | reaction |
/// | --- | --- |
/// | all neighbours in each tick | takes at most half of a gap per step, see [`GapLimit`] |
/// | one neighbour silent | avoids the growing ball in which it may be |
/// | one neighbour [lost] | avoids its ball; after twice the time, [`max_m`] larger at most |
/// | fewer than half fresh | avoids the balls of all silent robots, then stands |
/// | all lost | reports [`ContactLost`]; avoids their balls, then stands |
/// | all lost for longer than [`stands_after`] | stands until one is in contact |
/// | all lost, all left radio range | reports [`ContactLost`], moves freely |
/// | all lost, it may be alone | moves at [`alone_mps`](Self::alone_mps) around the lost robots |
/// | just started | stands and [listens](Self::listen) |
/// | others never told of this robot | moves, and expects that no robot gives way |
/// | never any since power-on | moves freely, or stands if it [expects others] |
///
/// The place of a lost robot stays blocked until a robot hears that robot again, or an operator
/// [clears](crate::wire::LostRobot) it. Robots tell each other the states of those that they know,
/// so that one is silent only if no other robot in range hears it. A robot that was receding near
/// the greatest distance of any reception has left radio range, and is forgotten.
///
/// [`GapLimit`]: crate::neighbor::GapLimit
/// [lost]: crate::neighbor::Ages::expire_after
/// [`stands_after`]: Self::stands_after
/// [expects others]: Self::expects_others
/// [`max_m`]: crate::neighbor::StalenessInflation::max_m
/// [`ContactLost`]: super::Event::ContactLost
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContactLossPolicy<S> {
    /// Silence after which a lost robot counts as standing even if most robots are lost, so that it
    /// may be the own radio that failed; at most ten minutes.
    pub stands_after: Duration,
    /// Speed when all robots are lost, m/s; 0 to stand until a robot is in contact. Above 0 only
    /// for robots that may be alone, since moving silent robots are not detected.
    pub alone_mps: S,
    /// How long a robot that has started stands before it moves, so that it hears the robots near
    /// by: a beacon period and the latency, several times that on a radio with losses; six times
    /// this time while it knows of robots that it does not hear.
    pub listen: Duration,
    /// Other robots exist: a robot that has not heard any stands, as if all were lost.
    pub expects_others: bool,
    /// Distance within which the radio works when nothing disturbs it, metres; a robot that falls
    /// silent nearer than that has not left. Greater distances are learned; 0: all.
    pub reach_m: S,
}

impl<S: Scalar> ContactLossPolicy<S> {
    /// Stands for a minute, and after the start for 0.2 s.
    pub const DEFAULT: Self = Self {
        stands_after: Duration::from_millis(60_000),
        alone_mps: S::ZERO,
        listen: Duration::from_millis(200),
        expects_others: false,
        reach_m: S::ZERO,
    };

    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> ContactLossPolicy<T> {
        ContactLossPolicy {
            stands_after: self.stands_after,
            alone_mps: cast(self.alone_mps),
            listen: self.listen,
            expects_others: self.expects_others,
            reach_m: cast(self.reach_m),
        }
    }

    /// Returns whether the robot moves although all others are lost.
    #[must_use]
    pub fn may_be_alone(&self) -> bool {
        self.alone_mps > S::ZERO
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum ContactState {
    /// Never in contact, or all other robots have left radio range.
    Never,
    /// The time of the last reception.
    InContact(Instant),
    /// All robots are lost; the time of the last reception.
    Lost(Instant),
    Forgotten,
}

impl ContactState {
    /// Updates the state. Returns whether contact was lost just now; `last_left(at)`: the robots
    /// received last, at that time, left radio range. Call it in each step, so that the 32-bit
    /// clock cannot wrap unnoticed.
    pub(super) fn passes<S: Scalar>(
        &mut self,
        now: Instant,
        last_left: impl Fn(Instant) -> bool,
        config: &AgentConfig<S>,
    ) -> bool {
        let is_over = |at, longest| !(Duration::ZERO..=longest).contains(&now.since(at));
        let before = *self;
        if let Self::InContact(at) = *self
            && is_over(at, config.ages.expire_after)
        {
            *self = Self::Lost(at);
        }
        if let Self::Lost(at) = *self {
            if is_over(at, config.contact_loss.stands_after) {
                *self = Self::Forgotten;
            } else if last_left(at) {
                *self = Self::Never;
            }
        }
        matches!(before, Self::InContact(_)) && *self != before
    }

    /// The state after a frame that was sent at `at`; a delayed one is older than others.
    pub(super) const fn heard(self, at: Instant) -> Self {
        match self {
            Self::InContact(last) if at.is_before(last) => self,
            _ => Self::InContact(at),
        }
    }

    pub(super) const fn is_lost(self) -> bool {
        matches!(self, Self::Lost(_) | Self::Forgotten)
    }
}

/// Time after which a robot that still finds others starts to move.
const LONGEST: Duration = Duration::from_millis(5000);
/// How much longer a robot listens while links fade: one that it does not hear yet may be near by.
const MISSING: i32 = 6;

/// How long a robot has been running, and when its last step was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Listening {
    NotStarted,
    /// The time of the first step, and when it last found a robot.
    Since {
        start: Instant,
        found: Instant,
    },
    /// The time of the last step.
    Over(Instant),
}

impl Listening {
    /// Updates the state; returns whether the robot still listens: while it `doubts` that others
    /// hear it, until it has found no robot for `listen`, for [`MISSING`] times that while it
    /// `misses` robots that it should hear, and for as long as it took to find the last one. Call
    /// it in each step.
    pub(super) fn passes(&mut self, now: Instant, listen: Duration, (doubts, misses): (bool, bool)) -> bool {
        let listen = if misses { listen.saturating_mul(MISSING) } else { listen };
        let (start, found) = match *self {
            Self::NotStarted => (now, now),
            Self::Since { start, found } => (start, found),
            Self::Over(_) => {
                *self = Self::Over(now);
                return false;
            }
        };
        let has_time = now.since(start) < LONGEST.max(listen);
        let lasts = has_time && (doubts || now.since(found) < found.since(start).max(listen));
        *self = if lasts { Self::Since { start, found } } else { Self::Over(now) };
        lasts
    }

    /// Notes that a robot was found at `now`.
    pub(super) fn note(&mut self, now: Instant) {
        if let Self::Since { found, .. } = self {
            *found = now;
        }
    }

    /// The time since the last step, at least a tick; a tick while the robot listens.
    pub(super) fn elapsed(self, now: Instant, tick: Duration) -> Duration {
        match self {
            Self::Over(last) => now.since(last).max(tick),
            Self::NotStarted | Self::Since { .. } => tick,
        }
    }
}
