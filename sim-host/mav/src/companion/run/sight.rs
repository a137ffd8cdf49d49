//! What somebody who looks on sees of the vehicles.

use super::{Companions, State, Vehicle};
use crate::geo::Origin;
use staya_controller::agent::Wait;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::Known;
use std::time::Duration;

/// The vehicles at a moment. Nothing is computed until somebody asks.
#[derive(Clone, Copy)]
pub struct Sight<'a> {
    vehicles: &'a [Vehicle],
    origin: &'a Origin,
    now: Duration,
}

/// A vehicle at a moment, in metres and m/s east, north, up.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Its number among the scenario's robots, from 0.
    pub index: usize,
    /// Where, if it ever had a position: by now, from telemetry.
    pub position_m: Option<[f64; 3]>,
    /// How fast.
    pub velocity_mps: [f64; 3],
    /// Seconds since it said where it is.
    pub age_s: Option<f64>,
    /// Where it is to go, if that is a place.
    pub goal_m: Option<[f64; 3]>,
    /// What its companion does.
    pub state: State,
    /// What its agent does.
    pub mode: Mode,
    /// Whom it follows; 0: nobody.
    pub leader: RobotId,
    /// What it waits for.
    pub wait: Option<Wait>,
    /// The velocity that it was commanded last.
    pub commanded_mps: [f64; 3],
    /// Whether it was at its goal when it was last steered.
    pub has_arrived: bool,
    /// Whom it knows.
    pub known: Vec<Known>,
    /// Packets of others that were heard.
    pub heard: u64,
    /// Packets that were refused.
    pub refused: u64,
}

impl Companions<'_> {
    /// What there is to see.
    pub(super) fn sight(&self) -> Sight<'_> {
        Sight { vehicles: &self.vehicles, origin: &self.origin, now: self.now() }
    }
}

impl Sight<'_> {
    /// Since the start.
    #[must_use]
    pub const fn now(&self) -> Duration {
        self.now
    }

    /// Each vehicle of this program, in the order of the configuration. O(vehicles * neighbours).
    #[must_use]
    pub fn vehicles(&self) -> Vec<Seen> {
        let vehicles = self.vehicles.iter().map(|vehicle| {
            let body = vehicle.body(self.origin, self.now);
            let controller = &vehicle.controller;
            let fix = vehicle.offboard.fix();
            Seen {
                index: vehicle.setup.index,
                position_m: body.map(|body| body.position_m),
                velocity_mps: body.map_or([0.0; 3], |body| body.velocity_mps),
                age_s: fix.map(|fix| self.now.saturating_sub(fix.at).as_secs_f64()),
                goal_m: controller.goal_m(),
                state: vehicle.offboard.state(),
                mode: controller.mode(),
                leader: controller.leader(),
                wait: controller.wait(),
                commanded_mps: controller.velocity_mps(),
                has_arrived: vehicle.has_arrived,
                known: controller.known(),
                heard: vehicle.heard,
                refused: vehicle.refused,
            }
        });
        vehicles.collect()
    }
}
