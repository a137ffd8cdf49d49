//! Plausibility limits on the values that other robots report.

use super::Neighbor;
use crate::geom::{Position, Vec3};
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use core::fmt;
use serde::{Deserialize, Serialize};

const SUSPECTS: usize = 4;

/// Limits on the values that a robot may report about itself, for robots that lie or whose sensors
/// fail.
///
/// | reported value | effect |
/// | --- | --- |
/// | radius above [`max_radius_m`](Self::max_radius_m) | reduced to that radius |
/// | speed above [`max_speed_mps`](Self::max_speed_mps) | velocity shortened to that speed |
/// | id above [`last`](Self::last) | beacon refused |
/// | unreachable position, robots avoid by velocities | a second robot with that id is assumed |
/// | unreachable position from either of the two, or on the grid | beacon refused |
///
/// A position is unreachable if the robot cannot have moved there since its last beacon. A robot
/// with refused beacons counts as silent, until it has reported mutually reachable positions for
/// [`settle`](Self::settle). With a limit below the true value a robot may run into a larger or
/// faster one; if in doubt, choose a wide limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlausibilityLimits<S> {
    /// Largest radius of any robot, metres.
    pub max_radius_m: S,
    /// Highest speed of any robot, m/s. With [`Scalar::MAX`], positions are not checked.
    pub max_speed_mps: S,
    /// Additional distance between two positions, metres: positioning errors and delays.
    pub slack_m: S,
    /// How long a robot that has jumped must report consistent positions; 0: accepted at once. With
    /// a longer time a robot that was moved stays unseen for longer; with a shorter one a lying
    /// robot can jump more often.
    pub settle: Duration,
    /// The greatest id of any robot.
    pub last: RobotId,
}

/// A reported value beyond its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Claim {
    /// An id that no robot has.
    Number,
    /// A radius above the limit.
    Radius,
    /// A speed above the limit.
    Speed,
    /// A position that is unreachable from the previous one.
    Jump,
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => "a number that no robot has",
            Self::Radius => "too large a radius",
            Self::Speed => "too high a speed",
            Self::Jump => "a place too far from its last one",
        })
    }
}

impl<S: Scalar> PlausibilityLimits<S> {
    /// Accepts all values.
    pub const ANY: Self = Self {
        max_radius_m: S::MAX,
        max_speed_mps: S::MAX,
        slack_m: S::ZERO,
        settle: Duration::ZERO,
        last: RobotId(u32::MAX),
    };

    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> PlausibilityLimits<T> {
        PlausibilityLimits {
            max_radius_m: cast(self.max_radius_m),
            max_speed_mps: if self.max_speed_mps < S::MAX { cast(self.max_speed_mps) } else { T::MAX },
            slack_m: cast(self.slack_m),
            settle: self.settle,
            last: self.last,
        }
    }

    /// Reduces radius and velocity to the limits. Returns whether each exceeded its limit.
    #[must_use]
    pub fn cut<P>(&self, said: &mut Neighbor<S, P>) -> (bool, bool) {
        let is_large = said.radius_m > self.max_radius_m;
        let is_fast = self.max_speed_mps < S::MAX && is_longer(said.velocity_mps, self.max_speed_mps);
        if is_large {
            said.radius_m = self.max_radius_m;
        }
        if is_fast {
            said.velocity_mps = said.velocity_mps.clamp_norm(self.max_speed_mps);
        }
        (is_large, is_fast)
    }

    /// Returns whether positions are not checked.
    #[must_use]
    pub fn believes_all_places(&self) -> bool {
        self.max_speed_mps >= S::MAX
    }

    /// Returns whether a robot can move from one position to another within `time`.
    #[must_use]
    pub fn can_go(&self, from: Position, to: Position, time: Duration) -> bool {
        if self.believes_all_places() {
            return true;
        }
        let most_m = self.max_speed_mps * S::from_micro(time.as_micros().max(0)) + self.slack_m;
        !is_longer(to.since::<S>(from), most_m)
    }
}

fn is_longer<S: Scalar>(vector: Vec3<S>, length: S) -> bool {
    vector.length_key() > Vec3::new(length, S::ZERO, S::ZERO).length_key()
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Suspect {
    id: RobotId,
    place: Position,
    /// Start of the mutually reachable positions.
    since: Instant,
    heard: Instant,
}

#[cfg(not(feature = "host"))]
type Jumpers = heapless::Vec<Suspect, SUSPECTS, u8>;
#[cfg(feature = "host")]
type Jumpers = crate::list::SparseVec<Suspect, SUSPECTS>;

/// Robots that reported an unreachable position recently. 100 bytes (less with `host`).
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PlausibilityFilter(Jumpers);

/// The verdict on an unreachable position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Accepted: the robot has reported consistent positions for long enough.
    Settled,
    /// Not accepted yet.
    Stands,
    /// Not accepted, and the first unreachable position of this robot.
    Begins,
}

impl PlausibilityFilter {
    /// Creates an empty list.
    #[must_use]
    pub const fn new() -> Self {
        Self(Jumpers::new())
    }

    /// Judges a robot that reports, at time `at`, a position that it cannot have reached; it starts
    /// again if its last report is older than `longest`. If all entries are in use, it stays in
    /// doubt until another one has been silent for `longest`. O(1).
    pub fn judge<S: Scalar>(
        &mut self,
        id: RobotId,
        place: Position,
        at: Instant,
        plausibility: &PlausibilityLimits<S>,
        longest: Duration,
    ) -> Verdict {
        self.0.retain(|suspect| (Duration::ZERO..=longest).contains(&at.since(suspect.heard)));
        let known = self.0.iter_mut().find(|suspect| suspect.id == id);
        let is_new = known.is_none();
        let since = match known {
            Some(suspect) => {
                if !plausibility.can_go(suspect.place, place, at.since(suspect.heard)) {
                    suspect.since = at;
                }
                (suspect.place, suspect.heard) = (place, at);
                suspect.since
            }
            None => {
                // Without an entry a robot stays in doubt.
                let _ = self.0.push(Suspect { id, place, since: at, heard: at });
                at
            }
        };
        if at.since(since) >= plausibility.settle {
            self.0.retain(|suspect| suspect.id != id);
            return Verdict::Settled;
        }
        if is_new { Verdict::Begins } else { Verdict::Stands }
    }

    /// Removes a robot whose positions are accepted again.
    pub fn clear(&mut self, id: RobotId) {
        self.0.retain(|suspect| suspect.id != id);
    }
}
