//! The record of a full run: the judgement on each condition of its plan.

use crate::error::SweepError;
use crate::sweep::plan::{Judgement, Plan, Verdict};
use serde::{Deserialize, Serialize};
use staya_sim::file::{TEXT, read_text};
use staya_sim::shown::Shown as _;
use std::path::Path;

/// The record in the folder of a figure, and in that of its results.
pub const RECORD: &str = "measured.json";

/// The judgements of a full run of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    /// Fingerprint of the plan.
    pub fingerprint: String,
    /// Runs per point.
    pub runs: u64,
    /// The conditions of the plan, in its order.
    pub conditions: Vec<Measured>,
}

/// The judgement on a condition.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Measured {
    /// The condition.
    pub condition: String,
    /// The judgement of the runs.
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
