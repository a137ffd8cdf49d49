//! Time and memory per robot in swarms of equal density, from a thousand to a million robots.
//!
//! On the grid these are the swarms of `scenarios/scale.toml` and `million.toml`: nine classes of
//! terrain, goals up to ten cells away, about nine receivers of each beacon. In the plane, boids
//! with ORCA have the same area per robot. Every beacon is encoded, transmitted, and decoded by
//! each receiver. Runs are identical on any machine; only their cost differs.

mod process;
mod report;

pub use report::{Report, Row};

use crate::experiment::Experiment;
use crate::experiment::rows::Jobs;
use crate::sweep::Value;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use process::Usage;
use serde::Serialize;
use staya_console::options;
use staya_sim::engine::{Moment, simulate};
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Overrides, Scenario};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// As in `scale.toml`.
const AREA_M2: f64 = 22.5;
/// Robot-ticks for a reliable time; smaller swarms run several times.
const WORTH: u64 = 1_000_000;

/// Space in which robots move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Ground {
    /// From cell to cell, each to its goal.
    Grid,
    /// Boids with ORCA.
    Plane,
}

/// Swarms of equal density and rising size.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Plan {
    /// Numbers of robots, rising; a million robots need some gigabytes of memory.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "1000,10000,100000")]
    pub robots: Vec<u32>,
    /// Spaces in which robots move.
    #[arg(long, value_delimiter = ',', default_value = "grid,plane")]
    pub ground: Vec<Ground>,
    /// Timed ticks, after two untimed ones.
    #[arg(long, default_value_t = 20)]
    pub ticks: u32,
    /// Seed; equal seeds give equal runs.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the rows.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-scale")]
    pub out: PathBuf,
}

/// Ticks in which tables fill and memory is allocated.
const WARM_UP: u32 = 2;

impl Default for Plan {
    fn default() -> Self {
        options::defaults()
    }
}

impl Plan {
    /// Text of the scenario with this number of robots.
    #[must_use]
    pub fn text(&self, ground: Ground, robots: u32) -> String {
        let (seed, ticks) = (self.seed, self.ticks + WARM_UP);
        let side = libm::ceil(libm::sqrt(f64::from(robots) * AREA_M2)) as u32;
        let (tick_s, ground) = match ground {
            Ground::Grid => (
                1.0,
                format!(
                    "[terrain.natural]\nwidth = {side}\nheight = {side}\nobstacles = {}\n\
                     [robots.scattered]\ncount = {robots}\ntravel = 10\n",
                    u64::from(side) * u64::from(side) * 7 / 1000
                ),
            ),
            Ground::Plane => (
                0.1,
                format!(
                    "[plane]\nradius_m = 0.2\nmax_speed_mps = 1.5\nguidance = \"boids\"\nsafety = \"orca\"\n\
                     [plane.boids]\ncrowded_m = 1.5\nclosest_m = 8\n\
                     [plane.robots.cloud]\ncount = {robots}\nfrom_m = [0, 0]\nto_m = [{side}, {side}]\n\
                     velocity_from_mps = [-1, -1]\nvelocity_to_mps = [1, 1]\n"
                ),
            ),
        };
        format!(
            "name = \"scale\"\nseed = {seed}\nticks = {ticks}\ntick_s = {tick_s:?}\n\
             [radio]\nrange_m = 8\nloss = 0.05\n{ground}"
        )
    }

    fn point(&self, point: usize) -> (Ground, u32) {
        (self.ground[point % self.ground.len()], self.robots[point / self.ground.len()])
    }

    fn row(&self, ground: Ground, robots: u32, may_continue: &dyn Fn() -> bool) -> Result<Option<Row>> {
        let scenario = Scenario::parse(&self.text(ground, robots), Path::new("scale.toml"), &Overrides::default())?;
        let runs = WORTH.div_ceil(u64::from(robots) * u64::from(self.ticks)).max(1);
        let mut row = Row::new(ground, robots);
        for _ in 0..runs {
            if !self.run(&scenario, &mut row, may_continue)? {
                return Ok(None);
            }
        }
        Ok(Some(row))
    }

    fn run(&self, scenario: &Scenario, row: &mut Row, may_continue: &dyn Fn() -> bool) -> Result<bool> {
        let mut begun = None;
        let mut is_whole = true;
        let watch = |moment: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| {
            if moment.row.tick == WARM_UP {
                begun = Some((Instant::now(), Usage::now()));
            }
            row.memory_bytes = row.memory_bytes.max(process::memory_bytes());
            is_whole &= may_continue();
            if is_whole { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let outcome = simulate(scenario, watch)?;
        if let Some((wall, usage)) = begun.filter(|_| is_whole) {
            row.ticks += u64::from(outcome.ticks.saturating_sub(WARM_UP));
            row.wall_s += wall.elapsed().as_secs_f64();
            row.processor_s = row.processor_s.zip(Usage::now().since(usage)).map(|(sum, part)| sum + part);
            row.packets_heard = outcome.packets.delivered;
            row.hash = outcome.trace_hash;
        }
        Ok(is_whole)
    }
}

impl Experiment for Plan {
    const NAME: &'static str = "scale";
    const UNIT: &'static str = "swarms";
    const ALONE: bool = true;
    const FILES: &'static str = "files";
    type Run = Row;
    type Report = Report;

    fn check(&self) -> Result<()> {
        ensure!(!self.robots.is_empty(), "no numbers of robots; give one or more");
        for robots in &self.robots {
            ensure!((1..=1_000_000).contains(robots), "{robots} robots; give 1 to 1000000");
        }
        ensure!(
            self.robots.is_sorted(),
            "the numbers of robots do not rise; what the larger ones used would be counted twice"
        );
        ensure!((1..=100_000).contains(&self.ticks), "{} ticks; give 1 to 100000", self.ticks);
        Ok(())
    }

    fn points(&self) -> usize {
        self.robots.len() * self.ground.len()
    }

    fn runs(&self) -> u32 {
        1
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let (ground, robots) = self.point(point);
        vec![
            ("ground", Value::Word(report::word(ground).into())),
            ("robots", Value::Number(f64::from(robots))),
            ("ticks", Value::Number(f64::from(self.ticks))),
            // Time and memory depend on the number of threads, which is therefore part of the plan.
            ("threads", Value::from(rayon::current_num_threads() as u32)),
        ]
    }

    fn seed(&self, _: usize, _: u32) -> u64 {
        self.seed
    }

    fn blank(&self, point: usize, _: u32) -> Row {
        let (ground, robots) = self.point(point);
        Row::new(ground, robots)
    }

    /// A timed run needs the machine for itself.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Row>>> {
        let before = process::memory_bytes();
        jobs.each(|(): &mut (), point, _| {
            let (ground, robots) = self.point(point);
            let Some(mut row) = self.row(ground, robots, &|| jobs.may_continue())? else { return Ok(None) };
            row.memory_bytes = row.memory_bytes.zip(before).map(|(after, before)| after.saturating_sub(before));
            Ok(Some(row))
        })
    }

    fn report(&self, rows: &[Vec<Row>]) -> Report {
        let mut rows = rows.concat();
        rows.sort_by_key(|row| self.ground.iter().position(|&ground| ground == row.ground));
        Report::new(self, &rows)
    }

    fn draw(&self, _: &[Vec<Row>], report: &Report, dir: &Path) -> Result<Vec<PathBuf>> {
        Ok(vec![report.write_csv(dir)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::rows::RowRetention;

    #[test]
    fn swarms_run_on_the_grid_and_in_the_plane() {
        let plan = Plan { robots: vec![20, 80], ticks: 3, ..Plan::default() };
        for ground in [Ground::Grid, Ground::Plane] {
            let scenario = |robots| {
                let text = plan.text(ground, robots);
                Scenario::parse(&text, Path::new("scale.toml"), &Overrides::default()).unwrap()
            };
            assert_eq!(scenario(20).robots.len(), 20);
            let mut row = Row::new(ground, 20);
            assert!(plan.run(&scenario(20), &mut row, &|| true).unwrap());
            assert_eq!(row.ticks, 3);
            assert!(row.wall_s > 0.0 && row.packets_heard > 0);
            assert!(!plan.run(&scenario(80), &mut row, &|| false).unwrap(), "stopped");
            assert_eq!(row.ticks, 3);
        }
    }

    #[test]
    fn rows_with_another_number_of_threads_are_not_continued() {
        let plan = Plan { robots: vec![20, 80], ticks: 3, ground: vec![Ground::Grid], ..Plan::default() };
        let dir = tempfile::tempdir().unwrap();
        let go = |threads: usize, keeping: &RowRetention| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let jobs =
                || plan.perform(&Jobs::new(&plan, &|_| true, Some((dir.path(), keeping)))).map(|rows| rows.len());
            pool.install(jobs)
        };
        assert_eq!(go(1, &RowRetention::default()).unwrap(), 2);
        let resume = RowRetention { resume: true, ..RowRetention::default() };
        assert_eq!(go(1, &resume).unwrap(), 2);
        assert!(go(2, &resume).is_err());
    }

    #[test]
    fn sizes_must_increase() {
        assert!(Plan { robots: vec![20, 10], ..Plan::default() }.check().is_err());
        assert!(Plan { robots: vec![0], ..Plan::default() }.check().is_err());
        assert!(Plan::default().check().is_ok());
    }
}
