//! Travel times and path lengths on the grid over those of the fastest routes on the whole map, for
//! a robot alone.

use super::{Kind, Probe};
use crate::optimal::{self, Planner};
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Robot, Scenario};
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "optimum",
    measures: &[
        ("loss_percent", "mean travel time of robots that arrived above their fastest routes, percent"),
        ("first_percent", "the same of the first robot; empty: it did not arrive"),
        ("last_percent", "the same of the last robot; empty: it did not arrive"),
        ("length_percent", "mean difference of the lengths of their paths to those of the routes, percent"),
        ("excess_percent", "the same with its sign: negative if robots cross bad ground"),
        ("ticks", "mean travel time of robots that arrived"),
        ("least_ticks", "mean travel time of the fastest routes of all robots"),
    ],
    new: |scenario| Box::new(Optimum { norm: scenario.rules.norm, ways: Vec::new() }),
};

struct Optimum {
    norm: Norm,
    /// Last cell and length so far of each robot's path, [`UNIT`]ths of a cell.
    ways: Vec<(Cell, u64)>,
}

impl Probe for Optimum {
    fn tick(&mut self, _: &Moment<'_>, robots: &[RobotRow]) -> ControlFlow<()> {
        if self.ways.is_empty() {
            self.ways = robots.iter().map(|robot| (robot.motion.cell, 0)).collect();
        }
        for ((last, length), robot) in self.ways.iter_mut().zip(robots) {
            *length += optimal::length(&[*last, robot.motion.cell], self.norm);
            *last = robot.motion.cell;
        }
        ControlFlow::Continue(())
    }

    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let mut planner = Planner::default();
        let rules = scenario.rules;
        let percent = |ours: u64, best: u64| (best > 0).then(|| 100.0 * (ours as f64 / best as f64 - 1.0));
        let (mut losses, mut lengths, mut times, mut leasts) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for ((robot, time), (_, length)) in scenario.robots.iter().zip(&outcome.arrival_times).zip(&self.ways) {
            let route = planner.route(&scenario.terrain, robot.start, robot.goal, rules.norm, rules.corner_cutting);
            let since = time.map(|time| time.saturating_sub(u64::from(departure(scenario, robot)) * u64::from(UNIT)));
            let best = route.as_ref().map(|route| (route.cost, route.length(rules.norm)));
            losses.push(since.zip(best).and_then(|(since, (cost, _))| percent(since, cost)));
            lengths.extend(since.and(best).and_then(|(_, best)| percent(*length, best)));
            times.extend(since.map(ticks));
            leasts.extend(best.map(|(cost, _)| ticks(cost)));
        }
        let known: Vec<f64> = losses.iter().copied().flatten().collect();
        let sizes: Vec<f64> = lengths.iter().map(|length| length.abs()).collect();
        let [loss, size, excess, time, least] =
            [known, sizes, lengths, times, leasts].map(|values| staya_stats::mean(&values));
        vec![loss, losses.first().copied().flatten(), losses.last().copied().flatten(), size, excess, time, least]
    }
}

fn ticks(cost: u64) -> f64 {
    cost as f64 / f64::from(UNIT)
}

/// Tick in which a robot sets out: one that is down at the start does so later.
fn departure(scenario: &Scenario, robot: &Robot) -> u32 {
    let mut faults = scenario.faults.iter().filter(|fault| fault.robot == robot.id && fault.from_tick == 0);
    faults.next().map_or(0, |fault| fault.to_tick)
}
