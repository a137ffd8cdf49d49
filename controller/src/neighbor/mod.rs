//! State of other robots: a neighbour table in a fixed buffer, silence and loss of neighbours,
//! plausibility limits, tracking with sensors, and the gap to each neighbour.
//!
//! Start with [`NeighborTable`], and call [`NeighborTable::expire`] at the start of each step: the
//! 32-bit clock cannot distinguish a neighbour silent for 71.6 minutes from a fresh one. Entries
//! are sorted by id, so results do not depend on the order in which packets arrive.

use crate::geom::{Position, Vec3};
use crate::grid::{Cell, Dir};
use crate::list::sink_last;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

mod gap_limit;
mod loss;
mod nearby;
mod plausibility;
mod sighting;
#[cfg(all(test, feature = "wire"))]
mod tests;
mod tie;
mod track;
mod tracker;

pub use gap_limit::GapLimit;
pub use loss::LossEstimate;
pub use nearby::{Nearby, StalenessInflation, add_lost, nearest};
pub use plausibility::{Claim, PlausibilityFilter, PlausibilityLimits, Verdict};
pub use sighting::{Sighted, Sighting, TrackParams};
pub use tie::tie;
pub use track::Track;
pub use tracker::{SIGHTINGS, TRACKS, Tracker};

/// Where a lost robot is out of range, thousandths of the distance to the farthest fresh robot.
const LEAVES_FROM: i32 = 750;

/// The last known state of one robot. `P` is the payload of its guidance law, if any.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Neighbor<S, P = ()> {
    /// Its id.
    pub id: RobotId,
    /// When the state was received, own clock.
    pub heard: Instant,
    /// When it is free to leave its cell, own clock (A. V. Kuznetsov 2017, KUZ, eq. 6).
    pub busy_until: Instant,
    /// World position at the time `heard`.
    pub position: Position,
    /// World velocity at the time `heard`, m/s.
    pub velocity_mps: Vec3<S>,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// The cell that it occupies.
    pub cell: Cell,
    /// The cell of its goal.
    pub target: Cell,
    /// Its leader, or [`RobotId::NONE`].
    pub leader: RobotId,
    /// The move that it intends next.
    pub heading: Dir,
    /// Its place in the formation, or its flock.
    pub slot: u8,
    /// The mode that it last reported.
    pub mode: Mode,
    /// It has been silent for longer than [`Ages::expire_after`]; only its last state is known.
    pub is_lost: bool,
    /// Lower bound of the gap to the own body while it is silent, metres; kept by [`GapLimit`].
    pub gap_m: S,
    /// The last payload of its guidance law; the default until one arrives.
    pub payload: P,
}

impl<S: Scalar, P> Neighbor<S, P> {
    /// Returns the time since its state was received; `None` beyond half of the clock's range.
    #[must_use]
    pub fn age(&self, now: Instant) -> Option<Duration> {
        Some(now.since(self.heard)).filter(|age| *age >= Duration::ZERO)
    }

    /// Returns its offset from `from` at `now`, metres, if it kept its velocity for at most
    /// `longest` and then stopped. [`Ages::stale_after`] is a good bound.
    #[must_use]
    pub fn offset_at(&self, from: Position, now: Instant, longest: Duration) -> Vec3<S> {
        let span = self.age(now).map_or(longest, |age| age.min(longest));
        self.position.since(from) + self.velocity_mps * S::from_micro(span.as_micros())
    }
}

/// Limits on the age of a neighbour's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ages {
    /// Age above which a neighbour is [`Knowledge::Stale`]: a few beacon periods. Shorter: packet
    /// loss makes neighbours stale. Longer: robots trust outdated positions.
    pub stale_after: Duration,
    /// Age above which a neighbour is lost and only its last position is remembered; at most half
    /// an hour, so that the clock never wraps meanwhile.
    pub expire_after: Duration,
}

/// Knowledge about one robot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Knowledge<'a, S, P = ()> {
    /// Its state is recent.
    Fresh(&'a Neighbor<S, P>),
    /// Its state is older than [`Ages::stale_after`].
    Stale(&'a Neighbor<S, P>),
    /// It was never received, is lost or forgotten, or was evicted.
    Unknown,
}

impl<'a, S, P> Knowledge<'a, S, P> {
    /// Returns the neighbour if it is fresh.
    #[must_use]
    pub const fn fresh(self) -> Option<&'a Neighbor<S, P>> {
        match self {
            Self::Fresh(neighbor) => Some(neighbor),
            Self::Stale(_) | Self::Unknown => None,
        }
    }

    /// Returns the neighbour if it is fresh or stale.
    #[must_use]
    pub const fn known(self) -> Option<&'a Neighbor<S, P>> {
        match self {
            Self::Fresh(neighbor) | Self::Stale(neighbor) => Some(neighbor),
            Self::Unknown => None,
        }
    }
}

/// The result of [`NeighborTable::put`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "an eviction is news for the robot's owner"]
pub enum Put {
    /// The robot was added.
    Inserted,
    /// The previous state of the robot was replaced.
    Updated,
    /// The robot was added, and this neighbour was removed.
    Evicted(RobotId),
    /// All neighbours in the full table have precedence, or the id is [`RobotId::NONE`].
    Refused,
}

#[cfg(not(feature = "host"))]
type Entries<S, const N: usize, P> = heapless::Vec<Neighbor<S, P>, N, u16>;
#[cfg(feature = "host")]
type Entries<S, const N: usize, P> = crate::list::SparseVec<Neighbor<S, P>, N>;

/// At most `N` robots, sorted by id: first the known robots, then the remembered lost ones.
///
/// Bytes: 16, and `N` times the size of [`Neighbor`] (60 for `f32` and fixed point, plus the
/// payload). With the feature `host`, only the memory of the stored robots.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NeighborTable<S, const N: usize, P = ()> {
    entries: Entries<S, N, P>,
    ages: Ages,
    /// Greatest distance to the farthest fresh robot when another one was lost, metres; 0: never.
    range_m: S,
}

impl<S: Scalar, const N: usize, P: Copy> NeighborTable<S, N, P> {
    /// Creates an empty table.
    #[must_use]
    pub const fn new(ages: Ages) -> Self {
        Self { entries: Entries::new(), ages, range_m: S::ZERO }
    }

    /// Returns the age limits of the table.
    #[must_use]
    pub const fn ages(&self) -> Ages {
        self.ages
    }

    /// Stores `newcomer`, replacing the previous state of that robot. O(N).
    ///
    /// A full table removes the first of these candidates; a robot for which `protect` returns true
    /// (the leader, members of the formation's template) only if it is lost:
    /// 1. the robot with the oldest state, if older than [`Ages::expire_after`];
    /// 2. the robot farthest from `own`, if the newcomer is nearer or protected;
    /// 3. otherwise the newcomer is refused.
    ///
    /// A [duplicate id](RobotId::duplicate) only replaces another duplicate, so that forged ids
    /// cannot crowd out other robots. The smaller id wins a tie; an unknown distance (NaN) is the
    /// largest. Distances are extrapolated, so a burst of beacons gives the same content in any
    /// order, unless more than `N` senders are protected.
    pub fn put(
        &mut self,
        newcomer: Neighbor<S, P>,
        own: Position,
        now: Instant,
        protect: impl Fn(RobotId) -> bool,
    ) -> Put {
        if !newcomer.id.is_some() {
            return Put::Refused;
        }
        let place = self.place(newcomer.id);
        if place.is_none() {
            self.entries.retain(|entry| entry.id != newcomer.id);
        }
        if let Some(entry) = place.and_then(|i| self.entries.get_mut(i)) {
            *entry = newcomer;
            return Put::Updated;
        }
        let mut answer = Put::Inserted;
        if self.entries.is_full() {
            let Some(victim) = self.victim(&newcomer, own, now, protect) else {
                return Put::Refused;
            };
            // Its loss was already reported.
            if self.place(victim).is_some() {
                answer = Put::Evicted(victim);
            }
            self.entries.retain(|entry| entry.id != victim);
        }
        if self.entries.push(newcomer).is_err() {
            return Put::Refused; // Reached only with a capacity of 0.
        }
        self.sort_last();
        answer
    }

    fn victim(
        &self,
        newcomer: &Neighbor<S, P>,
        own: Position,
        now: Instant,
        protect: impl Fn(RobotId) -> bool,
    ) -> Option<RobotId> {
        let is_double = newcomer.id.duplicate_of().is_some();
        let may_go = |entry: &&Neighbor<S, P>| {
            entry.is_lost || !protect(entry.id) && (!is_double || entry.id.duplicate_of().is_some())
        };
        let candidates = || self.entries.iter().filter(may_go);
        let age = |entry: &Neighbor<S, P>| entry.age(now).unwrap_or(Duration::MAX);
        let stalest = candidates()
            .filter(|entry| !entry.is_lost && age(entry) > self.ages.expire_after)
            .max_by_key(|entry| (age(entry), entry.id));
        if let Some(stalest) = stalest {
            return Some(stalest.id);
        }
        let distance = |entry: &Neighbor<S, P>| {
            let offset_m = entry.offset_at(own, now, self.ages.stale_after);
            (offset_m.length_key(), entry.id)
        };
        let farthest = candidates().map(distance).max()?;
        let comes_in = protect(newcomer.id) || distance(newcomer) < farthest;
        comes_in.then_some(farthest.1)
    }

    /// Moves neighbours silent for longer than `longest` (at most [`Ages::expire_after`]) to the
    /// list of lost robots, reports each in the order of ids, and forgets robots silent for longer
    /// than `remember`. Call it at the start of each step. O(N), and O(N) for each lost robot.
    ///
    /// These robots are not remembered:
    /// - A robot that left radio range: its extrapolated position is at least 3/4 as far from `own`
    ///   as the farthest fresh robot; without fresh robots, at least as far as any robot in contact
    ///   while another one was lost. If that never happened, all robots are remembered.
    /// - One of two robots with one id, while the other is fresh: the robot was moved.
    pub fn expire(
        &mut self,
        own: Position,
        now: Instant,
        (longest, remember): (Duration, Duration),
        mut lost: impl FnMut(RobotId),
    ) {
        let ages = self.ages;
        let longest = longest.min(ages.expire_after);
        let distance = |entry: &Neighbor<S, P>| entry.offset_at(own, now, ages.expire_after).norm();
        let is_within = |entry: &Neighbor<S, P>, longest| entry.age(now).is_some_and(|age| age <= longest);
        while let Some(&silent) = self.as_slice().iter().find(|entry| !is_within(entry, longest)) {
            lost(silent.id);
            self.entries.retain(|entry| entry.id != silent.id);
            let fresh = self.as_slice().iter().filter(|entry| is_within(entry, ages.stale_after));
            let farthest_m = fresh.map(distance).fold(S::ZERO, Scalar::max);
            // Without contact the own radio may have failed, unless earlier losses give the range.
            let range_m = if farthest_m > S::ZERO { farthest_m * S::from_milli(LEAVES_FROM) } else { self.range_m };
            self.range_m = self.range_m.max(farthest_m);
            // The other robot with this id is fresh: it was moved.
            let is_moved = || {
                let mut others = self.as_slice().iter();
                others.any(|entry| entry.id.duplicate() == silent.id.duplicate() && is_within(entry, ages.stale_after))
            };
            if (range_m <= S::ZERO || distance(&silent) < range_m) && !is_moved() {
                let _ = self.entries.push(Neighbor { is_lost: true, ..silent });
                self.sort_last();
            }
        }
        self.entries.retain(|entry| !entry.is_lost || is_within(entry, remember));
    }

    /// Stores the payload of robot `id`, if known; ignores an invalid one (`None`). O(log N).
    pub fn tell(&mut self, id: RobotId, payload: Option<P>) {
        if let Some(payload) = payload
            && let Some(entry) = self.place(id).and_then(|i| self.entries.get_mut(i))
        {
            entry.payload = payload;
        }
    }

    /// Removes robot `id` without remembering it as lost; returns whether it was known. O(N).
    pub fn forget(&mut self, id: RobotId) -> bool {
        let is_known = self.place(id).is_some();
        if is_known {
            self.entries.retain(|entry| entry.is_lost || entry.id != id);
        }
        is_known
    }

    /// Moves all robots, also lost ones; on a torus, to the image nearest to the own robot. O(N).
    pub fn see_at(&mut self, place: impl Fn(Position) -> Position) {
        for entry in &mut self.entries {
            entry.position = place(entry.position);
        }
    }

    /// Resets all gap bounds. Call it in a step in which [`GapLimit`] is not used. O(N).
    pub fn forget_gaps(&mut self) {
        for entry in &mut self.entries {
            entry.gap_m = S::ZERO;
        }
    }

    fn sort_last(&mut self) {
        sink_last(&mut self.entries, |before, after| (before.is_lost, before.id) > (after.is_lost, after.id));
    }

    /// Returns the knowledge about robot `id`. O(log N).
    #[must_use]
    pub fn get(&self, id: RobotId, now: Instant) -> Knowledge<'_, S, P> {
        match self.place(id).and_then(|i| self.entries.get(i)) {
            Some(entry) => self.judge(entry, now),
            None => Knowledge::Unknown,
        }
    }

    fn place(&self, id: RobotId) -> Option<usize> {
        self.as_slice().binary_search_by_key(&id, |entry| entry.id).ok()
    }

    /// Returns how far an entry of this table can be trusted at `now`.
    #[must_use]
    pub fn judge<'a>(&self, entry: &'a Neighbor<S, P>, now: Instant) -> Knowledge<'a, S, P> {
        match entry.age(now) {
            Some(age) if age > self.ages.expire_after => Knowledge::Unknown,
            Some(age) if age > self.ages.stale_after => Knowledge::Stale(entry),
            Some(_) => Knowledge::Fresh(entry),
            None => Knowledge::Unknown,
        }
    }

    /// Iterates over the known robots in the order of ids.
    pub fn iter(&self) -> core::slice::Iter<'_, Neighbor<S, P>> {
        self.as_slice().iter()
    }

    /// The known robots in the order of ids.
    #[must_use]
    pub fn as_slice(&self) -> &[Neighbor<S, P>] {
        self.entries.get(..self.count()).unwrap_or(&self.entries)
    }

    /// The lost robots that are remembered, in the order of ids.
    #[must_use]
    pub fn lost(&self) -> &[Neighbor<S, P>] {
        self.entries.get(self.count()..).unwrap_or_default()
    }

    fn count(&self) -> usize {
        match self.entries.last() {
            Some(last) if last.is_lost => self.entries.partition_point(|entry| !entry.is_lost),
            _ => self.entries.len(),
        }
    }

    /// Number of known robots.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count()
    }

    /// Whether no robot is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.as_slice().is_empty()
    }
}

impl<'a, S: Scalar, const N: usize, P: Copy> IntoIterator for &'a NeighborTable<S, N, P> {
    type Item = &'a Neighbor<S, P>;
    type IntoIter = core::slice::Iter<'a, Neighbor<S, P>>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

// Each robot stores 16 entries, and a simulated swarm has 100,000 robots.
const _: () = assert!(size_of::<Neighbor<f32>>() == 60);
#[cfg(not(feature = "host"))]
const _: () = assert!(size_of::<NeighborTable<f32, 16>>() == 16 * 60 + 16);
