//! Robots evenly on a circle with opposite goals: all routes cross in one point at one time.

use super::{Conditions, gap, picture, run};
use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, check_runs};
use crate::sweep::Value;
use anyhow::{Result, ensure};
use serde::Serialize;
use staya_plot::flock::Sheet;
use staya_plot::{Chart, Series};
use staya_sim::scenario::{PlaneSetup, Scenario, circle_starts};
use std::path::{Path, PathBuf};

/// Radius of a robot, metres.
pub const RADIUS_M: f64 = 0.15;
/// Distance from its goal at which a robot has arrived, metres.
pub const TOLERANCE_M: f64 = 0.05;

/// Parameters of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of robots, each at least 1.
    pub robots: Vec<u32>,
    /// Radius of the circle, metres; `None`: [`circle_m`].
    pub circle_m: Option<f64>,
    /// Largest random displacement of a start along both axes, metres; 0 for the exact circle.
    pub noise_m: f64,
    /// Runs of each number of robots, with consecutive seeds; equal without noise and packet loss.
    pub seeds: u32,
    /// The first seed.
    pub seed: u64,
    /// Time limit of a run in multiples of the free time.
    pub patience: f64,
    /// Conditions of all runs.
    pub conditions: Conditions,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            robots: (2..=64).collect(),
            circle_m: None,
            noise_m: 0.0,
            seeds: 1,
            seed: 1,
            patience: 6.0,
            conditions: Conditions::default(),
        }
    }
}

/// Radius of a circle with enough space for the robots: max(2 m, 0.1 m per robot).
#[must_use]
pub fn circle_m(robots: u32) -> f64 {
    (0.1 * f64::from(robots)).max(2.0)
}

/// Result of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Swap {
    /// Number of robots.
    pub robots: u32,
    /// Radius of the circle, metres.
    pub circle_m: f64,
    /// Seed of noise and losses.
    pub seed: u64,
    /// Robots at their goals at the end.
    pub arrived: usize,
    /// Last arrival divided by the free time (diameter / speed); `None` if not all arrived.
    pub time_ratio: Option<f64>,
    /// Mean ratio of arrival time to free time, over arrived robots.
    pub mean_time_ratio: Option<f64>,
    /// Smallest gap between two bodies, metres; `None` if no two bodies were near.
    pub least_gap_m: Option<f64>,
    /// Overlaps, summed over ticks.
    pub overlaps: u64,
    /// Trace hash.
    #[serde(skip)]
    pub hash: u64,
}

impl Record for Swap {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("arrived", "robots at their goals at the end", &mut self.arrived);
        each("time_ratio", "last arrival over the free time; empty: not all arrived", &mut self.time_ratio);
        each("mean_time_ratio", "the same, mean of those that arrived", &mut self.mean_time_ratio);
        each("least_gap_m", "least gap between two bodies; empty: no robots met", &mut self.least_gap_m);
        each("overlaps", "overlapping pairs, summed over ticks", &mut self.overlaps);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

/// Summary of all runs with one number of robots.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Number of robots.
    pub robots: u32,
    /// Radius of the circle, metres.
    pub circle_m: f64,
    /// Number of runs.
    pub runs: usize,
    /// Runs in which all robots arrived without overlaps.
    pub clean: usize,
    /// Arrived robots in all runs.
    pub arrived: usize,
    /// Largest [`Swap::time_ratio`]; `None` if a robot did not arrive.
    pub worst_time_ratio: Option<f64>,
    /// Smallest gap of all runs, metres.
    pub least_gap_m: Option<f64>,
    /// Overlaps of all runs.
    pub overlaps: u64,
}

/// Results of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Conditions of all runs.
    pub conditions: Conditions,
    /// Noise of the starts, metres.
    pub noise_m: f64,
    /// Summaries, by number of robots.
    pub rows: Vec<Row>,
    /// All runs.
    pub runs: Vec<Swap>,
}

impl Plan {
    /// Builds the scenario of one run.
    #[must_use]
    pub fn scenario(&self, robots: u32, seed: u64) -> Scenario {
        let circle = self.circle_m(robots);
        let starts = circle_starts(robots, circle, self.noise_m, seed);
        let setup = PlaneSetup::new(self.conditions.group(RADIUS_M, TOLERANCE_M), starts);
        let longest_s = self.patience * 2.0 * circle / self.conditions.speed_mps;
        self.conditions.scenario("swap", seed, longest_s, setup)
    }

    fn circle_m(&self, robots: u32) -> f64 {
        self.circle_m.unwrap_or_else(|| circle_m(robots))
    }

    fn swap(&self, robots: u32, seed: u64, may_continue: &dyn Fn() -> bool) -> Option<Swap> {
        let outcome = run(&self.scenario(robots, seed), may_continue, |_| ())?;
        let circle_m = self.circle_m(robots);
        let free_s = 2.0 * circle_m / self.conditions.speed_mps;
        let times: Vec<_> = self.conditions.arrivals_s(&outcome);
        let there: Vec<f64> = times.iter().flatten().copied().collect();
        let last = there.iter().copied().fold(0.0, f64::max);
        let clearance = outcome.clearance?;
        Some(Swap {
            robots,
            circle_m,
            seed,
            arrived: there.len(),
            time_ratio: (there.len() == times.len()).then_some(last / free_s),
            mean_time_ratio: (!there.is_empty()).then(|| there.iter().sum::<f64>() / there.len() as f64 / free_s),
            least_gap_m: gap(clearance.bodies_m),
            overlaps: clearance.overlaps,
            hash: outcome.trace_hash,
        })
    }

    /// Draws four moments of the first run with this number of robots.
    #[must_use]
    pub fn picture(&self, robots: u32) -> Sheet {
        let title = format!("{robots} robots change places, seed {}", self.seed);
        picture(&title, &self.scenario(robots, self.seed))
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "swap";
    const UNIT: &'static str = "runs";
    type Run = Swap;
    type Report = Report;

    fn check(&self) -> Result<()> {
        check_runs(self.seeds, "of each point")?;
        self.conditions.check(self.noise_m)?;
        let patience = self.patience;
        ensure!((0.1..=1000.0).contains(&patience), "--patience {patience} is out of range: give 0.1 to 1000");
        ensure!(
            self.circle_m.is_none_or(|circle| (0.01..=1e5).contains(&circle)),
            "--circle is out of range: give 0.01 to 100000 metres"
        );
        Ok(())
    }

    fn points(&self) -> usize {
        self.robots.len()
    }

    fn runs(&self) -> u32 {
        self.seeds
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let Self { robots, circle_m: _, noise_m, seeds: _, seed: _, patience, conditions } = self;
        let circle_m = self.circle_m(robots[point]);
        let own: [(_, Value); 3] =
            [("robots", robots[point].into()), ("circle_m", circle_m.into()), ("patience", (*patience).into())];
        own.into_iter().chain(conditions.given(*noise_m)).collect()
    }

    fn seed(&self, _: usize, run: u32) -> u64 {
        self.seed + u64::from(run)
    }

    fn blank(&self, point: usize, run: u32) -> Swap {
        let robots = self.robots[point];
        Swap { robots, circle_m: self.circle_m(robots), seed: self.seed(point, run), ..Swap::default() }
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Swap>>> {
        jobs.each(|(): &mut (), point, run| {
            Ok(self.swap(self.robots[point], self.seed(point, run), &|| jobs.may_continue()))
        })
    }

    fn report(&self, runs: &[Vec<Swap>]) -> Report {
        let points = self.robots.iter().zip(runs);
        Report {
            conditions: self.conditions,
            noise_m: self.noise_m,
            rows: points.filter_map(|(&robots, runs)| row(robots, runs)).collect(),
            runs: runs.concat(),
        }
    }

    fn draw(&self, _: &[Vec<Swap>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        let mut pictures = Vec::new();
        if report.rows.len() > 1 {
            pictures.extend(report.chart().write(&dir.join("times"))?);
        }
        // The largest number of robots that is recognisable. After a stop, no further run is made.
        let is_complete = report.runs.len() == self.total();
        let drawn = report.rows.iter().rev().find(|row| is_complete && row.robots <= 100);
        if let Some(row) = drawn {
            pictures.extend(self.picture(row.robots).draw().write(&dir.join("swap"))?);
        }
        Ok(pictures)
    }
}

fn row(robots: u32, mine: &[Swap]) -> Option<Row> {
    let first = mine.first()?;
    let least = mine.iter().filter_map(|run| run.least_gap_m);
    Some(Row {
        robots,
        circle_m: first.circle_m,
        runs: mine.len(),
        clean: mine.iter().filter(|run| run.time_ratio.is_some() && run.overlaps == 0).count(),
        arrived: mine.iter().map(|run| run.arrived).sum(),
        worst_time_ratio: mine
            .iter()
            .map(|run| run.time_ratio)
            .try_fold(0.0, |worst: f64, ratio| Some(worst.max(ratio?))),
        least_gap_m: least.reduce(f64::min),
        overlaps: mine.iter().map(|run| run.overlaps).sum(),
    })
}

impl Report {
    /// Chart of the time ratio over the number of robots.
    #[must_use]
    pub fn chart(&self) -> Chart {
        let points = self.rows.iter().filter_map(|row| Some([f64::from(row.robots), row.worst_time_ratio?]));
        let ends = [self.rows.first(), self.rows.last()];
        let ends = ends.map(|row| row.map_or(0.0, |row| f64::from(row.robots)));
        Chart::new("Swap over a circle: time of the last robot", "robots", "time / free time")
            .with(Series::points("worst of all runs", points))
            .with(Series::reference("1.5", ends.map(|x| [x, 1.5])))
    }
}
