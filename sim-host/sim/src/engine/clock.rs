//! The clocks of the robots' computers, and when the robots decide by them.

use crate::scenario::{Clocks, Scenario};
use crate::world::plane::CommandAge;
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;
use staya_controller::time::Instant;

/// When the robots of a scenario decide.
pub(super) struct Timing {
    clocks: Clocks,
    seed: u64,
}

impl Timing {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self { clocks: scenario.clocks.clone(), seed: scenario.seed }
    }

    /// The clock of robot `number` of the scenario at the start of the run.
    pub(super) fn first(&self, scenario: &Scenario, number: usize) -> Clock {
        let own = scenario.plane().and_then(|plane| plane.starts[number].phase_ticks);
        let robot = scenario.robots[number].id;
        let phase_us = u64::from(self.clocks.phase_ticks(self.seed, robot, own)) * u64::from(self.clocks.tick_us);
        let due = self.clocks.ticks_at(phase_us, self.clocks.slow_ppb(self.seed, robot));
        Clock { due_us: phase_us, due, ..Clock::new(0) }
    }
}

/// The clock of a computer. It shows 0 when the computer starts; readings are microseconds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Clock {
    /// Tick in which the computer started.
    pub(super) epoch: u32,
    /// Tick of the next decision: the first one in which the clock shows `due_us` or more.
    due: u32,
    due_us: u64,
    /// Tick of the last decision.
    decided: Option<u32>,
}

impl Clock {
    /// The clock of a computer that starts in a tick and decides at once.
    pub(super) const fn new(tick: u32) -> Self {
        Self { epoch: tick, due: tick, due_us: 0, decided: None }
    }

    pub(super) const fn is_due(&self, tick: u32) -> bool {
        tick >= self.due
    }

    /// Time of a decision, which is that for which it was planned, or else the reading in `tick`.
    pub(super) fn now(&self, tick: u32, robot: RobotId, timing: &Timing) -> Instant {
        let reading_us = if self.due == tick {
            self.due_us
        } else {
            let slow_ppb = timing.clocks.slow_ppb(timing.seed, robot);
            timing.clocks.reading_us(tick.saturating_sub(self.epoch), slow_ppb)
        };
        // An instant wraps.
        Instant::from_micros(reading_us as u32)
    }

    /// Ticks since the last decision, or since before the start.
    pub(super) fn since(&self, tick: u32) -> u32 {
        self.decided.map_or_else(|| tick.saturating_sub(self.epoch).saturating_add(1), |at| tick.saturating_sub(at))
    }

    /// Notes a decision at `tick`, and plans the next one: a step later by this clock, or more if
    /// it comes late.
    pub(super) fn decide(&mut self, tick: u32, robot: RobotId, timing: &Timing) {
        let Timing { clocks, seed } = timing;
        let late_us = u64::from(clocks.late_by_ticks(*seed, robot, tick)) * u64::from(clocks.tick_us);
        self.decided = Some(tick);
        self.due_us += u64::from(clocks.step_us()) + late_us;
        self.due = self.epoch.saturating_add(clocks.ticks_at(self.due_us, clocks.slow_ppb(*seed, robot)));
    }

    /// Age of the last command at `tick`. Before the first decision a body keeps the velocity of
    /// its start.
    pub(super) fn age(&self, tick: u32, timing: &Timing) -> CommandAge {
        match self.decided.map(|at| tick.saturating_sub(at)) {
            Some(0) => CommandAge::New,
            Some(ticks) if ticks >= timing.clocks.step_ticks => CommandAge::Expired,
            Some(_) | None => CommandAge::Kept,
        }
    }
}
