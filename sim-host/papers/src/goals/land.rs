//! Obstacles between the start and the goals: the paper's scenes have some, and do not say which.

use super::{Plan, STARTS};
use crate::arena::{distance_m, uniform};
use anyhow::{Result, bail};
use staya_controller::rand::Rng;
use staya_sim::world::plane::Solid;

/// Where obstacles end before the goals, in R_MinDist.
const LAST: f64 = 50.0;
/// Room between the start and obstacles, and between these, in R_MinDist.
const ROOM: f64 = 3.0;
/// Radii, in R_MinDist.
const RADII: [f64; 2] = [1.0, 3.0];
/// Draws of a place before nothing fits any more.
const TRIES: u32 = 1000;

impl Plan {
    /// The obstacles of a run: discs that the crowd has to go around, with ways between them.
    ///
    /// # Errors
    /// There is no room for so many.
    pub(super) fn solids(&self, run: u32) -> Result<Vec<Solid>> {
        let unit = self.min_distance_m;
        let (first, half) = (self.start_half_m() + ROOM * unit, self.start_half_m());
        let mut discs: Vec<([f64; 3], f64)> = Vec::new();
        for number in 0..self.obstacles {
            let mut rng = Rng::keyed(self.seed, STARTS + 2, run, number);
            let drawn = (0..TRIES).find_map(|_| {
                let radius = uniform(&mut rng, RADII[0], RADII[1]) * unit;
                let (west, east) = (first + radius, LAST * unit - radius);
                let center = [uniform(&mut rng, west, east), uniform(&mut rng, -half, half), 0.0];
                let is_free =
                    |&(other, size): &([f64; 3], f64)| distance_m(other, center) >= radius + size + ROOM * unit;
                (west < east && discs.iter().all(is_free)).then_some((center, radius))
            });
            let Some(disc) = drawn else {
                bail!(
                    "{} obstacles find no room before the goals; give fewer, or a smaller start side",
                    self.obstacles
                );
            };
            discs.push(disc);
        }
        Ok(discs.into_iter().map(|(center_m, radius_m)| Solid::Ball { center_m, radius_m }).collect())
    }
}
