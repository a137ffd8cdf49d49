//! Simulated autopilots in simulated time, for `staya companion --demo`.

use super::machine::Machine;
use crate::companion::config::{Config, VehicleSetup};
use crate::companion::offboard::Entry;
use crate::framed::framed;
use crate::geo::{Origin, enu, ned};
use crate::tlog::Missing;
use crate::{Peer, Received, Tlog};
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::{RawFrame, Sender};
use staya_mavlink::mavlink_core::MessageData as _;
use staya_sim::record;
use std::collections::VecDeque;
use std::time::Duration;

const STEP: Duration = Duration::from_millis(20);
/// When the simulated pilot does what the configuration leaves to the pilot.
const PILOT_ACTS: Duration = Duration::from_secs(2);
/// Height of a takeoff by the pilot, unless the configuration has one, metres.
const TAKEOFF_M: f64 = 10.0;
const CLIMB_MPS: f64 = 2.0;
/// Flags of an estimator with all values.
const HEALTHY: u16 = 0x33F;

/// Autopilots that accept all commands, and bodies that follow velocities with the configured lag.
/// Links are never cut and lose nothing.
pub struct Demo {
    now: Duration,
    /// Sleeps, so that a page can be watched.
    is_real_time: bool,
    origin: Origin,
    autopilots: Vec<Autopilot>,
    frames: VecDeque<Received>,
    tlog: Option<Tlog>,
}

struct Autopilot {
    setup: VehicleSetup,
    lag_s: f64,
    max_speed_mps: f64,
    /// East, north, up of the origin, as the velocities.
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    wish_mps: [f64; 3],
    is_controlled: bool,
    is_armed: bool,
    climb_to_m: Option<f64>,
    position_every: Duration,
    sender: Sender,
}

impl Demo {
    pub fn new(config: &Config, tlog: Option<Tlog>, is_real_time: bool) -> Self {
        let autopilot = |setup: &VehicleSetup| {
            let [x, y, _] = config.plane.starts[setup.index].position_m;
            let abilities = config.plane.group(setup.index).abilities;
            Autopilot {
                setup: setup.clone(),
                lag_s: abilities.lag_s.max(STEP.as_secs_f64()),
                max_speed_mps: abilities.max_speed_mps,
                position_m: [x, y, 0.0],
                velocity_mps: [0.0; 3],
                wish_mps: [0.0; 3],
                is_controlled: false,
                is_armed: false,
                climb_to_m: None,
                position_every: Duration::from_millis(250),
                sender: Sender { system: setup.system, component: MAV_COMP_ID_AUTOPILOT1, sequence: 0 },
            }
        };
        Self {
            now: Duration::ZERO,
            is_real_time,
            origin: config.origin,
            autopilots: config.vehicles.iter().map(autopilot).collect(),
            frames: VecDeque::new(),
            tlog,
        }
    }

    fn pass(&mut self, time: Duration) {
        if self.is_real_time {
            std::thread::sleep(time);
        }
        let end = self.now + time;
        let step = STEP.as_millis();
        while self.now.as_millis() / step < end.as_millis() / step {
            self.now += STEP;
            for autopilot in &mut self.autopilots {
                autopilot.advance(self.now);
                for message in autopilot.telemetry(self.now, &self.origin) {
                    self.frames.push_back(autopilot.packed(&message));
                }
            }
        }
        self.now = self.now.max(end);
    }
}

impl Autopilot {
    fn is_flying(&self) -> bool {
        self.position_m[2] > 0.1
    }

    fn advance(&mut self, now: Duration) {
        let (rules, flies) = (self.setup.rules, self.setup.kind.flies());
        if now >= PILOT_ACTS {
            self.is_controlled |= rules.entry == Entry::Wait;
            self.is_armed |= rules.entry == Entry::Wait || !rules.arm;
            let leaves_takeoff = rules.entry == Entry::Wait || !rules.takeoff;
            if flies && leaves_takeoff && self.is_controlled && self.is_armed && !self.is_flying() {
                self.climb_to_m.get_or_insert(rules.altitude_m.unwrap_or(TAKEOFF_M));
            }
        }
        let can_move = self.is_controlled && self.is_armed;
        let mut wish = if can_move { self.wish_mps } else { [0.0; 3] };
        if let Some(height_m) = self.climb_to_m.filter(|_| can_move) {
            let left_m = height_m - self.position_m[2];
            wish = [0.0, 0.0, left_m.clamp(-CLIMB_MPS, CLIMB_MPS)];
            if left_m < 0.1 {
                self.climb_to_m = None;
            }
        }
        let norm = libm::sqrt(wish.iter().map(|v| v * v).sum());
        let scale = if norm > self.max_speed_mps { self.max_speed_mps / norm } else { 1.0 };
        let dt = STEP.as_secs_f64();
        for ((position, velocity), wish) in self.position_m.iter_mut().zip(&mut self.velocity_mps).zip(wish) {
            *velocity += (wish * scale - *velocity) * (dt / self.lag_s).min(1.0);
            *position += *velocity * dt;
        }
        if !flies || self.position_m[2] < 0.0 {
            (self.position_m[2], self.velocity_mps[2]) = (0.0, 0.0);
        }
    }

    /// Messages due in the step that ends at `now`.
    fn telemetry(&self, now: Duration, origin: &Origin) -> Vec<MavMessage> {
        let is_due = |every: Duration| now.as_micros() % every.max(STEP).as_micros() < STEP.as_micros();
        let (kind, mut all) = (self.setup.kind, Vec::new());
        if is_due(Duration::from_secs(1)) {
            let mode = if self.is_controlled { kind.outside_control() } else { 0 };
            all.push(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode: if kind.is_px4() { mode << 16 } else { mode },
                base_mode: if self.is_armed { 0x81 } else { 0x01 },
                mavtype: if kind.flies() { 2 } else { 10 },
                autopilot: if kind.is_px4() { 12 } else { 3 },
                ..HEARTBEAT_DATA::DEFAULT
            }));
        }
        if is_due(self.position_every)
            && let Some(place) = origin.to_global(self.position_m)
        {
            let ([lat, lon, alt], [vx, vy, vz]) = (place.to_e7(), ned(self.velocity_mps).map(|v| (v * 100.0) as i16));
            all.push(MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
                time_boot_ms: now.as_millis() as u32,
                lat,
                lon,
                alt,
                relative_alt: (self.position_m[2] * 1000.0) as i32,
                vx,
                vy,
                vz,
                hdg: u16::MAX,
            }));
        }
        if is_due(Duration::from_millis(500)) {
            all.push(if kind.is_px4() {
                MavMessage::ESTIMATOR_STATUS(ESTIMATOR_STATUS_DATA { flags: HEALTHY, ..ESTIMATOR_STATUS_DATA::DEFAULT })
            } else {
                MavMessage::EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA {
                    flags: HEALTHY,
                    ..EKF_STATUS_REPORT_DATA::DEFAULT
                })
            });
            let landed_state = match (self.is_flying(), self.climb_to_m) {
                (false, _) => MAV_LANDED_STATE_ON_GROUND,
                (true, Some(_)) => MAV_LANDED_STATE_TAKEOFF,
                (true, None) => MAV_LANDED_STATE_IN_AIR,
            };
            let state = EXTENDED_SYS_STATE_DATA { landed_state, ..EXTENDED_SYS_STATE_DATA::DEFAULT };
            all.push(MavMessage::EXTENDED_SYS_STATE(state));
        }
        all
    }

    fn packed(&mut self, message: &MavMessage) -> Received {
        // A frame has room for any message.
        let frame = framed(&mut self.sender, message, None).unwrap_or_default();
        Received { line: self.setup.line, peer: Peer::Wire, frame: frame.to_vec() }
    }

    fn obey(&mut self, command: &COMMAND_LONG_DATA) {
        match command.command {
            MAV_CMD_DO_SET_MODE => self.is_controlled = command.param2 == self.setup.kind.outside_control() as f32,
            MAV_CMD_COMPONENT_ARM_DISARM => self.is_armed = command.param1 != 0.0,
            MAV_CMD_NAV_TAKEOFF if !self.is_flying() => self.climb_to_m = Some(command.param7.into()),
            MAV_CMD_SET_MESSAGE_INTERVAL if command.param1 == GLOBAL_POSITION_INT_DATA::ID as f32 => {
                self.position_every = Duration::from_micros(command.param2.max(0.0) as u64);
            }
            _ => {}
        }
    }
}

impl Machine for Demo {
    fn now(&self) -> Duration {
        self.now
    }

    fn pause(&mut self, time: Duration) {
        self.pass(time);
    }

    fn receive(&mut self, wait: Duration) -> Option<Received> {
        if self.frames.is_empty() {
            self.pass(wait);
        }
        self.frames.pop_front()
    }

    fn send(&mut self, line: usize, _: Option<Peer>, frame: &[u8]) {
        let Some(message) = RawFrame::new(frame).and_then(|frame| frame.message()) else { return };
        let target = match &message {
            MavMessage::COMMAND_LONG(command) => command.target_system,
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(setpoint) => setpoint.target_system,
            _ => return,
        };
        let is_it = |autopilot: &&mut Autopilot| autopilot.setup.line == line && autopilot.setup.system == target;
        let Some(autopilot) = self.autopilots.iter_mut().find(is_it) else { return };
        match message {
            MavMessage::COMMAND_LONG(command) => {
                autopilot.obey(&command);
                let ack = COMMAND_ACK_DATA { command: command.command, ..COMMAND_ACK_DATA::DEFAULT };
                let ack = autopilot.packed(&MavMessage::COMMAND_ACK(ack));
                self.frames.push_back(ack);
            }
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(setpoint) => {
                autopilot.wish_mps = enu([setpoint.vx, setpoint.vy, setpoint.vz].map(f64::from));
            }
            _ => {}
        }
    }

    fn log(&mut self, frame: &[u8]) -> Result<(), record::Error> {
        self.tlog.as_mut().map_or(Ok(()), |tlog| tlog.add(frame))
    }

    fn close_log(&mut self) -> Result<(), record::Error> {
        self.tlog.as_mut().map_or(Ok(()), Tlog::finish)
    }

    fn missing(&self) -> Missing {
        self.tlog.as_ref().map(Tlog::missing).unwrap_or_default()
    }
}
