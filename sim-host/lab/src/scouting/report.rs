//! Results of the scouting experiment.

use super::{Known, Plan, Run};
use crate::experiment::Maybe;
use serde::Serialize;
use staya_stats::{Summary, mean};
use std::fmt::{self, Display, Formatter};

/// Results for one kind of knowledge and one rate of change.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// `sight`, `map` or `far sight`.
    pub known: &'static str,
    /// Share of the map that is blank.
    pub unknown: Option<f64>,
    /// Share of the map that shows other places.
    pub wrong: Option<f64>,
    /// Share of the cells whose crossing time changes by a tick in each tick.
    pub drift_per_tick: f64,
    /// Number of landscapes.
    pub runs: usize,
    /// Robots that reached their target.
    pub arrived: usize,
    /// dT: mean excess of the travel time over that with perfect knowledge, percent.
    pub time_loss_percent: Option<f64>,
    /// Half the 95 % interval of the mean of dT.
    pub error95_percent: Option<f64>,
    /// Mean number of cells remembered at the end.
    pub remembered: Option<f64>,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Always `scouting`.
    pub experiment: &'static str,
    /// Requested landscapes per point.
    pub runs: u32,
    /// Obstacles per landscape.
    pub obstacles: u32,
    /// Cells along each side.
    pub size: u16,
    /// Range of sight, cells.
    pub sight: u8,
    /// Planning radius on a map, cells.
    pub map_radius: u8,
    /// Cells along each side of blank or wrong areas.
    pub patch_cells: u16,
    /// Seed of the experiment.
    pub seed: u64,
    /// Points by knowledge, without points that have no runs.
    pub points: Vec<Point>,
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Run>]) -> Self {
        let points = runs.iter().enumerate().filter(|(_, runs)| !runs.is_empty());
        Self {
            experiment: "scouting",
            runs: plan.runs,
            obstacles: plan.obstacles,
            size: plan.size,
            sight: plan.sight,
            map_radius: plan.map_radius,
            patch_cells: plan.patch_cells,
            seed: plan.seed,
            points: points.map(|(at, runs)| point(plan.point(at), runs)).collect(),
        }
    }
}

fn point((known, drift_per_tick): (Known, f64), runs: &[Run]) -> Point {
    let arrived = runs.iter().filter(|run| run.arrived);
    let loss = |run: &Run| 100.0 * (run.cost as f64 - run.least_cost as f64) / run.least_cost as f64;
    let losses: Vec<f64> = arrived.map(loss).collect();
    let summary = Summary::of(&losses);
    let remembered: Vec<f64> = runs.iter().map(|run| run.remembered.into()).collect();
    Point {
        known: known.name(),
        unknown: known.shares().map(|[unknown, _]| unknown),
        wrong: known.shares().map(|[_, wrong]| wrong),
        drift_per_tick,
        runs: runs.len(),
        arrived: losses.len(),
        time_loss_percent: summary.map(|summary| summary.mean),
        error95_percent: summary.and_then(|summary| summary.mean_error95),
        remembered: mean(&remembered),
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (size, sight, wide) = (self.size, self.sight, self.map_radius);
        writeln!(
            f,
            "{size} x {size} cells, {} obstacles, 9 classes, sight {sight}, maps of radius {wide}, patches of {}, seed {}",
            self.obstacles, self.patch_cells, self.seed
        )?;
        writeln!(
            f,
            "{:<10}{:>9}{:>7}{:>12}{:>7}{:>9}{:>8}{:>7}{:>12}",
            "known", "unknown", "wrong", "drift/tick", "runs", "arrived", "dT %", "+-", "remembered"
        )?;
        for point in &self.points {
            let [unknown, wrong] = [point.unknown, point.wrong].map(|share| Maybe(share, 2));
            writeln!(
                f,
                "{:<10}{unknown:>9}{wrong:>7}{:>12}{:>7}{:>9}{:>8}{:>7}{:>12}",
                point.known,
                point.drift_per_tick,
                point.runs,
                point.arrived,
                Maybe(point.time_loss_percent, 2),
                Maybe(point.error95_percent, 2),
                Maybe(point.remembered, 0),
            )?;
        }
        f.write_str(
            "dT: travel time above the least with the land of all times known; +-: half the 95 % interval of its mean\n\
             sight: plans on the land in sight; map: also on a map and on land seen before; far sight: sees as far as maps reach\n",
        )
    }
}
