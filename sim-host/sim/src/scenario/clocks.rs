//! `[clocks]`: when the robots decide.

use super::Draft;
use super::ranges::{micros, short};
use super::source::{Checked, Section};
use crate::{choice, defaults, table};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;

const PHASE: u32 = u32::from_be_bytes(*b"phas");
const RATE: u32 = u32::from_be_bytes(*b"rate");
const LATE: u32 = u32::from_be_bytes(*b"late");

const PER_BILLION: u128 = 1_000_000_000;

choice! {
    /// How the decisions of different robots are spread over a step.
    pub enum Phases {
        /// All robots decide at once.
        Equal = "equal",
        /// Each robot has a random phase.
        Random = "random",
    }
}

table! {
    /// `[clocks]`: when robots in the plane decide. Default: all of them in each tick.
    #[derive(Copy)]
    pub struct ClocksTable {
        /// Time between two decisions of a robot, and between its beacons: a whole number of
        /// ticks. Default: a tick.
        pub step_s: Option<f64>, 0.001..=60.0, "seconds";
        /// `"equal"`: all robots decide at once (default); `"random"`: each has a random phase.
        pub phases: Phases = Phases::Equal;
        /// Largest rate by which a robot's clock is slow; each robot has a random one. Default: 0.
        pub drift_ppm: f64 = 0.0, 0.0..=100_000.0, "parts per million";
        /// Share of the decisions that come late, 0 to 1. Default: 0.
        pub late: f64 = 0.0, 0.0..=1.0, "(a share)";
        /// Longest delay of a late decision, seconds, a tick or more; it delays the later decisions
        /// too. Required if `late` is above 0.
        pub late_s: Option<f64>, 0.0..=600.0, "seconds";
    }
}

defaults!(ClocksTable);

/// When the robots of a scenario decide.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clocks {
    /// Length of a tick, microseconds.
    pub tick_us: u32,
    /// Ticks between two decisions of a robot; at least 1.
    pub step_ticks: u32,
    /// Phases of the robots that have none of their own.
    pub phases: Phases,
    /// Whether some robots have a phase of their own.
    pub has_own_phases: bool,
    /// Largest rate by which a clock is slow, parts per billion.
    pub drift_ppb: u32,
    /// Probability that a decision comes late, Q0.32.
    pub late_q32: u32,
    /// Longest delay of a decision, ticks.
    pub late_ticks: u32,
}

impl Clocks {
    /// Clocks of robots that all decide in each tick.
    #[must_use]
    pub const fn synchronous(tick_us: u32) -> Self {
        Self {
            tick_us,
            step_ticks: 1,
            phases: Phases::Equal,
            has_own_phases: false,
            drift_ppb: 0,
            late_q32: 0,
            late_ticks: 0,
        }
    }

    /// Whether all robots decide in each tick, and so at the same instants.
    #[must_use]
    pub fn is_synchronous(&self) -> bool {
        let has_phases = self.phases != Phases::Equal || self.has_own_phases;
        self.step_ticks == 1 && !has_phases && self.drift_ppb == 0 && self.late_ticks == 0
    }

    /// Time between two decisions of a robot, microseconds.
    #[must_use]
    pub const fn step_us(&self) -> u32 {
        self.step_ticks.saturating_mul(self.tick_us)
    }

    /// Longest delay of a decision, microseconds.
    #[must_use]
    pub const fn late_us(&self) -> u32 {
        self.late_ticks.saturating_mul(self.tick_us)
    }

    /// Tick of a robot's first decision, below [`step_ticks`](Self::step_ticks); `own` is the phase
    /// that the scenario gives it.
    #[must_use]
    pub fn phase_ticks(&self, seed: u64, robot: RobotId, own: Option<u32>) -> u32 {
        own.unwrap_or_else(|| match self.phases {
            Phases::Equal => 0,
            Phases::Random => Rng::keyed(seed, PHASE, robot.0, 0).below(self.step_ticks),
        })
    }

    /// Rate by which a robot's clock is slow, parts per billion.
    #[must_use]
    pub fn slow_ppb(&self, seed: u64, robot: RobotId) -> u32 {
        match self.drift_ppb {
            0 => 0,
            most => Rng::keyed(seed, RATE, robot.0, 0).below(most.saturating_add(1)),
        }
    }

    /// Ticks by which the decision that follows one at `tick` comes late.
    #[must_use]
    pub fn late_by_ticks(&self, seed: u64, robot: RobotId, tick: u32) -> u32 {
        if self.late_ticks == 0 {
            return 0;
        }
        let mut draws = Rng::keyed(seed, LATE, robot.0, tick);
        if draws.chance_q32(self.late_q32) { 1 + draws.below(self.late_ticks) } else { 0 }
    }

    /// First tick after the start of a clock at which it shows `reading_us` or more; `slow_ppb` is
    /// its rate. Readings that are a step apart are at least a step of ticks apart.
    #[must_use]
    pub fn ticks_at(&self, reading_us: u64, slow_ppb: u32) -> u32 {
        let reading_us = u128::from(reading_us);
        let true_us = reading_us + reading_us * u128::from(slow_ppb) / PER_BILLION;
        u32::try_from(true_us.div_ceil(self.tick_us.max(1).into())).unwrap_or(u32::MAX)
    }

    /// Reading of a clock `ticks` after its start, microseconds.
    #[must_use]
    pub fn reading_us(&self, ticks: u32, slow_ppb: u32) -> u64 {
        let true_us = u64::from(ticks) * u64::from(self.tick_us);
        if slow_ppb == 0 {
            return true_us;
        }
        let reading_us = u128::from(true_us) * PER_BILLION / (PER_BILLION + u128::from(slow_ppb));
        u64::try_from(reading_us).unwrap_or(u64::MAX)
    }

    /// Age with which robots count a beacon when they use it first, microseconds, if the radio
    /// takes `delay_us` at most. A packet arrives in the next tick or later.
    ///
    /// Robots that decide in each tick use a beacon in the tick of its arrival. Other robots use it
    /// up to a step later. Their ages are rounded to whole steps: one step for a delay up to a
    /// quarter of a step, two for a delay up to one and a quarter
    /// ([`AgentConfig::latency`](staya_controller::agent::AgentConfig::latency)).
    #[must_use]
    pub fn latency_us(&self, delay_us: u32) -> u32 {
        let arrival = u64::from(delay_us.div_ceil(self.tick_us.max(1)).max(1));
        let step = u64::from(self.step_ticks.max(1));
        let ticks = if self.is_synchronous() {
            arrival
        } else {
            step * (1 + (4 * arrival).saturating_sub(step).div_ceil(4 * step))
        };
        u32::try_from(ticks * u64::from(self.tick_us)).unwrap_or(u32::MAX)
    }
}

impl Draft<'_> {
    /// Time between two decisions of a robot, seconds.
    pub(super) fn step_s(&self) -> f64 {
        self.file.clocks.step_s.unwrap_or(self.file.tick_s)
    }

    /// Ticks between two decisions of a robot, after [`clocks`] has checked them.
    pub(super) fn step_ticks(&self) -> u32 {
        micros(self.step_s()) / micros(self.file.tick_s).max(1)
    }
}

pub(super) fn clocks(draft: &Draft<'_>) -> Checked<Clocks> {
    let (at, table, tick_s) = (draft.at("clocks"), draft.file.clocks, draft.file.tick_s);
    let tick_us = micros(tick_s);
    if !draft.has("clocks") {
        return Ok(Clocks::synchronous(tick_us));
    }
    let what = "robots that move from cell to cell decide in each tick";
    draft.require(draft.file.plane.is_some(), "clocks", what, "give [plane], or leave this table out")?;
    let step_us = micros(draft.step_s());
    let what = format!("{} s is not a whole number of ticks", short(draft.step_s()));
    let is_whole = step_us >= tick_us && step_us.is_multiple_of(tick_us);
    at.require(is_whole, "step_s", what, format!("give a multiple of tick_s = {}", short(tick_s)))?;
    let step_ticks = step_us / tick_us;
    let what = "in a step of one tick there is one phase only";
    let is_spread = table.phases == Phases::Equal || step_ticks > 1;
    at.require(is_spread, "phases", what, "give step_s of two ticks or more, or leave it out")?;
    let late_s = table.late_s.unwrap_or_default();
    let what = "late and late_s go together";
    let remedy = "give both above 0, or none of them";
    let go_together = (table.late > 0.0) == (late_s > 0.0);
    at.require(go_together, if table.late > 0.0 { "late" } else { "late_s" }, what, remedy)?;
    let late_ticks = micros(late_s) / tick_us;
    let what = format!("{} s is less than a tick", short(late_s));
    let is_enough = late_s == 0.0 || late_ticks > 0;
    at.require(is_enough, "late_s", what, format!("give {} s or more", short(tick_s)))?;
    Ok(Clocks {
        step_ticks,
        phases: table.phases,
        drift_ppb: libm::round(table.drift_ppm * 1000.0) as u32,
        late_q32: (table.late * 4_294_967_296.0) as u32,
        late_ticks,
        ..Clocks::synchronous(tick_us)
    })
}

/// Phase of a robot, ticks, as its table or that of its group gives it.
pub(super) fn phase_ticks(draft: &Draft<'_>, at: &Section<'_>, phase_s: Option<f64>) -> Checked<Option<u32>> {
    let Some(phase_s) = phase_s else { return Ok(None) };
    let (tick_us, phase_us) = (micros(draft.file.tick_s).max(1), micros(phase_s));
    let is_phase = phase_us.is_multiple_of(tick_us) && phase_us / tick_us < draft.step_ticks();
    let what = format!("{} s is not a whole number of ticks below a step", short(phase_s));
    let (tick_s, step_s) = (short(draft.file.tick_s), short(draft.step_s()));
    let remedy = format!("give a multiple of tick_s = {tick_s} below clocks.step_s = {step_s}, or leave it out");
    at.require(is_phase, "phase_s", what, remedy)?;
    Ok(Some(phase_us / tick_us))
}

#[cfg(test)]
mod tests;
