//! How near bodies are to those of other ranks.

use super::{Clearance, Disc, Plane, ROUNDING_M, is_washed};
use crate::nearby::{Query, Search};
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;

/// A body of another rank, as far as others' nearness depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beside {
    /// The robot.
    pub id: RobotId,
    /// Its centre, metres.
    pub position_m: [f64; 3],
    /// Its radius, metres.
    pub radius_m: f64,
    /// How many times higher than wide its place is, for the air that it blows down.
    pub downwash: f64,
}

impl Plane {
    /// How far apart bodies are at most that count as near, metres.
    pub const fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Keeps these bodies alone, by their places, in this order. What counts as near is what did before.
    pub fn keep(&mut self, here: &[u32]) {
        self.discs = here.iter().map(|&index| self.discs[index as usize]).collect();
        self.shut = vec![Vec::new(); here.len()];
    }

    /// A body comes from another rank, behind those that are here.
    pub fn admit(&mut self, disc: Disc) {
        self.discs.push(disc);
        self.shut.push(Vec::new());
    }

    /// A body goes to another rank; the last one takes its place.
    pub fn dismiss(&mut self, index: usize) {
        self.discs.swap_remove(index);
        self.shut.swap_remove(index);
    }

    /// What [`Plane::clearance`], which was called before, does not see: pairs of a body here and one of another rank. An overlap is counted
    /// where the body with the lower number is.
    pub fn clearance_beside(&self, beside: &[Beside]) -> Clearance {
        let mut clearance = Clearance::FREE;
        let mut found = Vec::new();
        for other in beside {
            let query = Query { at: other.position_m, radius: self.reach_m, most: usize::MAX, except: None };
            self.index.within(&query, &mut found);
            for near in &found {
                let disc = &self.discs[near.index as usize];
                // In the order in which the body here would look at the other one.
                let gap = near.distance_squared.sqrt() - disc.radius_m - other.radius_m;
                clearance.bodies_m = clearance.bodies_m.min(gap);
                if other.id < disc.id {
                    continue;
                }
                let body = Disc { position_m: other.position_m, radius_m: other.radius_m, ..*disc };
                if gap < -ROUNDING_M {
                    clearance.overlaps += 1;
                } else if is_washed(disc, &Disc { downwash: other.downwash, ..body }) {
                    clearance.washed += 1;
                }
            }
        }
        clearance
    }
}
