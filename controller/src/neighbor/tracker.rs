//! Merges tracks of robots that sensors detect with received beacons ([`Tracker`]).

use super::sighting::{Sighted, Sighting, TrackParams};
use super::track::Track;
use super::{Neighbor, NeighborTable, Trace};
use crate::geom::{Position, Vec3};
use crate::list;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod tests;

/// Number of tracks, equal to the neighbour capacity of a default agent.
pub const TRACKS: usize = 16;
/// Detections of a step that are processed; further ones are counted in [`Sighted::no_room`].
pub const SIGHTINGS: usize = 32;

/// Assigns detections and beacons to tracks, and writes each track into the neighbour table.
///
/// | input | assigned to the first of these that exists |
/// | --- | --- |
/// | detection with an id | the track with that id; the closest anonymous track; a new track |
/// | detection without an id | the closest track; a new track |
/// | beacon | the track with that id; the closest matching anonymous track; a new track |
///
/// - An anonymous track adopts the id of a detection or beacon that is assigned to it.
/// - Detections without an id are assigned best pairs first, one per track and step (greedy nearest
///   neighbour: S. Blackman, R. Popoli, "Design and Analysis of Modern Tracking Systems", 1999,
///   section 6.4). One inside the body of a robot already detected starts no track.
/// - A detection matches a track inside the gate, or if the two bodies would overlap: then it must
///   be one robot after an unexpected turn.
///
/// A tracked neighbour has the fused position, the time of its last measurement, and a radius
/// enlarged by [`margin`](TrackParams::margin) standard deviations. A neighbour known from beacons
/// alone is stored unchanged. One known from detections alone has no payload; it counts as a member
/// of the own flock that gives way. 16 tracks of 80 bytes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tracker<S> {
    params: TrackParams<S>,
    tracks: Vec<Track<S>, TRACKS>,
    displaced: Vec<Displaced, TRACKS>,
    /// Anonymous tracks so far; wraps.
    nameless: u16,
}

/// A robot whose track was replaced by a nearer one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Displaced {
    id: RobotId,
    heard: Option<Instant>,
    known: Option<(Instant, Position)>,
}

struct Placed<'a, S> {
    sighting: &'a Sighting<S>,
    place: Position,
    at: Instant,
}

impl<S: Scalar> Placed<'_, S> {
    fn fit(&self, track: &Track<S>, params: &TrackParams<S>) -> Option<S> {
        let Sighting { deviation_m, radius_m, .. } = *self.sighting;
        track.fit(self.place, deviation_m, radius_m, self.at, params)
    }
}

impl<S: Scalar> Tracker<S> {
    /// Creates a tracker without tracks.
    #[must_use]
    pub const fn new(params: TrackParams<S>) -> Self {
        Self { params, tracks: Vec::new(), displaced: Vec::new(), nameless: 0 }
    }

    /// The current tracks.
    #[must_use]
    pub fn tracks(&self) -> &[Track<S>] {
        &self.tracks
    }

    /// Processes the detections of robot `own`, at `position` with `velocity_mps`, at time `now`.
    /// O(SIGHTINGS * TRACKS) predictions, and a pass over all pairs per track; 3 KiB of stack.
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
            match position.moved(sighting.offset_m - back_m).filter(|_| sighting.is_sound(own)) {
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
            let _ = named.push(id);
            let place = self.place_of(id, |track, params| placed.fit(track, params));
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

    fn see_nameless(&mut self, all: &[Placed<'_, S>], own: Position, count: &mut Sighted) {
        let Self { params, tracks, .. } = self;
        let fits = all
            .iter()
            .filter(|placed| placed.sighting.id.is_none())
            .map(|placed| (placed, list::collect::<_, TRACKS>(tracks.iter().map(|track| placed.fit(track, params)))));
        let mut fits: Vec<(&Placed<'_, S>, Vec<Option<S>, TRACKS>), SIGHTINGS> = list::collect(fits);
        let mut is_left = [true; SIGHTINGS];
        for _ in 0..TRACKS {
            let mut best: Option<(S, usize, usize)> = None;
            for (row, (_, fits)) in fits.iter().enumerate().filter(|(row, _)| is_left.get(*row) == Some(&true)) {
                for (column, fit) in fits.iter().enumerate() {
                    if let Some(fit) = *fit
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

    fn place_of(&self, id: RobotId, fit: impl Fn(&Track<S>, &TrackParams<S>) -> Option<S>) -> Option<usize> {
        self.tracks.iter().position(|track| track.id == id).or_else(|| {
            let nameless = self.tracks.iter().enumerate().filter(|(_, track)| track.id.is_local());
            let fits = nameless.filter_map(|(place, track)| Some((fit(track, &self.params)?, place)));
            fits.min_by(|(one, _), (other, _)| one.order(*other)).map(|(_, place)| place)
        })
    }

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

    /// Replaces the farthest track if all are in use. Returns whether the track was added.
    fn insert(&mut self, track: Track<S>, own: Position) -> bool {
        if self.tracks.is_full() {
            let key = |track: &Track<S>| (track.offset_m(own).length_key(), track.id);
            let farthest = self.tracks.iter_mut().max_by_key(|track| key(track));
            return match farthest {
                Some(farthest) if key(&track) < key(farthest) => {
                    if farthest.seen.is_some() && farthest.known.is_some() {
                        let Track { id, heard, known, .. } = *farthest;
                        // At most the tracks before the step are replaced.
                        let _ = self.displaced.push(Displaced { id, heard, known });
                    }
                    *farthest = track;
                    true
                }
                _ => false,
            };
        }
        self.tracks.push(track).is_ok()
    }

    /// Updates the tracks with beacons that arrived in `table` since the last step. O(N TRACKS).
    pub fn hear<const N: usize, P: Copy>(&mut self, table: &NeighborTable<S, N, P>, own: Position) {
        for entry in table.iter().filter(|entry| !entry.id.is_local()) {
            let news = Some((entry.heard, entry.position));
            if self.displaced.iter().any(|gone| gone.id == entry.id && gone.known == news) {
                // An earlier estimate of this tracker, not a beacon.
                continue;
            }
            let params = self.params;
            let place = self.place_of(entry.id, |track, params| {
                track.fit(entry.position, params.heard_m, entry.radius_m, entry.heard, params)
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

    /// Removes tracks whose robots are neither in sight nor in `table`. A detected robot whose
    /// track ended is removed from `table` unless its last beacon is younger than
    /// [`Ages::expire_after`](super::Ages::expire_after); `gone` receives its id. O(N TRACKS).
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
        for Displaced { id, heard, known } in core::mem::take(&mut self.displaced) {
            let is_news = table.get(id, now).known().is_none_or(|entry| known != Some((entry.heard, entry.position)));
            let is_followed = self.tracks.iter().any(|track| track.id == id);
            if !is_news && !is_followed && !is_within(heard, expire) && table.forget(id) {
                gone(id);
            }
        }
        self.tracks.retain(|track| track.seen.is_some() || table.get(track.id, now).known().is_some());
        // An anonymous robot with a new id or a replaced track must not keep its old entry.
        for n in (0..table.len()).rev() {
            let id = table.as_slice().get(n).map(|known| known.id).filter(|id| id.is_local());
            if let Some(id) = id.filter(|id| !self.tracks.iter().any(|track| track.id == *id))
                && table.forget(id)
            {
                gone(id);
            }
        }
    }

    /// Returns the detected robots as neighbours to store in `table`, which gives the fields that
    /// detections do not determine. A robot without beacons belongs to `flock`. O(TRACKS log N).
    pub fn seen<const N: usize, P: Copy>(
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

    fn new_number(&mut self) -> RobotId {
        // One more number than there are tracks.
        for _ in 0..=TRACKS {
            self.nameless = self.nameless.wrapping_add(1);
            if !self.tracks.iter().any(|track| track.id == RobotId::local(self.nameless)) {
                break;
            }
        }
        RobotId::local(self.nameless)
    }
}

fn stranger<S: Scalar, P>(track: &Track<S>, flock: u8) -> Neighbor<S, P> {
    Neighbor {
        id: track.id,
        heard: track.at,
        position: track.position,
        velocity_mps: track.velocity_mps,
        radius_m: track.radius_m,
        flock,
        mode: Mode::Cruise,
        trace: Trace::Heard,
        gap_m: S::ZERO,
        payload: None,
    }
}

fn add(count: &mut u16) {
    *count = count.saturating_add(1);
}
