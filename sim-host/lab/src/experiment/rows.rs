//! Rows of experiments, written by the code of sweeps ([`crate::sweep::row`]).

use super::{Experiment, ProgressCallback};
use crate::sweep::design::Design;
use crate::sweep::merge::Merged;
use crate::sweep::row::{Finished, Outcome, Row};
use crate::sweep::shard::{Course, Existing, files, perform_shard};
use crate::sweep::{Figure, Shard, Value, aggregate, jobs, schema};
use anyhow::{Result, ensure};
use clap::Args;
use staya_controller::digest::{chained, digest};
use staya_sim::record::{Error, write_atomically};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Written when all runs are done.
const ROWS: &str = "rows.csv";
const AGGREGATES: &str = "aggregates.csv";
/// Increase when equal plans give other rows.
const FORMAT: u64 = 1;

/// Visitor of figures: name, meaning and value.
pub type Each<'a> = dyn FnMut(&'static str, &'static str, &mut dyn Cell) + 'a;

/// Result of a run that can be written as a row.
pub trait Record: Send {
    /// Visits all figures in a fixed order and stores values that the visitor sets.
    fn figures(&mut self, each: &mut Each<'_>);

    /// Trace hash; `None` if the run did not use the engine.
    fn trace_hash(&mut self) -> Option<&mut u64> {
        None
    }
}

/// Value of a figure.
pub trait Cell {
    /// The value as a number; `None` if it is missing.
    fn get(&self) -> Option<f64>;
    /// Sets the value; `false` if this type cannot represent it.
    fn set(&mut self, value: Option<f64>) -> bool;
}

const EXACT: f64 = 9_007_199_254_740_992.0;

macro_rules! whole_cells {
    ($($kind:ty),*) => {$(
        impl Cell for $kind {
            fn get(&self) -> Option<f64> {
                Some(*self as f64)
            }

            fn set(&mut self, value: Option<f64>) -> bool {
                let whole = value.filter(|value| (0.0..=EXACT).contains(value) && libm::trunc(*value) == *value);
                whole.map(|value| *self = value as $kind).is_some()
            }
        }
    )*};
}

whole_cells!(u32, u64, usize);

impl Cell for f64 {
    fn get(&self) -> Option<f64> {
        Some(*self)
    }

    fn set(&mut self, value: Option<f64>) -> bool {
        value.map(|value| *self = value).is_some()
    }
}

impl Cell for bool {
    fn get(&self) -> Option<f64> {
        Some(f64::from(u8::from(*self)))
    }

    fn set(&mut self, value: Option<f64>) -> bool {
        let is_truth = value == Some(0.0) || value == Some(1.0);
        *self = value == Some(1.0);
        is_truth
    }
}

impl<T: Cell + Default> Cell for Option<T> {
    fn get(&self) -> Option<f64> {
        self.as_ref().and_then(Cell::get)
    }

    fn set(&mut self, value: Option<f64>) -> bool {
        let mut inner = T::default();
        let fits = value.is_none() || inner.set(value);
        *self = value.map(|_| inner);
        fits
    }
}

/// Treatment of rows, an option of every experiment.
#[derive(Args, Clone, Debug, Default)]
pub struct RowRetention {
    /// Make the missing runs.
    #[arg(long, global = true)]
    pub resume: bool,
    /// Replace existing rows.
    #[arg(long, global = true, conflicts_with = "resume")]
    pub restart: bool,
    /// Make one of N equal parts only, as in 3/8; when all are there, --resume writes the report.
    #[arg(long, global = true, value_name = "I/N", default_value_t = Shard::default())]
    pub shard: Shard,
}

impl RowRetention {
    /// Rows of a completed sweep are replaced like any results. Rows of an interrupted sweep may be
    /// hours of work, so they are kept.
    pub(crate) fn existing(&self, out: &Path) -> Existing {
        let is_whole = || self.shard.is_whole() && out.join(ROWS).is_file();
        match (self.resume, self.restart) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Forget,
            _ if is_whole() => Existing::Forget,
            _ => Existing::Refuse,
        }
    }
}

pub(crate) struct Sheet<'a, E> {
    plan: &'a E,
    fingerprint: u64,
    parameters: Vec<&'static str>,
    figures: Vec<(&'static str, &'static str)>,
}

impl<'a, E: Experiment> Sheet<'a, E> {
    pub fn new(plan: &'a E) -> Self {
        let (mut figures, mut parameters) = (Vec::new(), Vec::new());
        if plan.points() > 0 {
            plan.blank(0, 0).figures(&mut |name, meaning, _| figures.push((name, meaning)));
            parameters.extend(plan.given(0).iter().map(|(name, _)| *name));
        }
        let mut fingerprint = chained(FORMAT, digest(E::NAME.as_bytes()));
        let mut add = |text: &str| fingerprint = chained(fingerprint, digest(text.as_bytes()));
        parameters.iter().for_each(|name| add(name));
        figures.iter().for_each(|(name, _)| add(name));
        for point in 0..plan.points() {
            plan.given(point).iter().for_each(|(_, value)| add(&format!("{value:?}")));
            add(&format!("{} {}", plan.runs(), plan.seed(point, 0)));
        }
        Self { plan, fingerprint, parameters, figures }
    }

    fn place(&self, run: u64) -> (usize, u32) {
        let runs = self.runs_per_point();
        ((run / runs) as usize, (run % runs) as u32)
    }

    fn row(&self, number: u64, run: &mut E::Run) -> Row {
        let mut figures = Vec::new();
        run.figures(&mut |_, _, cell| figures.push(Figure(cell.get())));
        let trace_hash = run.trace_hash().map_or(String::new(), |hash| format!("{hash:016x}"));
        Row { run: number, outcome: Outcome::Done, figures, trace_hash }
    }

    fn read(&self, row: &Row, run: &mut E::Run) -> bool {
        let (mut cells, mut fits) = (row.figures.iter(), true);
        run.figures(&mut |_, _, cell| fits &= cells.next().is_some_and(|figure| cell.set(figure.0)));
        if let Some(hash) = run.trace_hash() {
            let read = u64::from_str_radix(&row.trace_hash, 16);
            fits &= read.is_ok();
            *hash = read.unwrap_or_default();
        }
        fits
    }
}

impl<E: Experiment> Design for Sheet<'_, E> {
    fn name(&self) -> &str {
        E::NAME
    }

    fn fingerprint(&self) -> String {
        format!("{:016x}", self.fingerprint)
    }

    fn runs(&self) -> u64 {
        self.plan.points() as u64 * self.runs_per_point()
    }

    fn runs_per_point(&self) -> u64 {
        u64::from(self.plan.runs()).max(1)
    }

    fn parameters(&self) -> Vec<String> {
        self.parameters.iter().map(ToString::to_string).collect()
    }

    fn values(&self, run: u64) -> Vec<String> {
        let cell = |(_, value): (_, Value)| value.to_string().replace([',', '"', '\n'], "_");
        self.plan.given(self.place(run).0).into_iter().map(cell).collect()
    }

    fn seed(&self, run: u64) -> u64 {
        let (point, run) = self.place(run);
        self.plan.seed(point, run)
    }

    fn figures(&self) -> Vec<String> {
        self.figures.iter().map(|(name, _)| (*name).to_owned()).collect()
    }

    fn meaning(&self, figure: &str) -> String {
        let known = self.figures.iter().find(|(name, _)| *name == figure);
        known.map_or(String::new(), |(_, meaning)| (*meaning).to_owned())
    }

    fn at_once(&self) -> usize {
        if E::ALONE { 1 } else { usize::MAX }
    }

    /// Alternates between points, so that an early end leaves about equally many runs of each.
    fn turn(&self, run: u64) -> u64 {
        let (point, run) = self.place(run);
        u64::from(run) * self.plan.points() as u64 + point as u64
    }
}

/// Runs of an experiment, and the folder of their rows.
pub struct Jobs<'a, E> {
    sheet: Sheet<'a, E>,
    may_continue: &'a ProgressCallback<'a>,
    place: Option<(&'a Path, &'a RowRetention)>,
    course: Mutex<Option<Course>>,
}

impl<'a, E: Experiment> Jobs<'a, E> {
    /// `plan` is checked. `place`: folder and options; `None` if rows are not stored.
    pub(crate) fn new(
        plan: &'a E,
        may_continue: &'a ProgressCallback<'a>,
        place: Option<(&'a Path, &'a RowRetention)>,
    ) -> Self {
        Self { sheet: Sheet::new(plan), may_continue, place, course: Mutex::new(None) }
    }

    /// Folder of the results; `None` if nothing is stored.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.place.map(|(out, _)| out)
    }

    /// Whether a run in progress may continue.
    #[must_use]
    pub fn may_continue(&self) -> bool {
        (self.may_continue)(0)
    }

    /// Makes the missing runs. Returns the available runs of each point in order, up to the first
    /// missing one.
    ///
    /// `job` receives the point and the number of the run within it; `None` ends the experiment.
    /// The contents of its scratch memory must not affect its result.
    ///
    /// # Errors
    /// The first error of a job, rows of another plan, or a row that cannot be written.
    pub fn each<S: Default>(
        &self,
        job: impl Fn(&mut S, usize, u32) -> Result<Option<E::Run>> + Sync,
    ) -> Result<Vec<Vec<E::Run>>> {
        let sheet = &self.sheet;
        let (made, wrong) = (Mutex::new(BTreeMap::new()), Mutex::new(None));
        let one = |scratch: &mut S, number: u64| {
            if !self.may_continue() {
                return None;
            }
            let since = Instant::now();
            let (point, run) = sheet.place(number);
            match job(scratch, point, run) {
                Ok(run) => {
                    let mut run = run?;
                    let row = sheet.row(number, &mut run);
                    made.lock().unwrap_or_else(PoisonError::into_inner).insert(number, run);
                    Some(Finished { row, seconds: since.elapsed().as_secs_f64(), refusal: None })
                }
                Err(error) => {
                    let mut wrong = wrong.lock().unwrap_or_else(PoisonError::into_inner);
                    // The error of the first job, whichever thread was first.
                    if wrong.as_ref().is_none_or(|(before, _)| sheet.turn(number) < *before) {
                        *wrong = Some((sheet.turn(number), error));
                    }
                    None
                }
            }
        };
        let rows = match self.place {
            Some((out, keeping)) => {
                let progress = |done, _| _ = (self.may_continue)(done as usize);
                let course = perform_shard(sheet, keeping.shard, out, keeping.existing(out), one, progress)?;
                *self.course.lock().unwrap_or_else(PoisonError::into_inner) = Some(course);
                Merged::read(sheet, &files(out)?)?.rows
            }
            None => in_memory(sheet, self.may_continue, one),
        };
        if let Some((_, error)) = wrong.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        let mut made = made.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut by_point: Vec<Vec<E::Run>> = (0..sheet.plan.points()).map(|_| Vec::new()).collect();
        for row in rows {
            let (point, number) = sheet.place(row.run);
            let mut run = made.remove(&row.run).unwrap_or_else(|| sheet.plan.blank(point, number));
            // Figures come from the rows, whichever process made them.
            ensure!(sheet.read(&row, &mut run), "run {} has a row that no run gives; begin --restart", row.run);
            if by_point[point].len() == number as usize {
                by_point[point].push(run);
            }
        }
        Ok(by_point)
    }

    pub(crate) fn course(&self) -> Option<Course> {
        self.course.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Removes the files that mark the results as complete.
    pub(crate) fn clear(&self) -> Result<(), Error> {
        let Some((out, keeping)) = self.place else {
            return Ok(());
        };
        if keeping.existing(out) != Existing::Forget || !keeping.shard.is_whole() {
            return Ok(());
        }
        // Removed last: after a kill here, the rest still counts as complete and may be replaced.
        for file in files(out)?.into_iter().chain([AGGREGATES, ROWS].map(|name| out.join(name))) {
            if file.exists() {
                std::fs::remove_file(&file).map_err(Error::new("remove", &file))?;
            }
        }
        Ok(())
    }

    pub(crate) fn write(&self) -> Result<Vec<PathBuf>> {
        let Some((out, _)) = self.place else {
            return Ok(Vec::new());
        };
        let merged = Merged::read(&self.sheet, &files(out)?)?;
        let mut texts = vec![("rows.schema.json", schema(&self.sheet)), (ROWS, merged.text(&self.sheet))];
        if self.sheet.runs_per_point() > 1 {
            let points = aggregate::points(&self.sheet, &merged);
            texts.insert(0, (AGGREGATES, aggregate::text(&self.sheet, &points)));
        }
        let mut written = Vec::new();
        for (name, text) in texts {
            write_atomically(&out.join(name), text.as_bytes())?;
            written.push(out.join(name));
        }
        Ok(written)
    }
}

fn in_memory<S: Default>(
    sheet: &dyn Design,
    may_continue: &ProgressCallback<'_>,
    one: impl Fn(&mut S, u64) -> Option<Finished> + Sync,
) -> Vec<Row> {
    let mut order: Vec<u64> = (0..sheet.runs()).collect();
    order.sort_by_key(|&run| sheet.turn(run));
    let mut rows = Vec::new();
    let take = |_, finished: Option<Finished>| {
        let Some(finished) = finished else {
            return ControlFlow::Break(());
        };
        rows.push(finished.row);
        if may_continue(rows.len()) { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    jobs::each(order.len(), sheet.at_once(), |scratch, index| one(scratch, order[index]), take);
    rows.sort_by_key(|row| row.run);
    rows
}

#[cfg(test)]
mod tests;
