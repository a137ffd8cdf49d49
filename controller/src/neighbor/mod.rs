//! State of other robots: a neighbour table in a fixed buffer, silence and loss of neighbours,
//! plausibility limits, tracking with sensors, and the gap to each neighbour.
//!
//! Start with [`NeighborTable`], and call [`NeighborTable::expire`] at the start of each step: the
//! 32-bit clock cannot distinguish a neighbour silent for 71.6 minutes from a fresh one. Entries
//! are sorted by id, so results do not depend on the order in which packets arrive.

use crate::body::Body;
use crate::geom::{Position, Vec3};
use crate::list::sink_last;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

mod gap_limit;
mod loss;
mod nearby;
mod plausibility;
mod rounding;
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
pub use rounding::{Rounding, TooCoarse};
pub use sighting::{Sighted, Sighting, TrackParams};
pub use tie::tie;
pub use track::Track;
pub use tracker::{SIGHTINGS, TRACKS, Tracker};

/// Where a receding robot leaves radio range, thousandths of [`NeighborTable::reach_m`].
const LEAVES_FROM: i32 = 900;
/// Where a robot of which others tell is still expected to be heard, thousandths of the same.
const WITHIN_REACH: i32 = 800;
/// Share of a full table that second owners of ids may take, as a power of a half.
const DOUBLES: u32 = 3;
/// Age at which the state of a lost robot stops ageing, so that the 32-bit clock never wraps.
/// In hundredths of a second it fits [`LostRobot::age_cs`](crate::wire::LostRobot::age_cs).
const OLDEST: Duration = Duration::from_millis(650_000);

/// The last known state of one robot. `P` is the payload of its guidance law, if any.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Neighbor<S, P = ()> {
    /// Its id.
    pub id: RobotId,
    /// When the state was received, own clock.
    pub heard: Instant,
    /// World position at the time `heard`.
    pub position: Position,
    /// World velocity at the time `heard`, m/s.
    pub velocity_mps: Vec3<S>,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// The number of its flock.
    pub flock: u8,
    /// The mode that it last reported.
    pub mode: Mode,
    /// How its last beacon was received.
    pub trace: Trace,
    /// Lower bound of the gap to the own body while it is silent, metres; kept by [`GapLimit`]. Of
    /// a [lost](Trace::Lost) robot: how far it may have been from `position` when it fell silent.
    pub gap_m: S,
    /// The last payload of its law; `None` for a law with another protocol.
    pub payload: Option<P>,
}

/// How the last beacon of a robot was received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Trace {
    /// Well within radio range, or while it came nearer.
    #[default]
    Heard,
    /// While it was about to leave radio range: its silence will mean that it has left.
    Leaving,
    /// By another robot, which told where it heard it last; the velocity is not of that time.
    Told,
    /// Too long ago: it stands, dead or without a radio, near the place that it last reported.
    Lost,
}

impl<S: Scalar, P> Neighbor<S, P> {
    /// The same robot with what its law says in another form.
    #[must_use]
    pub fn map<Q>(self, payload: impl FnOnce(P) -> Option<Q>) -> Neighbor<S, Q> {
        let Self { id, heard, position, velocity_mps, radius_m, flock, mode, trace, gap_m, payload: said } = self;
        let payload = said.and_then(payload);
        Neighbor { id, heard, position, velocity_mps, radius_m, flock, mode, trace, gap_m, payload }
    }

    /// Whether it has been silent for longer than [`Ages::expire_after`] without having left.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.trace == Trace::Lost
    }

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
/// Bytes: 16, and `N` times the size of [`Neighbor`] (44 for `f32` and fixed point, plus the
/// payload). With the feature `host`, only the memory of the stored robots.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NeighborTable<S, const N: usize, P = ()> {
    entries: Entries<S, N, P>,
    ages: Ages,
    /// Greatest distance at which a beacon was received, metres.
    reach_m: S,
}

impl<S: Scalar, const N: usize, P: Copy> NeighborTable<S, N, P> {
    /// Creates an empty table.
    #[must_use]
    pub const fn new(ages: Ages) -> Self {
        Self { entries: Entries::new(), ages, reach_m: S::ZERO }
    }

    /// Sets the least distance at which the radio is known to work, metres. Without it, a robot
    /// that dies as the farthest one so far, while it recedes, counts as having left.
    #[must_use]
    pub const fn with_reach(mut self, reach_m: S) -> Self {
        self.reach_m = reach_m;
        self
    }

    /// Returns the age limits of the table.
    #[must_use]
    pub const fn ages(&self) -> Ages {
        self.ages
    }

    /// Stores `newcomer`, replacing the previous state of that robot. O(N).
    ///
    /// In a full table the farthest robot makes way for a newcomer that is nearer or protected. A
    /// robot for which `protect` returns true (the leader, members of the formation's template)
    /// never makes way. Lost robots do so only for each other, while they take more than half of
    /// the table: nothing else tells the robot where they stand.
    ///
    /// A [duplicate id](RobotId::duplicate) that is not protected only replaces another duplicate,
    /// or the first owner of its id while duplicates fill less than an eighth of the table. So
    /// forged ids cannot crowd out other robots. The smaller id wins a tie; an unknown distance
    /// (NaN) is the largest. Distances are extrapolated, so a burst of beacons gives the same
    /// content in any order, unless more than `N` senders are protected.
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
            // News of a robot that has given way do not change the bound.
            let gap_m = if entry.mode.gives_way() { entry.gap_m } else { S::ZERO };
            *entry = Neighbor { gap_m, ..newcomer };
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
        let is_double = |entry: &Neighbor<S, P>| entry.id.duplicate_of().is_some();
        let first = newcomer.id.duplicate_of().filter(|_| !protect(newcomer.id));
        let has_room = || self.iter().filter(|entry| is_double(entry)).count() < (N >> DOUBLES).max(1);
        let replaces = |entry: &Neighbor<S, P>, first| is_double(entry) || entry.id == first && has_room();
        let lost = self.lost().len().saturating_add(usize::from(newcomer.is_lost()));
        let too_many_lost = lost > N >> 1;
        let may_go = |entry: &&Neighbor<S, P>| match (entry.is_lost(), newcomer.is_lost()) {
            (true, _) => too_many_lost,
            (false, true) if too_many_lost => false,
            (false, _) => !protect(entry.id) && first.is_none_or(|first| replaces(entry, first)),
        };
        let distance = |entry: &Neighbor<S, P>| {
            let offset_m = entry.offset_at(own, now, self.ages.stale_after);
            (offset_m.length_key(), entry.id)
        };
        let farthest = self.entries.iter().filter(may_go).map(distance).max()?;
        let comes_in = protect(newcomer.id) || distance(newcomer) < farthest;
        comes_in.then_some(farthest.1)
    }

    /// Notes the distance at which `received` was received, and whether it is about to leave radio
    /// range: it recedes, and within [`Ages::stale_after`] it will be about as far away as any
    /// robot that was ever received. Call it before [`put`](Self::put).
    pub fn note_reception(&mut self, received: &mut Neighbor<S, P>, own: Position, own_mps: Vec3<S>) {
        let offset_m = received.position.since::<S>(own);
        let distance_m = offset_m.norm();
        if distance_m.is_finite() {
            self.reach_m = self.reach_m.max(distance_m);
        }
        let rate = (received.velocity_mps - own_mps).dot(offset_m);
        let rest_m = self.reach_m * S::from_milli(LEAVES_FROM) - distance_m;
        let ahead_s = S::from_micro(self.ages.stale_after.as_micros());
        let leaves = rate > S::ZERO
            && (rest_m <= S::ZERO || rate.checked_div(distance_m).is_some_and(|rate_mps| rate_mps * ahead_s >= rest_m));
        received.trace = if leaves { Trace::Leaving } else { Trace::Heard };
    }

    /// Moves neighbours silent for longer than `longest` (at most [`Ages::expire_after`]) to the
    /// list of lost robots and reports each in the order of ids. Call it at the start of each
    /// step. O(N), and O(N) for each lost robot.
    ///
    /// A lost robot may have stopped at once, or have driven on for `on_s` (a beacon period and the
    /// lag), then braked like the own `body`: its ball grows to contain both places. It stays in
    /// the list until it is received again or [cleared](Self::clear_lost).
    ///
    /// These robots are not remembered:
    /// - All, without `remembers`.
    /// - A robot that [left](Trace::Leaving) radio range.
    /// - One of two robots with one id, while the other is fresh: the robot was moved.
    pub fn expire(
        &mut self,
        (body, on_s): (&Body<S>, S),
        now: Instant,
        (longest, remembers): (Duration, bool),
        mut lost: impl FnMut(RobotId),
    ) {
        let ages = self.ages;
        let longest = longest.min(ages.expire_after);
        let is_within = |entry: &Neighbor<S, P>, longest| entry.age(now).is_some_and(|age| age <= longest);
        while let Some(&silent) = self.as_slice().iter().find(|entry| !is_within(entry, longest)) {
            lost(silent.id);
            self.entries.retain(|entry| entry.id != silent.id);
            let is_moved = || {
                let mut others = self.as_slice().iter();
                others.any(|entry| entry.id.duplicate() == silent.id.duplicate() && is_within(entry, ages.stale_after))
            };
            if remembers && silent.trace != Trace::Leaving && !is_moved() {
                let is_told = silent.trace == Trace::Told;
                let speed_mps = if is_told { body.max_speed_mps } else { silent.velocity_mps.norm() };
                let on_m = speed_mps * on_s * S::HALF;
                let half_m = body.braking_m(speed_mps) * S::HALF + on_m;
                let direction = if is_told { None } else { silent.velocity_mps.normalized() };
                let ahead_m = direction.unwrap_or(Vec3::ZERO) * half_m;
                let _ = self.entries.push(Neighbor {
                    trace: Trace::Lost,
                    position: silent.position.moved(ahead_m).unwrap_or(silent.position),
                    velocity_mps: Vec3::ZERO,
                    // In any direction, if that is unknown.
                    radius_m: silent.radius_m + if is_told { half_m + half_m } else { half_m },
                    gap_m: on_m,
                    ..silent
                });
                self.sort_last();
            }
        }
        for entry in self.entries.iter_mut().filter(|entry| entry.is_lost() && !is_within(entry, OLDEST)) {
            entry.heard = now - OLDEST;
        }
    }

    /// Removes robot `id` without remembering it as lost; returns whether it was known. O(N).
    pub fn forget(&mut self, id: RobotId) -> bool {
        let is_known = self.place(id).is_some();
        if is_known {
            self.entries.retain(|entry| entry.is_lost() || entry.id != id);
        }
        is_known
    }

    /// Removes the lost robot `id`: it is elsewhere. O(N).
    pub fn clear_lost(&mut self, id: RobotId) {
        self.entries.retain(|entry| !entry.is_lost() || entry.id != id);
    }

    /// Moves all robots, also lost ones; on a torus, to the image nearest to the own robot. O(N).
    pub fn see_at(&mut self, place: impl Fn(Position) -> Position) {
        for entry in &mut self.entries {
            entry.position = place(entry.position);
        }
    }

    /// Resets all gap bounds. Call it in a step in which [`GapLimit`] is not used. O(N).
    pub fn forget_gaps(&mut self) {
        for entry in self.entries.iter_mut().filter(|entry| !entry.is_lost()) {
            entry.gap_m = S::ZERO;
        }
    }

    fn sort_last(&mut self) {
        sink_last(&mut self.entries, |before, after| (before.is_lost(), before.id) > (after.is_lost(), after.id));
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

    /// The known robots, then the lost ones.
    pub fn all(&self) -> impl Iterator<Item = &Neighbor<S, P>> {
        self.entries.iter()
    }

    /// Whether a robot at this offset is well within radio range, as far as that is known.
    #[must_use]
    pub fn is_within_reach(&self, offset_m: Vec3<S>) -> bool {
        offset_m.norm() <= self.reach_m * S::from_milli(WITHIN_REACH)
    }

    fn count(&self) -> usize {
        match self.entries.last() {
            Some(last) if last.is_lost() => self.entries.partition_point(|entry| !entry.is_lost()),
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
const _: () = assert!(size_of::<Neighbor<f32>>() == 44);
#[cfg(not(feature = "host"))]
const _: () = assert!(size_of::<NeighborTable<f32, 16>>() == 16 * 44 + 16);
