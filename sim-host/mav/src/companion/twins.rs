//! Recognises two vehicles that send with one system id on one link: by their peers, by clocks
//! since boot that disagree, and by places between which no vehicle could have moved.

use crate::Peer;
use crate::geo::{Global, Origin};
use staya_mavlink::dialect::MavMessage;
use std::collections::VecDeque;
use std::time::Duration;

/// Vehicles send heartbeats at 1 Hz, so after this time a second one was heard.
pub const LISTEN: Duration = Duration::from_millis(2500);
/// Returns to the other vehicle that are evidence if they happen within `WINDOW`. One return may
/// be a disturbance of the position or a reconnection.
const RETURNS: usize = 3;
const WINDOW: Duration = Duration::from_secs(5);
/// Time without a return after which one vehicle is left.
const CLEAR: Duration = Duration::from_secs(10);
/// Longest difference of delays between two messages of one vehicle.
const JITTER_MS: i64 = 1500;
/// Changes of an estimated position without a movement.
const DRIFT_M: f64 = 1.0;
/// Acceleration between two messages, as a change of velocity.
const GAIN_MPS: f64 = 2.0;

/// The difference between the two vehicles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evidence {
    /// Two peers.
    Peers(Peer, Peer),
    /// One peer, with different times since boot.
    Clocks,
    /// One peer, with places at this distance in metres.
    Places(f64),
}

#[derive(Clone, Copy, Debug)]
struct Track {
    peer: Peer,
    /// Time of arrival without the time since boot, milliseconds.
    clock_ms: Option<i64>,
    place: Option<(Duration, Global, f64)>,
}

/// The messages of one system id on one link.
#[derive(Clone, Debug, Default)]
pub struct Twins {
    /// The vehicle that was heard last, and another one.
    tracks: VecDeque<Track>,
    returns: VecDeque<Duration>,
    last_return: Duration,
    evidence: Option<Evidence>,
}

impl Twins {
    /// Records a message of the autopilot. Returns the evidence when it becomes sufficient.
    pub fn hear(&mut self, peer: Peer, message: &MavMessage, now: Duration) -> Option<Evidence> {
        let clock = |boot_ms: u32| Some(now.as_millis() as i64 - i64::from(boot_ms));
        let (clock_ms, place) = match message {
            MavMessage::HEARTBEAT(_) => (None, None),
            MavMessage::SYSTEM_TIME(time) => (clock(time.time_boot_ms), None),
            MavMessage::GLOBAL_POSITION_INT(at) => {
                let speed_mps = libm::hypot(f64::from(at.vx), f64::from(at.vy)) / 100.0;
                let place = (now, Global::from_e7(at.lat, at.lon, at.alt), speed_mps);
                (clock(at.time_boot_ms), Some(place).filter(|_| (at.lat, at.lon) != (0, 0)))
            }
            _ => return None,
        };
        let seen = Track { peer, clock_ms, place };
        let found = self.tracks.iter().position(|track| track.difference(&seen).is_none());
        match found {
            Some(0) => {}
            Some(other) => {
                self.tracks.swap(0, other);
                self.returns.push_back(now);
                self.last_return = now;
            }
            None => {
                self.tracks.truncate(1);
                self.tracks.push_front(seen);
            }
        }
        if let Some(track) = self.tracks.front_mut() {
            track.clock_ms = seen.clock_ms.or(track.clock_ms);
            track.place = seen.place.or(track.place);
        }
        while self.returns.front().is_some_and(|at| now.saturating_sub(*at) > WINDOW) || self.returns.len() > RETURNS {
            self.returns.pop_front();
        }
        if self.evidence.is_some() || self.returns.len() < RETURNS {
            return None;
        }
        let [first, second] = [0, 1].map(|index| self.tracks.get(index));
        self.evidence = first.zip(second).and_then(|(first, second)| second.difference(first));
        self.evidence
    }

    /// Whether two vehicles are heard.
    pub const fn are_two(&self) -> bool {
        self.evidence.is_some()
    }

    /// Returns true once when one vehicle is left.
    pub fn become_one(&mut self, now: Duration) -> bool {
        let is_quiet = now.saturating_sub(self.last_return) > CLEAR;
        is_quiet && self.evidence.take().is_some()
    }
}

impl Track {
    /// Why `seen` is not of this vehicle; `None` if it may be.
    fn difference(&self, seen: &Self) -> Option<Evidence> {
        if self.peer != seen.peer {
            return Some(Evidence::Peers(self.peer, seen.peer));
        }
        if let (Some(own), Some(other)) = (self.clock_ms, seen.clock_ms)
            && own.abs_diff(other) > JITTER_MS.unsigned_abs()
        {
            return Some(Evidence::Clocks);
        }
        let ((at, place, speed), (now, other, other_speed)) = self.place.zip(seen.place)?;
        let [x, y, _] = Origin::new(place)?.to_enu_m(&other)?;
        let (off_m, fastest_mps) = (libm::hypot(x, y), speed.max(other_speed));
        // A message may be late by some tenths of a second.
        let elapsed_s = now.saturating_sub(at).as_secs_f64();
        let near_m = DRIFT_M + (fastest_mps + GAIN_MPS) * elapsed_s + 0.3 * fastest_mps;
        (off_m > near_m).then_some(Evidence::Places(off_m))
    }
}

#[cfg(test)]
mod tests;
