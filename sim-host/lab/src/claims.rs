//! The claims of papers and of this project, beside the records of full runs.

use crate::error::SweepError;
use crate::figure::Figure;
use crate::sweep::plan::{Changes, Plan, Verdict};
use crate::sweep::record::{Measured, RECORD, Record};
use anyhow::Result;
use staya_sim::shown::Shown as _;
use std::fmt::Write as _;

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
