//! The orders that a vehicle last received.

use staya_controller::robot::RobotId;
use staya_controller::wire::{Header, Message};

type Order = Option<(RobotId, u8, u8)>;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ordered {
    goal: Order,
    template: Order,
    parts: u64,
}

impl Ordered {
    /// Returns a confirmation the first time that the order is complete. O(1).
    pub(super) fn hear(&mut self, header: Header, message: &Message) -> Option<String> {
        let order = |version| Some((header.sender, header.boot, version));
        match message {
            Message::Goal(goal) => {
                let order = order(goal.version);
                let is_new = core::mem::replace(&mut self.goal, order) != order;
                is_new.then(|| format!("goal: cell ({}, {})", goal.target.x, goal.target.y))
            }
            Message::Template(part) => {
                let order = order(part.version);
                if self.template != order {
                    (self.template, self.parts) = (order, 0);
                }
                let all = u64::MAX >> (64 - u32::from(part.parts).clamp(1, 64));
                let had_all = self.parts & all == all;
                self.parts |= 1_u64.checked_shl(part.part.into()).unwrap_or(0);
                let is_new = !had_all && self.parts & all == all;
                is_new.then(|| format!("new formation: place {}", u16::from(part.slot) + 1))
            }
            _ => None,
        }
    }
}
