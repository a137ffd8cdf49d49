//! Why robots in the plane have not arrived.

use super::PlaneGround;
use crate::world::plane::{Barrier, Barriers};
use staya_controller::agent::{Goals, LayerSettings};
use std::collections::HashMap;

/// Robots times obstacles up to which barriers are looked for; those of later robots are not known.
const MOST_WORK: usize = 100_000_000;

/// Barriers by radius and height of a body; `None`: too many obstacles.
pub(super) type Known = HashMap<[u64; 2], Option<Barriers>>;

impl PlaneGround {
    /// The last goal of a robot that goes to places, if it is at rest.
    pub(super) fn last_goal_m(&self, number: usize, tick: u32) -> Option<[f64; 3]> {
        let places = &self.setup.starts[number].places;
        let last = self.ordered(number, tick).last().map(|order| &order.target).or(places.last())?;
        let is_waypoint = self.setup.group(number).law.goals() == Goals::Waypoints;
        (is_waypoint && last.velocity_mps == [0.0; 3]).then_some(last.position_m)
    }

    /// Why no motion leads body `index` to its goal. Flyers may pass above or below obstacles, and
    /// robots without a safety layer through them.
    pub(super) fn barrier(&self, index: usize, goal_m: [f64; 3], known: &mut Known) -> Option<Barrier> {
        let (disc, group) = (&self.plane.discs()[index], self.setup.group(self.number(index)));
        let [from, to] = [disc.position_m, goal_m].map(|[x, y, _]| [x, y]);
        match group.safety {
            LayerSettings::None(_) => None,
            LayerSettings::Fly(_) => {
                let least_m = disc.radius_m - group.tolerance_m;
                let is_taken = self.plane.solids().iter().any(|solid| solid.distance_m(goal_m) < least_m);
                is_taken.then_some(Barrier::GoalTaken)
            }
            _ => {
                let height_m = disc.position_m[2];
                let barriers = known.entry([disc.radius_m, height_m].map(f64::to_bits)).or_insert_with(|| {
                    Barriers::new(self.plane.solids(), self.plane.terrain(), disc.radius_m, height_m)
                });
                // The same robots on any number of ranks.
                let work = |barriers: &&Barriers| barriers.count().saturating_mul(self.number(index)) <= MOST_WORK;
                barriers.as_ref().filter(work)?.between(from, to, group.tolerance_m)
            }
        }
    }
}
