//! What every experiment is: a plan with a check, runs made in parallel until Ctrl-C, rows, a report, pictures.
//!
//! A further experiment is a module with a plan that implements [`Experiment`], and one variant in
//! [`cli`](crate::cli).

pub mod rows;

use self::rows::{Jobs, Keeping, Record};
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

/// Largest number of runs per point: some hundred megabytes of results.
pub(crate) const MAX_RUNS: u32 = 1_000_000;

/// Is told how much is done, from any thread, and says whether to go on.
pub type GoesOn<'a> = dyn Fn(usize) -> bool + Sync + 'a;

/// A plan that can be carried out: the same plan gives the same report on any number of threads.
///
/// Its runs are those of `points()` points, `runs()` each. What is a run's own is in its row: what was given, seed, figures.
pub trait Experiment: Sized + Sync {
    /// What rows call it.
    const NAME: &'static str;
    /// What there is a number of: `runs`, `queries`.
    const UNIT: &'static str;
    /// Whether a run needs the machine for itself, since it is timed.
    const ALONE: bool = false;
    /// What JSON calls the list of files left.
    const FILES: &'static str = "pictures";
    /// What one run gives.
    type Run: Record;
    /// The numbers: fields of the JSON object, displayed as tables.
    type Report: Serialize + Display;

    /// Whether the plan can be carried out.
    ///
    /// # Errors
    /// What is out of range, and what is in it.
    fn check(&self) -> Result<()>;

    /// How many points there are.
    fn points(&self) -> usize;

    /// Runs of each point.
    fn runs(&self) -> u32;

    /// All parameters of a point, always the same ones in the same order: whatever a run depends on besides its seed. Points of
    /// equal parameters would be one.
    fn given(&self, point: usize) -> Vec<(&'static str, Value)>;

    /// The seed of a run: with it and the parameters anybody makes the run again.
    fn seed(&self, point: usize, run: u32) -> u64;

    /// A run as it is before its figures are known; rows are read into it.
    fn blank(&self, point: usize, run: u32) -> Self::Run;

    /// Makes the runs of a plan that was checked: for each point those that there are, in order, from the first one on.
    /// Most plans call [`Jobs::each`] and no more.
    ///
    /// # Errors
    /// A run that cannot be made, rows that cannot be kept.
    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Self::Run>>>;

    /// The numbers, of what rows say. Points without a run are left out.
    fn report(&self, runs: &[Vec<Self::Run>]) -> Self::Report;

    /// Leaves files in `dir` and names them.
    ///
    /// # Errors
    /// A file cannot be written.
    fn draw(&self, runs: &[Vec<Self::Run>], report: &Self::Report, dir: &Path) -> Result<Vec<PathBuf>> {
        let _ = (runs, report, dir);
        Ok(Vec::new())
    }

    /// What is to be said after a report that shows a defect.
    ///
    /// # Errors
    /// The defect.
    fn judge(report: &Self::Report) -> Result<()> {
        let _ = report;
        Ok(())
    }

    /// Runs in all.
    fn total(&self) -> usize {
        self.points() * self.runs() as usize
    }

    /// Checks the plan and makes its runs, without rows in files; see [`Experiment::perform`].
    ///
    /// # Errors
    /// A parameter out of range, a job that cannot be done.
    fn carry_out(&self, goes_on: impl Fn(usize) -> bool + Sync) -> Result<Vec<Vec<Self::Run>>> {
        self.check()?;
        self.perform(&Jobs::new(self, &goes_on, None))
    }

    /// The numbers of the whole plan.
    ///
    /// # Errors
    /// A parameter out of range, a job that cannot be done.
    fn measure(&self) -> Result<Self::Report> {
        Ok(self.report(&self.carry_out(|_| true)?))
    }

    /// The whole command: a folder for rows and pictures, the runs under a progress bar, files, the report on standard output.
    ///
    /// # Errors
    /// A parameter out of range, rows that are not to be touched, a file that cannot be written, an end before there was
    /// anything to show, a defect.
    fn command(&self, out: &Path, keeping: &Keeping, global: &Global, stop: &Stop) -> Result<Ended> {
        self.check()?;
        prepare_dir(out).context("results have no place")?;
        let since = Instant::now();
        let progress = Mutex::new((Progress::new(Self::UNIT, self.total() as u64, global), 0));
        // Several threads may tell it, and late.
        let goes_on = |done| {
            if let Ok(mut progress) = progress.lock()
                && done > progress.1
            {
                progress.1 = done;
                progress.0.set(done as u64, String::new);
            }
            !stop.is_requested()
        };
        let jobs = Jobs::new(self, &goes_on, Some((out, keeping)));
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

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Output<'a, R> {
    #[serde(flatten)]
    report: &'a R,
    interrupted: bool,
    wall_seconds: f64,
    #[serde(flatten)]
    files: BTreeMap<&'static str, &'a [PathBuf]>,
}

/// How an experiment went.
#[derive(Debug)]
struct Course {
    unit: &'static str,
    done: usize,
    /// Those that had been done before.
    found: u64,
    total: usize,
    /// Wall time of the runs.
    wall_seconds: f64,
    files: Vec<PathBuf>,
    /// Rows, what their columns are, means.
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

/// Refuses a number of runs that nothing can be made of.
pub(crate) fn check_runs(runs: u32, what: &str) -> Result<()> {
    match runs {
        0 => bail!("0 runs; make 1 or more {what}"),
        1..=MAX_RUNS => Ok(()),
        _ => bail!("{runs} runs; make at most {MAX_RUNS} {what}"),
    }
}

/// A value with so many decimals, `-` for a missing one; it can be padded.
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
    fn an_early_end_is_told() {
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
