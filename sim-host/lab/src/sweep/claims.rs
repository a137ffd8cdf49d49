//! What papers and this project claim, and what the last full run of each figure showed.

use crate::error::SweepError;
use crate::figure::Figure;
use crate::sweep::plan::{Changes, Judgement, Plan, Verdict};
use anyhow::Result;
use serde::{Deserialize, Serialize};
use staya_sim::file::{TEXT, read_text};
use staya_sim::shown::Shown as _;
use std::fmt::Write as _;
use std::path::Path;

/// The record in the folder of a figure, and in that of its results.
pub const RECORD: &str = "measured.json";

/// What a full run of a plan showed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    /// Fingerprint of the plan.
    pub fingerprint: String,
    /// Runs per point.
    pub runs: u64,
    /// The conditions of the plan, in its order.
    pub conditions: Vec<Measured>,
}

/// What the runs showed about a condition.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Measured {
    /// The condition.
    pub condition: String,
    /// What the runs say.
    pub judgement: Judgement,
    /// The values.
    pub measured: String,
}

impl Record {
    /// The record of a complete run.
    #[must_use]
    pub fn new(plan: &Plan, verdicts: &[Verdict]) -> Self {
        let measured = |verdict: &Verdict| Measured {
            condition: verdict.condition.clone(),
            judgement: verdict.judgement,
            measured: verdict.measured.clone(),
        };
        Self {
            fingerprint: plan.fingerprint(),
            runs: plan.seeds(),
            conditions: verdicts.iter().map(measured).collect(),
        }
    }

    /// The record as JSON, a condition per paragraph.
    #[must_use]
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Reads the record of a figure and checks that it is one of this plan.
    ///
    /// # Errors
    /// It is missing, damaged, or of another plan.
    pub fn read(plan: &Plan, path: &Path) -> Result<Self, SweepError> {
        let remedy = format!("make it again: cargo xtask claims {}", plan.name);
        let wrong = |what: String| SweepError::new(path.shown(), what, remedy.clone());
        let text = read_text(path, TEXT).map_err(|error| wrong(error.to_string()))?;
        let record: Self = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        let conditions = record.conditions.iter().map(|measured| measured.condition.clone());
        let is_same = conditions.eq(plan.expected().into_iter().map(|verdict| verdict.condition));
        if record.fingerprint != plan.fingerprint() || !is_same {
            return Err(wrong("the plan has changed since it was measured".to_owned()));
        }
        if record.runs != plan.seeds() {
            return Err(wrong(format!("it has {} of {} runs a point", record.runs, plan.seeds())));
        }
        Ok(record)
    }
}

/// The claims of a paper's figures as a table of Markdown, a row for each, from their records;
/// empty if there is none.
///
/// # Errors
/// A plan or a record cannot be read, or a condition is not as expected.
pub fn table(figures: &[Figure]) -> Result<String> {
    let mut text = String::new();
    for figure in figures {
        let plan = Plan::load(&figure.path, &Changes::default())?;
        let expected = plan.expected();
        if expected.iter().all(|verdict| verdict.claim.is_empty()) {
            continue;
        }
        let path = figure.path.with_file_name(RECORD);
        for (expected, Measured { judgement, measured, .. }) in
            expected.into_iter().zip(Record::read(&plan, &path)?.conditions)
        {
            let verdict = Verdict { judgement, measured, ..expected };
            if !verdict.is_expected() {
                let what = format!("{}: {judgement}, {}", verdict.condition, verdict.measured);
                return Err(SweepError::new(path.shown(), what, "a claim that fails needs its reason: `fails`").into());
            }
            if verdict.claim.is_empty() {
                continue;
            }
            let shown = verdict.fails.map_or_else(|| judgement.to_string(), |why| format!("does not hold: {why}"));
            let cell = |text: &str| text.replace('|', "\\|");
            let [claim, paper, measured, shown] =
                [&verdict.claim, &verdict.paper, &verdict.measured, &shown].map(|text| cell(text));
            writeln!(text, "| {claim} | {paper} | {measured} | {shown} | `{}` |", figure.name)?;
        }
    }
    if text.is_empty() {
        return Ok(text);
    }
    Ok(format!("| claim | paper | measured | verdict | figure |\n|---|---|---|---|---|\n{text}"))
}
