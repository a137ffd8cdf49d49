//! Effect of maps shared over the radio among walls.
//!
//! Each run draws one query of a benchmark per robot and starts all robots at once: without
//! sharing, and with shared maps ([`staya_controller::land`]) at each packet loss. The complete
//! simulator runs, so robots also block each other. The loss of a robot is its travel time compared
//! with the optimal length, as if it were alone.

use super::{Benchmark, Plan};
use crate::experiment::rows::Jobs;
use crate::experiment::{Experiment, Maybe, check_runs};
use crate::route::decimal;
use crate::share::{Outlook, Trip, scenario};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use serde::Serialize;
use staya_console::options::word;
use staya_controller::digest::digest;
use staya_controller::grid::UNIT;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::route::RouteParams;
use staya_sim::engine::simulate;
use staya_sim::scenario::Robot;
use staya_sim::terrain::movingai::Query;
use std::fmt::{self, Display, Formatter};
use std::ops::ControlFlow;

const QUERIES: u32 = 0x0045_0204;
/// For robots and radio.
const RUNS: u32 = 0x0045_0205;

/// Parameters of the experiment.
#[derive(Clone, Debug)]
pub struct GroupPlan {
    /// Queries and robots; their memories have the controller's default sizes.
    pub robots: Plan,
    /// Robots per group, 1 to 100.
    pub groups: Vec<u32>,
    /// Packet losses at which maps are shared, 0 to 1.
    pub losses: Vec<f64>,
    /// Groups of each size, at least 1.
    pub runs: u32,
    /// Seed; equal seeds give equal results. Shared maps were developed on seed 1.
    pub seed: u64,
}

/// Results for one group size.
#[derive(Clone, Debug, Serialize)]
pub struct GroupPoint {
    /// Robots per group.
    pub robots: u32,
    /// Number of groups.
    pub runs: usize,
    /// Results without sharing, then with shared maps at each loss.
    pub outlooks: Vec<Outlook>,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct GroupReport {
    /// File of the map.
    pub map: String,
    /// Radius of the windows.
    pub radius: u8,
    /// Seed of the experiment.
    pub seed: u64,
    /// Results by group size.
    pub points: Vec<GroupPoint>,
}

impl GroupPlan {
    fn benchmark(&self) -> &Benchmark {
        &self.robots.benchmark
    }

    fn route(&self) -> RouteParams {
        self.robots.params()
    }

    fn cases(&self) -> Vec<(u32, Option<f64>)> {
        let shared = || [None].into_iter().chain(self.losses.iter().copied().map(Some));
        self.groups.iter().flat_map(|&group| shared().map(move |shared| (group, shared))).collect()
    }

    fn queries(&self, group: u32, run: u32) -> Vec<&Query> {
        let mut rng = Rng::keyed(self.seed, QUERIES, group, run);
        let mut left: Vec<&Query> = self.benchmark().queries.iter().filter(|query| query.start != query.goal).collect();
        let mut chosen: Vec<&Query> = Vec::new();
        while chosen.len() < group as usize && !left.is_empty() {
            let query = left.swap_remove(rng.below(left.len() as u32) as usize);
            if chosen.iter().all(|other| other.start != query.start && other.goal != query.goal) {
                chosen.push(query);
            }
        }
        chosen
    }

    fn trip(&self, (group, shared): (u32, Option<f64>), run: u32) -> Result<Trip> {
        let queries = self.queries(group, run);
        let robots =
            (1..).zip(&queries).map(|(id, query)| Robot { id: RobotId(id), start: query.start, goal: query.goal });
        let seed = Rng::keyed(self.seed, RUNS, group, run).next_u64();
        let scenario = scenario(self.benchmark().land.clone(), robots.collect(), self.route(), shared, seed);
        let outcome = simulate(&scenario, |_, _| ControlFlow::Continue(()))?;
        let fastest: Vec<(u32, f64)> = queries.iter().map(|q| (0, q.optimal_length * f64::from(UNIT))).collect();
        Ok(Trip::of(&outcome, &fastest))
    }
}

impl Experiment for GroupPlan {
    const NAME: &'static str = "movingai-share";
    const UNIT: &'static str = "groups";
    type Run = Trip;
    type Report = GroupReport;

    fn check(&self) -> Result<()> {
        check_runs(self.runs, "groups of each size")?;
        ensure!(!self.groups.is_empty(), "no groups; give --group one value or more");
        for &group in &self.groups {
            ensure!((1..=100).contains(&group), "a group of {group} robots; it must be 1..=100");
            let fits = |run| self.queries(group, run).len() == group as usize;
            ensure!(
                (0..self.runs).all(fits),
                "{group} robots are more than the scenario has queries of different starts and goals; give a smaller --group"
            );
        }
        for loss in &self.losses {
            ensure!((0.0..=1.0).contains(loss), "a loss of {loss}; it must be between 0 and 1");
        }
        let radius = self.route().radius;
        ensure!((1..=16).contains(&radius), "a window of radius {radius}; with --share it must be 1..=16");
        Ok(())
    }

    fn points(&self) -> usize {
        self.cases().len()
    }

    fn runs(&self) -> u32 {
        self.runs
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Benchmark { map, land, queries: _ } = self.benchmark();
        let RouteParams { radius, exit, norm, corner_cutting, a0, a1, a2, a3 } = self.route();
        let (group, shared) = self.cases()[point];
        vec![
            ("map", map.file_name().unwrap_or_default().to_string_lossy().into_owned().into()),
            ("land", format!("{:016x}", digest(land.cells())).into()),
            ("robots", group.into()),
            ("shared", shared.is_some().into()),
            ("loss", shared.unwrap_or(0.0).into()),
            ("radius_cells", u32::from(radius).into()),
            ("a0", decimal(a0).into()),
            ("a1", decimal(a1).into()),
            ("a2", decimal(a2).into()),
            ("a3", decimal(a3).into()),
            ("norm", word(norm).into()),
            ("corner_cutting", corner_cutting.into()),
            ("exit", word(exit).into()),
            ("first_seed", self.seed.to_string().into()),
        ]
    }

    fn seed(&self, point: usize, run: u32) -> u64 {
        Rng::keyed(self.seed, RUNS, self.cases()[point].0, run).next_u64()
    }

    fn blank(&self, _: usize, _: u32) -> Trip {
        Trip { first_percent: Some(0.0), last_percent: Some(0.0), ..Trip::default() }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Trip>>> {
        let cases = self.cases();
        jobs.each(|(): &mut (), point, run| self.trip(cases[point], run).map(Some))
    }

    fn report(&self, runs: &[Vec<Trip>]) -> GroupReport {
        let (cases, of_group) = (self.cases(), 1 + self.losses.len());
        let points = cases.chunks(of_group).zip(runs.chunks(of_group)).filter_map(|(cases, runs)| {
            let outlooks = cases.iter().zip(runs).map(|(&(_, shared), trips)| Outlook::of(shared, trips));
            Some(GroupPoint {
                robots: cases.first()?.0,
                runs: runs.iter().map(Vec::len).min().unwrap_or(0),
                outlooks: outlooks.collect::<Option<_>>()?,
            })
        });
        let map = self.benchmark().map.display().to_string();
        GroupReport { map, radius: self.route().radius, seed: self.seed, points: points.collect() }
    }
}

impl Display for GroupReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { map, radius, seed, .. } = self;
        writeln!(f, "{map}, window radius {radius}, seed {seed}")?;
        writeln!(
            f,
            "{:>7}{:>7}  {:<14}{:>8}{:>8}{:>7}{:>9}{:>10}",
            "robots", "groups", "maps", "arrived", "dT %", "+-", "median", "packets"
        )?;
        for point in &self.points {
            for outlook in &point.outlooks {
                let loss = &outlook.loss_percent;
                writeln!(
                    f,
                    "{:>7}{:>7}  {:<14}{:>8}{:>8.1}{:>7}{:>9.1}{:>10.0}",
                    point.robots,
                    point.runs,
                    outlook.maps(),
                    outlook.arrived,
                    loss.mean,
                    Maybe(loss.mean_error95, 1),
                    loss.median,
                    outlook.packets,
                )?;
            }
        }
        f.write_str("dT: travel time over the optimal length, mean over groups of the means of their robots that arrived; median: over groups\n+-: half the 95 % interval. shared: at that loss of packets; own: each by its window alone\n")
    }
}

#[cfg(test)]
mod tests {
    use super::super::Robots;
    use super::super::Sight;
    use super::*;
    use staya_controller::grid::{BLOCKED, Cell};
    use staya_sim::terrain::Terrain;

    fn pocket(robots: i16) -> Benchmark {
        let mut land = Terrain::flat(60, 40);
        (10..=30).for_each(|y| land.set(Cell::new(40, y), BLOCKED));
        (22..=40).for_each(|x| [10, 30].iter().for_each(|&y| land.set(Cell::new(x, y), BLOCKED)));
        let query = |n: i16| {
            let [start, goal] = [Cell::new(2 * n, 19 + n % 3), Cell::new(56, 10 + n)];
            let route =
                crate::optimal::route(&land, start, goal, staya_controller::grid::Norm::Euclidean, false).unwrap();
            let optimal_length = route.cost as f64 / f64::from(UNIT);
            Query { bucket: 0, map: "a.map".into(), width: 60, height: 40, start, goal, optimal_length }
        };
        let queries = (0..robots).map(query).collect();
        Benchmark { map: "a.map".into(), land, queries }
    }

    fn plan() -> GroupPlan {
        let robots = Plan { benchmark: pocket(9), robots: Robots::new(Sight::Radius(5)) };
        GroupPlan { robots, groups: vec![6], losses: vec![0.0], runs: 3, seed: 3 }
    }

    #[test]
    fn all_robots_leave_a_dead_end_with_and_without_sharing() {
        let report = plan().measure().unwrap();
        let [own, shared] = &report.points[0].outlooks[..] else { panic!("{report}") };
        assert_eq!((own.arrived, shared.arrived), (18, 18), "{report}");
        assert_eq!((own.collisions, shared.collisions), (0, 0), "{report}");
        assert!(own.loss_percent.mean > 10.0 && shared.loss_percent.mean > 10.0, "it is one: {report}");
        assert!(shared.packets > own.packets, "{report}");
    }

    #[test]
    fn each_robot_has_its_own_query() {
        let plan = plan();
        for run in 0..3 {
            let queries = plan.queries(6, run);
            assert_eq!(queries.len(), 6);
            for (n, query) in queries.iter().enumerate() {
                assert!(queries[..n].iter().all(|other| other.start != query.start && other.goal != query.goal));
            }
        }
        assert_ne!(plan.queries(6, 0), plan.queries(6, 1));
    }

    #[test]
    fn invalid_plans_are_refused_with_a_remedy() {
        let refused = |plan: GroupPlan| plan.check().unwrap_err().to_string();
        assert!(refused(GroupPlan { groups: vec![10], ..plan() }).contains("give a smaller --group"));
        assert!(refused(GroupPlan { groups: vec![], ..plan() }).contains("--group"));
        assert!(refused(GroupPlan { losses: vec![-0.1], ..plan() }).contains("between 0 and 1"));
        let mut far = plan();
        far.robots.robots.sight = Sight::Map;
        assert!(refused(far).contains("1..=16"));
    }
}
