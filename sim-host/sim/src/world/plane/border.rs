//! Distances between bodies of different MPI ranks.

use super::{Clearance, Disc, Plane, ROUNDING_M, is_washed};
use crate::nearby::{Query, Search};
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;

/// Data of a body of another rank that distances depend on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beside {
    /// Id of the robot.
    pub id: RobotId,
    /// Centre, metres.
    pub position_m: [f64; 3],
    /// Radius, metres.
    pub radius_m: f64,
    /// Ratio of height to width of the space that other bodies should avoid because of downwash.
    pub downwash: f64,
}

impl Plane {
    /// Search radius for neighbours of a body, metres.
    pub const fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Keeps only the bodies with the indices `here`, in this order, and the search radius.
    pub fn keep(&mut self, here: &[u32]) {
        self.discs = here.iter().map(|&index| self.discs[index as usize]).collect();
        self.shut = vec![Vec::new(); here.len()];
    }

    /// Appends a body that comes from another rank.
    pub fn admit(&mut self, disc: Disc) {
        self.discs.push(disc);
        self.shut.push(Vec::new());
    }

    /// Removes a body that goes to another rank; the last body takes its index.
    pub fn dismiss(&mut self, index: usize) {
        self.discs.swap_remove(index);
        self.shut.swap_remove(index);
    }

    /// Distances between bodies of this rank and those of other ranks. Call [`Plane::clearance`]
    /// first. The rank that holds the body with the lower id counts an overlap.
    pub fn clearance_beside(&self, beside: &[Beside]) -> Clearance {
        let mut clearance = Clearance::FREE;
        let mut found = Vec::new();
        for other in beside {
            let query = Query { at: other.position_m, radius: self.reach_m, most: usize::MAX, except: None };
            self.index.within(&query, &mut found);
            for near in &found {
                let disc = &self.discs[near.index as usize];
                // Same order of operations as in `clearance`, for identical rounding.
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
