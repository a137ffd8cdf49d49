//! Failures and restarts of robots' computers.

use super::Engine;

impl Engine {
    /// Takes down computers whose fault begins; they restart with only id, parameters and task.
    pub fn apply_faults(&mut self) {
        for at in 0..self.faults.len() {
            let fault = self.faults[at];
            let Some(index) = self.index_of(fault.robot) else {
                continue;
            };
            if fault.from_tick == self.tick {
                let computer = &mut self.computers[index];
                computer.down_until = computer.down_until.max(fault.to_tick);
            }
            let ends = fault.to_tick == self.tick;
            if ends && self.computers[index].down_until == self.tick {
                self.restart(index, self.computers[index].starts.saturating_add(1));
            }
        }
        self.revive();
    }

    fn revive(&mut self) {
        let Some(external) = &mut self.external else {
            return;
        };
        let controllers = &mut external.controllers;
        let robots = external.robots.iter().map(|&(index, ..)| index);
        let lost: Vec<_> = robots.filter(|&index| controllers.has_restarted(index)).collect();
        for index in lost {
            // A robot that is down restarts when its fault ends.
            if self.computers[index].down_until <= self.tick {
                self.restart(index, self.computers[index].starts.saturating_add(1));
            }
        }
    }
}
