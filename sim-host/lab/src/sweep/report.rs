//! Carries out a plan and reports it: rows, summaries of points, verdicts, pictures.

use crate::sweep::aggregate;
use crate::sweep::gain::{self, Gain, gains};
use crate::sweep::merge::Merged;
use crate::sweep::plan::{Judgement, Plan, Verdict};
use crate::sweep::record::{RECORD, Record};
use crate::sweep::run::{draw, perform};
use crate::sweep::shard::{Existing, files, perform_shard};
use crate::sweep::value::{Point, short};
use crate::sweep::{Shard, pictures, schema};
use anyhow::{Result, ensure};
use serde::Serialize;
use staya_console::say;
use staya_console::{Global, Progress, Stop, print, print_json};
use staya_sim::record::{make_dir, write_atomically};
use staya_sim::shown::Shown as _;
use staya_stats::Summary;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Merged rows, in the folder of results.
pub const ROWS: &str = "rows.csv";
const AGGREGATES: &str = "aggregates.csv";
const SCHEMA: &str = "rows.schema.json";
/// Whether the last complete run fulfils what the plan accepts: a first line, then the conditions.
pub const VERDICT: &str = "verdict.txt";
/// Most points in the table.
const SHOWN: usize = 40;
/// Most measures in the table of a plan that does not choose them.
const FIGURES: usize = 4;

/// Results of a plan.
#[derive(Debug, Serialize)]
pub struct Report<'a> {
    plan: &'a str,
    #[serde(skip_serializing_if = "str::is_empty")]
    title: &'a str,
    fingerprint: String,
    /// Number of runs of the plan, or of the shard.
    pub runs: u64,
    /// Runs that had rows before.
    pub done_before: u64,
    /// Runs made by this process.
    pub done_now: u64,
    /// Rows in two files, identically.
    pub doubles: u64,
    interrupted: bool,
    wall_seconds: Option<f64>,
    points: Vec<PointFigures>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    gains: Vec<Gain>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    verdicts: Vec<Verdict>,
    files: Vec<PathBuf>,
    #[serde(skip)]
    out: &'a Path,
    #[serde(skip)]
    source: &'a Plan,
}

#[derive(Debug, Serialize)]
struct PointFigures {
    runs: usize,
    axes: BTreeMap<String, String>,
    figures: BTreeMap<String, Option<Summary>>,
    /// Values of the paper.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    reference: BTreeMap<String, f64>,
    #[serde(skip)]
    values: Vec<String>,
}

impl<'a> Report<'a> {
    /// A report without results.
    #[must_use]
    pub fn new(plan: &'a Plan, out: &'a Path) -> Self {
        Self {
            plan: &plan.name,
            title: &plan.title,
            fingerprint: plan.fingerprint(),
            runs: 0,
            done_before: 0,
            done_now: 0,
            doubles: 0,
            interrupted: false,
            wall_seconds: None,
            points: Vec::new(),
            gains: Vec::new(),
            verdicts: Vec::new(),
            files: Vec::new(),
            out,
            source: plan,
        }
    }

    /// Makes the missing runs of a shard, and reports them if all runs of the plan have rows.
    ///
    /// # Errors
    /// Rows are inconsistent or must not be replaced, or a file cannot be written.
    pub fn make(
        plan: &'a Plan,
        out: &'a Path,
        (shard, existing): (Shard, Existing),
        global: &Global,
        stop: &Stop,
    ) -> Result<Self> {
        let since = Instant::now();
        let mut bar = Progress::new("runs", 0, global);
        let progress = |done, total| {
            bar.of(total);
            bar.set(done, String::new);
        };
        let may_continue = || !stop.is_requested();
        let job = |run| perform(plan, run, may_continue);
        let course = perform_shard(plan, shard, out, existing, job, progress);
        bar.finish();
        let course = course?;
        if course.torn > 0 {
            say(&format!("{} bytes of a row that had been cut off are gone; its run was done again", course.torn));
        }
        if let Some((count, why)) = &course.impossible {
            say(&format!("{count} runs are impossible and have no figures; the first: {why}"));
        }
        let mut report = Self::new(plan, out);
        (report.runs, report.done_before, report.done_now) = (course.runs, course.found, course.done);
        report.interrupted = stop.is_requested();
        if shard.is_whole() && course.missing() == 0 {
            report.take(&Merged::read(plan, &files(out)?)?)?;
        }
        report.wall_seconds = Some(since.elapsed().as_secs_f64());
        Ok(report)
    }

    /// Whether runs are missing.
    #[must_use]
    pub const fn is_partial(&self) -> bool {
        self.done_before + self.done_now < self.runs
    }

    /// Computes the results from all rows and writes their files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn take(&mut self, merged: &Merged) -> Result<()> {
        let (plan, out) = (self.source, self.out);
        make_dir(out)?;
        let points = aggregate::points(plan, merged);
        let aggregates = aggregate::text(plan, &points);
        for (name, text) in [(ROWS, merged.text(plan)), (SCHEMA, schema(plan)), (AGGREGATES, aggregates)] {
            write_atomically(&out.join(name), text.as_bytes())?;
            self.files.push(out.join(name));
        }
        for plot in pictures::plots(plan) {
            self.files.extend(pictures::draw(plan, merged, &plot, &out.join("plots"))?);
        }
        self.files.extend(pictures::histograms(plan, merged, &out.join("plots"))?);
        for run in plan.pictured().map(|point| point * plan.seeds()) {
            let words = plan.values_of(run);
            // Files without their folders.
            let words: Vec<&str> = words.iter().filter_map(|word| word.rsplit('/').next()).collect();
            let name = words.join("-");
            let name = name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "-");
            self.files.extend(draw(plan, run, &out.join("pictures").join(format!("{}-{name}", plan.name)))?);
        }
        self.gains = plan.gains.iter().flat_map(|table| gains(plan, &points, table)).collect();
        self.verdicts = plan.accept.iter().map(|accept| accept.judge(plan, &points)).collect();
        self.verdicts.extend(plan.fits.iter().map(|fit| fit.judge(&points)));
        if !self.verdicts.is_empty() {
            let record = Record::new(plan, &self.verdicts);
            for (name, text) in [(VERDICT, self.verdict()), (RECORD, record.text())] {
                write_atomically(&out.join(name), text.as_bytes())?;
                self.files.push(out.join(name));
            }
        }
        let value = |point: &Point, name: &str| plan.reference.as_ref()?.value(&point.values, name);
        let reference = |point: &Point| {
            let values = plan.measures().iter().filter_map(|name| Some((name.clone(), value(point, name)?)));
            values.collect()
        };
        let of = |point: &Point| PointFigures {
            reference: reference(point),
            runs: point.runs,
            axes: plan.axes().map(str::to_owned).zip(point.values.iter().cloned()).collect(),
            figures: plan.measures().iter().cloned().zip(point.figures.iter().copied()).collect(),
            values: point.values.clone(),
        };
        self.points = points.iter().map(of).collect();
        Ok(())
    }

    /// A first line, then a line for each condition.
    fn verdict(&self) -> String {
        let mut text = match (self.broken(), self.undecided()) {
            (0, 0) => "holds\n".to_owned(),
            (0, few) => format!("{few} of {} conditions need more runs\n", self.verdicts.len()),
            (broken, _) => format!("{broken} of {} conditions are not as expected\n", self.verdicts.len()),
        };
        for verdict in &self.verdicts {
            let Verdict { claim, condition, judgement, measured, fails, .. } = verdict;
            let word = if verdict.is_expected() { judgement.to_string() } else { judgement.to_string().to_uppercase() };
            let claim = if claim.is_empty() { String::new() } else { format!("{claim}: ") };
            text += &format!("  {claim}{condition}: {word}, {measured}");
            text += &fails.as_ref().map_or(String::new(), |why| format!(" (known: {why})"));
            text.push('\n');
        }
        text
    }

    fn count(&self, is_counted: impl Fn(&Verdict) -> bool) -> usize {
        self.verdicts.iter().filter(|verdict| is_counted(verdict)).count()
    }

    /// Conditions that fail, or that hold although they are known to fail.
    fn broken(&self) -> usize {
        self.count(|verdict| !verdict.is_expected() && verdict.judgement != Judgement::TooFewRuns)
    }

    fn undecided(&self) -> usize {
        self.count(|verdict| verdict.judgement == Judgement::TooFewRuns)
    }

    /// Prints the report as a table or as JSON.
    ///
    /// # Errors
    /// Standard output is closed.
    pub fn print(&self, global: &Global) -> Result<()> {
        if global.json { print_json(self) } else { print(&self.table()?) }
    }

    /// # Errors
    /// A condition of the plan does not hold, or holds although it is known to fail; with all seeds
    /// of the plan, also one that needs more runs.
    pub fn judge(&self) -> Result<()> {
        let undecided = if self.source.has_few_seeds { 0 } else { self.undecided() };
        let broken = self.broken() + undecided;
        ensure!(broken == 0, "{}: {broken} of {} conditions are not as expected", self.plan, self.verdicts.len());
        Ok(())
    }

    fn table(&self) -> Result<String, std::fmt::Error> {
        let (plan, out) = (self.source, self.out.shown());
        let mut text = String::new();
        if !plan.title.is_empty() {
            writeln!(text, "{}", plan.title)?;
        }
        let done = self.done_before + self.done_now;
        write!(text, "{} ({}): {done} of {} runs", self.plan, self.fingerprint, self.runs)?;
        if let Some(seconds) = self.wall_seconds {
            write!(text, ", {} of them now, in {seconds:.1} s", self.done_now)?;
        }
        text.push('\n');
        if self.doubles > 0 {
            writeln!(text, "{} rows stood in two files, alike", self.doubles)?;
        }
        if done < self.runs {
            let file = plan.path().shown();
            writeln!(text, "stopped early; `staya sweep {file} --out {out} --resume` does the others")?;
        }
        if !self.points.is_empty() && self.points.len() <= SHOWN {
            self.points_table(&mut text)?;
        }
        for table in &plan.gains {
            let own: Vec<_> = self.gains.iter().filter(|gain| gain.figure == table.figure).cloned().collect();
            text += &gain::text(table, &own);
        }
        if !self.verdicts.is_empty() {
            write!(text, "accepted: {}", self.verdict())?;
        }
        if self.files.is_empty() {
            return Ok(text);
        }
        writeln!(text, "written to {out}")?;
        for file in &self.files {
            writeln!(text, "  {}", file.strip_prefix(self.out).unwrap_or(file).shown())?;
        }
        Ok(text)
    }

    fn points_table(&self, text: &mut String) -> std::fmt::Result {
        let plan = self.source;
        let most = if plan.accept.is_empty() { FIGURES } else { usize::MAX };
        let measures = &plan.measures()[..plan.measures().len().min(most)];
        let has_reference = |name: &&String| self.points.iter().any(|point| point.reference.contains_key(*name));
        let last = |axis: &str| axis.rsplit('.').next().unwrap_or_default().to_owned();
        let mut header: Vec<_> = plan.axes().map(last).collect();
        for name in measures {
            header.extend(
                [Some(name.clone()), Some("paper".to_owned()).filter(|_| has_reference(&name))].into_iter().flatten(),
            );
        }
        let mut lines = vec![header];
        for point in &self.points {
            let mut cells = point.values.clone();
            for name in measures {
                cells.push(match point.figures.get(name).copied().flatten() {
                    None => "-".to_owned(),
                    Some(Summary { min, max, .. }) if min == max => short(min),
                    Some(Summary { mean, mean_error95: Some(error), .. }) => {
                        format!("{} +- {}", short(mean), short(error))
                    }
                    Some(summary) => short(summary.mean),
                });
                if has_reference(&name) {
                    cells.push(point.reference.get(name).map_or("-".to_owned(), |value| short(*value)));
                }
            }
            lines.push(cells);
        }
        let columns = lines[0].len();
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for line in &lines {
            let cells = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
            writeln!(text, "  {}", cells.collect::<Vec<_>>().join("  "))?;
        }
        Ok(())
    }
}
