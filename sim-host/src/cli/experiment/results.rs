//! What experiments say at their end.

use crate::cli::{Global, print, print_json};
use anyhow::Result;
use serde::Serialize;
use std::fmt::{self, Write as _};
use std::path::{Path, PathBuf};

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
