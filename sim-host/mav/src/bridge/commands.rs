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
use super::params::NotSet;
use super::vehicle::{Action, Kind, Out, Vehicle};
use crate::geo::Global;
use staya_controller::parameters::SPEED;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;
use staya_mavlink::mavlink_core::MessageData as _;

const HIGHEST_M: f32 = 1000.0;

const STANDING_MPS: f64 = 0.05;

pub(super) type Refusal = u8;

#[derive(Clone, Copy, Debug)]
struct Spot {
    frame: u8,
    x: i32,
    y: i32,
    z: f32,
}

struct Command {
    id: u16,
    params: [f32; 7],
    /// The place in a COMMAND_INT.
    spot: Option<Spot>,
}

fn whole(x: f32, most: f32) -> Result<u32, Refusal> {
    let is_one = (0.0..=most).contains(&x) && libm::truncf(x) == x;
    if is_one { Ok(x as u32) } else { Err(MAV_RESULT_DENIED) }
}

impl Vehicle {
    pub(super) fn command_long(&mut self, from: Sender, c: &COMMAND_LONG_DATA, out: &mut Out) {
        let command = Command {
            id: c.command,
            params: [c.param1, c.param2, c.param3, c.param4, c.param5, c.param6, c.param7],
            spot: None,
        };
        self.answer(from, &command, out);
    }

    pub(super) fn command_int(&mut self, from: Sender, c: &COMMAND_INT_DATA, out: &mut Out) {
        let command = Command {
            id: c.command,
            params: [c.param1, c.param2, c.param3, c.param4, c.x as f32, c.y as f32, c.z],
            spot: Some(Spot { frame: c.frame, x: c.x, y: c.y, z: c.z }),
        };
        self.answer(from, &command, out);
    }

    fn answer(&mut self, from: Sender, command: &Command, out: &mut Out) {
        // The acknowledgement is sent before the messages that the command causes.
        let mut after = Out::default();
        let result = self.execute(command, &mut after);
        let result = result.err().unwrap_or(MAV_RESULT_ACCEPTED);
        out.messages.push(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
            command: command.id,
            result,
            progress: 0,
            result_param2: 0,
            target_system: from.system,
            target_component: from.component,
        }));
        out.messages.append(&mut after.messages);
        out.actions.append(&mut after.actions);
    }

    fn execute(&mut self, command: &Command, out: &mut Out) -> Result<(), Refusal> {
        let [first, second, ..] = command.params;
        match command.id {
            MAV_CMD_COMPONENT_ARM_DISARM => {
                let arms = whole(first, 1.0)? == 1;
                self.arm(arms, second == ARM_DISARM_FORCE, out)
            }
            MAV_CMD_DO_SET_MODE => {
                let base = whole(first, 255.0)?;
                let is_custom = base & u32::from(MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) != 0;
                let number = whole(second, 255.0)?;
                if !is_custom {
                    return Err(MAV_RESULT_DENIED);
                }
                self.set_mode(number, out)
            }
            MAV_CMD_NAV_TAKEOFF => {
                let frame = command.spot.map(|spot| spot.frame);
                let is_known =
                    matches!(frame, None | Some(MAV_FRAME_GLOBAL_RELATIVE_ALT | MAV_FRAME_GLOBAL_RELATIVE_ALT_INT));
                if self.model.flies && !is_known {
                    return Err(MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME);
                }
                self.take_off(command.params[6], out)
            }
            MAV_CMD_NAV_LAND if self.model.flies => {
                self.needs_arms()?;
                self.enter(FlightMode::LAND, out);
                Ok(())
            }
            MAV_CMD_NAV_RETURN_TO_LAUNCH => {
                self.needs_arms()?;
                self.set_mode(FlightMode::Return.number(self.model.flies), out)
            }
            MAV_CMD_DO_REPOSITION => self.reposition(command, out),
            MAV_CMD_DO_CHANGE_SPEED => self.change_speed(second, out),
            MAV_CMD_MISSION_START => {
                self.needs_arms()?;
                self.start_mission(out)
            }
            MAV_CMD_DO_SET_MISSION_CURRENT => {
                let seq = whole(first, f32::from(u16::MAX))?;
                self.set_current_item(seq as u16, out)
            }
            MAV_CMD_SET_MESSAGE_INTERVAL => {
                let id = self.stream_id(first)?;
                let now_us = self.now_us;
                if self.streams.set_interval(id, second, now_us) { Ok(()) } else { Err(MAV_RESULT_DENIED) }
            }
            MAV_CMD_GET_MESSAGE_INTERVAL => {
                let id = whole(first, 16_777_215.0)?;
                let interval_us = self.streams.interval_us(id).unwrap_or(0);
                out.messages
                    .push(MavMessage::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA { interval_us, message_id: id as u16 }));
                Ok(())
            }
            MAV_CMD_REQUEST_MESSAGE => {
                let id = self.stream_id(first)?;
                self.send_now(id, out)
            }
            MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES => self.send_now(AUTOPILOT_VERSION_DATA::ID, out),
            MAV_CMD_GET_HOME_POSITION => self.send_now(HOME_POSITION_DATA::ID, out),
            _ => Err(MAV_RESULT_UNSUPPORTED),
        }
    }

    fn stream_id(&self, number: f32) -> Result<u32, Refusal> {
        let id = whole(number, 16_777_215.0)?;
        if self.streams.has(id) { Ok(id) } else { Err(MAV_RESULT_UNSUPPORTED) }
    }

    fn send_now(&self, id: u32, out: &mut Out) -> Result<(), Refusal> {
        let message = self.telemetry(id).ok_or(MAV_RESULT_TEMPORARILY_REJECTED)?;
        out.messages.push(message);
        Ok(())
    }

    const fn needs_arms(&self) -> Result<(), Refusal> {
        if self.is_armed { Ok(()) } else { Err(MAV_RESULT_TEMPORARILY_REJECTED) }
    }

    fn arm(&mut self, arms: bool, forced: bool, out: &mut Out) -> Result<(), Refusal> {
        // Disarming a moving vehicle would make others run into it.
        let [vx, vy, vz] = self.sample.velocity_mps;
        let moves = vx * vx + vy * vy + vz * vz > STANDING_MPS * STANDING_MPS;
        if !arms && !forced && (moves || self.is_in_air()) {
            return Err(MAV_RESULT_TEMPORARILY_REJECTED);
        }
        if arms == self.is_armed {
            return Ok(());
        }
        self.is_armed = arms;
        if let (false, FlightMode::Mission { .. }) = (arms, self.mode) {
            self.mode = FlightMode::Auto;
        }
        self.begin(out);
        let text = if arms { "armed" } else { "disarmed" };
        self.text(out, Kind::News, MAV_SEVERITY_INFO, text);
        Ok(())
    }

    fn set_mode(&mut self, number: u32, out: &mut Out) -> Result<(), Refusal> {
        let mode = FlightMode::from_number(number, self.model.flies);
        let mode = mode.ok_or(MAV_RESULT_DENIED)?;
        if mode == FlightMode::Return && self.model.in_formation {
            return Err(MAV_RESULT_DENIED);
        }
        // AUTO flies the mission if there is one, as ArduPilot does.
        if mode == FlightMode::Auto && self.is_armed && !self.mission.is_empty() {
            return self.start_mission(out);
        }
        self.enter(mode, out);
        Ok(())
    }

    /// SET_MODE, the older message. The protocol defines no answer to it.
    pub(super) fn set_mode_message(&mut self, wanted: &SET_MODE_DATA, out: &mut Out) {
        let is_custom = wanted.base_mode & MAV_MODE_FLAG_CUSTOM_MODE_ENABLED != 0;
        let result = match is_custom {
            true => self.set_mode(wanted.custom_mode, out),
            false => Err(MAV_RESULT_DENIED),
        };
        if result.is_err() {
            let text = "unknown mode";
            self.text(out, Kind::News, MAV_SEVERITY_WARNING, text);
        }
    }

    fn take_off(&mut self, height_m: f32, out: &mut Out) -> Result<(), Refusal> {
        if !self.model.flies {
            return Err(MAV_RESULT_UNSUPPORTED);
        }
        let is_sound = height_m > self.tolerance_m() && height_m <= HIGHEST_M;
        let [x, y, _] = self.sample.position_m;
        let wish = self.goal([x, y, f64::from(height_m)]);
        let wish = wish.filter(|_| is_sound).ok_or(MAV_RESULT_DENIED)?;
        self.needs_arms()?;
        if self.mode != FlightMode::Guided || self.is_in_air() {
            return Err(MAV_RESULT_TEMPORARILY_REJECTED);
        }
        out.actions.push(Action::Wish(wish));
        Ok(())
    }

    fn reposition(&mut self, command: &Command, out: &mut Out) -> Result<(), Refusal> {
        let [speed_mps, flags, ..] = command.params;
        let spot = command.spot.ok_or(MAV_RESULT_COMMAND_INT_ONLY)?;
        let place = self.global_place(spot)?;
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
            self.change_speed(speed_mps, out)?;
        }
        if self.mode != FlightMode::Guided {
            self.enter(FlightMode::Guided, out);
        }
        out.actions.push(Action::Wish(wish));
        Ok(())
    }

    pub(super) fn guided_item(&mut self, from: Sender, item: &Item, out: &mut Out) -> MavMessage {
        let is_goto = item.current == 2 && item.command == MAV_CMD_NAV_WAYPOINT;
        let result = match self.item_place(item) {
            Some(_) if !is_goto || self.model.in_formation => MAV_MISSION_UNSUPPORTED,
            Some(_) if !self.is_armed || self.mode != FlightMode::Guided => MAV_MISSION_ERROR,
            Some(place) => match self.goal(place) {
                Some(wish) => {
                    out.actions.push(Action::Wish(wish));
                    MAV_MISSION_ACCEPTED
                }
                None => MAV_MISSION_INVALID_PARAM5_X,
            },
            None => MAV_MISSION_INVALID_PARAM5_X,
        };
        ack(from, MAV_MISSION_TYPE_MISSION, result)
    }

    pub(super) fn change_speed(&mut self, speed_mps: f32, out: &mut Out) -> Result<(), Refusal> {
        match self.parameters.set_setting(SPEED.name, speed_mps) {
            Ok(_) => {}
            Err(NotSet::Unknown) => return Err(MAV_RESULT_UNSUPPORTED),
            Err(NotSet::OutOf(_)) => return Err(MAV_RESULT_DENIED),
        }
        out.actions.push(Action::Set(SPEED.name, speed_mps));
        Ok(())
    }

    fn global_place(&self, spot: Spot) -> Result<[f64; 3], Refusal> {
        let origin = &self.model.origin;
        // Home is on the ground at the origin, so heights above home are heights above the ground.
        let above_m = match spot.frame {
            MAV_FRAME_GLOBAL | MAV_FRAME_GLOBAL_INT => 0.0,
            MAV_FRAME_GLOBAL_RELATIVE_ALT | MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => origin.place().altitude_m,
            _ => return Err(MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME),
        };
        // A ground vehicle ignores the height, which may be NaN.
        let z = match (self.model.flies, spot.z.is_nan()) {
            (true, true) => return Err(MAV_RESULT_DENIED),
            (true, false) => f64::from(spot.z) + above_m,
            (false, _) => origin.place().altitude_m,
        };
        let mut place = Global::from_e7(spot.x, spot.y, 0);
        place.altitude_m = z;
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
        self.global_place(Spot { frame, x, y, z }).ok()
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
        let is_frame = matches!(
            item.frame,
            MAV_FRAME_GLOBAL
                | MAV_FRAME_LOCAL_NED
                | MAV_FRAME_GLOBAL_RELATIVE_ALT
                | MAV_FRAME_GLOBAL_INT
                | MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
        );
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

    fn start_mission(&mut self, out: &mut Out) -> Result<(), Refusal> {
        if self.mission.is_empty() {
            return Err(MAV_RESULT_DENIED);
        }
        if self.mission.current() == 0 || self.mission.is_complete() {
            self.mission.set_current(1);
        }
        self.enter(FlightMode::Mission { there_since_us: None }, out);
        Ok(())
    }

    pub(super) fn set_current_item(&mut self, seq: u16, out: &mut Out) -> Result<(), Refusal> {
        if !self.mission.set_current(seq.max(1)) || seq >= self.mission.len() {
            return Err(MAV_RESULT_DENIED);
        }
        if let FlightMode::Mission { .. } = self.mode {
            self.begin_item(out);
        }
        Ok(())
    }
}
