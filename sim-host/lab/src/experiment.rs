//! Common parts of all experiments: a checked plan, parallel runs, rows, a report, pictures.
//!
//! A new experiment is a plan that implements [`Experiment`], and a variant in [`cli`](crate::cli).

pub mod rows;

use self::rows::{Jobs, Record, RowRetention};
use crate::sweep::Value;
use anyhow::{Context as _, Result, bail};
use serde::Serialize;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_sim::record::prepare_dir;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

/// Some hundred megabytes of results.
pub(crate) const MAX_RUNS: u32 = 1_000_000;

/// Progress callback: takes the number of finished runs, on any thread; returns whether to
/// continue.
pub type ProgressCallback<'a> = dyn Fn(usize) -> bool + Sync + 'a;

/// A plan of `points()` points with `runs()` runs each. Equal plans give equal reports on any
/// number of threads.
pub trait Experiment: Sized + Sync {
    /// Name of the experiment in rows.
    const NAME: &'static str;
    /// Plural noun for the runs: `runs`, `queries`.
    const UNIT: &'static str;
    /// Whether a run needs the machine for itself because it is timed.
    const ALONE: bool = false;
    /// JSON key of the list of written files.
    const FILES: &'static str = "pictures";
    /// Result of one run.
    type Run: Record;
    /// Results of the experiment: serialised as a JSON object, displayed as tables.
    type Report: Serialize + Display;

    /// Checks the plan.
    ///
    /// # Errors
    /// Names the value that is out of range, and the range.
    fn check(&self) -> Result<()>;

    /// Number of points.
    fn points(&self) -> usize;

    /// Runs per point.
    fn runs(&self) -> u32;

    /// All parameters of a point besides the seeds, in a fixed order; no two points have equal
    /// ones. Destructure the plan, so that a new field cannot be forgotten.
    fn given(&self, point: usize) -> Vec<(&'static str, Value)>;

    /// Seed of a run; with the parameters, it suffices to repeat the run.
    fn seed(&self, point: usize, run: u32) -> u64;

    /// A run without figures, to read a row into.
    fn blank(&self, point: usize, run: u32) -> Self::Run;

    /// Makes the runs of a checked plan, usually by [`Jobs::each`] only. Returns the runs of each
    /// point from the first one, in order and without gaps.
    ///
    /// # Errors
    /// A run fails, or a row cannot be written.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Self::Run>>>;

    /// Computes the report, without points that have no runs.
    fn report(&self, runs: &[Vec<Self::Run>]) -> Self::Report;

    /// Writes pictures or other files to `dir` and returns their paths.
    ///
    /// # Errors
    /// A file cannot be written.
    fn draw(&self, runs: &[Vec<Self::Run>], report: &Self::Report, dir: &Path) -> Result<Vec<PathBuf>> {
        let _ = (runs, report, dir);
        Ok(Vec::new())
    }

    /// Turns a report that shows a defect into an error after it was printed.
    ///
    /// # Errors
    /// The defect.
    fn judge(report: &Self::Report) -> Result<()> {
        let _ = report;
        Ok(())
    }

    /// Number of runs of all points.
    fn total(&self) -> usize {
        self.points() * self.runs() as usize
    }

    /// Checks the plan and makes its runs without rows; see [`Experiment::perform`].
    ///
    /// # Errors
    /// A parameter is out of range, or a run fails.
    fn carry_out(&self, may_continue: impl Fn(usize) -> bool + Sync) -> Result<Vec<Vec<Self::Run>>> {
        self.check()?;
        self.perform(&Jobs::new(self, &may_continue, None))
    }

    /// Makes all runs and computes the report.
    ///
    /// # Errors
    /// A parameter is out of range, or a run fails.
    fn measure(&self) -> Result<Self::Report> {
        Ok(self.report(&self.carry_out(|_| true)?))
    }

    /// Executes the experiment's command: makes the runs under a progress bar, writes rows and
    /// pictures to a folder, and prints the report.
    ///
    /// # Errors
    /// A parameter is out of range, existing rows must not be replaced, a file cannot be written,
    /// the command was stopped before any result, or the report shows a defect.
    fn command(&self, out: &Path, keeping: &RowRetention, global: &Global, stop: &Stop) -> Result<Ended> {
        self.check()?;
        prepare_dir(out).context("results have no place")?;
        let since = Instant::now();
        let progress = Mutex::new((Progress::new(Self::UNIT, self.total() as u64, global), 0));
        // Calls of several threads may arrive out of order.
        let may_continue = |done| {
            if let Ok(mut progress) = progress.lock()
                && done > progress.1
            {
                progress.1 = done;
                progress.0.set(done as u64, String::new);
            }
            !stop.is_requested()
        };
        let jobs = Jobs::new(self, &may_continue, Some((out, keeping)));
        jobs.clear()?;
        let runs = self.perform(&jobs);
        if let Ok(progress) = progress.lock() {
            progress.0.finish();
        }
        let runs = runs?;
        let rows = jobs.course().unwrap_or_default();
        let mut course = Course {
            unit: Self::UNIT,
            done: (rows.found + rows.done) as usize,
            found: rows.found,
            total: rows.runs as usize,
            wall_seconds: since.elapsed().as_secs_f64(),
            files: Vec::new(),
            rows: Vec::new(),
        };
        if course.done == 0 {
            bail!("stopped before any of the {} was done", Self::UNIT);
        }
        let mut text = String::new();
        if !keeping.shard.is_whole() {
            writeln!(text, "shard {}; with all shards in {}, --resume reports", keeping.shard, out.display())?;
            course.last_word(&mut text, out)?;
            print(&text)?;
            return Ok(Ended::by(stop));
        }
        if rows.missing() == 0 {
            course.rows = jobs.write()?;
        }
        let report = self.report(&runs);
        course.files = self.draw(&runs, &report, out)?;
        if global.json {
            print_json(&Output {
                report: &report,
                interrupted: stop.is_requested(),
                wall_seconds: course.wall_seconds,
                files: BTreeMap::from([(Self::FILES, &course.files[..]), ("tables", &course.rows)]),
            })?;
        } else {
            write!(text, "{report}")?;
            course.last_word(&mut text, out)?;
            print(&text)?;
        }
        Self::judge(&report)?;
        Ok(Ended::by(stop))
    }
}

#[derive(Debug, Serialize)]
struct Output<'a, R> {
    #[serde(flatten)]
    report: &'a R,
    interrupted: bool,
    wall_seconds: f64,
    #[serde(flatten)]
    files: BTreeMap<&'static str, &'a [PathBuf]>,
}

#[derive(Debug)]
struct Course {
    unit: &'static str,
    done: usize,
    found: u64,
    total: usize,
    wall_seconds: f64,
    files: Vec<PathBuf>,
    rows: Vec<PathBuf>,
}

impl Course {
    fn last_word(&self, text: &mut String, out: &Path) -> fmt::Result {
        let (done, total) = (self.done, self.total);
        text.push('\n');
        if done < total {
            write!(text, "stopped early, after {done} of {total} (--resume does the others): ")?;
        }
        write!(text, "{done} {} in {:.1} s", self.unit, self.wall_seconds)?;
        if self.found > 0 {
            write!(text, ", {} of them before", self.found)?;
        }
        text.push('\n');
        let files = self.files.len() + self.rows.len();
        match files {
            0 => Ok(()),
            _ => writeln!(text, "{files} files in {}", out.display()),
        }
    }
}

pub(crate) fn check_runs(runs: u32, what: &str) -> Result<()> {
    match runs {
        0 => bail!("0 runs; make 1 or more {what}"),
        1..=MAX_RUNS => Ok(()),
        _ => bail!("{runs} runs; make at most {MAX_RUNS} {what}"),
    }
}

/// A value with a number of decimals, or `-`; supports padding.
pub(crate) struct Maybe(pub Option<f64>, pub usize);

impl Display for Maybe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, decimals) = *self;
        match value {
            Some(value) => f.pad(&format!("{value:.decimals$}")),
            None => f.pad("-"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn early_end_is_reported() {
        let mut course = Course {
            unit: "landscapes",
            done: 7,
            found: 2,
            total: 9,
            wall_seconds: 1.25,
            files: vec![PathBuf::from("out/x/a.png")],
            rows: Vec::new(),
        };
        let word = |course: &Course| {
            let mut text = String::new();
            course.last_word(&mut text, Path::new("out/x")).unwrap();
            text
        };
        let early = "\nstopped early, after 7 of 9 (--resume does the others): 7 landscapes in 1.2 s, 2 of them before\n\
                     1 files in out/x\n";
        assert_eq!(word(&course), early);
        course.done = 9;
        assert!(word(&course).starts_with("\n9 landscapes"));
    }
}
