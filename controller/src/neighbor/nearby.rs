//! Who is near by right now, seen from oneself: what guidance and collision avoidance in the plane and in space work with.

use super::{Ages, Neighbor};
use crate::geom::{Position, Vec3};
use crate::list::{self, sink_last};
use crate::robot::{Mode, RobotId};
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A robot near by, as it should be right now.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Nearby<S> {
    /// Who it is.
    pub id: RobotId,
    /// Its place minus the own one, metres.
    pub offset_m: Vec3<S>,
    /// Its velocity in the world, metres per second.
    pub velocity_mps: Vec3<S>,
    /// Radius of the ball that it is in, metres.
    pub radius_m: S,
    /// Whether it gives way too: fresh, and its agent steers it ([`Mode::gives_way`](crate::robot::Mode::gives_way)).
    pub gives_way: bool,
    /// What it said last that it is doing.
    pub mode: Mode,
    /// Of another flock: one that flocks keeps off it, and takes no further notice.
    pub is_stranger: bool,
}

/// How the ball around a silent robot grows with the age of the news. By default it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StalenessInflation<S> {
    /// Speed at which the ball grows, m/s: the highest that others can have. Less is not safe when the radio is bad; 0: never.
    pub growth_mps: S,
    /// How much the ball of one that stands grows at most, metres: how far off it may have come to stand. More closes places;
    /// less hits who lies in the way.
    pub max_m: S,
}

impl<S: Scalar> StalenessInflation<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> StalenessInflation<T> {
        StalenessInflation { growth_mps: cast(self.growth_mps), max_m: cast(self.max_m) }
    }
}

/// The `K` robots nearest to `own` at `now` (all when fewer), nearest first, ties by number; an
/// unknown distance (NaN) comes last.
///
/// A fresh one is where its velocity has taken it since it was heard. A stale one (older than
/// [`Ages::stale_after`], not yet forgotten) stands where that ended; its ball grows as `inflation` says, at half of
/// that speed (what it may do at worst is the business of [`Room`](super::Room)), but never over the own ball of
/// `own_radius_m`, since old news alone is no collision; and it does not give way. One older than [`Ages::expire_after`] is not there any more.
/// Who is not of `flock` ([`Neighbor::slot`]) is a stranger.
///
/// O(N K); beside the answer 24 K bytes of stack (`f32`, pointers of 32 bits).
#[must_use]
pub fn nearest<S: Scalar, const K: usize>(
    known: &[Neighbor<S, impl Copy>],
    flock: u8,
    own: Position,
    own_radius_m: S,
    now: Instant,
    ages: &Ages,
    inflation: &StalenessInflation<S>,
) -> Vec<Nearby<S>, K> {
    let mut nearest = Vec::<(u64, Vec3<S>, &Neighbor<S, _>), K>::new();
    for entry in known {
        if entry.age(now).is_none_or(|age| age > ages.expire_after) {
            continue;
        }
        let offset_m = entry.offset_at(own, now, ages.stale_after);
        let key = offset_m.length_key();
        // Entries come in the order of ids, so that the later of two equal keys stays behind.
        if nearest.is_full() && nearest.last().is_some_and(|(farthest, ..)| *farthest > key) {
            nearest.pop();
        }
        if nearest.push((key, offset_m, entry)).is_ok() {
            sink_last(&mut nearest, |before, after| before.0 > after.0);
        }
    }
    let seen = |&(_, offset_m, entry): &(u64, Vec3<S>, &Neighbor<S, _>)| Nearby {
        is_stranger: entry.slot != flock,
        ..seen(entry, offset_m, own_radius_m, now, ages, inflation)
    };
    list::collect(nearest.iter().map(seen))
}

/// Adds robots that are lost ([`NeighborTable::lost`](super::NeighborTable::lost)) behind those that are not: balls that
/// stand, as a stale one's does, for as long as they are remembered. Those that find no room come to nothing. O(lost).
pub fn add_lost<S: Scalar, const K: usize>(
    nearby: &mut Vec<Nearby<S>, K>,
    lost: &[Neighbor<S, impl Copy>],
    own: Position,
    own_radius_m: S,
    now: Instant,
    ages: &Ages,
    inflation: &StalenessInflation<S>,
) {
    let offset_m = |entry: &Neighbor<S, _>| entry.offset_at(own, now, ages.stale_after);
    list::extend(nearby, lost.iter().map(|entry| seen(entry, offset_m(entry), own_radius_m, now, ages, inflation)));
}

fn seen<S: Scalar>(
    entry: &Neighbor<S, impl Copy>,
    offset_m: Vec3<S>,
    own_radius_m: S,
    now: Instant,
    ages: &Ages,
    inflation: &StalenessInflation<S>,
) -> Nearby<S> {
    let age = entry.age(now).unwrap_or(Duration::MAX);
    let is_fresh = age <= ages.stale_after;
    let mut nearby = Nearby {
        id: entry.id,
        offset_m,
        velocity_mps: entry.velocity_mps,
        radius_m: entry.radius_m,
        gives_way: is_fresh && entry.mode.gives_way(),
        mode: entry.mode,
        is_stranger: false,
    };
    if !is_fresh {
        nearby.velocity_mps = Vec3::ZERO;
        let silent = age.as_micros().saturating_sub(ages.stale_after.as_micros());
        let growth = (inflation.growth_mps * S::HALF * S::from_micro(silent)).min(inflation.max_m);
        let room = offset_m.norm() - own_radius_m - entry.radius_m;
        nearby.radius_m += growth.min(room).max(S::ZERO);
    }
    nearby
}
