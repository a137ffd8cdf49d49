//! Setpoints, and the dialect's orders to a formation. The protocol defines no answers to them.

use super::model::FlightMode;
use super::params::SETPOINT_TIMEOUT;
use super::vehicle::{Action, Kind, Vehicle};
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

impl Vehicle {
    pub(super) fn follow(&mut self, setpoint: Result<Wish<f32>, &str>) {
        match setpoint {
            Ok(wish) => self.wish(wish),
            Err(text) => self.refuse(text),
        }
    }

    fn refuse(&mut self, text: &str) {
        self.text(Kind::Setpoint, MAV_SEVERITY_WARNING, text);
    }

    /// The error is the text for the operator, here and below.
    pub(super) fn local_setpoint(
        &self,
        target: &SET_POSITION_TARGET_LOCAL_NED_DATA,
    ) -> Result<Wish<f32>, &'static str> {
        let (is_offset, is_turned) = match target.coordinate_frame {
            MAV_FRAME_LOCAL_NED => (false, false),
            MAV_FRAME_LOCAL_OFFSET_NED => (true, false),
            MAV_FRAME_BODY_NED | MAV_FRAME_BODY_OFFSET_NED => (true, true),
            _ => return Err("setpoint: unsupported frame"),
        };
        let yaw = f64::from(if is_turned { self.yaw } else { 0.0 });
        let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
        let turned = |xyz: [f32; 3]| {
            let [x, y, z] = xyz.map(f64::from);
            enu([x * cos - y * sin, x * sin + y * cos, z])
        };
        let [east, north, up] = turned([target.x, target.y, target.z]);
        let [x, y, z] = if is_offset { self.seen.motion.position_m } else { [0.0; 3] };
        let place_m = Some([x + east, y + north, z + up]);
        self.setpoint(target.type_mask, place_m, turned([target.vx, target.vy, target.vz]))
    }

    pub(super) fn global_setpoint(
        &self,
        target: &SET_POSITION_TARGET_GLOBAL_INT_DATA,
    ) -> Result<Wish<f32>, &'static str> {
        let origin = self.model.origin;
        let datum_m = self.datum_m(target.coordinate_frame).ok_or("setpoint: unsupported frame")?;
        let altitude_m = origin.place().altitude_m;
        let place = Global { altitude_m, ..Global::from_e7(target.lat_int, target.lon_int, 0) };
        let up = f64::from(target.alt) + datum_m - altitude_m;
        let place_m = origin.to_enu_m(&place).map(|[x, y, _]| [x, y, up]);
        self.setpoint(target.type_mask, place_m, enu([target.vx, target.vy, target.vz].map(f64::from)))
    }

    /// A place that is `None` is off the Earth; the mask may exclude it.
    fn setpoint(
        &self,
        mask: u16,
        place_m: Option<[f64; 3]>,
        [vx, vy, vz]: [f64; 3],
    ) -> Result<Wish<f32>, &'static str> {
        const PLACE: u16 = 0b11;
        const VELOCITY: u16 = 0b11 << 3;
        const ACCELERATION: u16 = 0b111 << 6;
        // FORCE_SET only says how accelerations are read, so it matters only if one is in use.
        if mask & ACCELERATION != ACCELERATION {
            return Err("setpoint: acceleration is unsupported");
        }
        let has = |bits: u16| match mask & bits {
            0 => Ok(true),
            ignored if ignored == bits => Ok(false),
            _ => Err("setpoint: use both x and y, or neither"),
        };
        let (has_place, has_velocity) = (has(PLACE)?, has(VELOCITY)?);
        if !has_place && !has_velocity {
            return Err("setpoint: no position and no velocity");
        }
        let up =
            |ignored: u16, given: f64, kept: f64| if self.model.flies && mask & ignored == 0 { given } else { kept };
        let mut goal_m = None;
        if has_place {
            let [x, y, z] = place_m.ok_or("setpoint: invalid position")?;
            goal_m = Some([x, y, up(POSITION_TARGET_TYPEMASK_Z_IGNORE, z, self.seen.motion.position_m[2])]);
        }
        let velocity_mps = has_velocity.then(|| [vx, vy, up(POSITION_TARGET_TYPEMASK_VZ_IGNORE, vz, 0.0)]);
        if self.mode != FlightMode::Guided || !self.is_armed {
            return Err("setpoint: arm and select GUIDED first");
        }
        if [goal_m, velocity_mps].into_iter().flatten().flatten().any(|x| !x.is_finite()) {
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
        let wish = match (goal_m, velocity_mps) {
            (None, None) => None,
            (None, Some(velocity_mps)) => Some(Wish::Velocity { velocity_mps, valid }),
            (Some(goal_m), velocity) => self.goal(goal_m).map(|wish| match (wish, velocity) {
                (Wish::Waypoint { waypoint, .. }, Some(velocity_mps)) => {
                    Wish::Waypoint { waypoint: Waypoint { velocity_mps, ..waypoint }, valid: Some(valid) }
                }
                _ => wish,
            }),
        };
        wish.ok_or("setpoint: obstacle or out of range")
    }

    pub(super) fn receive_orders(&mut self, from: Sender, message: &MavMessage) {
        let Some(Frame { header, message, .. }) = order(from, message) else {
            return self.refuse_unsupported(message);
        };
        self.confirm(header, &message);
        self.out.actions.push(Action::Tell(header, message));
    }

    fn confirm(&mut self, header: Header, message: &Message) {
        let Message::Order(Addressed { number, protocol, content, .. }) = message else {
            return;
        };
        let Some(order) = GridOrder::decode(Grid::ID, *protocol, content) else {
            return;
        };
        if matches!(order, GridOrder::Template { .. }) && !self.model.in_formation {
            return self.refuse("STAYA_TEMPLATE: not in a formation");
        }
        if let Some(text) = self.ordered.hear(header, *number, &order) {
            self.text(Kind::News, MAV_SEVERITY_INFO, &text);
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
