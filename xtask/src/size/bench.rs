//! The output of the program `bench`.

use serde::Serialize;
use std::fmt::{self, Display};

/// Stands for the kind of number where there is none: wire formats have only bytes.
pub const NO_NUMBER: &str = "-";

/// One case with one kind of number.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Row {
    /// Its name.
    pub case: String,
    /// The kind of number.
    pub number: String,
    /// Steps taken.
    pub steps: u64,
    /// Instructions of a step.
    pub median: u64,
    /// Of the longest step.
    pub worst: u64,
    /// Bytes of stack of the deepest step.
    pub stack: u64,
    /// Bytes of an agent.
    pub agent: u64,
    /// Bytes of the workspace.
    pub workspace: u64,
}

impl Display for Row {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { case, number, steps, median, worst, stack, agent, workspace } = self;
        write!(out, "{case:<26} {number:>6} {steps:>6} {median:>9} {worst:>9} {stack:>6} {agent:>6} {workspace:>9}")
    }
}

/// All that it printed. The error names the first line that is none of its own.
pub fn rows(output: &str) -> Result<Vec<Row>, String> {
    let rows: Result<Vec<Row>, String> =
        output.lines().map(|line| row(line).ok_or_else(|| format!("`bench` printed `{line}`"))).collect();
    match rows {
        Ok(rows) if rows.is_empty() => Err(String::from("`bench` printed nothing")),
        other => other,
    }
}

fn row(line: &str) -> Option<Row> {
    let mut words = line.split(' ');
    let (case, number) = (words.next()?.to_string(), words.next()?.to_string());
    let mut count = || words.next()?.parse::<u64>().ok();
    let row = Row {
        case,
        number,
        steps: count()?,
        median: count()?,
        worst: count()?,
        stack: count()?,
        agent: count()?,
        workspace: count()?,
    };
    words.next().is_none().then_some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_bench_prints_is_read_and_nothing_else() {
        let read = rows("route f32 256 11071 73154 1944 1296 2704\n").unwrap();
        assert_eq!(read.len(), 1);
        assert_eq!((read[0].case.as_str(), read[0].worst), ("route", 73154));
        assert_eq!((read[0].stack, read[0].workspace), (1944, 2704));
        for bad in [
            "",
            "panicked at 3\n",
            "route f32 256 11071 73154 1944 1296\n",
            "route f32 256 11071 73154 1944 1296 2704 1\n",
        ] {
            assert!(rows(bad).is_err(), "{bad}");
        }
    }
}
