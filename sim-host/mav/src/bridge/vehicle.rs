//! One robot as a MAVLink vehicle: frames and moments in, answers and wishes out; no sockets, no clock. Read [`Vehicle::receive`]
//! first.
//!
//! What a client says becomes a [`Action`] for the robot's controller, or is refused. Commands are answered always
//! (`commands`), setpoints never (`guided`), as the protocol has it; what was wrong with them is said as STATUSTEXT.

use super::files;
use super::mission::{Item, Mission};
use super::model::{FlightMode, Sample, VehicleModel};
use super::ordered::Ordered;
use super::params::{Meaning, Parameters};
use super::streams::Streams;
use crate::geo::FAR_M;
use staya_controller::agent::{Event, Parameter, Waypoint, Wish};
use staya_controller::geom::Position;
use staya_controller::robot::Mode;
use staya_controller::wire::{Header, Message};
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;
use staya_mavlink::mavlink_core::Message as _;
use std::sync::Arc;

mod tuning;

/// Texts of one kind come at most once in this time, microseconds.
const TEXT_EVERY_US: u64 = 2_000_000;

/// What is to be done to the robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Its controller gets a wish.
    Wish(Wish<f32>),
    /// Its controller hears a message.
    Tell(Header, Message),
    /// Its controller gets a parameter.
    Set(Parameter, f32),
}

/// What comes of a moment.
#[derive(Clone, Debug, Default)]
pub struct Out {
    /// To send, in this order.
    pub messages: Vec<MavMessage>,
    /// To do, in this order, before the next tick.
    pub actions: Vec<Action>,
    /// How commands were answered.
    pub results: Vec<u8>,
}

/// One robot as clients see it.
#[derive(Clone, Debug)]
pub struct Vehicle {
    pub(super) system: u8,
    pub(super) model: Arc<VehicleModel>,
    pub(super) streams: Streams,
    pub(super) parameters: Parameters,
    pub(super) mission: Mission,
    pub(super) sample: Sample,
    /// When its computer started, simulated time.
    started_us: u64,
    /// Where it was then.
    pub(super) home_m: [f64; 3],
    /// Where its front points, radians from north to the east.
    pub(super) yaw: f32,
    pub(super) mode: FlightMode,
    pub(super) is_armed: bool,
    starts_armed: bool,
    /// Its mission is under way, since this simulated time at the present item's place.
    pub(super) is_on_mission: bool,
    pub(super) there_since_us: Option<u64>,
    /// It lands because an item of its mission says so.
    pub(super) is_landing_item: bool,
    /// What it was last told of a formation.
    pub(super) ordered: Ordered,
    /// When a text of each kind was last sent, and the time now.
    texts: [Option<u64>; Kind::COUNT],
    pub(super) now_us: u64,
}

/// What a text is about.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// Each is news.
    News,
    Parameter,
    Setpoint,
    Neighbor,
    Route,
}

impl Kind {
    const COUNT: usize = 5;
}

impl Vehicle {
    /// A robot that has just started, disarmed unless `starts_armed`. `streams` says what it sends.
    #[must_use]
    pub fn new(
        system: u8,
        model: Arc<VehicleModel>,
        parameters: Parameters,
        streams: Streams,
        sample: Sample,
        starts_armed: bool,
    ) -> Self {
        let [x, y, _] = sample.position_m;
        Self {
            system,
            streams,
            parameters,
            mission: Mission::default(),
            started_us: sample.time_us,
            // Home is on the ground of those that fly.
            home_m: [x, y, 0.0],
            sample,
            yaw: 0.0,
            mode: if starts_armed { FlightMode::Auto } else { FlightMode::Hold },
            is_armed: starts_armed,
            starts_armed,
            is_on_mission: false,
            there_since_us: None,
            is_landing_item: false,
            ordered: Ordered::default(),
            texts: [None; Kind::COUNT],
            now_us: 0,
            model,
        }
    }

    /// Its MAVLink system.
    #[must_use]
    pub const fn system(&self) -> u8 {
        self.system
    }

    /// What the robot must be told at its start.
    #[must_use]
    pub const fn first_deed(&self) -> Option<Action> {
        if self.starts_armed { None } else { Some(Action::Wish(Wish::Off)) }
    }

    /// Its computer has started anew: it has forgotten all but its mission.
    pub fn restart(&mut self, parameters: Parameters, sample: Sample, out: &mut Out) {
        let fresh = Self::new(
            self.system,
            Arc::clone(&self.model),
            parameters,
            self.streams.clone(),
            sample,
            self.starts_armed,
        );
        let old = core::mem::replace(self, fresh);
        (self.mission, self.home_m) = (old.mission, old.home_m);
        (self.now_us, self.yaw) = (old.now_us, old.yaw);
        out.actions.extend(self.first_deed());
        self.text(out, Kind::News, MAV_SEVERITY_WARNING, "started anew");
    }

    /// Takes note of where the robot is after a tick, and what happened in it.
    pub fn observe(&mut self, sample: Sample, events: &[Event], now_us: u64, out: &mut Out) {
        let before = core::mem::replace(&mut self.sample, sample);
        self.now_us = now_us;
        if !sample.is_up {
            return;
        }
        let [east, north, _] = sample.velocity_mps;
        if east * east + north * north > 1e-6 {
            self.yaw = libm::atan2(east, north) as f32;
        }
        if matches!(before.wish, Wish::Velocity { .. } | Wish::Waypoint { .. })
            && sample.wish == Wish::Hold
            && self.mode == FlightMode::Guided
        {
            let text = "no setpoint any more: holding";
            self.text(out, Kind::Setpoint, MAV_SEVERITY_NOTICE, text);
        }
        for event in events {
            self.report(event, out);
        }
        self.go_on(out);
    }

    fn report(&mut self, event: &Event, out: &mut Out) {
        use MAV_SEVERITY_INFO as INFO;
        match *event {
            Event::ModeChanged { to: Mode::Fault, .. } => {
                self.text(out, Kind::News, MAV_SEVERITY_ERROR, "fault: standing");
            }
            Event::ModeChanged { to: Mode::Arrived, .. } => self.text(out, Kind::News, INFO, "arrived"),
            Event::NeighborLost(id) => {
                let text = format!("robot {id} is not heard any more");
                self.text(out, Kind::Neighbor, INFO, &text);
            }
            Event::NeighborRebooted(id) => {
                let text = format!("robot {id} has started anew");
                self.text(out, Kind::Neighbor, INFO, &text);
            }
            Event::DuplicateId(id) => {
                let text = format!("two robots have number {id}");
                self.text(out, Kind::News, MAV_SEVERITY_WARNING, &text);
            }
            Event::Overclaimed { id, claim } => {
                let text = format!("robot {id} claims {claim}");
                self.text(out, Kind::Neighbor, MAV_SEVERITY_WARNING, &text);
            }
            Event::NobodyHeard => self.text(out, Kind::News, MAV_SEVERITY_WARNING, "nobody is heard any more"),
            Event::Muted => {
                let text = "robot is mute: it needs a new key";
                self.text(out, Kind::Neighbor, MAV_SEVERITY_ERROR, text);
            }
            Event::NoRoute => self.text(out, Kind::Route, MAV_SEVERITY_WARNING, "no way is open"),
            _ => {}
        }
    }

    /// Says something; texts of one kind not too often.
    pub(super) fn text(&mut self, out: &mut Out, kind: Kind, severity: u8, text: &str) {
        if !matches!(kind, Kind::News) {
            let last = &mut self.texts[kind as usize];
            let is_early = |last: u64| self.now_us.saturating_sub(last) < TEXT_EVERY_US;
            if last.is_some_and(is_early) {
                return;
            }
            *last = Some(self.now_us);
        }
        out.messages.push(MavMessage::STATUSTEXT(STATUSTEXT_DATA {
            severity,
            text: text.into(),
            ..STATUSTEXT_DATA::DEFAULT
        }));
    }

    /// Sends what is due at `now_us`, and asks for what did not come.
    pub fn poll(&mut self, now_us: u64, out: &mut Out) {
        self.now_us = now_us;
        if !self.sample.is_up {
            return;
        }
        let mut streams = core::mem::take(&mut self.streams);
        streams.each_due(now_us, |id| out.messages.extend(self.telemetry(id)));
        self.streams = streams;
        out.messages.extend(self.mission.poll(now_us));
    }

    /// Whether parameters that somebody asked to be listed are still to be sent.
    #[must_use]
    pub const fn is_listing(&self) -> bool {
        self.parameters.is_listing()
    }

    /// Sends one of them.
    pub fn list_one(&mut self, out: &mut Out) {
        out.messages.extend(self.parameters.next_listed().map(MavMessage::PARAM_VALUE));
    }

    /// Says that soon nothing can be said any more, since there is no timestamp left to sign with.
    pub fn say_exhausted(&mut self, out: &mut Out) {
        let text = "no timestamp to sign with: take a new key";
        self.text(out, Kind::News, MAV_SEVERITY_ERROR, text);
    }

    /// Takes a message of somebody else in: for this vehicle, or for all.
    pub fn receive(&mut self, from: Sender, message: &MavMessage, now_us: u64, out: &mut Out) {
        self.now_us = now_us;
        if !self.sample.is_up || !self.is_for_me(message) {
            return;
        }
        match message {
            MavMessage::COMMAND_LONG(command) => self.command_long(from, command, out),
            MavMessage::COMMAND_INT(command) => self.command_int(from, command, out),
            MavMessage::SET_MODE(wanted) => self.set_mode_message(wanted, out),
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(target) => self.target_local(target, out),
            MavMessage::SET_POSITION_TARGET_GLOBAL_INT(target) => self.target_global(target, out),
            MavMessage::PARAM_REQUEST_LIST(_) => self.parameters.list(),
            MavMessage::PARAM_REQUEST_READ(wanted) => {
                let index = match usize::try_from(wanted.param_index) {
                    Ok(index) => Some(index),
                    Err(_) => self.parameters.find(&wanted.param_id),
                };
                match index.and_then(|index| self.parameters.message(index)) {
                    Some(told) => out.messages.push(MavMessage::PARAM_VALUE(told)),
                    None => self.unknown_parameter(out),
                }
            }
            MavMessage::PARAM_SET(wanted) => self.set_parameter(wanted, out),
            MavMessage::REQUEST_DATA_STREAM(wanted) => {
                let rate = match wanted.start_stop {
                    0 => 0,
                    _ => wanted.req_message_rate,
                };
                self.streams.set_group(wanted.req_stream_id, rate, now_us);
            }
            MavMessage::PING(ping) if ping.target_system == 0 => {
                out.messages.push(MavMessage::PING(PING_DATA {
                    target_system: from.system,
                    target_component: from.component,
                    ..ping.clone()
                }));
            }
            // Only a question is answered.
            MavMessage::TIMESYNC(sync) if sync.tc1 == 0 => {
                out.messages.push(MavMessage::TIMESYNC(TIMESYNC_DATA {
                    tc1: i64::try_from(self.sample.time_us).map_or(i64::MAX, |us| us * 1000),
                    ts1: sync.ts1,
                }));
            }
            MavMessage::FILE_TRANSFER_PROTOCOL(asked) => out.messages.extend(files::none(from, asked)),
            _ => self.receive_goals(from, message, out),
        }
    }

    /// Missions, and what robots say to each other.
    fn receive_goals(&mut self, from: Sender, message: &MavMessage, out: &mut Out) {
        let now_us = self.now_us;
        let answer = match message {
            MavMessage::MISSION_COUNT(told) => {
                // What is under way is not taken from under its feet.
                if self.is_on_mission && told.mission_type == MAV_MISSION_TYPE_MISSION {
                    self.stop_mission(out);
                }
                self.mission.count(from, told, now_us)
            }
            MavMessage::MISSION_ITEM_INT(item) if item.current < 2 => {
                self.take_item(from, item.seq, Item::from_int(item), out)
            }
            MavMessage::MISSION_ITEM(item) if item.current < 2 => {
                self.take_item(from, item.seq, Item::from_float(item), out)
            }
            // How clients of old say "go there now": an item of no mission.
            MavMessage::MISSION_ITEM_INT(item) => self.guided_item(from, item.current, &Item::from_int(item), out),
            MavMessage::MISSION_ITEM(item) => self.guided_item(from, item.current, &Item::from_float(item), out),
            MavMessage::MISSION_REQUEST_LIST(wanted) => self.mission.list(from, wanted.mission_type),
            MavMessage::MISSION_REQUEST_INT(wanted) => self.mission.tell(from, wanted.seq, wanted.mission_type, true),
            MavMessage::MISSION_REQUEST(wanted) => self.mission.tell(from, wanted.seq, wanted.mission_type, false),
            MavMessage::MISSION_CLEAR_ALL(wanted) => {
                self.stop_mission(out);
                self.mission.clear(from, wanted.mission_type)
            }
            MavMessage::MISSION_SET_CURRENT(wanted) => {
                if self.set_current_item(wanted.seq, out).is_err() {
                    let text = "no such mission item";
                    self.text(out, Kind::News, MAV_SEVERITY_WARNING, text);
                }
                return out.messages.extend(self.telemetry(MISSION_CURRENT_ID));
            }
            _ => return self.receive_orders(from, message, out),
        };
        out.messages.push(answer);
    }

    fn is_for_me(&self, message: &MavMessage) -> bool {
        let system = message.target_system_id();
        let component = message.target_component_id();
        let is_mine = system.is_none_or(|system| system == 0 || system == self.system);
        // What goes to everybody would make everybody the same: not that.
        let is_private = matches!(
            message,
            MavMessage::PARAM_SET(_)
                | MavMessage::MISSION_COUNT(_)
                | MavMessage::MISSION_ITEM(_)
                | MavMessage::MISSION_ITEM_INT(_)
                | MavMessage::FILE_TRANSFER_PROTOCOL(_)
        );
        let is_addressed = !is_private || system == Some(self.system);
        // 0: all components. There is one here.
        let is_here = component.is_none_or(|to| to == 0 || to == MAV_COMP_ID_AUTOPILOT1);
        is_mine && is_addressed && is_here
    }

    /// Microseconds since its computer started, simulated.
    pub(super) const fn uptime_us(&self) -> u64 {
        self.sample.time_us.saturating_sub(self.started_us)
    }

    /// Whether it is off the ground.
    pub(super) fn is_in_air(&self) -> bool {
        let low_m = 0.02_f64.max(f64::from(self.tolerance_m()));
        self.model.flies && self.sample.position_m[2] > low_m
    }

    /// How near is there, metres.
    pub(super) fn tolerance_m(&self) -> f32 {
        let tolerance = Meaning::Controller(Parameter::Tolerance);
        self.parameters.get(tolerance).unwrap_or(0.0)
    }

    /// Changes the mode, whoever wants it, and does what the mode begins with.
    pub(super) fn enter(&mut self, mode: FlightMode, out: &mut Out) {
        if mode != self.mode {
            let text = format!("mode {}", mode.name(self.model.flies));
            self.text(out, Kind::News, MAV_SEVERITY_INFO, &text);
        }
        self.mode = mode;
        (self.is_on_mission, self.is_landing_item) = (false, false);
        self.begin(out);
    }

    /// What the mode begins with.
    pub(super) fn begin(&mut self, out: &mut Out) {
        let [x, y, z] = self.sample.position_m;
        let wish = match self.mode {
            _ if !self.is_armed => Wish::Off,
            FlightMode::Auto if self.is_on_mission => return self.begin_item(out),
            FlightMode::Auto => Wish::Own,
            FlightMode::Guided | FlightMode::Hold => Wish::Hold,
            // At its present height; it lands when it is there.
            FlightMode::Return => {
                let [home_x, home_y, _] = self.home_m;
                self.goal([home_x, home_y, z]).unwrap_or(Wish::Hold)
            }
            FlightMode::Land => self.goal([x, y, 0.0]).unwrap_or(Wish::Hold),
        };
        out.actions.push(Action::Wish(wish));
    }

    /// The wish to be at a place; `None` for one that no number or no body has room for.
    pub(super) fn goal(&self, [x, y, z]: [f64; 3]) -> Option<Wish<f32>> {
        // Who does not fly keeps his height.
        let place_m = [x, y, if self.model.flies { z } else { self.sample.position_m[2] }];
        let is_near = place_m.iter().all(|m| m.abs() <= FAR_M);
        if !is_near || !self.model.has_room(place_m) {
            return None;
        }
        if self.model.grid.is_some() {
            return Some(Wish::Cell(self.model.cell(place_m)?));
        }
        Some(Wish::Waypoint { waypoint: Waypoint::fixed(Position::from_metres(place_m)?), valid: None })
    }

    /// Whether it is at a place, by what it knows of its own.
    pub(super) fn is_at(&self, place_m: [f64; 3], near_m: f64) -> bool {
        if self.model.grid.is_some() {
            return self.model.cell(place_m) == Some(self.sample.cell);
        }
        let off = [0, 1, 2].map(|axis| place_m[axis] - self.sample.position_m[axis]);
        let flat = off[0] * off[0] + off[1] * off[1];
        let all = flat + if self.model.flies { off[2] * off[2] } else { 0.0 };
        let near_m = near_m.max(1.5 * f64::from(self.tolerance_m()));
        all <= near_m * near_m
    }

    /// What follows from where it is now: the end of a return or a landing, the next item of a mission.
    fn go_on(&mut self, out: &mut Out) {
        if !self.is_armed {
            return;
        }
        let [x, y, z] = self.sample.position_m;
        match self.mode {
            FlightMode::Land if self.is_at([x, y, 0.0], 0.0) => {
                self.is_armed = false;
                self.begin(out);
                self.finish_landing(out);
                self.text(out, Kind::News, MAV_SEVERITY_INFO, "landed, disarmed");
            }
            FlightMode::Return if self.model.flies => {
                let [home_x, home_y, _] = self.home_m;
                if self.is_at([home_x, home_y, z], 0.0) {
                    self.enter(FlightMode::Land, out);
                }
            }
            FlightMode::Auto if self.is_on_mission => self.go_on_with_mission(out),
            _ => {}
        }
    }
}

/// MISSION_CURRENT.
const MISSION_CURRENT_ID: u32 = 42;

#[cfg(test)]
mod tests;
