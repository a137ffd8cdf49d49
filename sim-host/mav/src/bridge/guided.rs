//! Setpoints, and the dialect's orders to a formation. The protocol defines no answers to them.

use super::model::FlightMode;
use super::params::SETPOINT_TIMEOUT;
use super::vehicle::{Action, Kind, Out, Vehicle};
use crate::framed::framed;
use crate::geo::{Global, enu};
use staya_controller::agent::{Grid, GridOrder, Protocol as _, Waypoint, Wish};
use staya_controller::geom::Vec3;
use staya_controller::time::Duration;
use staya_controller::wire::{Addressed, Content as _, Frame, Header, Message};
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;
use staya_mavlink::wire::decode;

/// Kind of an order in `STAYA_MESSAGE`.
const ORDER: u8 = 2;

/// Place and velocity, each if it is given.
type Setpoint = (Option<[f64; 3]>, Option<[f64; 3]>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Used {
    place: bool,
    place_z: bool,
    velocity: bool,
    velocity_z: bool,
}

impl Used {
    /// Decodes a type mask. The error is the text for the operator.
    const fn new(mask: u16, flies: bool) -> Result<Self, &'static str> {
        const PLACE: u16 = 0b11;
        const VELOCITY: u16 = 0b11 << 3;
        const ACCELERATION: u16 = 0b111 << 6;
        // FORCE_SET only says how accelerations are read, so it matters only if one is in use.
        if mask & ACCELERATION != ACCELERATION {
            return Err("setpoint: acceleration is unsupported");
        }
        let (place, velocity) = (mask & PLACE, mask & VELOCITY);
        if !(place == 0 || place == PLACE) || !(velocity == 0 || velocity == VELOCITY) {
            return Err("setpoint: use both x and y, or neither");
        }
        let used = Self {
            place: place == 0,
            place_z: flies && mask & POSITION_TARGET_TYPEMASK_Z_IGNORE == 0,
            velocity: velocity == 0,
            velocity_z: flies && mask & POSITION_TARGET_TYPEMASK_VZ_IGNORE == 0,
        };
        if used.place || used.velocity { Ok(used) } else { Err("setpoint: no position and no velocity") }
    }

    fn velocity(self, [east, north, up]: [f64; 3]) -> Option<[f64; 3]> {
        self.velocity.then_some([east, north, if self.velocity_z { up } else { 0.0 }])
    }
}

impl Vehicle {
    pub(super) fn target_local(&mut self, target: &SET_POSITION_TARGET_LOCAL_NED_DATA, out: &mut Out) {
        self.follow(self.local_setpoint(target), out);
    }

    pub(super) fn target_global(&mut self, target: &SET_POSITION_TARGET_GLOBAL_INT_DATA, out: &mut Out) {
        self.follow(self.global_setpoint(target), out);
    }

    fn follow(&mut self, setpoint: Result<Setpoint, &str>, out: &mut Out) {
        match setpoint.and_then(|setpoint| self.wish_of(setpoint)) {
            Ok(wish) => out.actions.push(Action::Wish(wish)),
            Err(text) => self.refuse(text, out),
        }
    }

    fn refuse(&mut self, text: &str, out: &mut Out) {
        self.text(out, Kind::Setpoint, MAV_SEVERITY_WARNING, text);
    }

    fn local_setpoint(&self, target: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Result<Setpoint, &'static str> {
        let (is_offset, is_turned) = match target.coordinate_frame {
            MAV_FRAME_LOCAL_NED => (false, false),
            MAV_FRAME_LOCAL_OFFSET_NED => (true, false),
            MAV_FRAME_BODY_NED | MAV_FRAME_BODY_OFFSET_NED => (true, true),
            _ => return Err("setpoint: unsupported frame"),
        };
        let used = Used::new(target.type_mask, self.model.flies)?;
        let turned = |xyz: [f32; 3]| {
            let [x, y, z] = xyz.map(f64::from);
            let yaw = f64::from(if is_turned { self.yaw } else { 0.0 });
            let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
            enu([x * cos - y * sin, x * sin + y * cos, z])
        };
        let here = self.sample.position_m;
        let place_m = used.place.then(|| {
            let [east, north, up] = turned([target.x, target.y, target.z]);
            let [x, y, z] = if is_offset { here } else { [0.0; 3] };
            let up = if used.place_z { z + up } else { here[2] };
            [x + east, y + north, up]
        });
        Ok((place_m, used.velocity(turned([target.vx, target.vy, target.vz]))))
    }

    fn global_setpoint(&self, target: &SET_POSITION_TARGET_GLOBAL_INT_DATA) -> Result<Setpoint, &'static str> {
        let origin = self.model.origin;
        let ground_m = match target.coordinate_frame {
            MAV_FRAME_GLOBAL | MAV_FRAME_GLOBAL_INT => 0.0,
            MAV_FRAME_GLOBAL_RELATIVE_ALT | MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => origin.place().altitude_m,
            _ => return Err("setpoint: unsupported frame"),
        };
        let used = Used::new(target.type_mask, self.model.flies)?;
        let mut place_m = None;
        if used.place {
            let mut place = Global::from_e7(target.lat_int, target.lon_int, 0);
            place.altitude_m = origin.place().altitude_m;
            let [x, y, _] = origin.to_enu_m(&place).ok_or("setpoint: invalid position")?;
            let up = f64::from(target.alt) + ground_m - origin.place().altitude_m;
            place_m = Some([x, y, if used.place_z { up } else { self.sample.position_m[2] }]);
        }
        Ok((place_m, used.velocity(enu([target.vx, target.vy, target.vz].map(f64::from)))))
    }

    fn wish_of(&self, (place_m, velocity_mps): Setpoint) -> Result<Wish<f32>, &'static str> {
        if self.mode != FlightMode::Guided || !self.is_armed {
            return Err("setpoint: arm and select GUIDED first");
        }
        if [place_m, velocity_mps].into_iter().flatten().flatten().any(|x| !x.is_finite()) {
            return Err("setpoint: a value is NaN");
        }
        if self.model.in_formation {
            return Err("setpoint: in formation; use STAYA_GOAL");
        }
        if self.model.grid.is_some() && velocity_mps.is_some() {
            return Err("setpoint: no velocities on a grid");
        }
        let timeout_s = self.parameters.get(SETPOINT_TIMEOUT).unwrap_or(0.0);
        let valid = Duration::from_micros((timeout_s * 1e6) as i32);
        let velocity_mps = velocity_mps.map(|v| {
            let [x, y, z] = v.map(|v| v as f32);
            Vec3::new(x, y, z)
        });
        let wish = match (place_m, velocity_mps) {
            (None, None) => None,
            (None, Some(velocity_mps)) => Some(Wish::Velocity { velocity_mps, valid }),
            (Some(place_m), velocity) => self.goal(place_m).map(|wish| match (wish, velocity) {
                (Wish::Waypoint { waypoint, .. }, Some(velocity_mps)) => {
                    Wish::Waypoint { waypoint: Waypoint { velocity_mps, ..waypoint }, valid: Some(valid) }
                }
                _ => wish,
            }),
        };
        wish.ok_or("setpoint: obstacle or out of range")
    }

    pub(super) fn receive_orders(&mut self, from: Sender, message: &MavMessage, out: &mut Out) {
        let Some(Frame { header, message, .. }) = order(from, message) else {
            return;
        };
        self.confirm(header, &message, out);
        out.actions.push(Action::Tell(header, message));
    }

    fn confirm(&mut self, header: Header, message: &Message, out: &mut Out) {
        let Message::Order(Addressed { number, protocol, content, .. }) = message else {
            return;
        };
        let Some(order) = GridOrder::decode(Grid::ID, *protocol, content) else {
            return;
        };
        if matches!(order, GridOrder::Template { .. }) && !self.model.in_formation {
            return self.refuse("STAYA_TEMPLATE: not in a formation", out);
        }
        if let Some(text) = self.ordered.hear(header, *number, &order) {
            self.text(out, Kind::News, MAV_SEVERITY_INFO, &text);
        }
    }
}

/// An order as robots receive it; `None` for any other message.
fn order(mut from: Sender, message: &MavMessage) -> Option<Frame> {
    let is_order = match message {
        MavMessage::STAYA_GOAL(_) | MavMessage::STAYA_PLACE(_) | MavMessage::STAYA_TEMPLATE(_) => true,
        MavMessage::STAYA_MESSAGE(message) => message.kind == ORDER,
        _ => false,
    };
    if !is_order {
        return None;
    }
    decode(&framed(&mut from, message, None)?).ok()
}
