//! What a robot keeps of a gap, compared with the true places: after each tick of all tests.

use super::*;
use crate::world::plane::Disc;
use staya_controller::agent::Safety as _;

/// By how much a robot may be wrong: its tolerance, and whole millimetres of positions.
const SLACK_M: f64 = 0.004;

impl Engine {
    /// After the motions of a tick, at least as much is left of the gap to a robot in contact as a
    /// robot keeps of it for its next step, told states included (docs/proof.md). Attackers tell
    /// false states, and sensors show wrong places: there nothing is checked.
    pub(in crate::engine) fn check_gaps(&self) {
        if !self.others.is_empty() {
            return;
        }
        let discs = self.ground.view(self.tick).discs;
        let disc_of = |id: RobotId| discs.binary_search_by_key(&id, |disc| disc.id).ok().and_then(|at| discs.get(at));
        let mut seen = Vec::new();
        for (index, computer) in self.computers.iter().enumerate() {
            self.ground.sightings(index, self.tick, 1, &mut seen);
            // One that has just been up again restarts in the next tick.
            let agent = computer.agent.as_ref().filter(|_| seen.is_empty() && self.tick > computer.down_until);
            let Some((own, agent)) = disc_of(self.id(index)).zip(agent) else { continue };
            if agent.safety().inflation().is_none() {
                continue;
            }
            let downwash = f64::from(agent.safety().downwash());
            for other in agent.neighbors().iter().filter(|other| other.gap_m > 0.0) {
                let Some(disc) = disc_of(other.id) else { continue };
                let (gap_m, kept_m) = (gap_m(own, disc, downwash), f64::from(other.gap_m));
                assert!(
                    kept_m <= gap_m + SLACK_M,
                    "tick {}: robot {} keeps {kept_m} m of a gap of {gap_m} m to robot {}",
                    self.tick,
                    own.id.0,
                    other.id.0
                );
            }
        }
    }
}

fn gap_m(one: &Disc, other: &Disc, downwash: f64) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| one.position_m[axis] - other.position_m[axis]);
    libm::sqrt(x * x + y * y + (z / downwash) * (z / downwash)) - one.radius_m - other.radius_m
}
