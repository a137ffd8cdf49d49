//! The nearest robots relative to the own one, as input of guidance and collision avoidance.

use super::{Ages, Neighbor};
use crate::geom::{Position, Vec3};
use crate::list::{self, sink_last};
use crate::robot::{Mode, RobotId};
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A robot near by, extrapolated to the current step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Nearby<S> {
    /// Its id.
    pub id: RobotId,
    /// Its position minus the own position, metres.
    pub offset_m: Vec3<S>,
    /// Its world velocity, m/s.
    pub velocity_mps: Vec3<S>,
    /// Radius of the ball that contains it, metres.
    pub radius_m: S,
    /// Whether it is fresh and its [mode](crate::robot::Mode::gives_way) gives way.
    pub gives_way: bool,
    /// The mode that it last reported.
    pub mode: Mode,
    /// It belongs to another flock: a flocking robot only avoids it.
    pub is_stranger: bool,
}

/// How the ball around a silent robot grows with the age of its state; by default not at all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StalenessInflation<S> {
    /// Growth of the radius, m/s: the highest speed of any robot; less is not safe. 0: no growth.
    pub growth_mps: S,
    /// Largest growth of the ball of a robot that is taken to stand, metres: how far away it may
    /// have stopped. More blocks more places; with less, a robot may hit one that lies in its way.
    pub max_m: S,
}

impl<S: Scalar> StalenessInflation<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> StalenessInflation<T> {
        StalenessInflation { growth_mps: cast(self.growth_mps), max_m: cast(self.max_m) }
    }
}

/// Returns the `K` robots nearest to `own` at `now`, nearest first, ties by id, unknown distances
/// last.
///
/// | neighbour | position | radius | gives way |
/// | --- | --- | --- | --- |
/// | fresh | extrapolated by its velocity | as reported | depends on its mode |
/// | stale | extrapolated by [`Ages::stale_after`], then at rest | grows | no |
/// | older than [`Ages::expire_after`] | not included | | |
///
/// The ball of a stale robot grows at half of the speed in `inflation`, because
/// [`GapLimit`](super::GapLimit) covers its worst case, and never over the own ball of
/// `own_radius_m`. A robot that is not of `flock` ([`Neighbor::flock`]) is a stranger. O(N K); 24 K
/// bytes of stack in addition to the result (`f32`, 32-bit pointers).
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
        // Entries come in the order of ids: the larger id comes last among equal keys.
        if nearest.is_full() && nearest.last().is_some_and(|(farthest, ..)| *farthest > key) {
            nearest.pop();
        }
        if nearest.push((key, offset_m, entry)).is_ok() {
            sink_last(&mut nearest, |before, after| before.0 > after.0);
        }
    }
    let seen = |&(_, offset_m, entry): &(u64, Vec3<S>, &Neighbor<S, _>)| Nearby {
        is_stranger: entry.flock != flock,
        ..seen(entry, offset_m, own_radius_m, now, ages, inflation)
    };
    list::collect(nearest.iter().map(seen))
}

/// Appends lost robots ([`NeighborTable::lost`](super::NeighborTable::lost)) as stationary balls
/// that grow like those of stale robots, up to the capacity. O(lost).
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
