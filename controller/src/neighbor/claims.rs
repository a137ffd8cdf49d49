//! What others may say of themselves and be believed.

use super::Neighbor;
use crate::geom::{Position, Vec3};
use crate::robot::RobotId;
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use core::fmt;
use serde::{Deserialize, Serialize};

/// Robots whose places are in doubt at a time.
const SUSPECTS: usize = 4;

/// Bounds on what a robot may say of itself. No honest robot meets them, so they cost nothing until somebody lies, or a
/// sensor does.
///
/// | claim | what becomes of it |
/// | --- | --- |
/// | a radius above [`max_radius_m`](Self::max_radius_m) | it is taken for that |
/// | a velocity above [`max_speed_mps`](Self::max_speed_mps) | it is shortened to that |
/// | a place that it cannot have come to since it was heard | where robots keep clear of each other by velocities it may be a second robot of that number, and both places are kept clear of from then on; a jump from either, and any on the grid: the beacon is refused, and the robot is as good as silent: room is left for where it can be. Once it has said places for [`settle`](Self::settle) that it can have gone between, it is believed again |
/// | a number above [`last`](Self::last) | the beacon is refused |
///
/// A bound that is smaller than the truth lets a robot run into a larger or faster one: in doubt, leave it wide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Claims<S> {
    /// Largest radius of any robot, metres.
    pub max_radius_m: S,
    /// Highest speed of any robot, m/s; [`Scalar::MAX`]: any, and places are not looked at.
    pub max_speed_mps: S,
    /// How far off two places of one robot may be besides, metres: errors of positioning, and what a packet that was held back adds.
    pub slack_m: S,
    /// For how long a robot that has jumped must say consistent places before it is believed. 0: at once. Longer: one that
    /// was carried, or whose positioning has jumped, is unseen for longer where it is now; shorter: a liar moves about more freely.
    pub settle: Duration,
    /// The greatest number of any robot.
    pub last: RobotId,
}

/// A claim beyond its bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Claim {
    /// A number that no robot has.
    Number,
    /// A radius.
    Radius,
    /// A velocity.
    Speed,
    /// A place too far from the last one.
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

impl<S: Scalar> Claims<S> {
    /// Everything is believed.
    pub const ANY: Self = Self {
        max_radius_m: S::MAX,
        max_speed_mps: S::MAX,
        slack_m: S::ZERO,
        settle: Duration::ZERO,
        last: RobotId(u32::MAX),
    };

    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Claims<T> {
        Claims {
            max_radius_m: cast(self.max_radius_m),
            max_speed_mps: if self.max_speed_mps < S::MAX { cast(self.max_speed_mps) } else { T::MAX },
            slack_m: cast(self.slack_m),
            settle: self.settle,
            last: self.last,
        }
    }

    /// Cuts what a robot says of itself down to what is believed. Whether its radius and its speed were beyond.
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

    /// Whether a robot can have gone anywhere at any time.
    #[must_use]
    pub fn believes_all_places(&self) -> bool {
        self.max_speed_mps >= S::MAX
    }

    /// Whether a robot can have gone from one place to another in `time`.
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

/// A robot whose places are in doubt.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Suspect {
    id: RobotId,
    /// Where it says that it is.
    place: Position,
    /// Since when it has said places that go together.
    since: Instant,
    heard: Instant,
}

#[cfg(not(feature = "host"))]
type Jumpers = heapless::Vec<Suspect, SUSPECTS, u8>;
#[cfg(feature = "host")]
type Jumpers = crate::list::Seldom<Suspect, SUSPECTS>;

/// Who has jumped of late; 100 bytes, with the feature `host` those of who has.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Suspects(Jumpers);

/// What a jump is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// It has been where it says for long enough: it is believed.
    Settled,
    /// Not yet.
    Stands,
    /// Not yet, and it was not in doubt before.
    Begins,
}

impl Suspects {
    /// Nobody.
    #[must_use]
    pub const fn new() -> Self {
        Self(Jumpers::new())
    }

    /// Judges a robot that says, at `at`, that it is where it cannot have come to. One whose last word is older than `longest` begins anew. O(1).
    ///
    /// When all places are taken it stays in doubt until somebody else is not heard for `longest`.
    pub fn judge<S: Scalar>(
        &mut self,
        id: RobotId,
        place: Position,
        at: Instant,
        claims: &Claims<S>,
        longest: Duration,
    ) -> Doubt {
        self.0.retain(|suspect| (Duration::ZERO..=longest).contains(&at.since(suspect.heard)));
        let known = self.0.iter_mut().find(|suspect| suspect.id == id);
        let is_new = known.is_none();
        let since = match known {
            Some(suspect) => {
                if !claims.can_go(suspect.place, place, at.since(suspect.heard)) {
                    suspect.since = at;
                }
                (suspect.place, suspect.heard) = (place, at);
                suspect.since
            }
            None => {
                // Who finds no room stays in doubt.
                let _ = self.0.push(Suspect { id, place, since: at, heard: at });
                at
            }
        };
        if at.since(since) >= claims.settle {
            self.0.retain(|suspect| suspect.id != id);
            return Doubt::Settled;
        }
        if is_new { Doubt::Begins } else { Doubt::Stands }
    }

    /// Forgets a robot whose places are believed again.
    pub fn clear(&mut self, id: RobotId) {
        self.0.retain(|suspect| suspect.id != id);
    }
}
