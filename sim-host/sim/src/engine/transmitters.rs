//! Transmitters outside the swarm: attackers, intruders and the key server.

use super::Engine;
use super::attacker::Attacker;
use super::intruder::Intruder;
use super::key_server::KeyServer;
use super::roster::ring;
use super::transmitter::Transmitter;
use crate::scenario::Scenario;
use crate::world::plane::Disc;
use staya_controller::robot::RobotId;
use staya_controller::wire::Ring;

/// The transmitters of a scenario: attackers, then the intruders that send beacons, then the key
/// server.
pub(super) fn transmitters(scenario: &Scenario, intruders: &[Disc]) -> Vec<Box<dyn Transmitter>> {
    let attackers = scenario.events.attacks.iter().enumerate();
    let attackers = attackers.map(|(index, attack)| Box::new(Attacker::new(attack, index, scenario)) as _);
    let heard = intruders.iter().filter(|disc| disc.id.is_some());
    let intruders =
        heard.map(|disc| Box::new(Intruder::new(disc.id, scenario.radio.format, scenario.clocks.step_ticks)) as _);
    let server = KeyServer::new(scenario).map(|server| Box::new(server) as _);
    attackers.chain(intruders).chain(server).collect()
}

impl Engine {
    /// Lets the transmitters outside the swarm receive and prepare frames.
    pub fn transmit(&mut self) {
        let robots = self.computers.len();
        for at in 0..self.others.len() {
            if let Some(robot) = self.others[at].captures(self.tick)
                && let Some(ring) = self.ring_of(robot).or_else(|| self.taken.get(&robot).cloned())
            {
                self.others[at].take(&ring);
            }
            let (other, intruders) = (&mut self.others[at], self.ground.view(self.tick).intruders);
            other.act(self.tick, &self.radio.inbox(robots + at).to_vec(), intruders);
            self.positions_m[robots + at] = other.place_m(intruders);
        }
    }

    /// Keys of a robot in this process.
    pub fn ring_of(&self, robot: RobotId) -> Option<Ring> {
        let agent = self.computers[self.index_of(robot)?].agent.as_ref()?;
        ring(agent.wire()).cloned()
    }
}
