//! What is known of other robots: a table on a fixed buffer.
//!
//! Read this first. Entries lie sorted by id, so that no result depends on the order in which
//! packets arrived. The owner calls [`NeighborTable::expire`] at the start of every step: the
//! 32-bit clock cannot tell a neighbour that has been silent for 71.6 minutes from a fresh one, and
//! a table that is swept more often than that never holds one.

use crate::geom::{Position, Vec3};
use crate::grid::{Cell, Dir};
use crate::list::sink_last;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

mod claims;
mod loss;
mod nearby;
mod room;
mod sighting;
#[cfg(all(test, feature = "wire"))]
mod tests;
mod tie;
mod track;
mod tracker;

pub use claims::{Claim, Claims, Doubt, Suspects};
pub use loss::LossEstimate;
pub use nearby::{Nearby, StalenessInflation, add_lost, nearest};
pub use room::Room;
pub use sighting::{Sighted, Sighting, TrackParams};
pub use tie::tie;
pub use track::Track;
pub use tracker::{SIGHTINGS, TRACKS, Tracker};

/// Thousandths of the distance to the farthest fresh robot from which on one that is lost has gone out of range.
const LEAVES_FROM: i32 = 750;

/// One robot as last heard; `P` is what its law tells, of size 0 unless it tells something.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Neighbor<S, P = ()> {
    /// Who it is.
    pub id: RobotId,
    /// When it was heard, own clock.
    pub heard: Instant,
    /// When it is free to leave its cell, own clock (A. V. Kuznetsov 2017, KUZ, eq. 6).
    pub busy_until: Instant,
    /// World position when heard.
    pub position: Position,
    /// World velocity when heard, metres per second.
    pub velocity_mps: Vec3<S>,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// The cell that it occupies.
    pub cell: Cell,
    /// The cell that it is heading for.
    pub target: Cell,
    /// Its leader, or nobody.
    pub leader: RobotId,
    /// The move that it wants next.
    pub heading: Dir,
    /// Its place in the formation, or its flock.
    pub slot: u8,
    /// What it is doing.
    pub mode: Mode,
    /// Silent for longer than [`Ages::expire_after`]: it is remembered, but what it did no longer counts.
    pub is_lost: bool,
    /// How far it is from the own body at least while it is silent, metres: what [`Room`] makes of it.
    pub gap_m: S,
    /// What its law told last, beside its beacons; the default until it has told something.
    pub payload: P,
}

impl<S: Scalar, P> Neighbor<S, P> {
    /// Time since it was heard; `None` when that lies in the future, which means that more than
    /// half the clock's range has passed.
    #[must_use]
    pub fn age(&self, now: Instant) -> Option<Duration> {
        Some(now.since(self.heard)).filter(|age| *age >= Duration::ZERO)
    }

    /// Where it is at `now` if it kept its velocity for at most `longest` since it was heard and
    /// then stood, seen from `from`; metres. Bounding the age bounds the error: a robot that fell
    /// silent does not run off the map. [`Ages::stale_after`] is a good bound.
    #[must_use]
    pub fn offset_at(&self, from: Position, now: Instant, longest: Duration) -> Vec3<S> {
        let span = self.age(now).map_or(longest, |age| age.min(longest));
        self.position.since(from) + self.velocity_mps * S::from_micro(span.as_micros())
    }
}

/// How old news may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ages {
    /// Older than this is [`Knowledge::Stale`]: a few beacon periods. Too short: a lossy radio makes
    /// everybody stale; too long: robots trust positions that are no longer true.
    pub stale_after: Duration,
    /// Older than this is lost: only where it was is remembered; at most half an hour, so that the clock's wrap is never
    /// near.
    pub expire_after: Duration,
}

/// What is known of one robot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Knowledge<'a, S, P = ()> {
    /// Heard a short while ago.
    Fresh(&'a Neighbor<S, P>),
    /// Heard, but not lately.
    Stale(&'a Neighbor<S, P>),
    /// Never heard, forgotten, or pushed out.
    Unknown,
}

impl<'a, S, P> Knowledge<'a, S, P> {
    /// The neighbour if it is fresh.
    #[must_use]
    pub const fn fresh(self) -> Option<&'a Neighbor<S, P>> {
        match self {
            Self::Fresh(neighbor) => Some(neighbor),
            Self::Stale(_) | Self::Unknown => None,
        }
    }

    /// The neighbour, fresh or stale.
    #[must_use]
    pub const fn known(self) -> Option<&'a Neighbor<S, P>> {
        match self {
            Self::Fresh(neighbor) | Self::Stale(neighbor) => Some(neighbor),
            Self::Unknown => None,
        }
    }
}

/// What became of a neighbour that was put into the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "an eviction is news for the robot's owner"]
pub enum Put {
    /// It is new.
    Inserted,
    /// It replaced what was known of the same robot.
    Updated,
    /// It is new, and this one had to go.
    Evicted(RobotId),
    /// The table is full of more important ones, or the newcomer is nobody.
    Refused,
}

#[cfg(not(feature = "host"))]
type Entries<S, const N: usize, P> = heapless::Vec<Neighbor<S, P>, N, u16>;
#[cfg(feature = "host")]
type Entries<S, const N: usize, P> = crate::list::Seldom<Neighbor<S, P>, N>;

/// The known robots, at most `N`, sorted by id; behind them the lost ones that are still remembered, by id too.
///
/// Bytes: `N` times those of [`Neighbor`] (60 for `f32` and fixed point, and those of a payload) and 16 more; with the feature `host` those of the
/// robots in it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NeighborTable<S, const N: usize, P = ()> {
    entries: Entries<S, N, P>,
    ages: Ages,
    /// The farthest that anybody was heard from while another one was lost, metres; 0: that never was.
    range_m: S,
}

impl<S: Scalar, const N: usize, P: Copy> NeighborTable<S, N, P> {
    /// An empty table.
    #[must_use]
    pub const fn new(ages: Ages) -> Self {
        Self { entries: Entries::new(), ages, range_m: S::ZERO }
    }

    /// The ages that it was built with.
    #[must_use]
    pub const fn ages(&self) -> Ages {
        self.ages
    }

    /// Puts `newcomer` in, replacing what was known of the same robot. O(N).
    ///
    /// When the table is full, somebody has to go, though never a robot that `protect` names (the
    /// leader, members of the formation's template) unless it is lost:
    /// 1. the stalest of those older than [`Ages::expire_after`];
    /// 2. else the one farthest from `own`, if the newcomer is nearer or protected;
    /// 3. else the newcomer is refused.
    ///
    /// A [double](RobotId::double) only ever takes the place of another one, so that nobody crowds out robots by speaking in the
    /// names of others. Ties go to the smaller id. Distances are taken at the extrapolated positions; an unknown
    /// distance (NaN) is the largest. So the content after a burst of beacons does not depend on
    /// their order (unless more than `N` of them are protected).
    pub fn put(
        &mut self,
        newcomer: Neighbor<S, P>,
        own: Position,
        now: Instant,
        protect: impl Fn(RobotId) -> bool,
    ) -> Put {
        if !newcomer.id.is_somebody() {
            return Put::Refused;
        }
        let place = self.place(newcomer.id);
        if place.is_none() {
            // Here is one of the lost again.
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
            // Whose loss was news already is no news again.
            if self.place(victim).is_some() {
                answer = Put::Evicted(victim);
            }
            self.entries.retain(|entry| entry.id != victim);
        }
        if self.entries.push(newcomer).is_err() {
            return Put::Refused; // Only a table without any room comes here.
        }
        self.sort_last();
        answer
    }

    /// Who must go so that `newcomer` can come in; `None`: nobody.
    fn victim(
        &self,
        newcomer: &Neighbor<S, P>,
        own: Position,
        now: Instant,
        protect: impl Fn(RobotId) -> bool,
    ) -> Option<RobotId> {
        let is_double = newcomer.id.doubled().is_some();
        let may_go = |entry: &&Neighbor<S, P>| {
            entry.is_lost || !protect(entry.id) && (!is_double || entry.id.doubled().is_some())
        };
        let candidates = || self.entries.iter().filter(may_go);
        // An age beyond half the clock's range is older than any that can be told.
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

    /// Moves everybody older than `longest`, at most [`Ages::expire_after`], to the lost, reporting each in the order of ids,
    /// and forgets whom it has not heard for longer than `remember`. O(N), and O(N) for each that is lost.
    ///
    /// One that would be three quarters as far from `own` as the farthest fresh one, or farther, had it gone on as it went
    /// last, has gone out of range, as far as one can tell, and is not remembered; when nobody is fresh, one that would be
    /// as far as anybody was heard from when others left, or farther; all are remembered if nobody has left before. Neither
    /// is one of two with one number while the other one is fresh: one robot that was moved looks like two.
    ///
    /// Call it every step: see the head of this module.
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
            // Who hears nobody at all knows how far the radio reaches from those who left before, or takes it for dead.
            let range_m = if farthest_m > S::ZERO { farthest_m * S::from_milli(LEAVES_FROM) } else { self.range_m };
            self.range_m = self.range_m.max(farthest_m);
            // Of two with one number one is still there: it was moved, and taken for another one.
            let is_moved = || {
                let mut others = self.as_slice().iter();
                others.any(|entry| entry.id.double() == silent.id.double() && is_within(entry, ages.stale_after))
            };
            if (range_m <= S::ZERO || distance(&silent) < range_m) && !is_moved() {
                // Into the place that has just become free.
                let _ = self.entries.push(Neighbor { is_lost: true, ..silent });
                self.sort_last();
            }
        }
        self.entries.retain(|entry| !entry.is_lost || is_within(entry, remember));
    }

    /// Takes in what the law of robot `id` tells, if that robot is known; `None` is what makes no sense. O(log N).
    pub fn tell(&mut self, id: RobotId, payload: Option<P>) {
        if let Some(payload) = payload
            && let Some(entry) = self.place(id).and_then(|i| self.entries.get_mut(i))
        {
            entry.payload = payload;
        }
    }

    /// Forgets robot `id`, whom it does not remember as lost; whether it was known. O(N).
    pub fn forget(&mut self, id: RobotId) -> bool {
        let is_known = self.place(id).is_some();
        if is_known {
            self.entries.retain(|entry| entry.is_lost || entry.id != id);
        }
        is_known
    }

    /// Has everybody, the lost too, at another place: on a torus, at the image nearest to oneself. O(N).
    pub fn see_at(&mut self, place: impl Fn(Position) -> Position) {
        for entry in &mut self.entries {
            entry.position = place(entry.position);
        }
    }

    /// Forgets how near the silent ones can be: to be called in a step in which nobody asks [`Room`]. O(N).
    pub fn forget_gaps(&mut self) {
        for entry in &mut self.entries {
            entry.gap_m = S::ZERO;
        }
    }

    /// Puts the last entry where it belongs.
    fn sort_last(&mut self) {
        sink_last(&mut self.entries, |before, after| (before.is_lost, before.id) > (after.is_lost, after.id));
    }

    /// What is known of robot `id`. O(log N).
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

    /// How far an entry of this table can be trusted at `now`.
    #[must_use]
    pub fn judge<'a>(&self, entry: &'a Neighbor<S, P>, now: Instant) -> Knowledge<'a, S, P> {
        match entry.age(now) {
            Some(age) if age > self.ages.expire_after => Knowledge::Unknown,
            Some(age) if age > self.ages.stale_after => Knowledge::Stale(entry),
            Some(_) => Knowledge::Fresh(entry),
            None => Knowledge::Unknown,
        }
    }

    /// Everybody, in the order of ids; fresh and stale ones, if [`NeighborTable::expire`] is called
    /// every step.
    pub fn iter(&self) -> core::slice::Iter<'_, Neighbor<S, P>> {
        self.as_slice().iter()
    }

    /// Everybody, in the order of ids.
    #[must_use]
    pub fn as_slice(&self) -> &[Neighbor<S, P>] {
        self.entries.get(..self.count()).unwrap_or(&self.entries)
    }

    /// The lost that are remembered, in the order of ids.
    #[must_use]
    pub fn lost(&self) -> &[Neighbor<S, P>] {
        self.entries.get(self.count()..).unwrap_or_default()
    }

    /// How many are known: the first ones of all entries.
    fn count(&self) -> usize {
        // Few robots have lost anybody: who is last tells.
        match self.entries.last() {
            Some(last) if last.is_lost => self.entries.partition_point(|entry| !entry.is_lost),
            _ => self.entries.len(),
        }
    }

    /// How many are known.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count()
    }

    /// Whether nobody is known.
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

// Every byte counts 16 times per robot, and a simulated swarm has 100,000 of them.
const _: () = assert!(size_of::<Neighbor<f32>>() == 60);
#[cfg(not(feature = "host"))]
const _: () = assert!(size_of::<NeighborTable<f32, 16>>() == 16 * 60 + 16);
