//! Times of robots in the plane over their free times: alone, straight, at cruising speed.

use super::{Kind, Probe};
use staya_controller::grid::UNIT;
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "free",
    measures: &[
        ("worst_ratio", "largest time of a robot over its free time; empty: not all arrived"),
        ("mean_ratio", "mean of the ratios of robots that arrived"),
        ("last_s", "when the last robot with a goal arrived; empty: not all did"),
    ],
    new: |scenario| Box::new(Free { sent: ways_m(scenario).flatten().count() }),
};

/// Ends a run when all robots with a goal have arrived; others stay where they are.
struct Free {
    sent: usize,
}

/// Length of each robot's way, metres; `None` without a goal.
fn ways_m(scenario: &Scenario) -> impl Iterator<Item = Option<f64>> {
    scenario.plane().into_iter().flat_map(|plane| &plane.starts).map(|start| {
        let places = start.places.iter().map(|place| place.position_m);
        let (way_m, _) = places.fold((0.0, start.position_m), |(way_m, from), to| (way_m + distance_m(from, to), to));
        (!start.places.is_empty()).then_some(way_m)
    })
}

impl Probe for Free {
    fn tick(&mut self, moment: &Moment<'_>, _: &[RobotRow]) -> ControlFlow<()> {
        if self.sent > 0 && moment.arrived >= self.sent { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let seconds = |units: u64| units as f64 / f64::from(UNIT) * scenario.tick_s();
        let (mut ratios, mut last_s, mut arrived) = (Vec::new(), 0.0_f64, 0);
        for (index, (way_m, time)) in ways_m(scenario).zip(&outcome.arrival_times).enumerate() {
            let (Some(way_m), Some(plane), Some(time_s)) = (way_m, scenario.plane(), time.map(seconds)) else {
                continue;
            };
            arrived += 1;
            last_s = last_s.max(time_s);
            // A robot that starts at its goal has no ratio.
            if way_m > 0.1 {
                ratios.push(time_s / (way_m / plane.group(index).cruise_mps));
            }
        }
        let all = arrived == self.sent && arrived > 0;
        let worst = ratios.iter().copied().reduce(f64::max);
        vec![worst.filter(|_| all), staya_stats::mean(&ratios), all.then_some(last_s)]
    }
}

fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    libm::sqrt(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum())
}
