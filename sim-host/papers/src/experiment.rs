//! What every experiment is: a plan with a check, jobs done in parallel until Ctrl-C, a report, pictures.
//!
//! A further experiment is a module with a plan that implements [`Experiment`], and one variant in
//! [`cli`](crate::cli).

use anyhow::{Context as _, Result, bail};
use serde::Serialize;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_sim::record::prepare_dir;
use staya_sweep::jobs;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

/// Largest number of runs per point: some hundred megabytes of results.
pub(crate) const MAX_RUNS: u32 = 1_000_000;

/// Is told how much is done, from any thread, and says whether to go on.
pub type GoesOn<'a> = dyn Fn(usize) -> bool + Sync + 'a;

/// A plan that can be carried out: the same plan gives the same report on any number of threads.
pub trait Experiment {
    /// What there is a number of: `runs`, `landscapes`.
    const UNIT: &'static str;
    /// What JSON calls the list of files left.
    const FILES: &'static str = "pictures";
    /// What one job gives.
    type Run;
    /// The numbers: fields of the JSON object, displayed as tables.
    type Report: Serialize + Display;

    /// Whether the plan can be carried out.
    ///
    /// # Errors
    /// What is out of range, and what is in it.
    fn check(&self) -> Result<()>;

    /// Jobs in all.
    fn total(&self) -> usize;

    /// Does the jobs of a plan that was checked: for each point of the figures its runs in order. Stopped early, what
    /// is done so far is returned.
    ///
    /// # Errors
    /// A job that cannot be done.
    fn perform(&self, goes_on: &GoesOn<'_>) -> Result<Vec<Vec<Self::Run>>>;

    /// The numbers. Points without a run are left out.
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

    /// Checks the plan and does the jobs; see [`Experiment::perform`].
    ///
    /// # Errors
    /// A parameter out of range, a job that cannot be done.
    fn carry_out(&self, goes_on: impl Fn(usize) -> bool + Sync) -> Result<Vec<Vec<Self::Run>>> {
        self.check()?;
        self.perform(&goes_on)
    }

    /// The numbers of the whole plan.
    ///
    /// # Errors
    /// A parameter out of range, a job that cannot be done.
    fn measure(&self) -> Result<Self::Report> {
        Ok(self.report(&self.carry_out(|_| true)?))
    }

    /// The whole command: a folder for the files (if it leaves any), the jobs under a progress bar, files, the report on standard
    /// output.
    ///
    /// # Errors
    /// A parameter out of range, a file that cannot be written, an end before there was anything to show, a defect.
    fn command(&self, out: Option<&Path>, global: &Global, stop: &Stop) -> Result<Ended> {
        self.check()?;
        if let Some(out) = out {
            prepare_dir(out).context("pictures have no place")?;
        }
        let since = Instant::now();
        let progress = Mutex::new((Progress::new(Self::UNIT, self.total() as u64, global), 0));
        // Several threads may tell it, and late.
        let runs = self.perform(&|done| {
            if let Ok(mut progress) = progress.lock()
                && done > progress.1
            {
                progress.1 = done;
                progress.0.set(done as u64, String::new);
            }
            !stop.is_requested()
        });
        if let Ok((progress, _)) = progress.into_inner() {
            progress.finish();
        }
        let runs = runs?;
        let mut course = Course {
            unit: Self::UNIT,
            done: runs.iter().map(Vec::len).sum(),
            total: self.total(),
            wall_seconds: since.elapsed().as_secs_f64(),
            files: Vec::new(),
        };
        if course.done == 0 {
            bail!("stopped before any of the {} was done", Self::UNIT);
        }
        let report = self.report(&runs);
        if let Some(out) = out {
            course.files = self.draw(&runs, &report, out)?;
        }
        if global.json {
            print_json(&Output {
                report: &report,
                interrupted: stop.is_requested(),
                wall_seconds: course.wall_seconds,
                files: BTreeMap::from([(Self::FILES, course.files.as_slice())]),
            })?;
        } else {
            let mut text = report.to_string();
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
    total: usize,
    /// Wall time of the jobs.
    wall_seconds: f64,
    files: Vec<PathBuf>,
}

impl Course {
    fn last_word(&self, text: &mut String, out: Option<&Path>) -> fmt::Result {
        let (done, total) = (self.done, self.total);
        text.push('\n');
        if done < total {
            write!(text, "stopped early, after {done} of {total}: ")?;
        }
        writeln!(text, "{done} {} in {:.1} s", self.unit, self.wall_seconds)?;
        match out {
            Some(out) if !self.files.is_empty() => {
                writeln!(text, "{} files in {}", self.files.len(), out.display())
            }
            _ => Ok(()),
        }
    }
}

/// Does the jobs `0..count` in parallel, as [`staya_sweep::jobs`] does, and returns their results in order.
///
/// `batch` jobs, some tenths of a second of work, are one step: then `goes_on` is told how many are done; when it answers
/// `false`, what is done so far is returned, which is always a beginning of the whole. A job must not depend on what its scratch
/// memory holds.
///
/// # Errors
/// That of the first job that fails.
pub(crate) fn in_parallel<S: Default, T: Send>(
    count: usize,
    batch: usize,
    goes_on: &GoesOn<'_>,
    job: impl Fn(&mut S, usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    if !goes_on(0) {
        return Ok(Vec::new());
    }
    let mut parts: Vec<Option<Result<Vec<T>>>> = (0..count.div_ceil(batch)).map(|_| None).collect();
    let mut done = 0;
    let work = |scratch: &mut S, part: usize| {
        let jobs = part * batch..((part + 1) * batch).min(count);
        jobs.map(|number| job(scratch, number)).collect()
    };
    jobs::each(parts.len(), work, |part, results: Result<Vec<T>>| {
        let is_over = match &results {
            Ok(results) => {
                done += results.len();
                !goes_on(done)
            }
            Err(_) => true,
        };
        parts[part] = Some(results);
        if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let parts: Vec<Vec<T>> = parts.into_iter().flatten().collect::<Result<_>>()?;
    Ok(parts.into_iter().flatten().collect())
}

/// Does `runs` runs of each of the points `0..points`, all points in step, so that an early end leaves about equally many of each; see
/// [`in_parallel`]. A job is told its point and the number of its run.
///
/// # Errors
/// That of the first job that fails.
pub(crate) fn by_point<S: Default, T: Send>(
    points: usize,
    runs: u32,
    batch: usize,
    goes_on: &GoesOn<'_>,
    job: impl Fn(&mut S, usize, u32) -> Result<T> + Sync,
) -> Result<Vec<Vec<T>>> {
    let done = in_parallel(points * runs as usize, batch, goes_on, |scratch, number| {
        job(scratch, number % points, (number / points) as u32)
    })?;
    let mut by_point: Vec<Vec<T>> = (0..points).map(|_| Vec::new()).collect();
    for (number, run) in done.into_iter().enumerate() {
        by_point[number % points].push(run);
    }
    Ok(by_point)
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
    fn jobs_come_back_in_order_and_stop_between_batches() {
        let double = |(): &mut (), job| Ok(2 * job);
        let all = in_parallel(1000, 16, &|_| true, double).unwrap();
        assert_eq!(all, (0..1000).map(|job| 2 * job).collect::<Vec<_>>());
        let at_once = 3 * rayon::current_num_threads();
        let some = in_parallel(3 * at_once, 3, &|done| done <= at_once, double).unwrap();
        // What was under way when it was told to stop is finished.
        assert!((at_once + 3..=2 * at_once).contains(&some.len()), "{}", some.len());
        assert!(some.iter().zip(0..).all(|(result, job)| *result == 2 * job));
        let none = in_parallel(1000, 16, &|_| false, double).unwrap();
        assert!(none.is_empty());
    }

    #[test]
    fn failure_of_a_job_is_the_result() {
        let job = |(): &mut (), job| if job == 300 { bail!("{job}") } else { Ok(()) };
        let error = in_parallel(1000, 16, &|_| true, job).unwrap_err();
        assert_eq!(error.to_string(), "300");
    }

    #[test]
    fn points_advance_together() {
        let job = |(): &mut (), point, run| Ok((point, run));
        let all = by_point(2, 3, 1, &|_| true, job).unwrap();
        assert_eq!(all, [[(0, 0), (0, 1), (0, 2)], [(1, 0), (1, 1), (1, 2)]]);
    }

    #[test]
    fn an_early_end_is_told() {
        let mut course = Course {
            unit: "landscapes",
            done: 7,
            total: 9,
            wall_seconds: 1.25,
            files: vec![PathBuf::from("out/x/a.png")],
        };
        let word = |course: &Course| {
            let mut text = String::new();
            course.last_word(&mut text, Some(Path::new("out/x"))).unwrap();
            text
        };
        let early = "\nstopped early, after 7 of 9: 7 landscapes in 1.2 s\n1 files in out/x\n";
        assert_eq!(word(&course), early);
        course.done = 9;
        assert!(word(&course).starts_with("\n9 landscapes"));
    }
}
