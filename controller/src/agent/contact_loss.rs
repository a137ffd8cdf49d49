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
/// | one neighbour [lost] | avoids its ball, which grows by at most [`max_m`] |
/// | fewer than half fresh | avoids the balls of all silent robots, then stands |
/// | all lost | reports [`ContactLost`]; avoids their balls, then stands |
/// | all lost for longer than [`remember`](Self::remember) | stands until a robot is in contact |
/// | all lost, all left radio range | reports [`ContactLost`], moves freely |
/// | all lost, it may be alone | moves at [`alone_mps`](Self::alone_mps) around the lost robots |
/// | never any since power-on | moves freely: it is the first or only robot of its swarm |
///
/// A lost robot is avoided until it is in contact again or [`remember`](Self::remember) has passed.
/// It left radio range, and is forgotten, if it was last known about as far away as the farthest
/// fresh robot. All have left if the last ones exceed the greatest distance of any earlier contact.
///
/// [`GapLimit`]: crate::neighbor::GapLimit
/// [lost]: crate::neighbor::Ages::expire_after
/// [`max_m`]: crate::neighbor::StalenessInflation::max_m
/// [`ContactLost`]: super::Event::ContactLost
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContactLossPolicy<S> {
    /// How long a silent robot is remembered; at most half an hour. Longer: a removed robot blocks
    /// its place for longer. Shorter: a dead robot is hit sooner. Below
    /// [`Ages::expire_after`](crate::neighbor::Ages::expire_after), no robot is remembered.
    pub remember: Duration,
    /// Speed when all robots are lost, m/s; 0 to stand until a robot is in contact. Above 0 only
    /// for robots that may be alone, since moving silent robots are not detected.
    pub alone_mps: S,
}

impl<S: Scalar> ContactLossPolicy<S> {
    /// Remembers for a minute, and stands.
    pub const DEFAULT: Self = Self { remember: Duration::from_millis(60_000), alone_mps: S::ZERO };

    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> ContactLossPolicy<T> {
        ContactLossPolicy { remember: self.remember, alone_mps: cast(self.alone_mps) }
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
    /// Updates the state. Returns whether contact was lost just now; `have_left`: all lost robots
    /// left radio range. Call it in each step, so that the 32-bit clock cannot wrap unnoticed.
    pub(super) fn passes<S: Scalar>(&mut self, now: Instant, have_left: bool, config: &AgentConfig<S>) -> bool {
        let is_over = |at, longest| !(Duration::ZERO..=longest).contains(&now.since(at));
        let before = *self;
        if let Self::InContact(at) = *self
            && is_over(at, config.ages.expire_after)
        {
            *self = Self::Lost(at);
        }
        if let Self::Lost(at) = *self {
            if is_over(at, config.contact_loss.remember) {
                *self = Self::Forgotten;
            } else if have_left {
                *self = Self::Never;
            }
        }
        matches!(before, Self::InContact(_)) && *self != before
    }

    pub(super) const fn is_lost(self) -> bool {
        matches!(self, Self::Lost(_) | Self::Forgotten)
    }
}
