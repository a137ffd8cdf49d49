//! One robot as a MAVLink vehicle, without sockets or a clock. Start with [`Vehicle::receive`].
//!
//! A message becomes an [`Action`] for the robot's controller, or is refused. Commands are always
//! answered, setpoints never, as the protocol demands; a STATUSTEXT says why one was refused.

use super::files;
use super::mission::{Mission, Refused, ack, from_float};
use super::model::{FlightMode, VehicleModel};
use super::ordered::Ordered;
use super::params::Parameters;
use super::streams::Streams;
use crate::geo::FAR_M;
use staya_controller::agent::{Event, Waypoint, Wish};
use staya_controller::geom::Position;
use staya_controller::parameters::TOLERANCE;
use staya_controller::robot::Mode;
use staya_controller::wire::{Header, Message};
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;
use staya_mavlink::mavlink_core::{Message as _, MessageData as _};
use staya_sim::engine::Observation;
use std::sync::Arc;

mod tuning;

const TEXT_EVERY_US: u64 = 2_000_000;

/// An action for the robot's controller.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Sets the goal.
    Wish(Wish<f32>),
    /// Delivers a message as if it had arrived by radio.
    Tell(Header, Message),
    /// Sets the parameter with this name.
    Set(&'static str, f32),
}

/// The output of a vehicle.
#[derive(Clone, Debug, Default)]
pub struct Out {
    /// Messages to send, in this order.
    pub messages: Vec<MavMessage>,
    /// Actions to perform in this order before the next tick.
    pub actions: Vec<Action>,
}

/// The vehicle that clients see for one robot.
#[derive(Clone, Debug)]
pub struct Vehicle {
    pub(super) sender: Sender,
    pub(super) model: Arc<VehicleModel>,
    pub(super) streams: Streams,
    pub(super) parameters: Parameters,
    pub(super) mission: Mission,
    /// Simulated time, microseconds.
    pub(super) time_us: u64,
    /// The robot's own state at that time.
    pub(super) seen: Observation,
    started_us: u64,
    pub(super) home_m: [f64; 3],
    /// Radians from north to east.
    pub(super) yaw: f32,
    pub(super) mode: FlightMode,
    pub(super) is_armed: bool,
    starts_armed: bool,
    pub(super) ordered: Ordered,
    texts: [Option<u64>; Kind::COUNT],
    /// The last text of [`Kind::Unsupported`].
    refused: String,
    pub(super) now_us: u64,
    /// The output of the calls since it was last taken.
    pub(super) out: Out,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    News,
    Parameter,
    Setpoint,
    Neighbor,
    Route,
    Unsupported,
}

impl Kind {
    const COUNT: usize = 6;
}

impl Vehicle {
    /// Creates a vehicle that has just started, disarmed unless `starts_armed`, with its streams.
    pub fn new(
        system: u8,
        model: Arc<VehicleModel>,
        parameters: Parameters,
        streams: Streams,
        (time_us, seen): (u64, Observation),
        starts_armed: bool,
    ) -> Self {
        let [x, y, _] = seen.motion.position_m;
        let actions = if starts_armed { Vec::new() } else { vec![Action::Wish(Wish::Off)] };
        Self {
            sender: Sender { system, component: MAV_COMP_ID_AUTOPILOT1, sequence: 0 },
            streams,
            parameters,
            mission: Mission::default(),
            started_us: time_us,
            home_m: [x, y, 0.0],
            time_us,
            seen,
            yaw: 0.0,
            mode: if starts_armed { FlightMode::Auto } else { FlightMode::Hold },
            is_armed: starts_armed,
            starts_armed,
            ordered: Ordered::default(),
            texts: [None; Kind::COUNT],
            refused: String::new(),
            now_us: 0,
            out: Out { actions, ..Out::default() },
            model,
        }
    }

    /// Resets the vehicle after its onboard computer restarted. Only the mission is kept.
    pub fn restart(&mut self, parameters: Parameters, state: (u64, Observation)) {
        let fresh = Self::new(
            self.sender.system,
            Arc::clone(&self.model),
            parameters,
            self.streams.clone(),
            state,
            self.starts_armed,
        );
        let old = core::mem::replace(self, fresh);
        (self.mission, self.home_m, self.sender) = (old.mission, old.home_m, old.sender);
        (self.now_us, self.yaw) = (old.now_us, old.yaw);
        self.text(Kind::News, MAV_SEVERITY_WARNING, "restarted");
    }

    /// Records the robot's state and events after a tick.
    pub fn observe(&mut self, (time_us, seen): (u64, Observation), events: &[Event], now_us: u64) {
        let before = core::mem::replace(&mut self.seen, seen);
        (self.time_us, self.now_us) = (time_us, now_us);
        if !seen.is_up {
            return;
        }
        let [east, north, _] = seen.motion.velocity_mps;
        if east * east + north * north > 1e-6 {
            self.yaw = libm::atan2(east, north) as f32;
        }
        if matches!(before.wish, Wish::Velocity { .. } | Wish::Waypoint { .. })
            && seen.wish == Wish::Hold
            && self.mode == FlightMode::Guided
        {
            self.text(Kind::Setpoint, MAV_SEVERITY_NOTICE, "setpoint timed out: holding");
        }
        for event in events {
            self.report(event);
        }
        self.advance();
    }

    fn report(&mut self, event: &Event) {
        use MAV_SEVERITY_WARNING as WARNING;
        let (kind, severity, text) = match *event {
            Event::ModeChanged { to: Mode::Fault, .. } => (Kind::News, MAV_SEVERITY_ERROR, "fault: standing".into()),
            Event::ModeChanged { to: Mode::Arrived, .. } => (Kind::News, MAV_SEVERITY_INFO, "arrived".into()),
            Event::NeighborLost(id) => (Kind::Neighbor, MAV_SEVERITY_INFO, format!("robot {id} is lost")),
            Event::NeighborRebooted(id) => (Kind::Neighbor, MAV_SEVERITY_INFO, format!("robot {id} has restarted")),
            Event::DuplicateId(id) => (Kind::News, WARNING, format!("two robots use number {id}")),
            Event::Implausible { id, claim } => {
                (Kind::Neighbor, WARNING, format!("robot {id} reports implausible {claim}"))
            }
            Event::ContactLost => (Kind::News, WARNING, "contact to all robots lost".into()),
            Event::Muted => (Kind::Neighbor, MAV_SEVERITY_ERROR, "robot cannot send: give it a new key".into()),
            Event::NoRoute => (Kind::Route, WARNING, "no open route to the goal".into()),
            _ => return,
        };
        self.text(kind, severity, &text);
    }

    pub(super) fn wish(&mut self, wish: Wish<f32>) {
        self.out.actions.push(Action::Wish(wish));
    }

    /// All kinds but `News` are limited in rate, of `Unsupported` each text by itself.
    pub(super) fn text(&mut self, kind: Kind, severity: u8, text: &str) {
        if !matches!(kind, Kind::News) {
            let last = &mut self.texts[kind as usize];
            let is_early = |last: u64| self.now_us.saturating_sub(last) < TEXT_EVERY_US;
            let is_new = matches!(kind, Kind::Unsupported) && self.refused != text;
            if last.is_some_and(is_early) && !is_new {
                return;
            }
            *last = Some(self.now_us);
            if is_new {
                text.clone_into(&mut self.refused);
            }
        }
        self.out.messages.push(MavMessage::STATUSTEXT(STATUSTEXT_DATA {
            severity,
            text: text.into(),
            ..STATUSTEXT_DATA::DEFAULT
        }));
    }

    /// Sends due telemetry, and requests overdue mission items.
    pub fn poll(&mut self, now_us: u64) {
        self.now_us = now_us;
        if !self.seen.is_up {
            return;
        }
        let mut streams = core::mem::take(&mut self.streams);
        streams.each_due(now_us, |id| self.out.messages.extend(self.telemetry(id)));
        self.streams = streams;
        self.out.messages.extend(self.mission.poll(now_us));
    }

    /// Handles a message for this vehicle or for all vehicles.
    pub fn receive(&mut self, from: Sender, message: &MavMessage, now_us: u64) {
        self.now_us = now_us;
        if !self.seen.is_up || !self.is_for_me(message) {
            return;
        }
        if is_private(message) && !self.is_named(message) {
            return self.refuse_ambiguous(from, message);
        }
        match message {
            MavMessage::COMMAND_LONG(command) => self.command_long(from, command),
            MavMessage::COMMAND_INT(command) => self.command(from, command, true),
            // The protocol defines no answer to this older message; a text tells why it failed.
            MavMessage::SET_MODE(wanted) => drop(self.set_mode(wanted.base_mode, wanted.custom_mode)),
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(target) => self.follow(self.local_setpoint(target)),
            MavMessage::SET_POSITION_TARGET_GLOBAL_INT(target) => self.follow(self.global_setpoint(target)),
            MavMessage::PARAM_REQUEST_LIST(_) => self.parameters.list(),
            MavMessage::PARAM_REQUEST_READ(wanted) => {
                let index = match usize::try_from(wanted.param_index) {
                    Ok(index) => Some(index),
                    Err(_) => self.parameters.find(&wanted.param_id),
                };
                match index.and_then(|index| self.parameters.message(index)) {
                    Some(told) => self.out.messages.push(MavMessage::PARAM_VALUE(told)),
                    None => self.unknown_parameter(),
                }
            }
            MavMessage::PARAM_SET(wanted) => self.set_parameter(wanted),
            MavMessage::REQUEST_DATA_STREAM(wanted) => {
                let rate = if wanted.start_stop == 0 { 0 } else { wanted.req_message_rate };
                if !self.streams.set_group(wanted.req_stream_id, rate, now_us) {
                    let text = format!("data stream {} has no messages", wanted.req_stream_id);
                    self.text(Kind::Unsupported, MAV_SEVERITY_INFO, &text);
                }
            }
            MavMessage::PING(ping) if ping.target_system == 0 => {
                self.out.messages.push(MavMessage::PING(PING_DATA {
                    target_system: from.system,
                    target_component: from.component,
                    ..ping.clone()
                }));
            }
            // A TIMESYNC with a time is an answer.
            MavMessage::TIMESYNC(sync) if sync.tc1 == 0 => {
                self.out.messages.push(MavMessage::TIMESYNC(TIMESYNC_DATA {
                    tc1: i64::try_from(self.time_us).map_or(i64::MAX, |us| us * 1000),
                    ts1: sync.ts1,
                }));
            }
            MavMessage::FILE_TRANSFER_PROTOCOL(asked) => self.out.messages.extend(files::none(from, asked)),
            _ => self.receive_goals(from, message),
        }
    }

    fn receive_goals(&mut self, from: Sender, message: &MavMessage) {
        let now_us = self.now_us;
        let (mission_type, answer) = match message {
            MavMessage::MISSION_COUNT(told) => {
                // An upload would replace the items of the active mission.
                if told.mission_type == MAV_MISSION_TYPE_MISSION {
                    self.stop_mission();
                }
                (told.mission_type, self.mission.count(from, told, now_us))
            }
            MavMessage::MISSION_WRITE_PARTIAL_LIST(told) => {
                (told.mission_type, self.mission.replace(from, told, now_us))
            }
            MavMessage::MISSION_REQUEST_PARTIAL_LIST(told) => {
                (told.mission_type, Err((MAV_MISSION_UNSUPPORTED, "mission: partial download is unsupported")))
            }
            MavMessage::MISSION_ITEM_INT(item) => return self.take_item(from, item.clone()),
            MavMessage::MISSION_ITEM(item) => return self.take_item(from, from_float(item)),
            MavMessage::MISSION_REQUEST_LIST(wanted) => {
                (wanted.mission_type, Ok(self.mission.list(from, wanted.mission_type)))
            }
            MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA { seq, mission_type, .. }) => {
                (*mission_type, self.mission.tell(from, self.home_item(), *seq, *mission_type, true))
            }
            MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA { seq, mission_type, .. }) => {
                (*mission_type, self.mission.tell(from, self.home_item(), *seq, *mission_type, false))
            }
            MavMessage::MISSION_CLEAR_ALL(wanted) => {
                self.stop_mission();
                (wanted.mission_type, Ok(self.mission.clear(from, wanted.mission_type)))
            }
            MavMessage::MISSION_SET_CURRENT(wanted) => {
                if self.set_current_item(wanted.seq).is_err() {
                    self.text(Kind::News, MAV_SEVERITY_WARNING, "unknown mission item");
                }
                return self.out.messages.extend(self.telemetry(MISSION_CURRENT_DATA::ID));
            }
            _ => return self.receive_orders(from, message),
        };
        match answer {
            Ok(answer) => self.out.messages.push(answer),
            Err(refused) => self.refuse_mission(from, mission_type, refused),
        }
    }

    pub(super) fn refuse_mission(&mut self, from: Sender, mission_type: u8, (result, text): Refused) {
        self.out.messages.push(ack(from, mission_type, result));
        self.text(Kind::Unsupported, MAV_SEVERITY_WARNING, text);
    }

    /// Messages that would configure all vehicles alike or send them to one place need the number
    /// of a vehicle if there are several.
    fn refuse_ambiguous(&mut self, from: Sender, message: &MavMessage) {
        if !matches!(message, MavMessage::PARAM_SET(_)) {
            self.out.messages.push(ack(from, MAV_MISSION_TYPE_MISSION, MAV_MISSION_DENIED));
        }
        let text = format!("{} to system 0: name one", message.message_name());
        self.text(Kind::Unsupported, MAV_SEVERITY_WARNING, &text);
    }

    /// A message that these vehicles have no use for.
    pub(super) fn refuse_unsupported(&mut self, message: &MavMessage) {
        let is_request = matches!(
            message,
            MavMessage::SET_GPS_GLOBAL_ORIGIN(_)
                | MavMessage::MANUAL_CONTROL(_)
                | MavMessage::RC_CHANNELS_OVERRIDE(_)
                | MavMessage::SET_ATTITUDE_TARGET(_)
                | MavMessage::LOG_REQUEST_LIST(_)
                | MavMessage::SET_ACTUATOR_CONTROL_TARGET(_)
                | MavMessage::FENCE_POINT(_)
                | MavMessage::FENCE_FETCH_POINT(_)
                | MavMessage::RALLY_POINT(_)
                | MavMessage::RALLY_FETCH_POINT(_)
                | MavMessage::SET_HOME_POSITION(_)
                | MavMessage::SETUP_SIGNING(_)
        );
        if is_request {
            let text = format!("{} is unsupported", message.message_name());
            self.text(Kind::Unsupported, MAV_SEVERITY_WARNING, &text);
        }
    }

    fn is_for_me(&self, message: &MavMessage) -> bool {
        let (system, component) = (message.target_system_id(), message.target_component_id());
        let is_mine = system.is_none_or(|system| system == 0 || system == self.sender.system);
        // 0 addresses all components; this vehicle has one.
        let is_here = component.is_none_or(|to| to == 0 || to == MAV_COMP_ID_AUTOPILOT1);
        is_mine && is_here
    }

    fn is_named(&self, message: &MavMessage) -> bool {
        self.model.is_alone || message.target_system_id() == Some(self.sender.system)
    }

    pub(super) const fn uptime_us(&self) -> u64 {
        self.time_us.saturating_sub(self.started_us)
    }

    pub(super) fn is_in_air(&self) -> bool {
        let [x, y, _] = self.seen.motion.position_m;
        self.model.flies && !self.is_at([x, y, 0.0], 0.02)
    }

    pub(super) fn tolerance_m(&self) -> f32 {
        self.parameters.get(TOLERANCE.name).unwrap_or(0.0)
    }

    pub(super) fn enter(&mut self, mode: FlightMode) {
        let flies = self.model.flies;
        if mode.number(flies) != self.mode.number(flies) {
            let text = format!("mode {}", mode.name(flies));
            self.text(Kind::News, MAV_SEVERITY_INFO, &text);
        }
        self.mode = mode;
        self.begin();
    }

    pub(super) fn begin(&mut self) {
        let [x, y, z] = self.seen.motion.position_m;
        let wish = match self.mode {
            _ if !self.is_armed => Wish::Off,
            FlightMode::Mission { .. } => return self.begin_item(),
            FlightMode::Auto => Wish::Own,
            FlightMode::Guided | FlightMode::Hold | FlightMode::Brake => Wish::Hold,
            FlightMode::Return => {
                let [home_x, home_y, _] = self.home_m;
                self.goal([home_x, home_y, z]).unwrap_or(Wish::Hold)
            }
            FlightMode::Land { .. } => self.goal([x, y, 0.0]).unwrap_or(Wish::Hold),
        };
        self.wish(wish);
    }

    /// `None` if the position is not finite, too far, or inside an obstacle.
    pub(super) fn goal(&self, [x, y, z]: [f64; 3]) -> Option<Wish<f32>> {
        let place_m = [x, y, if self.model.flies { z } else { self.seen.motion.position_m[2] }];
        let is_near = place_m.iter().all(|m| m.abs() <= FAR_M);
        if self.model.grid.is_some() {
            return self.model.cell(place_m).map(Wish::Cell);
        }
        if !is_near || !self.model.has_room(place_m) {
            return None;
        }
        Some(Wish::Waypoint { waypoint: Waypoint::fixed(Position::from_metres(place_m)?), valid: None })
    }

    pub(super) fn is_at(&self, place_m: [f64; 3], near_m: f64) -> bool {
        if self.model.grid.is_some() {
            return self.model.cell(place_m) == Some(self.seen.motion.cell);
        }
        let off = [0, 1, 2].map(|axis| place_m[axis] - self.seen.motion.position_m[axis]);
        let flat = off[0] * off[0] + off[1] * off[1];
        let all = flat + if self.model.flies { off[2] * off[2] } else { 0.0 };
        let near_m = near_m.max(1.5 * f64::from(self.tolerance_m()));
        all <= near_m * near_m
    }

    fn advance(&mut self) {
        if !self.is_armed {
            return;
        }
        let z = self.seen.motion.position_m[2];
        match self.mode {
            FlightMode::Land { is_item } if !self.is_in_air() => {
                self.is_armed = false;
                self.begin();
                if is_item {
                    self.finish_landing();
                }
                self.text(Kind::News, MAV_SEVERITY_INFO, "landed, disarmed");
            }
            FlightMode::Return if self.model.flies => {
                let [home_x, home_y, _] = self.home_m;
                if self.is_at([home_x, home_y, z], 0.0) {
                    self.enter(FlightMode::LAND);
                }
            }
            FlightMode::Mission { .. } => self.advance_mission(),
            _ => {}
        }
    }
}

/// Whether the message must not be for all vehicles at once.
const fn is_private(message: &MavMessage) -> bool {
    matches!(
        message,
        MavMessage::PARAM_SET(_)
            | MavMessage::MISSION_COUNT(_)
            | MavMessage::MISSION_WRITE_PARTIAL_LIST(_)
            | MavMessage::MISSION_ITEM(_)
            | MavMessage::MISSION_ITEM_INT(_)
    )
}

#[cfg(test)]
mod tests;
