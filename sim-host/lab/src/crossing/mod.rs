//! Scenes in which robots obstruct each other: [`swap`] over a circle, [`doorway`] through a gap,
//! and fourteen other [`cases`].
//!
//! Every robot is a complete controller with ORCA that knows others only from beacons: positions
//! rounded to a millimetre, one tick old. Plain ORCA deadlocks in all of these scenes.

pub mod cases;
pub mod doorway;
mod report;
pub mod swap;

use crate::sweep::Value;
use anyhow::{Result, ensure};
use serde::Serialize;
use staya_console::options::word;
use staya_controller::agent::SafetyKind;
use staya_controller::grid::UNIT;
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::PushOutParams;
use staya_plot::flock::Sheet;
use staya_plot::motion_sheet;
use staya_sim::engine::{Outcome, simulate};
use staya_sim::radio::RadioParams;
use staya_sim::record::{Options, Recorder, RobotRow};
use staya_sim::scenario::{PlaneSetup, RobotGroup, Scenario};
use staya_sim::world::plane::Abilities;
use std::ops::ControlFlow;

/// Conditions of all runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Conditions {
    /// Time between two decisions, seconds; overlaps depend on it.
    pub step_s: f64,
    /// Highest speed, m/s.
    pub speed_mps: f64,
    /// Range of the radio, metres; at least the distance of robots one horizon before they meet.
    pub range_m: f64,
    /// Share of packets lost.
    pub loss: f64,
    /// Safety layer.
    pub safety: SafetyKind,
}

impl Default for Conditions {
    fn default() -> Self {
        Self { step_s: 0.05, speed_mps: 0.5, range_m: 3.0, loss: 0.0, safety: SafetyKind::Orca }
    }
}

impl Conditions {
    fn check(&self, noise_m: f64) -> Result<()> {
        for (name, value, low, high) in [
            ("--noise", noise_m, 0.0, 100.0),
            ("--step", self.step_s, 0.001, 10.0),
            ("--speed", self.speed_mps, 0.01, 32.0),
            ("--range", self.range_m, 0.0, 1e6),
            ("--loss", self.loss, 0.0, 1.0),
        ] {
            ensure!((low..=high).contains(&value), "{name} {value} is out of range: give {low} to {high}");
        }
        Ok(())
    }

    fn given(&self, noise_m: f64) -> Vec<(&'static str, Value)> {
        let Self { step_s, speed_mps, range_m, loss, safety } = *self;
        vec![
            ("noise_m", noise_m.into()),
            ("step_s", step_s.into()),
            ("speed_mps", speed_mps.into()),
            ("range_m", range_m.into()),
            ("loss", loss.into()),
            ("safety", word(safety).into()),
        ]
    }

    fn group(&self, radius_m: f64, tolerance_m: f64) -> RobotGroup {
        self.group_at(self.speed_mps, radius_m, tolerance_m)
    }

    fn group_at(&self, max_speed_mps: f64, radius_m: f64, tolerance_m: f64) -> RobotGroup {
        let abilities =
            Abilities { max_speed_mps, max_acceleration_mps2: f64::INFINITY, lag_s: 0.0, step_s: self.step_s };
        let group = RobotGroup::new(abilities, radius_m).to_places(tolerance_m);
        group.behind(self.safety, AvoidParams::default(), PushOutParams::new(1.0))
    }

    fn scenario(&self, name: &str, seed: u64, longest_s: f64, setup: PlaneSetup) -> Scenario {
        let radio = RadioParams { range_m: self.range_m, loss: self.loss, ..RadioParams::default() };
        let ticks = libm::ceil(longest_s / self.step_s) as u32;
        Scenario::in_plane(name, seed, ticks.max(1), radio, setup)
    }

    fn arrivals_s(&self, outcome: &Outcome) -> Vec<Option<f64>> {
        let seconds = |units: u64| units as f64 / f64::from(UNIT) * self.step_s;
        let times = outcome.arrival_times.iter();
        times.map(|time| time.map(seconds)).collect()
    }
}

/// Runs until all robots with a goal have arrived; `None` if `may_continue` stops the run. `see` is
/// called before the first tick and after each.
fn run(
    scenario: &Scenario,
    may_continue: &dyn Fn() -> bool,
    mut see: impl FnMut(&mut dyn Iterator<Item = RobotRow>),
) -> Option<Outcome> {
    let mut stopped = false;
    let starts = scenario.plane.iter().flat_map(|plane| &plane.starts);
    let sent = starts.filter(|start| !start.places.is_empty()).count();
    let outcome = simulate(scenario, |moment, robots| {
        see(robots);
        if moment.arrived >= sent {
            ControlFlow::Break(())
        } else if may_continue() {
            ControlFlow::Continue(())
        } else {
            stopped = true;
            ControlFlow::Break(())
        }
    });
    let outcome = outcome.expect("bodies in the plane can start anywhere");
    (!stopped).then_some(outcome)
}

fn picture(title: &str, scenario: &Scenario) -> Sheet {
    let in_memory = "a recorder without files cannot fail";
    let mut recorder = Recorder::in_memory(Options::default());
    let outcome = simulate(scenario, |moment, robots| {
        recorder.tick(moment.row, robots).expect(in_memory);
        ControlFlow::Continue(())
    });
    let _ = outcome.expect("bodies in the plane can start anywhere");
    let history = recorder.finish().expect(in_memory);
    let setup = scenario.plane.as_ref().expect("it was made in the plane");
    motion_sheet(title, setup, None, &history)
}

fn gap(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests;
