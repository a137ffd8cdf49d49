//! Time of a formation over that of its robots without formation on the same land.

use super::{Kind, Probe};
use staya_sim::engine::{Outcome, simulate};
use staya_sim::radio::RadioParams;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "alone",
    measures: &[(
        "time_ratio",
        "last arrival over that without formation, losses and shuffles; empty: not all arrived in both",
    )],
    new: |_| Box::new(Alone),
};

struct Alone;

impl Probe for Alone {
    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let mut alone = scenario.clone();
        alone.formations.clear();
        alone.laws.maps = None;
        alone.set_in_laws("halved_per_ticks", 0.0);
        alone.radio = RadioParams { range_m: scenario.radio.range_m, ..RadioParams::default() };
        let other = simulate(&alone, |_, _| ControlFlow::Continue(())).ok();
        let ratio = last(outcome).zip(other.as_ref().and_then(last)).map(|(own, other)| own as f64 / other as f64);
        vec![ratio]
    }
}

fn last(outcome: &Outcome) -> Option<u64> {
    outcome.arrival_times.iter().copied().try_fold(0, |last, at| Some(at?.max(last)))
}
