//! What experiments say at their end.

use anyhow::{Result, bail};
use serde::Serialize;
use staya_console::{Global, Progress, Stop, print, print_json};
use std::fmt::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

/// How an experiment went.
#[derive(Clone, Debug)]
pub struct Course<'a> {
    /// What was done so many times: landscapes, runs.
    pub unit: &'static str,
    /// How many of them.
    pub done: usize,
    /// How many were planned.
    pub total: usize,
    /// Whether Ctrl-C ended it early.
    pub interrupted: bool,
    /// Wall time of everything but the pictures, seconds.
    pub wall_seconds: f64,
    /// Where pictures went.
    pub out: &'a Path,
    /// Files written.
    pub pictures: Vec<PathBuf>,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Output<'a, R> {
    #[serde(flatten)]
    report: &'a R,
    interrupted: bool,
    wall_seconds: f64,
    pictures: &'a [PathBuf],
}

/// An experiment under way, timed from its making on.
#[derive(Debug)]
pub struct Work<'a> {
    /// What is done so many times: landscapes, runs.
    pub unit: &'static str,
    /// How many of them.
    pub total: usize,
    /// Where pictures will go.
    pub out: &'a Path,
    since: Instant,
}

impl<'a> Work<'a> {
    /// Begins now.
    #[must_use]
    pub fn new(unit: &'static str, total: usize, out: &'a Path) -> Self {
        Self {
            unit,
            total,
            out,
            since: Instant::now(),
        }
    }

    /// Does it under a progress bar. `work` gets a function that it tells how much is done and that says whether to go on; `done` says how much its
    /// results hold.
    ///
    /// # Errors
    /// Those of `work`, and an end before there was anything to show.
    pub fn carry_out<T, E: Into<anyhow::Error>>(
        self,
        global: &Global,
        stop: &Stop,
        work: impl FnOnce(&(dyn Fn(usize) -> bool + Sync)) -> Result<T, E>,
        done: impl FnOnce(&T) -> usize,
    ) -> Result<(T, Course<'a>)> {
        let progress = Mutex::new((Progress::new(self.unit, self.total as u64, global), 0));
        // Several threads may tell it, and late.
        let results = work(&|done| {
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
        let results = results.map_err(Into::into)?;
        let done = done(&results);
        if done == 0 {
            bail!("stopped before any of the {} was done", self.unit);
        }
        let course = Course {
            unit: self.unit,
            done,
            total: self.total,
            interrupted: stop.is_requested(),
            wall_seconds: self.since.elapsed().as_secs_f64(),
            out: self.out,
            pictures: Vec::new(),
        };
        Ok((results, course))
    }
}

impl Course<'_> {
    /// Prints the report, as JSON or as tables with a last word.
    ///
    /// # Errors
    /// Standard output is closed or full.
    pub fn tell<R: Serialize>(
        &self,
        report: &R,
        tables: impl FnOnce(&R) -> Result<String, fmt::Error>,
        global: &Global,
    ) -> Result<()> {
        if global.json {
            return print_json(&Output {
                report,
                interrupted: self.interrupted,
                wall_seconds: self.wall_seconds,
                pictures: &self.pictures,
            });
        }
        let mut text = tables(report)?;
        self.last_word(&mut text)?;
        print(&text)
    }

    fn last_word(&self, text: &mut String) -> fmt::Result {
        let (done, total) = (self.done, self.total);
        text.push('\n');
        if done < total {
            write!(text, "stopped early, after {done} of {total}: ")?;
        }
        writeln!(text, "{done} {} in {:.1} s", self.unit, self.wall_seconds)?;
        let (count, out) = (self.pictures.len(), self.out.display());
        if count == 0 {
            return Ok(());
        }
        writeln!(text, "{count} files in {out}")
    }
}

/// `-` for a missing value.
pub fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| String::from("-"), |x| format!("{x:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_early_end_is_told() {
        let mut course = Course {
            unit: "landscapes",
            done: 7,
            total: 9,
            interrupted: true,
            wall_seconds: 1.25,
            out: Path::new("out/x"),
            pictures: vec![PathBuf::from("out/x/a.png")],
        };
        let word = |course: &Course<'_>| {
            let mut text = String::new();
            course.last_word(&mut text).unwrap();
            text
        };
        let early = "\nstopped early, after 7 of 9: 7 landscapes in 1.2 s\n1 files in out/x\n";
        assert_eq!(word(&course), early);
        course.done = 9;
        assert!(word(&course).starts_with("\n9 landscapes"));
    }
}
