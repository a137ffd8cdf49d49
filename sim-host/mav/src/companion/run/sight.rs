use super::{Companions, State, Vehicle};
use crate::geo::Origin;
use staya_controller::agent::Wait;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::Known;
use std::time::Duration;

/// Access to the vehicles at one moment; values are computed on request.
#[derive(Clone, Copy)]
pub struct Sight<'a> {
    vehicles: &'a [Vehicle],
    origin: &'a Origin,
    now: Duration,
}

/// A vehicle at one moment, in metres and m/s east, north, up.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Index among the scenario's robots, from 0.
    pub index: usize,
    /// Present position, extrapolated from telemetry; `None` before the first one.
    pub position_m: Option<[f64; 3]>,
    /// Velocity.
    pub velocity_mps: [f64; 3],
    /// Age of the last position, seconds.
    pub age_s: Option<f64>,
    /// Goal; `None` if the guidance has none.
    pub goal_m: Option<[f64; 3]>,
    /// State of the companion.
    pub state: State,
    /// Mode of the agent.
    pub mode: Mode,
    /// Robot that this one follows; 0 for none.
    pub leader: RobotId,
    /// Why the robot waits, if it does.
    pub wait: Option<Wait>,
    /// Last commanded velocity.
    pub commanded_mps: [f64; 3],
    /// Whether the vehicle was at its goal when it was last controlled.
    pub has_arrived: bool,
    /// Known neighbours.
    pub known: Vec<Known>,
    /// Packets accepted from other robots.
    pub heard: u64,
    /// Packets rejected.
    pub refused: u64,
}

impl Companions<'_> {
    pub(super) fn sight(&self) -> Sight<'_> {
        Sight { vehicles: &self.vehicles, origin: &self.origin, now: self.now() }
    }
}

impl Sight<'_> {
    /// Time since the start.
    #[must_use]
    pub const fn now(&self) -> Duration {
        self.now
    }

    /// All vehicles of this process in the order of the configuration. O(vehicles * neighbours).
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
                mode: controller.agent().mode(),
                leader: controller.agent().leader(),
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
