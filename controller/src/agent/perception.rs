//! How a robot knows other robots besides by radio.

use super::{Agent, KinematicState, Law, Outputs, Safety};
use crate::geom::Position;
use crate::list;
use crate::neighbor::{Sighted, Sighting, Tracker};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::Wire;
use heapless::Vec;

/// Knows other robots by radio alone ([`RadioOnly`]) or also by sensors ([`Tracker`]).
pub trait Perception<S: Scalar> {
    /// The tracker of detected robots, if any.
    fn tracker(&mut self) -> Option<&mut Tracker<S>>;
}

/// No sensor detects other robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RadioOnly;

impl<S: Scalar> Perception<S> for RadioOnly {
    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        None
    }
}

impl<S: Scalar> Perception<S> for Tracker<S> {
    fn tracker(&mut self) -> Option<&mut Self> {
        Some(self)
    }
}

/// For hosts, where only some robots have sensors.
#[cfg(feature = "host")]
impl<S: Scalar> Perception<S> for Option<alloc::boxed::Box<Tracker<S>>> {
    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        self.as_deref_mut()
    }
}

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Processes the detections of all sensors at `now`, relative to the `state` of the next
    /// [`step`](Agent::step), before that step. Without a [`Tracker`] all are dropped and counted
    /// in [`Sighted::no_room`]. Work: [`Tracker::see`], and O(N TRACKS) per step.
    pub fn see(&mut self, sightings: &[Sighting<S>], state: &KinematicState<S>, now: Instant) -> Sighted {
        let own = self.config.id;
        match self.perception.tracker() {
            Some(tracker) => tracker.see(sightings, own, state.position, state.velocity_mps, now),
            None => Sighted { no_room: u16::try_from(sightings.len()).unwrap_or(u16::MAX), ..Sighted::default() },
        }
    }

    pub(super) fn merge_sightings(&mut self, position: Position, now: Instant, out: &mut Outputs<S>) {
        let Self { config, law, link, perception, .. } = self;
        let Some(tracker) = perception.tracker() else { return };
        let leader = law.report().leader;
        let is_needed = |id: &RobotId| *id == leader || *id == config.id.duplicate() || law.needs(*id);
        let needed: Vec<RobotId, N> = list::collect(link.table.iter().map(|known| known.id).filter(is_needed));
        link.see(tracker, position, &needed, config.flock, now, out);
    }
}
