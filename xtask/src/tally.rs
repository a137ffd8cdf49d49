//! The closing lines of test programs, added up.

use crate::repo::run_reading;
use crate::report::Counts;
use anyhow::anyhow;
use std::process::Command;

/// Where tests are that a short command leaves out.
const LONG: &str = "a part of `cargo xtask test --all`";
/// How many failed tests the closing table names.
const NAMED: usize = 8;

/// The test programs of one command, so far.
#[derive(Default)]
struct Tally {
    counts: Counts,
    /// Tests that another command has.
    others: u64,
    /// Whether a program has said how it ended.
    is_closed: bool,
    /// Programs that have begun and not yet said how they ended.
    open: u64,
    /// The last figures that a test printed for the closing table.
    figures: Option<String>,
    /// Names of tests that failed.
    failed: Vec<String>,
}

impl Tally {
    fn read(&mut self, line: &str) {
        if let Some((counts, others)) = closing_line(line) {
            self.counts += counts;
            self.others += others;
            self.is_closed = true;
            self.open = self.open.saturating_sub(1);
        } else if let Some(figures) = line.strip_prefix("figures: ") {
            self.figures = Some(figures.to_string());
        } else if line.starts_with("running ") && (line.ends_with(" tests") || line.ends_with(" test")) {
            self.open += 1;
        } else if let Some(name) = line.strip_prefix("test ").and_then(|test| test.strip_suffix(" ... FAILED")) {
            self.failed.push(name.to_string());
        }
    }

    /// The note on failures in the closing table.
    fn failures(&self) -> Option<String> {
        let mut names: Vec<String> = self.failed.iter().take(NAMED).cloned().collect();
        names.extend((self.failed.len() > NAMED).then(|| format!("and {} more", self.failed.len() - NAMED)));
        names.extend((self.open > 0).then(|| format!("programs without a closing line: {}", self.open)));
        (!names.is_empty()).then(|| names.join(", "))
    }
}

/// The counts in the closing line of a program of `cargo test`, of pytest (`1 failed, 2 passed in
/// 3.21s`) or of the soak, and the number of tests that were ignored or not wanted, which another
/// command has. Tests that cargo's command line filters out were skipped.
fn closing_line(line: &str) -> Option<(Counts, u64)> {
    let mut fields = match line.strip_prefix("test result: ") {
        // The last field is "finished in 0.01s".
        Some(result) => result.split_once(". ")?.1.rsplit_once("; ")?.0.split("; "),
        None => {
            let (counts, time) = line.trim_start_matches("soak: ").trim_matches(['=', ' ']).rsplit_once(" in ")?;
            let is_time = time.contains('s') && time.starts_with(|first: char| first.is_ascii_digit());
            is_time.then_some(counts)?.split(", ")
        }
    };
    fields.try_fold((Counts::default(), 0), |(mut sum, mut others), field| {
        let (number, what) = field.split_once(' ')?;
        let number: u64 = number.parse().ok()?;
        match what {
            "passed" => sum.passed += number,
            "failed" | "error" | "errors" | "xpassed" => sum.failed += number,
            "filtered out" | "skipped" | "xfailed" => sum.skipped += number,
            "ignored" | "deselected" => others += number,
            _ => {}
        }
        Some((sum, others))
    })
}

/// Runs test programs of Rust or pytest and adds up their closing lines. A program that ends
/// without one (it crashed), and a command that fails without any test that does (it did not
/// compile), is one failure each. The note names the failed tests and the figures that were found
/// last.
pub fn counted(tests: &mut Command) -> (Counts, String) {
    let mut tally = Tally::default();
    let ended = run_reading(tests, |line| tally.read(line));
    let ended = if tally.is_closed { ended } else { ended.and(Err(anyhow!("no closing line"))) };
    let mut counts = tally.counts;
    counts.failed += tally.open;
    let mut notes: Vec<String> = tally.failures().into_iter().collect();
    if let Err(reason) = ended {
        counts.failed = counts.failed.max(1);
        notes.push(format!("{reason:#}, see above"));
    }
    notes.extend((tally.others > 0).then(|| format!("{} tests: {LONG}", tally.others)));
    notes.extend(tally.figures);
    (counts, notes.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PASSED: &str = "test result: ok. 2 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out; finished in 0.1s";
    const FAILED: &str =
        "test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 3 filtered out; finished in 1s";

    fn counts(passed: u64, failed: u64, skipped: u64) -> Counts {
        Counts { passed, failed, skipped }
    }

    /// The counts and the note of a script.
    fn of(script: &str) -> (Counts, String) {
        counted(Command::new("sh").args(["-c", script]))
    }

    #[test]
    fn closing_lines_of_cargo_pytest_and_the_soak_are_counted() {
        assert_eq!(closing_line(PASSED), Some((counts(2, 0, 2), 1)));
        assert_eq!(closing_line(FAILED), Some((counts(2, 1, 3), 0)));
        let line = "==== 1 failed, 12 passed, 2 skipped, 7 deselected, 1 error in 63.21s (0:01:03) ====";
        assert_eq!(closing_line(line), Some((counts(12, 2, 2), 7)));
        let soak = "soak: 27 passed, 1 failed in 3.0 minutes; load of the machine 1.9";
        assert_eq!(closing_line(soak), Some((counts(27, 1, 0), 0)));
    }

    #[test]
    fn other_lines_are_not_counted() {
        for line in [
            "",
            "running 3 tests",
            "test a::b ... ok",
            "  test result: ok. 1 passed;",
            "tests/python/test_a.py ....  [100%]",
            "FAILED test_a.py::test_b - assert 1 in (2, 3)",
            "no tests ran in 0.01s",
            "flood     ok      memory is flat",
        ] {
            assert_eq!(closing_line(line), None, "{line:?}");
        }
    }

    #[test]
    fn closing_lines_add_up_and_figures_are_noted() {
        assert_eq!(of(&format!("echo '{PASSED}'; echo '{PASSED}'")), (counts(4, 0, 4), format!("2 tests: {LONG}")));
        let pytest = of("echo figures: 3 m; echo 3 passed, 2 deselected in 0.12s");
        assert_eq!(pytest, (counts(3, 0, 0), format!("2 tests: {LONG}; 3 m")));
    }

    #[test]
    fn crash_without_a_closing_line_is_a_failure_whatever_the_others_say() {
        assert_eq!(of("true").0, counts(0, 1, 0));
        let (crashed, note) = of("echo running 3 tests; exit 101");
        assert_eq!(crashed.failed, 1);
        assert!(note.contains("101") && note.contains("closing line"), "{note}");
        let script =
            format!("echo running 3 tests; echo running 1 test; echo 'test c ... FAILED'; echo '{FAILED}'; exit 101");
        let (failed, note) = of(&script);
        assert_eq!(failed, counts(2, 2, 3));
        assert!(note.starts_with("c, programs without"), "{note}");
    }

    #[test]
    fn failed_tests_are_named_and_counted_once() {
        let (failed, note) =
            of(&format!("echo running 3 tests; echo 'test a::b ... FAILED'; echo '{FAILED}'; exit 101"));
        assert_eq!(failed, counts(2, 1, 3));
        assert!(note.starts_with("a::b; "), "{note}");
        let mut many = Tally::default();
        (0..NAMED + 2).for_each(|number| many.read(&format!("test t{number} ... FAILED")));
        assert!(many.failures().unwrap().ends_with("t7, and 2 more"));
    }
}
