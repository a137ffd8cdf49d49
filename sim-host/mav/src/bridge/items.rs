//! A vehicle goes from item to item of its mission.

use super::mission::Item;
use super::model::FlightMode;
use super::vehicle::{Action, Kind, Out, Vehicle};
use staya_controller::agent::Wish;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;

impl Vehicle {
    /// Sends it to the present item's place.
    pub(super) fn begin_item(&mut self, out: &mut Out) {
        self.there_since_us = None;
        let item = self.mission.item(self.mission.current()).copied();
        let Some(item) = item else {
            return self.stop_mission(out);
        };
        match item.command {
            MAV_CMD_NAV_RETURN_TO_LAUNCH => self.enter(FlightMode::Return, out),
            MAV_CMD_NAV_LAND => self.enter(FlightMode::Land, out),
            _ => match self.item_place(&item).and_then(|place| self.goal(place)) {
                Some(wish) => out.actions.push(Action::Wish(wish)),
                None => self.stop_mission(out),
            },
        }
    }

    /// The next item, when it has been at the present one for long enough.
    pub(super) fn go_on_with_mission(&mut self, out: &mut Out) {
        let seq = self.mission.current();
        let item = self.mission.item(seq).copied();
        let Some((item, place)) = item.and_then(|item| Some((item, self.item_place(&item)?))) else {
            return;
        };
        let [hold_s, near_m, ..] = item.params;
        let near_m = if near_m.is_finite() { near_m } else { 0.0 };
        if !self.is_at(place, near_m.into()) {
            return;
        }
        let now = self.sample.time_us;
        let since = *self.there_since_us.get_or_insert(now);
        let hold_s = if hold_s.is_finite() { hold_s } else { 0.0 };
        if ((now - since) as f64) < libm::round(f64::from(hold_s) * 1e6) {
            return;
        }
        let reached = MISSION_ITEM_REACHED_DATA { seq };
        out.messages.push(MavMessage::MISSION_ITEM_REACHED(reached));
        if self.mission.set_current(seq + 1) {
            self.begin_item(out);
        } else {
            // It stays where it is.
            self.is_on_mission = false;
            out.actions.push(Action::Wish(Wish::Hold));
            self.text(out, Kind::News, MAV_SEVERITY_INFO, "mission done: holding");
        }
    }

    pub(super) fn stop_mission(&mut self, out: &mut Out) {
        if core::mem::take(&mut self.is_on_mission) {
            out.actions.push(Action::Wish(Wish::Hold));
            self.text(out, Kind::News, MAV_SEVERITY_NOTICE, "mission ended: holding");
        }
    }

    /// Takes an item of an upload in.
    pub(super) fn take_item(&mut self, from: Sender, seq: u16, item: Item) -> MavMessage {
        let mut mission = core::mem::take(&mut self.mission);
        let now_us = self.now_us;
        let answer = mission.take(from, seq, item, now_us, |item| self.item_fault(item));
        self.mission = mission;
        answer
    }
}
