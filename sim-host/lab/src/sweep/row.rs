//! Record of a run: a line of CSV, identical on every machine. The last cell is the CRC-32 of the
//! cells before it, so that a damaged row is not merged.
//!
//! Hashes begin with `h`: spreadsheets and pandas read some digits, such as `606634e5`, as numbers.

use crate::sweep::plan::Plan;
use crate::sweep::value::Figure;
use staya_console::VERSION;

/// Name of the column of checksums.
const CHECKSUM: &str = "crc32";

/// The first letter of hashes.
const HASH: char = 'h';

/// A completed run.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the run in the plan.
    pub run: u64,
    /// Whether the run was possible.
    pub outcome: Outcome,
    /// Figures in the order of the design; empty if the run was impossible.
    pub figures: Vec<Figure>,
    /// Trace hash, 16 hex digits; empty if there was no simulation.
    pub trace_hash: String,
}

/// A completed run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// Record of the run.
    pub row: Row,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Reason for an impossible run.
    pub refusal: Option<String>,
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The run was made.
    Done,
    /// Inconsistent values or a missing file; tried again on resume.
    Impossible,
}

impl Outcome {
    const fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Impossible => "impossible",
        }
    }
}

/// Header line of a file of rows, without line end.
#[must_use]
pub fn header(plan: &Plan) -> String {
    let own = |name: &str| name.to_owned();
    let mut names = vec![own("run")];
    names.extend(plan.axes().map(str::to_owned));
    names.extend(["seed", "outcome"].map(own));
    names.extend(plan.measures().iter().cloned());
    names.extend(["trace_hash", "plan", "version", CHECKSUM].map(own));
    names.join(",")
}

/// Whether `line` is the header of rows without checksums.
#[must_use]
pub fn is_older_header(plan: &Plan, line: &str) -> bool {
    header(plan) == format!("{line},{CHECKSUM}")
}

impl Row {
    /// Formats the row as a line, without line end.
    #[must_use]
    pub fn line(&self, plan: &Plan) -> String {
        let mut cells = beginning(plan, self.run);
        cells.push(self.outcome.name().to_owned());
        cells.extend(self.figures.iter().map(ToString::to_string));
        cells.extend([hash_cell(&self.trace_hash), hash_cell(&plan.fingerprint()), VERSION.to_owned()]);
        checked(&cells.join(","))
    }

    /// Parses a line.
    ///
    /// # Errors
    /// The line is damaged, or belongs to another plan or version. Returns cause and remedy.
    pub fn read(plan: &Plan, line: &str) -> Result<Self, (String, String)> {
        let cells = line.rsplit_once(',').map(|(cells, _)| cells).filter(|cells| checked(cells) == line);
        let cells: Vec<&str> = cells.ok_or_else(|| damaged("its checksum is wrong"))?.split(',').collect();
        let [start @ .., hash, fingerprint, version] = &cells[..] else {
            return Err(damaged("it is not a row"));
        };
        if *fingerprint != hash_cell(&plan.fingerprint()) {
            let fingerprint = fingerprint.trim_start_matches(HASH);
            let what = format!("it is of another plan ({fingerprint}, this one is {})", plan.fingerprint());
            return Err((what, elsewhere()));
        }
        if *version != VERSION {
            return Err((format!("it is of version {version}, this is {VERSION}"), elsewhere()));
        }
        let run = start.first().and_then(|cell| cell.parse().ok()).filter(|&run| run < plan.runs());
        let run: u64 = run.ok_or_else(|| damaged("the plan has no such run"))?;
        let expected = beginning(plan, run);
        let Some((own, [outcome, figures @ ..])) = start.split_at_checked(expected.len()) else {
            return Err(damaged("it is too short"));
        };
        if own.iter().zip(&expected).any(|(cell, expected)| cell != expected) {
            return Err(damaged("its values are not those of this run"));
        }
        let outcome = [Outcome::Done, Outcome::Impossible].into_iter().find(|known| known.name() == *outcome);
        let outcome = outcome.ok_or_else(|| damaged("its outcome is unknown"))?;
        if figures.len() != plan.measures().len() {
            return Err(damaged("it has not as many figures as the plan"));
        }
        let figures = figures.iter().map(|cell| Figure::read(cell)).collect::<Option<Vec<_>>>();
        let figures = figures.ok_or_else(|| damaged("a figure is not a number"))?;
        Ok(Self { run, outcome, figures, trace_hash: hash.trim_start_matches(HASH).to_owned() })
    }
}

/// Appends the checksum of the cells as the last cell.
pub(super) fn checked(cells: &str) -> String {
    format!("{cells},{}", hash_cell(&format!("{:08x}", crc32fast::hash(cells.as_bytes()))))
}

/// A cell with a hash; the empty one remains empty.
fn hash_cell(digits: &str) -> String {
    if digits.is_empty() { String::new() } else { format!("{HASH}{digits}") }
}

fn beginning(plan: &Plan, run: u64) -> Vec<String> {
    let (number, seed) = (run.to_string(), plan.run(run).seed.to_string());
    [number].into_iter().chain(plan.values_of(run)).chain([seed]).collect()
}

fn damaged(what: &str) -> (String, String) {
    (what.to_owned(), "the file is damaged: remove this line, and `--resume` does the run again".to_owned())
}

fn elsewhere() -> String {
    "choose another folder with --out, or begin again with --restart".to_owned()
}
