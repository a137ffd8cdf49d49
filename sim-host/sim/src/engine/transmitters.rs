//! Transmitters outside the swarm: attackers, intruders and the key server.

use super::Engine;
use crate::radio::HostWire;
use staya_controller::robot::RobotId;
use staya_controller::wire::Ring;

impl Engine {
    /// Lets attackers receive and prepare frames.
    pub fn attack(&mut self) {
        let robots = self.computers.len();
        for at in 0..self.attackers.len() {
            if let Some(taken) = self.attackers[at].takes(self.tick)
                && let Some(ring) = self.ring_of(taken).or_else(|| self.taken.get(&taken).cloned())
            {
                self.attackers[at].take(&ring);
            }
            self.attackers[at].act(self.tick, self.radio.inbox(robots + at));
        }
    }

    /// Keys of a robot in this process.
    pub fn ring_of(&self, robot: RobotId) -> Option<Ring> {
        let agent = self.computers[self.index_of(robot)?].agent.as_ref()?;
        ring(agent.wire()).cloned()
    }

    /// Lets the key server receive and prepare frames.
    pub fn keep_keys(&mut self) {
        let at = self.computers.len() + self.attackers.len() + self.intruders.len();
        if let Some(keeper) = &mut self.keeper {
            keeper.act(self.tick, self.radio.inbox(at));
        }
    }

    /// Lets intruders prepare beacons.
    pub fn intrude(&mut self) {
        let first = self.computers.len() + self.attackers.len();
        let (positions_m, view) = (self.positions_m.iter_mut().skip(first), self.ground.view(self.tick));
        for ((intruder, position_m), disc) in self.intruders.iter_mut().zip(positions_m).zip(view.heard()) {
            intruder.speak(disc);
            *position_m = intruder.position_m;
        }
    }
}

pub(super) fn ring(wire: &HostWire) -> Option<&Ring> {
    match wire {
        HostWire::Sealed(sealed) => Some(sealed.ring()),
        _ => None,
    }
}
