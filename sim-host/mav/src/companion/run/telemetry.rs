use super::{Companions, FEW_TIMESTAMPS, LOOK, Link, Vehicle, shown, status_text};
use crate::Peer;
use crate::companion::offboard::State;
use crate::companion::report::{CompanionReport, LineReport, VehicleReport};
use crate::companion::twins::Evidence;
use staya_controller::agent::Event as AgentEvent;
use staya_controller::robot::{Mode, RobotId};
use staya_mavlink::constants::MAV_COMP_ID_AUTOPILOT1;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::Sender;
use std::time::Duration;

const SHOWN: Duration = Duration::from_secs(1);
/// Time without MAVLink 2, although messages of MAVLink 2 are sent to the vehicle.
const OLD: Duration = Duration::from_secs(5);

impl Companions<'_> {
    pub(super) fn tell(&mut self, index: usize, what: &str) {
        let (at, robot) = (self.now().as_secs_f64(), self.vehicles[index].setup.robot.0);
        self.say(&format!("{at:9.3} robot {robot}: {what}"));
    }

    pub(super) fn say(&mut self, line: &str) {
        if !self.options.quiet {
            let _ = self.machine.tell(line);
        }
    }

    /// Velocities at 1 Hz.
    pub(super) fn show(&mut self, index: usize, message: &MavMessage) {
        let (now, vehicle) = (self.machine.now(), &mut self.vehicles[index]);
        if let MavMessage::SET_POSITION_TARGET_LOCAL_NED(_) = message {
            if vehicle.shown.is_some_and(|at| now.saturating_sub(at) < SHOWN) {
                return;
            }
            vehicle.shown = Some(now);
        }
        let (at, robot) = (now.as_secs_f64(), vehicle.setup.robot.0);
        if let Some(words) = shown::words(message).filter(|_| self.output_error.is_none()) {
            self.output_error = self.machine.show(&format!("{at:9.3} robot {robot}: {words}")).err();
        }
    }

    fn trouble(&self, line: usize) -> Option<String> {
        self.machine.lines()?.trouble(line)
    }

    pub(super) fn look_at_links(&mut self, now: Duration) {
        if now < self.next_look {
            return;
        }
        self.next_look = now + LOOK;
        self.look_at_vehicles(now);
        for index in 0..self.links.len() {
            let trouble = self.trouble(index);
            let link = &mut self.links[index];
            if trouble != link.trouble {
                let endpoint = &self.config.lines[index];
                let line = match &trouble {
                    Some(error) => format!("staya: {endpoint}: no connection: {error}; retrying every second"),
                    None => format!("staya: {endpoint}: connected"),
                };
                link.trouble = trouble;
                self.say(&line);
            }
        }
    }

    /// Names the causes for which a vehicle never obeys.
    pub(super) fn look_at_vehicles(&mut self, now: Duration) {
        for index in 0..self.vehicles.len() {
            let vehicle = &mut self.vehicles[index];
            if vehicle.twins.become_one(now) {
                vehicle.offboard.set_ambiguous(false, now);
            }
            let is_old = vehicle.first_heard.is_some_and(|first| now.saturating_sub(first) >= OLD);
            if is_old && !vehicle.has_mavlink_2 && !std::mem::replace(&mut vehicle.is_version_told, true) {
                self.tell(
                    index,
                    "its port sends MAVLink 1 only and ignores requests; set SERIALn_PROTOCOL 2 (ArduPilot) or \
                     MAV_PROTO_VER 2 (PX4)",
                );
            }
        }
    }

    pub(super) fn tell_of_twins(&mut self, robot: RobotId, line: usize, evidence: Evidence) {
        let Some(index) = self.vehicles.iter().position(|vehicle| vehicle.setup.robot == robot) else { return };
        let by = match evidence {
            Evidence::Peers(Peer::Address(one), Peer::Address(other)) => format!("from {one} and {other}"),
            Evidence::Peers(..) => String::from("from two peers"),
            Evidence::Clocks => String::from("with different times since boot"),
            Evidence::Places(off_m) => format!("{off_m:.1} m apart"),
        };
        let system = self.vehicles[index].setup.system;
        let text = format!(
            "two vehicles send as system {system} on {}, {by}: no setpoints; give one another number (SYSID_THISMAV, \
             MAV_SYS_ID)",
            self.config.lines[line]
        );
        self.tell(index, &text);
    }

    pub(super) fn look_at_timestamps(&mut self) {
        for line in 0..self.links.len() {
            let is_ending = self.links[line].signing.as_ref().is_some_and(|signing| signing.left() < FEW_TIMESTAMPS);
            if !is_ending || std::mem::replace(&mut self.links[line].is_end_told, true) {
                continue;
            }
            self.say(&format!(
                "staya: {}: signing timestamps are nearly used up; give a new link key",
                self.config.lines[line]
            ));
            for index in 0..self.vehicles.len() {
                if self.vehicles[index].setup.line == line {
                    self.send(index, &status_text("staya: link key used up, give a new one", true));
                }
            }
        }
    }

    /// Explains once why messages of a vehicle are not accepted, or not signed here (`is_open`).
    pub(super) fn tell_of_signing(&mut self, line: usize, sender: Sender, is_open: bool) {
        let is_it = |vehicle: &Vehicle| {
            let at = (vehicle.setup.line, vehicle.setup.system, MAV_COMP_ID_AUTOPILOT1);
            !vehicle.is_signing_told && at == (line, sender.system, sender.component)
        };
        let Some(index) = self.vehicles.iter().position(is_it) else { return };
        self.vehicles[index].is_signing_told = true;
        self.tell(
            index,
            if is_open {
                "messages are signed; if it accepts only signed ones, give link_key or --link-key"
            } else {
                "messages rejected: not signed with the key of link_key, or replayed; give both sides the same key"
            },
        );
    }

    pub(super) fn tell_of(&mut self, index: usize, event: AgentEvent) {
        let text = match event {
            AgentEvent::NeighborFound(id) => format!("found robot {id}"),
            AgentEvent::NeighborLost(id) => format!("lost robot {id}"),
            AgentEvent::DuplicateId(id) => format!("two robots use number {id}; give one of them another number"),
            AgentEvent::Implausible { id, claim } => format!("ignores robot {id}: implausible {claim}"),
            AgentEvent::ContactLost => "lost contact to all robots".into(),
            AgentEvent::Muted => {
                self.tell(index, "cannot send: packet counters or timestamps are used up; give a new key (air.key)");
                return self.send(index, &status_text("staya: cannot send, new swarm key needed", true));
            }
            AgentEvent::NoRoute => "no open route to the goal".into(),
            AgentEvent::ModeChanged { to: Mode::Fault, .. }
                if self.vehicles[index].offboard.state() == State::Steering =>
            {
                "stopped: off the scenario's map, or without a goal".into()
            }
            _ => return,
        };
        self.tell(index, &text);
    }

    pub(super) fn report(&self, seconds: f64, interrupted: bool) -> CompanionReport {
        let vehicles = self.vehicles.iter().map(|vehicle| VehicleReport {
            robot: vehicle.setup.robot.0,
            system: vehicle.setup.system,
            autopilot: vehicle.setup.kind,
            state: vehicle.offboard.state(),
            agent: vehicle.controller.agent().mode(),
            has_arrived: vehicle.has_arrived,
            position_m: vehicle.offboard.fix().and_then(|fix| self.config.origin.to_enu_m(&fix.place)),
            tally: vehicle.offboard.tally(),
            packets_heard: vehicle.heard,
            packets_refused: vehicle.refused,
            neighbors: vehicle.controller.agent().neighbors().len(),
        });
        let links = self.links.iter().enumerate().filter(|_| !self.options.demo);
        let links = links.map(|(line, Link { signing, .. })| LineReport {
            link: self.config.lines[line].to_string(),
            counts: self.machine.lines().map(|lines| lines.counts(line)).unwrap_or_default(),
            trouble: self.trouble(line),
            refused: signing.as_ref().map_or(0, |signing| signing.counts().refused()),
            is_exhausted: signing.as_ref().is_some_and(|signing| signing.left() == 0),
        });
        CompanionReport {
            scenario: self.config.scenario.name.clone(),
            seconds,
            interrupted,
            dry_run: self.options.dry_run,
            demo: self.options.demo,
            vehicles: vehicles.collect(),
            links: links.collect(),
            log_error: self.log_error.as_ref().map(ToString::to_string),
            log_missing: self.machine.missing(),
        }
    }
}
