//! Travel times on the grid over those of the fastest routes on the whole map, for a robot alone.

use super::{Kind, Probe};
use staya_controller::grid::UNIT;
use staya_controller::route::RouteParams;
use staya_sim::engine::Outcome;
use staya_sim::scenario::{Robot, Scenario};
use staya_sim::terrain::optimal::Planner;

pub const KIND: Kind = Kind {
    name: "optimum",
    measures: &[
        ("loss_percent", "mean travel time of robots that arrived above their fastest routes, percent"),
        ("first_percent", "the same of the first robot; empty: it did not arrive"),
        ("last_percent", "the same of the last robot; empty: it did not arrive"),
    ],
    new: |_| Box::new(Optimum),
};

struct Optimum;

impl Probe for Optimum {
    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let mut planner = Planner::default();
        let loss = |(robot, time): (&Robot, &Option<u64>)| {
            let since = time.as_ref()?.saturating_sub(u64::from(departure(scenario, robot)) * u64::from(UNIT));
            let RouteParams { norm, corner_cutting, .. } = scenario.route().params;
            let route = planner.route(&scenario.land.terrain, robot.start, robot.goal, norm, corner_cutting)?;
            (route.cost > 0).then(|| 100.0 * (since as f64 / route.cost as f64 - 1.0))
        };
        let losses: Vec<Option<f64>> = scenario.robots.iter().zip(&outcome.arrival_times).map(loss).collect();
        let known: Vec<f64> = losses.iter().copied().flatten().collect();
        vec![staya_stats::mean(&known), losses.first().copied().flatten(), losses.last().copied().flatten()]
    }
}

/// Tick in which a robot sets out: one that is down at the start does so later.
fn departure(scenario: &Scenario, robot: &Robot) -> u32 {
    let mut faults = scenario.events.faults.iter().filter(|fault| fault.robot == robot.id && fault.from_tick == 0);
    faults.next().map_or(0, |fault| fault.to_tick)
}
