//! Results of the scale experiment.

use super::{Ground, Plan};
use crate::experiment::Maybe;
use crate::experiment::rows::{Each, Record};
use serde::Serialize;
use staya_sim::record::{Error, write_atomically};
use std::fmt::{self, Display, Formatter, Write as _};
use std::path::{Path, PathBuf};

const TICK_S: f64 = 0.1;

/// Measurements of one swarm.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Space in which robots moved.
    pub ground: Ground,
    /// Number of robots.
    pub robots: u32,
    /// Timed ticks of all runs.
    pub ticks: u64,
    /// Wall time of these ticks, seconds.
    pub wall_s: f64,
    /// Processor time of all threads, seconds; `None` if unknown.
    pub processor_s: Option<f64>,
    /// Resident memory beyond that before the first swarm; `None` if unknown.
    pub memory_bytes: Option<u64>,
    /// Packets decoded in a run.
    pub packets_heard: u64,
    /// Trace hash.
    pub hash: u64,
}

impl Record for Row {
    fn figures(&mut self, each: &mut Each<'_>) {
        each("timed_ticks", "ticks that were timed, over all runs", &mut self.ticks);
        each("wall_s", "wall time of them", &mut self.wall_s);
        each("processor_s", "processor time of all threads; empty: not known", &mut self.processor_s);
        each("memory_bytes", "resident memory beyond the program's; empty: not known", &mut self.memory_bytes);
        each("packets_heard", "packets decoded in a run", &mut self.packets_heard);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

impl Row {
    pub(super) const fn new(ground: Ground, robots: u32) -> Self {
        let (processor_s, memory_bytes) = (Some(0.0), None);
        Self { ground, robots, ticks: 0, wall_s: 0.0, processor_s, memory_bytes, packets_heard: 0, hash: 0 }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    pub ground: Ground,
    pub robots: u32,
    pub ticks: u64,
    pub wall_us: f64,
    /// Processor time of all threads per robot and tick, microseconds; `null` if unknown.
    pub processor_us: Option<f64>,
    /// Ratio to the smallest swarm of processor time (wall time if unknown).
    pub ratio: f64,
    pub tick_s: f64,
    /// Whether a tick takes at most 0.1 s.
    pub is_real_time: bool,
    /// Resident memory per robot, bytes; mostly the program's in small swarms.
    pub bytes: Option<f64>,
    pub heard: f64,
    pub trace_hash: String,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the runs.
    pub seed: u64,
    /// Number of threads.
    pub threads: usize,
    /// Rows by ground, in ascending order of robots.
    pub lines: Vec<Line>,
}

impl Report {
    pub(super) fn new(plan: &Plan, rows: &[Row]) -> Self {
        let cost_us = |row: &Row| {
            let robot_ticks = f64::from(row.robots) * row.ticks as f64;
            let us = |seconds: f64| seconds * 1e6 / robot_ticks;
            (us(row.wall_s), row.processor_s.map(us))
        };
        let line = |row: &Row| {
            let (wall_us, processor_us) = cost_us(row);
            let smallest =
                rows.iter().find(|other| other.ground == row.ground).map_or((wall_us, processor_us), cost_us);
            let tick_s = wall_us * f64::from(row.robots) / 1e6;
            let ticks = f64::from(plan.ticks + super::WARM_UP);
            Line {
                ground: row.ground,
                robots: row.robots,
                ticks: row.ticks,
                wall_us,
                processor_us,
                ratio: processor_us.zip(smallest.1).map_or(wall_us / smallest.0, |(own, first)| own / first),
                tick_s,
                is_real_time: tick_s <= TICK_S,
                bytes: row.memory_bytes.map(|bytes| bytes as f64 / f64::from(row.robots)),
                heard: row.packets_heard as f64 / (f64::from(row.robots) * ticks),
                trace_hash: format!("{:016x}", row.hash),
            }
        };
        Self { seed: plan.seed, threads: rayon::current_num_threads(), lines: rows.iter().map(line).collect() }
    }

    /// Writes `scale.csv` into `dir` and returns its path.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_csv(&self, dir: &Path) -> Result<PathBuf, Error> {
        let mut text = String::from(
            "ground,robots,threads,ticks,wall_us,processor_us,ratio,tick_s,bytes_per_robot,packets_heard,trace_hash\n",
        );
        let known = |value: Option<f64>, decimals: usize| value.map_or(String::new(), |v| format!("{v:.decimals$}"));
        for line in &self.lines {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{:.4},{},{:.3},{:.5},{},{:.3},{}",
                word(line.ground),
                line.robots,
                self.threads,
                line.ticks,
                line.wall_us,
                known(line.processor_us, 4),
                line.ratio,
                line.tick_s,
                known(line.bytes, 0),
                line.heard,
                line.trace_hash,
            );
        }
        let path = dir.join("scale.csv");
        write_atomically(&path, text.as_bytes())?;
        Ok(path)
    }
}

pub(super) const fn word(ground: Ground) -> &'static str {
    match ground {
        Ground::Grid => "grid",
        Ground::Plane => "plane",
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "what a robot costs, {} threads, seed {}", self.threads, self.seed)?;
        writeln!(f, "(us per robot and tick; ratio: processor time over that of the smallest swarm)\n")?;
        writeln!(
            f,
            "{:<6} {:>8} {:>8} {:>8} {:>10} {:>6} {:>10} {:>9} {:>8}",
            "ground", "robots", "heard", "wall us", "processor", "ratio", "tick s", "10 Hz", "bytes"
        )?;
        for line in &self.lines {
            writeln!(
                f,
                "{:<6} {:>8} {:>8.2} {:>8.3} {:>10} {:>6.2} {:>10.4} {:>9} {:>8}",
                word(line.ground),
                line.robots,
                line.heard,
                line.wall_us,
                Maybe(line.processor_us, 3),
                line.ratio,
                line.tick_s,
                if line.is_real_time { "yes" } else { "no" },
                Maybe(line.bytes, 0),
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_per_robot_and_tick_and_relative_to_the_smallest_swarm() {
        let row = |robots, wall_s, processor_s| Row {
            ticks: 10,
            wall_s,
            processor_s,
            memory_bytes: Some(u64::from(robots) * 3000),
            ..Row::new(Ground::Grid, robots)
        };
        let rows = [row(1000, 0.01, Some(0.02)), row(100_000, 2.0, Some(3.0))];
        let report = Report::new(&Plan::default(), &rows);
        let [small, large] = &report.lines[..] else { panic!("two lines") };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(near(small.wall_us, 1.0) && near(small.ratio, 1.0) && small.is_real_time);
        assert!(near(large.wall_us, 2.0) && near(large.ratio, 1.5) && near(large.tick_s, 0.2) && !large.is_real_time);
        assert_eq!(large.bytes, Some(3000.0));
        let unknown = Report::new(&Plan::default(), &[row(1000, 0.01, None), row(2000, 0.04, None)]);
        assert!(near(unknown.lines[1].ratio, 2.0));
        let dir = tempfile::tempdir().unwrap();
        let text = std::fs::read_to_string(report.write_csv(dir.path()).unwrap()).unwrap();
        assert_eq!(text.lines().count(), 3);
        assert!(text.contains("grid,100000,"));
    }
}
