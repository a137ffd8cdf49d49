//! The orders that a vehicle last received.

use staya_controller::agent::GridOrder;
use staya_controller::robot::RobotId;
use staya_controller::wire::Header;

type Order = Option<(RobotId, u8, u8)>;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ordered {
    goal: Order,
    template: Order,
    parts: u64,
}

impl Ordered {
    /// Returns a confirmation the first time that the order is complete. O(1).
    pub(super) fn hear(&mut self, header: Header, number: u8, order: &GridOrder) -> Option<String> {
        let sent = Some((header.sender, header.boot, number));
        match order {
            GridOrder::FormationGoal(target) => {
                let is_new = core::mem::replace(&mut self.goal, sent) != sent;
                is_new.then(|| format!("goal: cell ({}, {})", target.x, target.y))
            }
            GridOrder::Template { part, .. } => {
                if self.template != sent {
                    (self.template, self.parts) = (sent, 0);
                }
                let all = u64::MAX >> (64 - u32::from(part.parts).clamp(1, 64));
                let had_all = self.parts & all == all;
                self.parts |= 1_u64.checked_shl(part.part.into()).unwrap_or(0);
                let is_new = !had_all && self.parts & all == all;
                is_new.then(|| format!("new formation: place {}", u16::from(part.slot) + 1))
            }
            GridOrder::Goal(_) => None,
        }
    }
}
