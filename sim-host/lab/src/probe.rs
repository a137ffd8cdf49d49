//! Probes: measures of a run that are not in its summary, named `PROBE.MEASURE`.

mod alone;
mod company;
mod cost;
mod energy;
mod flock;
mod flow;
mod foresight;
mod free;
mod joint;
pub(crate) mod optimum;
mod process;
mod structure;
mod touch;
mod tracking;

use staya_plot::Panels;
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

/// An observer of one run. It sees the start as tick 0, then each tick.
pub trait Probe {
    /// Sees a tick with all robots; may end the run. By default does neither.
    fn tick(&mut self, moment: &Moment<'_>, robots: &[RobotRow]) -> ControlFlow<()> {
        let _ = (moment, robots);
        ControlFlow::Continue(())
    }

    /// Charts of the run over time; by default there are none.
    fn charts(&self, title: &str) -> Option<Panels> {
        let _ = title;
        None
    }

    /// The run over time as CSV; by default there is none.
    fn table(&self) -> Option<String> {
        None
    }

    /// Values in the order of the probe's measures.
    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>>;
}

/// A kind of probe.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Name before the dot.
    pub name: &'static str,
    /// Names of the measures after the dot, with their meaning.
    pub measures: &'static [(&'static str, &'static str)],
    /// Creates a probe for a run of a scenario.
    pub new: fn(&Scenario) -> Box<dyn Probe>,
}

/// All kinds.
pub const KINDS: [Kind; 13] = [
    free::KIND,
    flow::KIND,
    flock::KIND,
    company::KIND,
    alone::KIND,
    cost::KIND,
    optimum::KIND,
    joint::KIND,
    foresight::KIND,
    touch::KIND,
    tracking::KIND,
    structure::KIND,
    energy::KIND,
];

/// Names and meanings of the measures of all probes.
pub fn measures() -> impl Iterator<Item = (String, &'static str)> {
    KINDS.into_iter().flat_map(|kind| {
        kind.measures.iter().map(move |(measure, meaning)| (format!("{}.{measure}", kind.name), *meaning))
    })
}
