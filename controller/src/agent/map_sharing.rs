//! Shares a map of the terrain with other robots and plans with it.

use super::guidance::{BadInput, Decision, Guidance, GuidanceInput, Teamwork, pass_on};
use super::{Surroundings, Waypoint};
use crate::grid::Cell;
use crate::land::{FarLand, LandMap, LandPatch, MapParams};
use crate::list::SparseVec;
use crate::neighbor::Tracker;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::TemplateAssignment;
use serde::{Deserialize, Serialize};

/// Guidance law `G` with a [`LandMap`] of `T` tiles beyond the window, shared by one patch per
/// beacon. Laws on the grid price window exits by it while they lead ([`GuidanceInput::land`]).
///
/// False reports cost only time, at most 42 moves per goal plus the ways back: the robot stops
/// using the map after 32 moves without a new least distance to its goal, then after a quarter of
/// that.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MapSharing<G, const T: usize> {
    inside: G,
    #[serde(with = "counted_if_shared")]
    map: SparseVec<Map<T>, 1>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Map<const T: usize> {
    land: LandMap<T>,
    params: MapParams,
    progress: Progress,
}

/// Moves with the map without a new least distance to the goal.
const PATIENCE: u8 = 32;

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Progress {
    way: Option<(Cell, Cell)>,
    /// Squared distance.
    least: u64,
    idle: u8,
    patience: u8,
}

impl Progress {
    fn makes_progress(&mut self, cell: Cell, goal: Cell) -> bool {
        let before = self.way.replace((cell, goal));
        if before.is_none_or(|(_, old)| old != goal) {
            *self = Self { way: self.way, least: u64::MAX, idle: 0, patience: PATIENCE };
        }
        let distance = cell.distance_squared(goal);
        if distance < self.least {
            if self.idle > self.patience {
                self.patience >>= 2;
            }
            (self.least, self.idle) = (distance, 0);
        } else if before.is_some_and(|(here, _)| here != cell) {
            self.idle = self.idle.saturating_add(1);
        }
        self.idle <= self.patience
    }
}

/// Digests omit a map that does not exist.
mod counted_if_shared {
    use super::{Map, SparseVec};
    use serde::{Deserialize, Deserializer};
    use serde::{Serialize, Serializer};

    pub(super) fn serialize<const T: usize, Z: Serializer>(
        map: &SparseVec<Map<T>, 1>,
        to: Z,
    ) -> Result<Z::Ok, Z::Error> {
        match map.first() {
            None => crate::digest::uncounted::serialize(map, to),
            Some(_) => map.serialize(to),
        }
    }

    pub(super) fn deserialize<'de, const T: usize, D: Deserializer<'de>>(
        from: D,
    ) -> Result<SparseVec<Map<T>, 1>, D::Error> {
        SparseVec::deserialize(from)
    }
}

impl<G, const T: usize> MapSharing<G, T> {
    /// Wraps `inside` with a map kept by `params`; with `None` it behaves as `G`.
    #[must_use]
    pub fn new(inside: G, params: Option<MapParams>) -> Self {
        let mut map = SparseVec::new();
        if let Some(params) = params {
            let _ = map.push(Map { land: LandMap::new(), params, progress: Progress::default() });
        }
        Self { inside, map }
    }

    /// The wrapped guidance law.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.inside
    }

    /// The map, if the robot shares it.
    #[must_use]
    pub fn land(&self) -> Option<&LandMap<T>> {
        self.map.first().map(|map| &map.land)
    }
}

impl<G: Teamwork, const T: usize> Teamwork for MapSharing<G, T> {
    pass_on!(orders: self => self.inside);

    fn hear_land(&mut self, patch: &LandPatch) {
        if let Some(map) = self.map.first_mut() {
            map.land.hear(patch);
        }
    }

    fn say_land(&mut self, now: Instant) -> Option<LandPatch> {
        let map = self.map.first_mut()?;
        map.land.age(&map.params, now);
        map.land.say()
    }
}

impl<S: Scalar, G: Guidance<S>, const T: usize> Guidance<S> for MapSharing<G, T> {
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
        let Some(map) = self.map.first_mut() else {
            return self.inside.decide(input, here, rng, workspace);
        };
        if let Some((cell, window)) = here.on_grid().and_then(|grid| Some((grid.cell.cell, grid.window?))) {
            map.land.see(&window, cell);
            let land: &dyn FarLand = &map.land;
            let land = map.progress.makes_progress(cell, input.goal).then_some(land);
            return self.inside.decide(&GuidanceInput { land, ..*input }, here, rng, workspace);
        }
        self.inside.decide(input, here, rng, workspace)
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

    fn tracker(&mut self) -> Option<&mut Tracker<S>> {
        self.inside.tracker()
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
