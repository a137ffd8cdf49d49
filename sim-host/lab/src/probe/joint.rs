//! A formation on the grid beside the optima of its robots by the two criteria of A. V. Kuznetsov
//! 2017 (KUZ), section 2 ([`crate::joint`]), and whether it was restored.

use super::{Kind, Probe};
use crate::joint::{Fastest, fastest, rigid};
use staya_controller::grid::Cell;
use staya_controller::route::RouteParams;
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "joint",
    measures: &[
        ("time_ratio", "last arrival over the least one by criterion (4), without formation; empty: not all arrived"),
        ("rigid_ratio", "the least time without any deviation by criterion (5), over the same"),
        ("wait_percent", "excess of the fastest routes with waiting, percent; 0: the least time is exact"),
        ("restored_cells", "least mean distance from the places after the greatest one, before the first arrival"),
    ],
    new: |_| Box::new(Joint { greatest: 0.0, least_after: None, has_arrived: false }),
};

struct Joint {
    /// The greatest mean distance from the places so far, and the least since then, cells.
    greatest: f64,
    least_after: Option<f64>,
    has_arrived: bool,
}

impl Probe for Joint {
    fn tick(&mut self, moment: &Moment<'_>, _: &[RobotRow]) -> ControlFlow<()> {
        self.has_arrived |= moment.arrived > 0;
        let error = moment.row.formation_error_per_agent;
        if self.has_arrived || !error.is_finite() {
            return ControlFlow::Continue(());
        }
        if error >= self.greatest {
            (self.greatest, self.least_after) = (error, None);
        } else {
            self.least_after = Some(self.least_after.map_or(error, |least| least.min(error)));
        }
        ControlFlow::Continue(())
    }

    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let restored = self.least_after;
        let [formation] = &scenario.formations[..] else { return vec![None, None, None, restored] };
        if scenario.plane().is_some() {
            return vec![None, None, None, restored];
        }
        let RouteParams { norm, corner_cutting, .. } = scenario.route().params;
        let land = &scenario.land.terrain;
        let members = &scenario.robots[formation.members()];
        let trips: Vec<(Cell, Cell)> = members.iter().map(|robot| (robot.start, robot.goal)).collect();
        let Some(Fastest { bound, reached }) = fastest(land, &trips, norm, corner_cutting).filter(|it| it.bound > 0)
        else {
            return vec![None, None, None, restored];
        };
        let over = |time: u64| time as f64 / bound as f64;
        let times = &outcome.arrival_times[formation.members()];
        let last = times.iter().copied().try_fold(0, |last, at| Some(at?.max(last)));
        let stiff = rigid(land, &formation.places, trips[0], norm, corner_cutting);
        vec![last.map(over), stiff.map(over), reached.map(|time| 100.0 * (over(time) - 1.0)), restored]
    }
}
