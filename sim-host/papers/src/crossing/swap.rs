//! Robots evenly on a circle, each bound for the opposite side: all ways cross in one point at one time.

use super::{Conditions, gap, picture, run};
use rayon::prelude::*;
use serde::Serialize;
use staya_plot::flock::Sheet;
use staya_plot::{Chart, Series};
use staya_sim::scenario::{PlaneSetup, Scenario, circle_starts};

/// Radius of a robot, metres.
pub const RADIUS_M: f64 = 0.15;
/// How near to its goal a robot has arrived, metres.
pub const TOLERANCE_M: f64 = 0.05;

/// Which swaps to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of robots; each 1 or more.
    pub robots: Vec<u32>,
    /// Radius of the circle, metres; `None`: [`circle_m`].
    pub circle_m: Option<f64>,
    /// Each start is off by up to this along both axes, metres; 0: the exact circle.
    pub noise_m: f64,
    /// Runs of each number of robots, with seeds `seed`, `seed` + 1, ... They differ only with noise or losses.
    pub seeds: u32,
    /// The first seed.
    pub seed: u64,
    /// A run ends after so many times the free time.
    pub patience: f64,
    /// What else holds.
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

/// Radius of a circle that leaves `robots` robots room: max(2 m, 0.1 m for each).
#[must_use]
pub fn circle_m(robots: u32) -> f64 {
    (0.1 * f64::from(robots)).max(2.0)
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Swap {
    /// How many robots.
    pub robots: u32,
    /// Radius of the circle, metres.
    pub circle_m: f64,
    /// Seed of noise and losses.
    pub seed: u64,
    /// Robots at their goals at the end.
    pub arrived: usize,
    /// Time of the last arrival over the free time (diameter / speed); `None`: not all arrived.
    pub time_ratio: Option<f64>,
    /// The same, mean over the robots that arrived.
    pub mean_time_ratio: Option<f64>,
    /// Least gap between two bodies, metres; `None`: nobody came near.
    pub least_gap_m: Option<f64>,
    /// Overlaps, summed over ticks.
    pub overlaps: u64,
}

/// All runs of a number of robots.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// How many robots.
    pub robots: u32,
    /// Radius of the circle, metres.
    pub circle_m: f64,
    /// Runs.
    pub runs: usize,
    /// Runs in which all arrived and nobody overlapped.
    pub clean: usize,
    /// Robots that arrived, of all runs.
    pub arrived: usize,
    /// The largest [`Swap::time_ratio`]; `None`: in some run not all arrived.
    pub worst_time_ratio: Option<f64>,
    /// Least gap of all runs, metres.
    pub least_gap_m: Option<f64>,
    /// Overlaps of all runs.
    pub overlaps: u64,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// What held.
    pub conditions: Conditions,
    /// Noise of the starts, metres.
    pub noise_m: f64,
    /// By number of robots.
    pub rows: Vec<Row>,
    /// Each run.
    pub runs: Vec<Swap>,
}

impl Plan {
    /// Runs to do.
    #[must_use]
    pub fn total(&self) -> usize {
        self.robots.len() * self.seeds as usize
    }

    /// The scenario of one run.
    #[must_use]
    pub fn scenario(&self, robots: u32, seed: u64) -> Scenario {
        let circle = self.circle_m.unwrap_or_else(|| circle_m(robots));
        let starts = circle_starts(robots, circle, self.noise_m, seed);
        let mut setup = PlaneSetup::new(self.conditions.abilities(), RADIUS_M, starts);
        setup.tolerance_m = TOLERANCE_M;
        let longest_s = self.patience * 2.0 * circle / self.conditions.speed_mps;
        self.conditions.scenario("swap", seed, longest_s, setup)
    }

    /// Runs them all; `progress` is told how many are done and says whether to go on. Runs that were not over then are left
    /// out.
    pub fn run(&self, progress: &(dyn Fn(usize) -> bool + Sync)) -> Report {
        let jobs: Vec<(u32, u64)> = self
            .robots
            .iter()
            .flat_map(|&robots| (0..self.seeds).map(move |i| (robots, self.seed + u64::from(i))))
            .collect();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let count = |by| done.fetch_add(by, std::sync::atomic::Ordering::Relaxed) + by;
        let runs: Vec<Swap> = jobs
            .par_iter()
            // The largest last ones would otherwise be one thread's.
            .with_max_len(1)
            .filter_map(|&(robots, seed)| {
                let swap = self.swap(robots, seed, &|| progress(count(0)));
                progress(count(1));
                swap
            })
            .collect();
        Report {
            conditions: self.conditions,
            noise_m: self.noise_m,
            rows: self.robots.iter().filter_map(|&n| row(n, &runs)).collect(),
            runs,
        }
    }

    fn swap(&self, robots: u32, seed: u64, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<Swap> {
        let outcome = run(&self.scenario(robots, seed), goes_on, |_| ())?;
        let circle_m = self.circle_m.unwrap_or_else(|| circle_m(robots));
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
            mean_time_ratio: (!there.is_empty())
                .then(|| there.iter().sum::<f64>() / there.len() as f64 / free_s),
            least_gap_m: gap(clearance.bodies_m),
            overlaps: clearance.overlaps,
        })
    }

    /// Four moments of the first run with so many robots.
    #[must_use]
    pub fn picture(&self, robots: u32) -> Sheet {
        picture(&self.scenario(robots, self.seed))
    }
}

fn row(robots: u32, runs: &[Swap]) -> Option<Row> {
    let mine: Vec<&Swap> = runs.iter().filter(|run| run.robots == robots).collect();
    let first = mine.first()?;
    let least = mine.iter().filter_map(|run| run.least_gap_m);
    Some(Row {
        robots,
        circle_m: first.circle_m,
        runs: mine.len(),
        clean: mine
            .iter()
            .filter(|run| run.time_ratio.is_some() && run.overlaps == 0)
            .count(),
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
    /// Time over free time by the number of robots.
    #[must_use]
    pub fn chart(&self) -> Chart {
        let points = self
            .rows
            .iter()
            .filter_map(|row| Some([f64::from(row.robots), row.worst_time_ratio?]));
        let ends = [self.rows.first(), self.rows.last()];
        let ends = ends.map(|row| row.map_or(0.0, |row| f64::from(row.robots)));
        Chart::new(
            "Swap over a circle: time of the last robot",
            "robots",
            "time / free time",
        )
        .with(Series::points("worst of all runs", points))
        .with(Series::reference("1.5", ends.map(|x| [x, 1.5])))
    }
}
