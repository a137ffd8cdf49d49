//! What is written down of a run: one line of CSV, the same on every machine.

use crate::VERSION;
use crate::plan::{Plan, Run};
use crate::value::Figure;

/// A run that is over.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its number in the plan.
    pub run: u64,
    /// Whether it could be done; if not, it has no figures.
    pub outcome: Outcome,
    /// The plan's measures, in its order.
    pub figures: Vec<Figure>,
    /// 16 hex digits; empty: there was no run.
    pub trace_hash: String,
}

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It was done.
    Done,
    /// Its values do not go together, or a file was not there: nothing could be simulated. It is tried again at resume.
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

/// The first line of a file, without its end.
#[must_use]
pub fn header(plan: &Plan) -> String {
    let mut names = vec!["run"];
    names.extend(plan.axes());
    names.extend(["seed", "outcome"]);
    names.extend(plan.measures().iter().map(String::as_str));
    names.extend(["trace_hash", "plan", "version"]);
    names.join(",")
}

impl Row {
    /// As a line, without its end.
    #[must_use]
    pub fn line(&self, plan: &Plan) -> String {
        let mut cells = beginning(&plan.run(self.run));
        cells.push(self.outcome.name().to_owned());
        cells.extend(self.figures.iter().map(ToString::to_string));
        cells.extend([self.trace_hash.clone(), plan.fingerprint(), VERSION.to_owned()]);
        cells.join(",")
    }

    /// Reads a line. The error says what is wrong with it, and what to do.
    ///
    /// # Errors
    /// It is no row, or one of another plan or version.
    pub fn read(plan: &Plan, line: &str) -> Result<Self, (String, String)> {
        let cells: Vec<&str> = line.split(',').collect();
        let [start @ .., hash, fingerprint, version] = &cells[..] else {
            return Err(damaged("it is no row"));
        };
        let is_fingerprint = fingerprint.len() == 16 && fingerprint.chars().all(|c| c.is_ascii_hexdigit());
        if !is_fingerprint || version.is_empty() {
            return Err(damaged("it is no row"));
        }
        if *fingerprint != plan.fingerprint() {
            let what = format!("it is of another plan ({fingerprint}, this one is {})", plan.fingerprint());
            return Err((what, elsewhere()));
        }
        if *version != VERSION {
            return Err((format!("it is of version {version}, this is {VERSION}"), elsewhere()));
        }
        let run = start.first().and_then(|cell| cell.parse().ok()).filter(|&run| run < plan.runs());
        let run: u64 = run.ok_or_else(|| damaged("the plan has no such run"))?;
        let expected = beginning(&plan.run(run));
        let Some((own, [outcome, figures @ ..])) = start.split_at_checked(expected.len()) else {
            return Err(damaged("it is too short"));
        };
        if own.iter().zip(&expected).any(|(cell, expected)| cell != expected) {
            return Err(damaged("its values are not those of this run"));
        }
        let outcome = [Outcome::Done, Outcome::Impossible].into_iter().find(|known| known.name() == *outcome);
        let outcome = outcome.ok_or_else(|| damaged("nobody knows what became of it"))?;
        if figures.len() != plan.measures().len() {
            return Err(damaged("it has not as many figures as the plan"));
        }
        let figures = figures.iter().map(|cell| Figure::read(cell)).collect::<Option<Vec<_>>>();
        let figures = figures.ok_or_else(|| damaged("a figure is no number"))?;
        Ok(Self { run, outcome, figures, trace_hash: (*hash).to_owned() })
    }
}

/// Number, values and seed.
fn beginning(run: &Run<'_>) -> Vec<String> {
    let values = run.values.iter().map(ToString::to_string);
    [run.number.to_string()].into_iter().chain(values).chain([run.seed.to_string()]).collect()
}

fn damaged(what: &str) -> (String, String) {
    (what.to_owned(), "the file is damaged: remove this line, and `--resume` does the run again".to_owned())
}

fn elsewhere() -> String {
    "choose another folder with --out, or begin again with --anew".to_owned()
}
