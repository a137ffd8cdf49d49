//! What a robot that goes by velocities makes of silence.

use super::AgentConfig;
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// What a robot that goes by velocities makes of silence; behind a safety layer that looks at others.
///
/// | it hears | it does |
/// | --- | --- |
/// | everybody, each tick | takes half of a gap in a step at most: see [`Room`](crate::neighbor::Room) |
/// | one of them no more | keeps clear of where that one can be by now, a ball that grows; once it is [lost](crate::neighbor::Ages::expire_after), of one that grows up to [`max_m`](crate::neighbor::StalenessInflation::max_m), until it is heard again or [`remember`](Self::remember) is over. One that drove about as far off as any who are heard has gone out of range, and is forgotten |
/// | fewer than half of them | keeps clear of where they can be, then stands |
/// | nobody any more, all are lost | says so ([`Event::NobodyHeard`](super::Event)); keeps clear of where they can be, then stands. After [`remember`](Self::remember) it stands anyway, until somebody speaks |
/// | the same, and all have gone out of range: the last ones drove on to beyond where anybody was ever heard | says so, goes as it likes |
/// | the same as in the row before last, and it may be alone | goes on at [`alone_mps`](Self::alone_mps), around where the lost were last |
/// | nobody ever, since it was switched on | goes as it likes: it is the first of its swarm, or all of it |
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Silence<S> {
    /// How long one that fell silent is remembered, at most half an hour. Longer: a robot that was taken away blocks its
    /// place for longer, and one that drives out of range goes on for longer; shorter: one that lies dead somewhere is
    /// hit sooner. With less than [`Ages::expire_after`](crate::neighbor::Ages::expire_after) nobody is.
    pub remember: Duration,
    /// How fast to go, m/s, when all are lost: 0 stands until somebody speaks, [`Scalar::MAX`] goes on as if nothing
    /// were. Above 0 only for robots that may be alone: whoever is still there and moves is not seen.
    pub alone_mps: S,
}

impl<S: Scalar> Silence<S> {
    /// Remembers for a minute, and stands.
    pub const DEFAULT: Self = Self { remember: Duration::from_millis(60_000), alone_mps: S::ZERO };

    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Silence<T> {
        Silence { remember: self.remember, alone_mps: cast(self.alone_mps) }
    }

    /// Whether the robot may be alone.
    #[must_use]
    pub fn may_be_alone(&self) -> bool {
        self.alone_mps > S::ZERO
    }
}

/// Whether anybody is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Company {
    /// Nobody was ever heard, or all have gone out of range since.
    Unknown,
    /// Somebody was heard last at this moment.
    Heard(Instant),
    /// All are lost; somebody was heard last at this moment.
    Lost(Instant),
    /// All are forgotten.
    Gone,
}

impl Company {
    /// Takes note of the time; whether all have been lost just now. To be asked in each step, so that the clock never
    /// goes half round unnoticed.
    ///
    /// `have_left`: of those who are lost nobody is remembered, for all went out of range.
    pub(super) fn passes<S: Scalar>(&mut self, now: Instant, have_left: bool, config: &AgentConfig<S>) -> bool {
        let is_over = |at, longest| !(Duration::ZERO..=longest).contains(&now.since(at));
        let before = *self;
        if let Self::Heard(at) = *self
            && is_over(at, config.ages.expire_after)
        {
            *self = Self::Lost(at);
        }
        if let Self::Lost(at) = *self {
            if is_over(at, config.silence.remember) {
                *self = Self::Gone;
            } else if have_left {
                *self = Self::Unknown;
            }
        }
        matches!(before, Self::Heard(_)) && *self != before
    }

    pub(super) const fn is_lost(self) -> bool {
        matches!(self, Self::Lost(_) | Self::Gone)
    }
}
