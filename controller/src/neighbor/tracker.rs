//! Neighbours that are seen, not heard: by a camera, by UWB, by motion capture. Read [`Tracker`] first.

use super::track::Track;
use super::{Neighbor, NeighborTable};
use crate::geom::{Position, Vec3};
use crate::grid::{Cell, Dir};
use crate::list;
use crate::robot::{Mode, RobotId};
use crate::scalar::{Scalar, cast};
use crate::time::{Duration, Instant};
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(all(test, feature = "fixed"))]
mod tests;

/// Robots that a tracker follows: as many as an agent of default capacity knows.
pub const TRACKS: usize = 16;
/// Sightings of a step that are looked at; those beyond are counted as [`Sighted::no_room`].
pub const SIGHTINGS: usize = 32;

/// Where a robot that stands in no known cell is: in the corner of all maps.
const NO_CELL: Cell = Cell::new(i16::MIN, i16::MIN);

/// Another robot, as somebody's own sensors show it.
///
/// The place is relative to the own one, since that is what a camera or UWB measures and needs no frame in common: a robot that goes by
/// odometry alone avoids whom it sees. What is heard besides is in the common frame, and merging both needs it. Motion capture
/// tells places in it: subtract the own one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighting<S> {
    /// Its place minus the own one when it was seen, metres, along the axes of the world (not of the body).
    pub offset_m: Vec3<S>,
    /// Standard deviation of that along each axis, metres; above 0. Less than 4 mm counts as 4 mm.
    pub deviation_m: S,
    /// How long ago it was seen; 0 or more.
    pub age: Duration,
    /// Radius of the ball around its body, metres.
    pub radius_m: S,
    /// Who it is, if the sensor can tell; `None`: somebody.
    pub id: Option<RobotId>,
    /// Its world velocity and the standard deviation of that along each axis, m/s, if the sensor can tell.
    pub velocity_mps: Option<(Vec3<S>, S)>,
}

/// How sightings become neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TrackParams<S> {
    /// Standard deviation of the others' accelerations, m/s^2. Larger: the estimate follows turns sooner and believes each single
    /// sighting more; smaller: it is smoother, and late where somebody turns.
    pub acceleration_mps2: S,
    /// Standard deviation of the velocity along each axis of somebody who has just come into sight, m/s: about what others can do.
    pub speed_mps: S,
    /// Standard deviation of the places that others say, metres: their positioning.
    pub heard_m: S,
    /// Standard deviation of the velocities that others say, m/s: how well their bodies do what they say.
    pub heard_mps: S,
    /// How many standard deviations from where it should be a sighting may be and still be of that robot. Larger: two who pass
    /// each other are taken for each other; smaller: one robot becomes two.
    pub gate: S,
    /// How many standard deviations of its place are added to the radius of one that is seen. Smaller: errors lead to overlaps; larger:
    /// crowds stand still. (D. Hennes, D. Claes, W. Meeussen, K. Tuyls, "Multi-robot collision avoidance with localization
    /// uncertainty", AAMAS 2012, section 3: bodies grow by the error of localization.)
    pub margin: S,
    /// After how long one that says nothing and is not seen any more is forgotten. It is behind something or out of sight, so its silence
    /// is no sign that it is near. Longer: who comes out from behind others is known sooner, and places where somebody was are kept
    /// clear for longer. With more than [`Ages::stale_after`](super::Ages::stale_after) it counts as fallen silent meanwhile.
    pub forget: Duration,
}

impl<S: Scalar> TrackParams<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> TrackParams<T> {
        TrackParams {
            acceleration_mps2: cast(self.acceleration_mps2),
            speed_mps: cast(self.speed_mps),
            heard_m: cast(self.heard_m),
            heard_mps: cast(self.heard_mps),
            gate: cast(self.gate),
            margin: cast(self.margin),
            forget: self.forget,
        }
    }
}

/// What became of the sightings of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighted {
    /// Of robots that were known.
    pub known: u16,
    /// Of robots that were not.
    pub new: u16,
    /// Of one robot a second time: of the same number, or in the place of one that was seen already.
    pub repeated: u16,
    /// That cannot be: no numbers, a deviation of 0 or less, an age below 0, the own number, one that no robot has.
    pub refused: u16,
    /// For which there is no room.
    pub no_room: u16,
}

/// Follows those who are seen, and merges what is seen of them with what is heard.
///
/// | what comes | it goes to |
/// | --- | --- |
/// | a sighting with a number | the track of that number; else the nearest nameless track within the gate, which has this number from then on; else a new one |
/// | one without | the track within the gate whose place it fits best, seen or heard, the best fits first and each track once in a step (greedy nearest neighbour: S. Blackman, R. Popoli, "Design and Analysis of Modern Tracking Systems", 1999, section 6.4); else, unless it lies within the body of one that was seen already, a new one |
/// | a beacon | the track of that number, or a nameless one within the gate, or a new one |
///
/// Each is weighted by its error, which grows with its age ([`Track`]). Who is seen is in the neighbour table as that makes it,
/// fresh from when it was seen, its radius enlarged by [`margin`](TrackParams::margin) deviations; who is only heard is there as
/// it said, untouched. Who is only seen has no leader and no cell, tells nothing, is of the own flock and taken to give way.
///
/// 16 tracks of 80 bytes (`f32`).
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "state", derive(serde::Deserialize))]
pub struct Tracker<S> {
    params: TrackParams<S>,
    tracks: Vec<Track<S>, TRACKS>,
    /// Nameless tracks so far, wraps.
    nameless: u16,
}

/// A sighting with its place and time in the robot's world.
struct Placed<'a, S> {
    sighting: &'a Sighting<S>,
    place: Position,
    at: Instant,
}

impl<S: Scalar> Tracker<S> {
    /// One that has seen nobody.
    #[must_use]
    pub const fn new(params: TrackParams<S>) -> Self {
        Self { params, tracks: Vec::new(), nameless: 0 }
    }

    /// Those that it follows.
    #[must_use]
    pub fn tracks(&self) -> &[Track<S>] {
        &self.tracks
    }

    /// Takes in what robot `own`, who is at `position` and goes with `velocity_mps`, sees at `now`.
    ///
    /// O(SIGHTINGS * TRACKS) predictions, and as often as there are tracks a look at all pairs; 3 KiB of stack (`f32`).
    pub fn see(
        &mut self,
        sightings: &[Sighting<S>],
        own: RobotId,
        position: Position,
        velocity_mps: Vec3<S>,
        now: Instant,
    ) -> Sighted {
        let mut count = Sighted::default();
        let mut all = Vec::<Placed<'_, S>, SIGHTINGS>::new();
        for sighting in sightings {
            let back_m = velocity_mps * S::from_micro(sighting.age.as_micros());
            match position.moved(sighting.offset_m - back_m).filter(|_| is_sound(sighting, own)) {
                None => add(&mut count.refused),
                Some(place) => {
                    if all.push(Placed { sighting, place, at: now - sighting.age }).is_err() {
                        add(&mut count.no_room);
                    }
                }
            }
        }
        let mut named = Vec::<RobotId, SIGHTINGS>::new();
        for placed in &all {
            let Some(id) = placed.sighting.id else { continue };
            if named.contains(&id) {
                add(&mut count.repeated);
                continue;
            }
            // As many as there are sightings.
            let _ = named.push(id);
            let place = self.place_of(id, |track, params| {
                track.surprise(placed.place, placed.sighting.deviation_m, placed.at, params)
            });
            match place.and_then(|place| self.tracks.get_mut(place)) {
                Some(track) => {
                    track.id = id;
                    track.see(placed.sighting, placed.place, placed.at, &self.params);
                    add(&mut count.known);
                }
                None => self.begin(id, placed, position, &mut count),
            }
        }
        self.see_nameless(&all, position, &mut count);
        count
    }

    /// Sightings without numbers, the best fits first.
    fn see_nameless(&mut self, all: &[Placed<'_, S>], own: Position, count: &mut Sighted) {
        let Self { params, tracks, .. } = self;
        let fits = all.iter().filter(|placed| placed.sighting.id.is_none()).map(|placed| {
            let fit = |track: &Track<S>| track.surprise(placed.place, placed.sighting.deviation_m, placed.at, params);
            (placed, list::collect::<_, TRACKS>(tracks.iter().map(fit)))
        });
        let mut fits: Vec<(&Placed<'_, S>, Vec<Option<S>, TRACKS>), SIGHTINGS> = list::collect(fits);
        let mut is_left = [true; SIGHTINGS];
        for _ in 0..TRACKS {
            let mut best: Option<(S, usize, usize)> = None;
            for (row, (_, fits)) in fits.iter().enumerate().filter(|(row, _)| is_left.get(*row) == Some(&true)) {
                for (column, fit) in fits.iter().enumerate() {
                    if let Some(fit) = *fit
                        && fit <= params.gate
                        && best.is_none_or(|(least, ..)| fit < least)
                    {
                        best = Some((fit, row, column));
                    }
                }
            }
            let Some((_, row, column)) = best else { break };
            if let (Some((placed, _)), Some(track)) = (fits.get(row), tracks.get_mut(column)) {
                track.see(placed.sighting, placed.place, placed.at, params);
                add(&mut count.known);
            }
            for (_, fits) in &mut fits {
                if let Some(fit) = fits.get_mut(column) {
                    *fit = None;
                }
            }
            if let Some(is_left) = is_left.get_mut(row) {
                *is_left = false;
            }
        }
        let left = fits.iter().zip(is_left).filter(|(_, is_left)| *is_left);
        for ((placed, _), _) in left {
            let Sighting { radius_m, .. } = *placed.sighting;
            let is_within = |track: &Track<S>| {
                track.seen == Some(placed.at) && track.offset_m(placed.place).norm() < radius_m.max(track.radius_m)
            };
            if self.tracks.iter().any(is_within) {
                add(&mut count.repeated);
                continue;
            }
            let id = self.new_number();
            self.begin(id, placed, own, count);
        }
    }

    /// The track of a number: its own, or the nameless one that `surprise` likes best, within the gate.
    fn place_of(&self, id: RobotId, surprise: impl Fn(&Track<S>, &TrackParams<S>) -> Option<S>) -> Option<usize> {
        self.tracks.iter().position(|track| track.id == id).or_else(|| {
            let nameless = self.tracks.iter().enumerate().filter(|(_, track)| track.id.is_local());
            let fits = nameless.filter_map(|(place, track)| Some((surprise(track, &self.params)?, place)));
            let best = fits.min_by(|(one, _), (other, _)| one.order(*other));
            best.filter(|(surprise, _)| *surprise <= self.params.gate).map(|(_, place)| place)
        })
    }

    /// Begins to follow somebody who was seen.
    fn begin(&mut self, id: RobotId, placed: &Placed<'_, S>, own: Position, count: &mut Sighted) {
        let &Placed { sighting, place, at } = placed;
        let mut track = Track::new(id, at, place, sighting.deviation_m, &self.params);
        if let Some((velocity_mps, deviation_mps)) = sighting.velocity_mps {
            track.goes(velocity_mps, deviation_mps);
        }
        (track.radius_m, track.seen) = (sighting.radius_m, Some(at));
        if self.insert(track, own) {
            add(&mut count.new);
        } else {
            add(&mut count.no_room);
        }
    }

    /// Adds a track; when there are too many, in the place of the farthest if it is nearer. Whether it is in.
    fn insert(&mut self, track: Track<S>, own: Position) -> bool {
        if self.tracks.is_full() {
            let key = |track: &Track<S>| (track.offset_m(own).length_key(), track.id);
            let farthest = self.tracks.iter_mut().max_by_key(|track| key(track));
            return match farthest {
                Some(farthest) if key(&track) < key(farthest) => {
                    *farthest = track;
                    true
                }
                _ => false,
            };
        }
        self.tracks.push(track).is_ok()
    }

    /// Takes in what `table` has heard since the last step. O(N TRACKS).
    pub fn hear<const N: usize, P: Copy>(&mut self, table: &NeighborTable<S, N, P>, own: Position) {
        for entry in table {
            let news = Some((entry.heard, entry.position));
            let params = self.params;
            let place = self.place_of(entry.id, |track, params| {
                track.surprise(entry.position, params.heard_m, entry.heard, params)
            });
            let track = match place.and_then(|place| self.tracks.get_mut(place)) {
                Some(track) if track.known == news => continue,
                Some(track) => track,
                None => {
                    let mut track = Track::new(entry.id, entry.heard, entry.position, params.heard_m, &params);
                    track.goes(entry.velocity_mps, params.heard_mps);
                    (track.radius_m, track.heard, track.known) = (entry.radius_m, Some(entry.heard), news);
                    let _ = self.insert(track, own);
                    continue;
                }
            };
            track.id = entry.id;
            track.hear(entry.position, entry.velocity_mps, entry.heard, &params);
            (track.radius_m, track.known) = (entry.radius_m, news);
        }
    }

    /// Stops following those who are neither seen any more nor in `table`, and those who are neither seen nor have been heard for
    /// longer than [`Ages::expire_after`](super::Ages::expire_after): `gone` hears the numbers of the latter that were followed by sight. O(N TRACKS).
    pub fn forget<const N: usize, P: Copy>(
        &mut self,
        table: &mut NeighborTable<S, N, P>,
        now: Instant,
        mut gone: impl FnMut(RobotId),
    ) {
        let (forget, expire) = (self.params.forget, table.ages().expire_after);
        let is_within = |at: Option<Instant>, longest: Duration| {
            at.is_some_and(|at| (Duration::ZERO..=longest).contains(&now.since(at)))
        };
        for track in &mut self.tracks {
            if is_within(track.seen, forget) {
                continue;
            }
            let was_seen = track.seen.take().is_some();
            if was_seen && !is_within(track.heard, expire) && table.forget(track.id) {
                gone(track.id);
            }
        }
        self.tracks.retain(|track| track.seen.is_some() || table.get(track.id, now).known().is_some());
    }

    /// Those who are seen as neighbours, each with what `table` knows of it otherwise, if anything; to be put there. The flock of those who say
    /// nothing is `flock`. O(TRACKS log N).
    pub fn seen<const N: usize, P: Copy + Default>(
        &mut self,
        table: &NeighborTable<S, N, P>,
        flock: u8,
        now: Instant,
    ) -> Vec<Neighbor<S, P>, TRACKS> {
        let params = self.params;
        let seen = self.tracks.iter_mut().filter(|track| track.seen.is_some()).map(|track| {
            track.known = Some((track.at, track.position));
            let known = table.get(track.id, now).known();
            let neighbor = known.copied().unwrap_or_else(|| stranger(track, flock));
            Neighbor {
                heard: track.at,
                position: track.position,
                velocity_mps: track.velocity_mps,
                radius_m: track.radius_m + params.margin * track.deviation_m(),
                ..neighbor
            }
        });
        list::collect(seen)
    }

    /// A number for somebody without one, which nobody else has now.
    fn new_number(&mut self) -> RobotId {
        // One of so many is free.
        for _ in 0..=TRACKS {
            self.nameless = self.nameless.wrapping_add(1);
            if !self.tracks.iter().any(|track| track.id == RobotId::local(self.nameless)) {
                break;
            }
        }
        RobotId::local(self.nameless)
    }
}

/// Somebody of whom nothing is known but where he is.
fn stranger<S: Scalar, P: Default>(track: &Track<S>, flock: u8) -> Neighbor<S, P> {
    Neighbor {
        id: track.id,
        heard: track.at,
        busy_until: track.at,
        position: track.position,
        velocity_mps: track.velocity_mps,
        radius_m: track.radius_m,
        cell: NO_CELL,
        target: NO_CELL,
        leader: RobotId::NOBODY,
        heading: Dir::Stay,
        slot: flock,
        mode: Mode::Cruise,
        is_lost: false,
        gap_m: S::ZERO,
        payload: P::default(),
    }
}

/// Whether it can be what robot `own` saw.
fn is_sound<S: Scalar>(sighting: &Sighting<S>, own: RobotId) -> bool {
    let Sighting { offset_m, deviation_m, age, radius_m, id, velocity_mps } = sighting;
    let is_size = |x: S| x.is_finite() && x >= S::ZERO;
    offset_m.is_finite()
        && is_size(*deviation_m)
        && *deviation_m > S::ZERO
        && is_size(*radius_m)
        && *age >= Duration::ZERO
        && id.is_none_or(|id| id.is_somebody() && id != own && id.doubled().is_none() && !id.is_local())
        && velocity_mps.is_none_or(|(v, deviation)| v.is_finite() && is_size(deviation))
}

fn add(count: &mut u16) {
    *count = count.saturating_add(1);
}
