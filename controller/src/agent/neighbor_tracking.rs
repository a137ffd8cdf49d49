//! Adds sensor detections of other robots to a guidance law.

use super::guidance::{BadInput, Decision, Guidance, GuidanceInput, Teamwork, pass_on};
use super::{Agent, KinematicState, Outputs, Safety, Waypoint};
use crate::geom::Position;
use crate::grid::Cell;
use crate::land::LandPatch;
use crate::list::{self, SparseVec};
use crate::neighbor::{Sighted, Sighting, TrackParams, Tracker};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::{TemplateAssignment, Wire};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Guidance law `G` of a robot that detects other robots ([`Agent::see`]), in the plane and in
/// space. The neighbour table holds detected robots merged with beacons: see [`Tracker`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NeighborTracking<S: Scalar, G> {
    inside: G,
    #[serde(with = "counted_if_it_sees")]
    tracker: SparseVec<Tracker<S>, 1>,
}

/// Digests omit a tracker that does not exist.
mod counted_if_it_sees {
    use super::{Scalar, SparseVec, Tracker};
    use serde::{Deserialize, Deserializer};
    use serde::{Serialize, Serializer};

    pub(super) fn serialize<S: Scalar, Z: Serializer>(
        tracker: &SparseVec<Tracker<S>, 1>,
        to: Z,
    ) -> Result<Z::Ok, Z::Error> {
        match tracker.first() {
            None => crate::digest::uncounted::serialize(tracker, to),
            Some(_) => tracker.serialize(to),
        }
    }

    pub(super) fn deserialize<'de, S: Scalar, D: Deserializer<'de>>(
        from: D,
    ) -> Result<SparseVec<Tracker<S>, 1>, D::Error> {
        SparseVec::deserialize(from)
    }
}

impl<S: Scalar, G> NeighborTracking<S, G> {
    /// Wraps `inside` with a tracker; without `params` it behaves as `G`.
    #[must_use]
    pub fn new(inside: G, params: Option<TrackParams<S>>) -> Self {
        let mut tracker = SparseVec::new();
        if let Some(params) = params {
            let _ = tracker.push(Tracker::new(params));
        }
        Self { inside, tracker }
    }

    /// The wrapped guidance law.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.inside
    }
}

impl<S: Scalar, G: Guidance<S>, const N: usize, A: Safety<S>, W: Wire> Agent<S, G, N, A, W> {
    /// Processes the detections of all sensors at `now`, relative to the `state` of the next
    /// [`step`](Agent::step), before that step. Without a [`NeighborTracking`] all are dropped and
    /// counted in [`Sighted::no_room`]. Work: [`Tracker::see`], and O(N TRACKS) per step.
    pub fn see(&mut self, sightings: &[Sighting<S>], state: &KinematicState<S>, now: Instant) -> Sighted {
        let own = self.config.id;
        match self.guidance.tracker() {
            Some(tracker) => tracker.see(sightings, own, state.position, state.velocity_mps, now),
            None => Sighted { no_room: u16::try_from(sightings.len()).unwrap_or(u16::MAX), ..Sighted::default() },
        }
    }

    pub(super) fn merge_sightings(&mut self, position: Position, now: Instant, out: &mut Outputs<S>) {
        if self.guidance.tracker().is_none() {
            return;
        }
        let Self { config, guidance, link, last, .. } = self;
        let is_needed = |id: &RobotId| *id == last.leader || *id == config.id.duplicate() || guidance.needs(*id);
        let needed: Vec<RobotId, N> = list::collect(link.table.iter().map(|known| known.id).filter(is_needed));
        if let Some(tracker) = guidance.tracker() {
            link.see(tracker, position, &needed, config.flock, now, out);
        }
    }
}

impl<S: Scalar, G: Teamwork> Teamwork for NeighborTracking<S, G> {
    pass_on!(orders: self => self.inside);
    pass_on!(land: self => self.inside);
}

impl<S: Scalar, G: Guidance<S>> Guidance<S> for NeighborTracking<S, G> {
    type Input<'a> = G::Input<'a>;
    type Destination = G::Destination;
    type Workspace = G::Workspace;
    type Payload = G::Payload;

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S, Self::Payload>,
        here: &Self::Input<'_>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        self.inside.decide(input, here, rng, workspace)
    }

    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        self.tracker.first_mut()
    }

    fn goes_to_cells(&self) -> bool {
        self.inside.goes_to_cells()
    }

    fn goes_by_velocity(&self) -> bool {
        self.inside.goes_by_velocity()
    }

    fn has_own_goal(&self) -> bool {
        self.inside.has_own_goal()
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool {
        self.inside.assign_waypoint(index, waypoint)
    }

    fn payload(&mut self, now: Instant) -> Self::Payload {
        self.inside.payload(now)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.inside.parameters(visit);
    }
}
