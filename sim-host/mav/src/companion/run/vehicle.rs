use crate::Peer;
use crate::companion::config::{Config, VehicleSetup};
use crate::companion::controller::{Body, Controller};
use crate::companion::offboard::OffboardStateMachine;
use crate::companion::twins::Twins;
use crate::geo::enu;
use staya_mavlink::frame::Sender;
use staya_sim::radio::HostWire;
use std::time::Duration;

/// Packets beyond this are lost, as on a radio.
const INBOX: usize = 16 * 1024;

pub struct Vehicle {
    pub setup: VehicleSetup,
    pub offboard: OffboardStateMachine,
    pub controller: Controller<HostWire>,
    pub peer: Option<Peer>,
    pub twins: Twins,
    /// Time of its first message, and whether one of its messages was MAVLink 2.
    pub first_heard: Option<Duration>,
    pub has_mavlink_2: bool,
    pub is_version_told: bool,
    pub is_signing_told: bool,
    pub sender: Sender,
    pub shown: Option<Duration>,
    pub inbox: Vec<u8>,
    pub next_step: Duration,
    pub has_arrived: bool,
    pub is_far: bool,
    pub heard: u64,
    pub refused: u64,
}

impl Vehicle {
    pub fn listen(&mut self, frames: &[u8]) {
        if self.inbox.len() + frames.len() <= INBOX {
            self.inbox.extend_from_slice(frames);
        }
    }

    /// Extrapolated to `now`. With stale or untrusted telemetry the error grows with its age up to
    /// [`Config::error_m`], since the vehicle may still roll or be driven by a pilot.
    pub fn body(&self, config: &Config, now: Duration) -> Option<Body> {
        let last = self.offboard.fix()?;
        let at = config.origin.to_enu_m(&last.place)?;
        let age_s = now.saturating_sub(last.at).as_secs_f64();
        if self.offboard.fresh_fix(now).is_none() {
            let max_speed_mps = config.plane.group(self.setup.index).abilities.max_speed_mps;
            let error_m = (max_speed_mps * age_s).min(config.error_m);
            return Some(Body { position_m: at, velocity_mps: [0.0; 3], error_m });
        }
        let velocity_mps = enu(last.velocity_ned_mps);
        let position_m = [0, 1, 2].map(|axis| at[axis] + velocity_mps[axis] * age_s);
        Some(Body { position_m, velocity_mps, error_m: 0.0 })
    }
}

pub fn is_within(body: &Body, reach_m: f64) -> bool {
    let [x, y, _] = body.position_m;
    x * x + y * y <= reach_m * reach_m
}
