//! Merges the rows of all shards.

use crate::error::SweepError;
use crate::sweep::plan::Plan;
use crate::sweep::row::{Outcome, Row, header};
use crate::sweep::shard::{Rows, read_rows};
use staya_sim::shown::Shown as _;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

/// The rows of a plan, ordered by run number, each run once.
#[derive(Clone, Debug, Default)]
pub struct Merged {
    /// Rows ordered by run number.
    pub rows: Vec<Row>,
    /// Rows found in two places, identically.
    pub doubles: u64,
    /// Runs without a row, as inclusive ranges.
    pub missing: Vec<(u64, u64)>,
}

impl Merged {
    /// Merges the files of shards, in any order.
    ///
    /// # Errors
    /// A file cannot be read, a row is damaged or belongs to another plan or version, or two rows
    /// of one run differ.
    pub fn read(plan: &Plan, files: &[PathBuf]) -> Result<Self, SweepError> {
        let mut rows: BTreeMap<u64, (Row, &Path, usize)> = BTreeMap::new();
        let mut doubles = 0;
        for file in files {
            for (line, row) in read_rows(plan, file)?.rows {
                match rows.entry(row.run) {
                    Entry::Vacant(place) => drop(place.insert((row, file, line))),
                    // Impossible runs are tried again, so there may be a later row.
                    Entry::Occupied(_) if row.outcome == Outcome::Impossible => {}
                    Entry::Occupied(mut place) if place.get().0.outcome == Outcome::Impossible => {
                        drop(place.insert((row, file, line)));
                    }
                    Entry::Occupied(place) => {
                        let (other, path, at) = place.get();
                        // As text, because a figure may be NaN.
                        if other.line(plan) != row.line(plan) {
                            let what = format!("run {} has another row in {}:{at}", row.run, path.shown());
                            let remedy =
                                "one of them was made by a changed program: remove it, or begin again with --restart";
                            return Err(SweepError::new(format_args!("{}:{line}", file.shown()), what, remedy));
                        }
                        doubles += 1;
                    }
                }
            }
        }
        let mut missing: Vec<(u64, u64)> = Vec::new();
        for run in (0..plan.runs()).filter(|run| !rows.contains_key(run)) {
            match missing.last_mut() {
                Some((_, last)) if *last + 1 == run => *last = run,
                _ => missing.push((run, run)),
            }
        }
        Ok(Self { rows: rows.into_values().map(|(row, ..)| row).collect(), doubles, missing })
    }

    /// Reads a merged file, which has each run once and in order.
    ///
    /// # Errors
    /// As for [`Merged::read`], and if a run is missing, out of order or duplicated.
    pub fn reread(plan: &Plan, file: &Path) -> Result<Self, SweepError> {
        let again = "merge the shards again: `staya sweep merge`";
        let Rows { rows, .. } = read_rows(plan, file).map_err(|error| match error {
            SweepError::Other { place, what, .. } => SweepError::new(place, what, again),
            other => other,
        })?;
        for ((line, row), expected) in rows.iter().zip(0..) {
            if row.run != expected {
                let place = format!("{}:{line}", file.shown());
                let what = match row.run < expected {
                    true => format!("run {} has two rows, or is out of order", row.run),
                    false => format!("run {expected} is missing"),
                };
                return Err(SweepError::new(place, what, again));
            }
        }
        if rows.len() as u64 != plan.runs() {
            let what = format!("it has {} of {} runs", rows.len(), plan.runs());
            return Err(SweepError::new(file.shown(), what, again));
        }
        Ok(Self { rows: rows.into_iter().map(|(_, row)| row).collect(), ..Self::default() })
    }

    /// Refuses missing runs; `remedy` states how to make them.
    ///
    /// # Errors
    /// A run is missing.
    pub fn whole(self, plan: &Plan, place: &Path, remedy: &str) -> Result<Self, SweepError> {
        let count: u64 = self.missing.iter().map(|(first, last)| last - first + 1).sum();
        if count == 0 {
            return Ok(self);
        }
        let named = self.missing.iter().take(8).map(|&(first, last)| match first == last {
            true => first.to_string(),
            false => format!("{first}-{last}"),
        });
        let mut named = named.collect::<Vec<_>>().join(", ");
        if self.missing.len() > 8 {
            named.push_str(", ...");
        }
        let what = format!("{count} of {} runs are missing: {named}", plan.runs());
        Err(SweepError::new(place.shown(), what, remedy))
    }

    /// Formats the rows as a file.
    #[must_use]
    pub fn text(&self, plan: &Plan) -> String {
        let lines = self.rows.iter().map(|row| row.line(plan));
        [header(plan)].into_iter().chain(lines).map(|line| line + "\n").collect()
    }
}
