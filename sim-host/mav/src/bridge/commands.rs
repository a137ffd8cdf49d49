//! COMMAND_LONG and COMMAND_INT: every command is executed or refused, and always answered.
//!
//! | answer | when |
//! | --- | --- |
//! | UNSUPPORTED | the vehicle does not have this command (a ground vehicle has no takeoff) |
//! | DENIED | a required parameter is NaN or out of range, or the place is in an obstacle |
//! | TEMPORARILY_REJECTED | not now: disarmed, in the wrong mode, in the air, or moving |
//! | COMMAND_INT_ONLY, UNSUPPORTED_MAV_FRAME | an unknown frame, or one with coarse coordinates |
//!
//! Parameters that a command does not use may have any value, NaN included.

use super::items::{fault_without_place, has_no_place};
use super::mission::{Item, ack};
use super::model::FlightMode;
use super::vehicle::{Action, Kind, Vehicle};
use crate::geo::Global;
use staya_controller::parameters::SPEED;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;
use staya_mavlink::mavlink_core::MessageData as _;

const HIGHEST_M: f32 = 1000.0;

const STANDING_MPS: f64 = 0.05;

pub(super) type Refusal = u8;

fn whole(x: f32, most: f32) -> Result<u32, Refusal> {
    let is_one = (0.0..=most).contains(&x) && libm::truncf(x) == x;
    if is_one { Ok(x as u32) } else { Err(MAV_RESULT_DENIED) }
}

impl Vehicle {
    /// Without the coordinates, which are too coarse for any command.
    pub(super) fn command_long(&mut self, from: Sender, command: &COMMAND_LONG_DATA) {
        let COMMAND_LONG_DATA { param1, param2, param7: z, command, .. } = *command;
        let frame = MAV_FRAME_GLOBAL_RELATIVE_ALT;
        let command = COMMAND_INT_DATA { param1, param2, z, command, frame, ..COMMAND_INT_DATA::DEFAULT };
        self.command(from, &command, false);
    }

    pub(super) fn command(&mut self, from: Sender, command: &COMMAND_INT_DATA, is_int: bool) {
        // The acknowledgement is sent before the messages that the command causes.
        let at = self.out.messages.len();
        let result = self.execute(command, is_int).err().unwrap_or(MAV_RESULT_ACCEPTED);
        let (target_system, target_component) = (from.system, from.component);
        let ack = COMMAND_ACK_DATA { command: command.command, result, ..COMMAND_ACK_DATA::DEFAULT };
        let ack = COMMAND_ACK_DATA { target_system, target_component, ..ack };
        self.out.messages.insert(at, MavMessage::COMMAND_ACK(ack));
        // Clients try out by themselves which messages there are.
        let is_trial = matches!(command.command, MAV_CMD_REQUEST_MESSAGE | MAV_CMD_SET_MESSAGE_INTERVAL);
        if result == MAV_RESULT_UNSUPPORTED && !is_trial {
            let text = format!("command {} is unsupported", command.command);
            self.text(Kind::Unsupported, MAV_SEVERITY_WARNING, &text);
        }
    }

    fn execute(&mut self, command: &COMMAND_INT_DATA, is_int: bool) -> Result<(), Refusal> {
        let (first, second) = (command.param1, command.param2);
        match command.command {
            MAV_CMD_COMPONENT_ARM_DISARM => {
                let arms = whole(first, 1.0)? == 1;
                self.arm(arms, second == ARM_DISARM_FORCE)
            }
            MAV_CMD_DO_SET_MODE => {
                let base = whole(first, 255.0)? as u8;
                self.set_mode(base, whole(second, 255.0)?)
            }
            MAV_CMD_NAV_TAKEOFF => {
                let frames = [MAV_FRAME_GLOBAL_RELATIVE_ALT, MAV_FRAME_GLOBAL_RELATIVE_ALT_INT];
                if self.model.flies && !frames.contains(&command.frame) {
                    return Err(MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME);
                }
                self.take_off(command.z)
            }
            MAV_CMD_NAV_LAND if self.model.flies => {
                self.needs_arms()?;
                self.enter(FlightMode::LAND);
                Ok(())
            }
            MAV_CMD_NAV_LOITER_UNLIM => {
                self.enter(FlightMode::Hold);
                Ok(())
            }
            MAV_CMD_NAV_RETURN_TO_LAUNCH => {
                self.needs_arms()?;
                self.set_mode(MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, FlightMode::Return.number(self.model.flies))
            }
            MAV_CMD_DO_REPOSITION if !is_int => Err(MAV_RESULT_COMMAND_INT_ONLY),
            MAV_CMD_DO_REPOSITION => self.reposition(command),
            MAV_CMD_DO_CHANGE_SPEED => self.change_speed(second),
            MAV_CMD_MISSION_START => {
                self.needs_arms()?;
                self.start_mission()
            }
            MAV_CMD_DO_SET_MISSION_CURRENT => {
                let seq = whole(first, f32::from(u16::MAX))?;
                self.set_current_item(seq as u16)
            }
            MAV_CMD_SET_MESSAGE_INTERVAL => {
                let id = self.stream_id(first)?;
                let now_us = self.now_us;
                if self.streams.set_interval(id, second, now_us) { Ok(()) } else { Err(MAV_RESULT_DENIED) }
            }
            MAV_CMD_GET_MESSAGE_INTERVAL => {
                let id = whole(first, 16_777_215.0)?;
                let interval_us = self.streams.interval_us(id).unwrap_or(0);
                self.out
                    .messages
                    .push(MavMessage::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA { interval_us, message_id: id as u16 }));
                Ok(())
            }
            MAV_CMD_REQUEST_MESSAGE => {
                let id = self.stream_id(first)?;
                self.send_now(id)
            }
            MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES => self.send_now(AUTOPILOT_VERSION_DATA::ID),
            MAV_CMD_GET_HOME_POSITION => self.send_now(HOME_POSITION_DATA::ID),
            _ => Err(MAV_RESULT_UNSUPPORTED),
        }
    }

    fn stream_id(&self, number: f32) -> Result<u32, Refusal> {
        let id = whole(number, 16_777_215.0)?;
        if self.streams.has(id) { Ok(id) } else { Err(MAV_RESULT_UNSUPPORTED) }
    }

    fn send_now(&mut self, id: u32) -> Result<(), Refusal> {
        let message = self.telemetry(id).ok_or(MAV_RESULT_TEMPORARILY_REJECTED)?;
        self.out.messages.push(message);
        Ok(())
    }

    const fn needs_arms(&self) -> Result<(), Refusal> {
        if self.is_armed { Ok(()) } else { Err(MAV_RESULT_TEMPORARILY_REJECTED) }
    }

    fn arm(&mut self, arms: bool, forced: bool) -> Result<(), Refusal> {
        // Disarming a moving vehicle would make others run into it.
        let [vx, vy, vz] = self.seen.motion.velocity_mps;
        let moves = vx * vx + vy * vy + vz * vz > STANDING_MPS * STANDING_MPS;
        if !arms && !forced && (moves || self.is_in_air()) {
            let text = if self.is_in_air() { "disarm refused: in the air" } else { "disarm refused: still moving" };
            self.text(Kind::Setpoint, MAV_SEVERITY_WARNING, text);
            return Err(MAV_RESULT_TEMPORARILY_REJECTED);
        }
        if arms == self.is_armed {
            return Ok(());
        }
        self.is_armed = arms;
        if let (false, FlightMode::Mission { .. }) = (arms, self.mode) {
            self.mode = FlightMode::Auto;
        }
        self.begin();
        let text = if arms { "armed" } else { "disarmed" };
        self.text(Kind::News, MAV_SEVERITY_INFO, text);
        Ok(())
    }

    pub(super) fn set_mode(&mut self, base: u8, number: u32) -> Result<(), Refusal> {
        let Some(mode) = FlightMode::from_number(number, self.model.flies) else {
            return self.refuse_mode(&format!("mode {number} is unsupported"));
        };
        if base & MAV_MODE_FLAG_CUSTOM_MODE_ENABLED == 0 {
            return self.refuse_mode("mode: the flag of custom modes is missing");
        }
        if mode == FlightMode::Return && self.model.in_formation {
            return self.refuse_mode("RTL: not in a formation");
        }
        // AUTO flies the mission if there is one, as ArduPilot does.
        if mode == FlightMode::Auto && self.is_armed && !self.mission.is_empty() {
            return self.start_mission();
        }
        self.enter(mode);
        Ok(())
    }

    fn refuse_mode(&mut self, text: &str) -> Result<(), Refusal> {
        self.text(Kind::News, MAV_SEVERITY_WARNING, text);
        Err(MAV_RESULT_DENIED)
    }

    fn take_off(&mut self, height_m: f32) -> Result<(), Refusal> {
        if !self.model.flies {
            return Err(MAV_RESULT_UNSUPPORTED);
        }
        let is_sound = height_m > self.tolerance_m() && height_m <= HIGHEST_M;
        let [x, y, _] = self.seen.motion.position_m;
        let wish = self.goal([x, y, f64::from(height_m)]);
        let wish = wish.filter(|_| is_sound).ok_or(MAV_RESULT_DENIED)?;
        self.needs_arms()?;
        if self.mode != FlightMode::Guided || self.is_in_air() {
            return Err(MAV_RESULT_TEMPORARILY_REJECTED);
        }
        self.wish(wish);
        Ok(())
    }

    fn reposition(&mut self, command: &COMMAND_INT_DATA) -> Result<(), Refusal> {
        let COMMAND_INT_DATA { param1: speed_mps, param2: flags, frame, x, y, z, .. } = *command;
        let place = self.global_place(frame, x, y, z)?;
        let flags = if flags.is_nan() { 0 } else { whole(flags, 255.0)? };
        let changes_mode = flags & MAV_DO_REPOSITION_FLAGS_CHANGE_MODE != 0;
        if self.model.in_formation {
            return Err(MAV_RESULT_DENIED);
        }
        let wish = self.goal(place).ok_or(MAV_RESULT_DENIED)?;
        self.needs_arms()?;
        if self.mode != FlightMode::Guided && !changes_mode {
            return Err(MAV_RESULT_TEMPORARILY_REJECTED);
        }
        if speed_mps > 0.0 {
            self.change_speed(speed_mps)?;
        }
        if self.mode != FlightMode::Guided {
            self.enter(FlightMode::Guided);
        }
        self.wish(wish);
        Ok(())
    }

    pub(super) fn guided_item(&mut self, from: Sender, item: &Item) {
        let is_goto = item.current == 2 && item.command == MAV_CMD_NAV_WAYPOINT;
        let (result, text) = match self.item_place(item) {
            _ if self.model.in_formation => (MAV_MISSION_UNSUPPORTED, "guided item: in formation; use STAYA_GOAL"),
            _ if !is_goto => (MAV_MISSION_UNSUPPORTED, "guided item: only WAYPOINT with current 2"),
            _ if !self.is_armed || self.mode != FlightMode::Guided => {
                (MAV_MISSION_ERROR, "guided item: arm and select GUIDED first")
            }
            place => match place.and_then(|place| self.goal(place)) {
                Some(wish) => {
                    self.wish(wish);
                    return self.out.messages.push(ack(from, MAV_MISSION_TYPE_MISSION, MAV_MISSION_ACCEPTED));
                }
                None => (MAV_MISSION_INVALID_PARAM5_X, "guided item: obstacle or out of range"),
            },
        };
        self.refuse_mission(from, MAV_MISSION_TYPE_MISSION, (result, text));
    }

    pub(super) fn change_speed(&mut self, speed_mps: f32) -> Result<(), Refusal> {
        let index = self.parameters.index_of(SPEED.name).ok_or(MAV_RESULT_UNSUPPORTED)?;
        self.parameters.set(index, speed_mps).map_err(|_| MAV_RESULT_DENIED)?;
        self.out.actions.push(Action::Set(SPEED.name, speed_mps));
        Ok(())
    }

    /// Altitude of height 0 in a global frame; `None` for other frames.
    pub(super) fn datum_m(&self, frame: u8) -> Option<f64> {
        match frame {
            MAV_FRAME_GLOBAL | MAV_FRAME_GLOBAL_INT => Some(0.0),
            // Home is on the ground at the origin: heights above home are heights above the ground.
            MAV_FRAME_GLOBAL_RELATIVE_ALT | MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => {
                Some(self.model.origin.place().altitude_m)
            }
            _ => None,
        }
    }

    fn global_place(&self, frame: u8, x: i32, y: i32, z: f32) -> Result<[f64; 3], Refusal> {
        let origin = &self.model.origin;
        let datum_m = self.datum_m(frame).ok_or(MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME)?;
        // A ground vehicle ignores the height, which may be NaN. A NaN fails the check of heights.
        let altitude_m = if self.model.flies { f64::from(z) + datum_m } else { origin.place().altitude_m };
        let place = Global { altitude_m, ..Global::from_e7(x, y, 0) };
        let place_m = origin.to_enu_m(&place).ok_or(MAV_RESULT_DENIED)?;
        let is_low = place_m[2] <= f64::from(HIGHEST_M);
        let is_above_ground = !self.model.flies || place_m[2] >= -0.001;
        if is_low && is_above_ground { Ok(place_m) } else { Err(MAV_RESULT_DENIED) }
    }

    pub(super) fn item_place(&self, item: &Item) -> Option<[f64; 3]> {
        let Item { frame, x, y, z, .. } = *item;
        if frame == MAV_FRAME_LOCAL_NED {
            let [north, east] = [x, y].map(|x| f64::from(x) / 1e4);
            let up = if self.model.flies { -f64::from(z) } else { 0.0 };
            return (0.0..=f64::from(HIGHEST_M)).contains(&up).then_some([east, north, up]);
        }
        if item.command == MAV_CMD_NAV_TAKEOFF && (x, y) == (0, 0) {
            // A takeoff without a place is where the vehicle stands, as in ArduPilot.
            let up = f64::from(z) + self.datum_m(frame)? - self.model.origin.place().altitude_m;
            let [east, north, _] = self.seen.motion.position_m;
            return (0.0..=f64::from(HIGHEST_M)).contains(&up).then_some([east, north, up]);
        }
        self.global_place(frame, x, y, z).ok()
    }

    pub(super) fn item_fault(&self, item: &Item) -> u8 {
        let is_known = match item.command {
            MAV_CMD_NAV_WAYPOINT => true,
            MAV_CMD_NAV_RETURN_TO_LAUNCH => return MAV_MISSION_ACCEPTED,
            _ if has_no_place(item) && !self.model.in_formation => return fault_without_place(item),
            MAV_CMD_NAV_LAND if self.model.flies => return MAV_MISSION_ACCEPTED,
            MAV_CMD_NAV_TAKEOFF => self.model.flies,
            _ => false,
        };
        let is_frame = item.frame == MAV_FRAME_LOCAL_NED || self.datum_m(item.frame).is_some();
        let hold_s = item.param1;
        match self.item_place(item) {
            _ if !is_known || self.model.in_formation => MAV_MISSION_UNSUPPORTED,
            _ if !is_frame => MAV_MISSION_UNSUPPORTED_FRAME,
            _ if hold_s < 0.0 || hold_s == f32::INFINITY => MAV_MISSION_INVALID_PARAM1,
            _ if self.model.flies && item.z.is_nan() => MAV_MISSION_INVALID_PARAM7,
            Some(place) if self.goal(place).is_some() => MAV_MISSION_ACCEPTED,
            _ => MAV_MISSION_INVALID_PARAM5_X,
        }
    }

    fn start_mission(&mut self) -> Result<(), Refusal> {
        if self.mission.is_empty() {
            return Err(MAV_RESULT_DENIED);
        }
        if self.mission.current == 0 || self.mission.is_complete {
            self.mission.set_current(1);
        }
        self.enter(FlightMode::Mission { there_since_us: None });
        Ok(())
    }

    pub(super) fn set_current_item(&mut self, seq: u16) -> Result<(), Refusal> {
        if !self.mission.set_current(seq.max(1)) || seq >= self.mission.len() {
            return Err(MAV_RESULT_DENIED);
        }
        if let FlightMode::Mission { .. } = self.mode {
            self.begin_item();
        }
        Ok(())
    }
}
