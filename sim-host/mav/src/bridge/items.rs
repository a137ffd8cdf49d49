//! Mission execution, item by item.

use super::mission::{Item, MAV_MISSION_INVALID_PARAM2};
use super::model::FlightMode;
use super::vehicle::{Kind, Vehicle};
use staya_controller::agent::Wish;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;

const NAV_DELAY: u16 = 93;
/// Commands to cameras and gimbals, which these vehicles do not have; a mission skips them.
const OF_CAMERAS: [u16; 9] = [204, 205, 206, 1000, 1001, 2000, 2001, 2500, 2501];

pub(super) fn has_no_place(item: &Item) -> bool {
    matches!(item.command, NAV_DELAY | MAV_CMD_DO_CHANGE_SPEED) || OF_CAMERAS.contains(&item.command)
}

/// Why an item without a place is invalid, as a MAV_MISSION_RESULT; 0 if it is valid.
pub(super) fn fault_without_place(item: &Item) -> u8 {
    match item.command {
        NAV_DELAY if !(0.0..f32::INFINITY).contains(&item.param1) => MAV_MISSION_INVALID_PARAM1,
        MAV_CMD_DO_CHANGE_SPEED if !item.param2.is_finite() || item.param2 == 0.0 => MAV_MISSION_INVALID_PARAM2,
        _ => MAV_MISSION_ACCEPTED,
    }
}

impl Vehicle {
    /// Starts the current item, and the next one if it finishes at once; at most once through all.
    pub(super) fn begin_item(&mut self) {
        self.mode = FlightMode::Mission { there_since_us: None };
        loop {
            let Some(item) = self.mission.item(self.mission.current).cloned() else {
                return self.stop_mission();
            };
            match item.command {
                MAV_CMD_NAV_RETURN_TO_LAUNCH => {
                    self.mission.is_complete = true;
                    return self.enter(FlightMode::Return);
                }
                MAV_CMD_NAV_LAND => return self.enter(FlightMode::Land { is_item: true }),
                NAV_DELAY => return self.wish(Wish::Hold),
                MAV_CMD_DO_CHANGE_SPEED => self.limit_speed(item.param2),
                command if OF_CAMERAS.contains(&command) => {
                    self.text(Kind::Setpoint, MAV_SEVERITY_NOTICE, "no camera or gimbal: item skipped");
                }
                _ => {
                    return match self.item_place(&item).and_then(|place| self.goal(place)) {
                        Some(wish) => self.wish(wish),
                        None => self.stop_mission(),
                    };
                }
            }
            if !self.finish_item() {
                return;
            }
        }
    }

    /// Returns whether there is a next item.
    fn finish_item(&mut self) -> bool {
        let seq = self.mission.current;
        self.out.messages.push(MavMessage::MISSION_ITEM_REACHED(MISSION_ITEM_REACHED_DATA { seq }));
        let has_next = self.mission.set_current(seq + 1);
        if !has_next {
            self.mission.is_complete = true;
            self.mode = FlightMode::Auto;
            self.wish(Wish::Hold);
            self.text(Kind::News, MAV_SEVERITY_INFO, "mission done: holding");
        }
        has_next
    }

    fn limit_speed(&mut self, speed_mps: f32) {
        let most_mps = self.model.max_speed_mps;
        if speed_mps > most_mps {
            let text = format!("mission speed {speed_mps} m/s limited to {most_mps}");
            self.text(Kind::Setpoint, MAV_SEVERITY_NOTICE, &text);
        }
        if speed_mps > 0.0 {
            let _ = self.change_speed(speed_mps.min(most_mps));
        }
    }

    pub(super) fn finish_landing(&mut self) {
        self.mode = FlightMode::LAND;
        self.mission.is_complete = true;
        let seq = self.mission.current;
        self.out.messages.push(MavMessage::MISSION_ITEM_REACHED(MISSION_ITEM_REACHED_DATA { seq }));
    }

    pub(super) fn advance_mission(&mut self) {
        let Some(item) = self.mission.item(self.mission.current) else { return };
        let finite = |x: f32| f64::from(if x.is_finite() { x } else { 0.0 });
        let (wait_us, near_m) = (libm::round(finite(item.param1) * 1e6), finite(item.param2));
        if !has_no_place(item) && !self.item_place(item).is_some_and(|place| self.is_at(place, near_m)) {
            return;
        }
        let now = self.time_us;
        let FlightMode::Mission { there_since_us } = &mut self.mode else { return };
        let since = *there_since_us.get_or_insert(now);
        if ((now - since) as f64) < wait_us {
            return;
        }
        if self.finish_item() {
            self.begin_item();
        }
    }

    pub(super) fn stop_mission(&mut self) {
        if let FlightMode::Mission { .. } = self.mode {
            self.mode = FlightMode::Auto;
            self.wish(Wish::Hold);
            self.text(Kind::News, MAV_SEVERITY_NOTICE, "mission ended: holding");
        }
    }

    pub(super) fn take_item(&mut self, from: Sender, item: Item) {
        if item.current >= 2 {
            return self.guided_item(from, &item);
        }
        let before = self.mission.item(self.mission.current).cloned();
        let mut mission = core::mem::take(&mut self.mission);
        let now_us = self.now_us;
        let mut fault = MAV_MISSION_ACCEPTED;
        let answer = mission.take(from, item.clone(), now_us, |item| {
            fault = self.item_fault(item);
            fault
        });
        self.mission = mission;
        self.out.messages.extend(answer);
        if let FlightMode::Mission { .. } = self.mode
            && self.mission.item(self.mission.current) != before.as_ref()
        {
            self.begin_item();
        }
        if fault != MAV_MISSION_ACCEPTED {
            // MISSION_ACK cannot say which item was invalid.
            let text = format!("mission item {}: {}", item.seq, self.fault_in_words(&item, fault));
            self.text(Kind::News, MAV_SEVERITY_WARNING, &text);
        }
    }

    /// The text fits into a STATUSTEXT with the item number in front.
    fn fault_in_words(&self, item: &Item, fault: u8) -> String {
        match fault {
            MAV_MISSION_UNSUPPORTED if self.model.in_formation => String::from("not in a formation"),
            MAV_MISSION_UNSUPPORTED => format!("unsupported command {}", item.command),
            MAV_MISSION_UNSUPPORTED_FRAME => format!("unsupported frame {}", item.frame),
            MAV_MISSION_INVALID_PARAM1 => String::from("param1 (wait) invalid"),
            MAV_MISSION_INVALID_PARAM2 => String::from("param2 (speed) invalid"),
            MAV_MISSION_INVALID_PARAM7 => String::from("param7 (height) is NaN"),
            _ => String::from("obstacle or off the map"),
        }
    }
}
