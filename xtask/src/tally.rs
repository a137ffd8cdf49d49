//! The closing lines of test programs, added up.

use crate::extent::LONG;
use crate::repo::run_reading;
use crate::report::Counts;
use std::process::Command;

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
    /// The last figures that a test printed for the closing table.
    figures: Option<String>,
    /// Whether a program has begun and not yet said how it ended.
    runs: bool,
    /// The last test of that program that was said to take long.
    slow: Option<String>,
    /// Names of tests that failed, and of programs that ended without a closing line.
    failed: Vec<String>,
}

impl Tally {
    fn read(&mut self, line: &str) {
        if let Some((counts, others)) = cargo_line(line).or_else(|| pytest_line(line)) {
            self.counts += counts;
            self.others += others;
            (self.is_closed, self.runs, self.slow) = (true, false, None);
        } else if let Some(figures) = line.strip_prefix("figures: ") {
            self.figures = Some(figures.to_string());
        } else if line.starts_with("running ") && (line.ends_with(" tests") || line.ends_with(" test")) {
            self.crashed();
            self.runs = true;
        } else if let Some(test) = line.strip_prefix("test ") {
            if let Some(name) = test.strip_suffix(" ... FAILED") {
                self.failed.push(name.to_string());
            } else if let Some((name, _)) = test.split_once(" has been running for ") {
                self.slow = Some(name.to_string());
            }
        }
    }

    /// A program that has begun ended without a closing line: one failure.
    fn crashed(&mut self) {
        if std::mem::take(&mut self.runs) {
            self.counts.failed += 1;
            let during = self.slow.take().map_or(String::new(), |name| format!(", perhaps in {name}"));
            self.failed.push(format!("a test program ended without a closing line{during}"));
        }
    }

    /// For the closing table.
    fn note(&self) -> Option<String> {
        let more = self.failed.len().checked_sub(NAMED).filter(|&more| more > 0);
        let more = more.map(|more| format!("and {more} more"));
        let names: Vec<String> = self.failed.iter().take(NAMED).cloned().chain(more).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }
}

/// The counts in the closing line of a program of `cargo test`, and the number of ignored tests,
/// which another command has. Tests that the command line filters out were skipped.
fn cargo_line(line: &str) -> Option<(Counts, u64)> {
    let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
    // "finished in 0.01s" is not a count.
    add_up(counts.split("; ").filter(|field| field.starts_with(|first: char| first.is_ascii_digit())))
}

/// The counts in the closing line of pytest, `1 failed, 2 passed, 1 skipped in 3.21s`, or of the
/// soak, and the number of tests that were not wanted.
fn pytest_line(line: &str) -> Option<(Counts, u64)> {
    let (counts, time) = line.trim_start_matches("soak: ").trim_matches(['=', ' ']).rsplit_once(" in ")?;
    let is_time = time.contains('s') && time.starts_with(|first: char| first.is_ascii_digit());
    add_up(counts.split(", ").filter(|_| is_time)).filter(|_| is_time)
}

fn add_up<'a>(mut fields: impl Iterator<Item = &'a str>) -> Option<(Counts, u64)> {
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
/// last; `why_skipped` is part of it if tests were skipped.
pub fn counted(tests: &mut Command, why_skipped: &str) -> (Counts, String) {
    let mut tally = Tally::default();
    let ended = run_reading(tests, |line| tally.read(line));
    tally.crashed();
    let mut notes = Vec::new();
    notes.extend(tally.note());
    let mut counts = tally.counts;
    let ended = if tally.is_closed { ended } else { ended.and(Err(String::from("no closing line"))) };
    if let Err(reason) = ended {
        counts.failed = counts.failed.max(1);
        notes.push(format!("{reason}, see above"));
    }
    if counts.skipped > 0 && !why_skipped.is_empty() {
        notes.push(why_skipped.to_string());
    }
    notes.extend((tally.others > 0).then(|| format!("{} tests: {LONG}", tally.others)));
    notes.extend(tally.figures);
    (counts, notes.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_line_of_a_test_program_is_counted() {
        let line = "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; \
                    4 filtered out; finished in 0.02s";
        let counts = Counts { passed: 12, failed: 3, skipped: 4 };
        assert_eq!(cargo_line(line), Some((counts, 1)));
    }

    #[test]
    fn closing_line_of_pytest_and_of_the_soak_is_counted() {
        let line = "==== 1 failed, 12 passed, 2 skipped, 7 deselected, 1 error in 63.21s (0:01:03) ====";
        assert_eq!(pytest_line(line), Some((Counts { passed: 12, failed: 2, skipped: 2 }, 7)));
        let soak = "soak: 27 passed, 1 failed in 3.0 minutes; load of the machine 1.9";
        assert_eq!(pytest_line(soak), Some((Counts { passed: 27, failed: 1, skipped: 0 }, 0)));
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
            assert_eq!(cargo_line(line).or_else(|| pytest_line(line)), None, "{line:?}");
        }
    }

    #[test]
    fn deselected_tests_are_not_counted_and_figures_are_noted() {
        let (counts, note) = counted(&mut shell("echo figures: 3 m; echo 3 passed, 2 deselected in 0.12s"), "");
        assert_eq!((counts, note), (Counts { passed: 3, ..Counts::default() }, format!("2 tests: {LONG}; 3 m")));
        assert_eq!(counted(&mut shell("true"), "").0.failed, 1);
    }

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    const PASSED: &str = "test result: ok. 2 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out";
    const FAILED: &str = "test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 3 filtered out";

    #[test]
    fn closing_lines_add_up() {
        let (counts, note) = counted(&mut shell(&format!("echo '{PASSED}'; echo '{PASSED}'")), "why");
        assert_eq!(counts, Counts { passed: 4, failed: 0, skipped: 4 });
        assert_eq!(note, format!("why; 2 tests: {LONG}"));
    }

    #[test]
    fn crash_without_a_closing_line_is_a_failure_whatever_the_others_say() {
        let (counts, note) = counted(&mut shell("echo running 3 tests; exit 101"), "");
        assert_eq!(counts.failed, 1);
        assert!(note.contains("101") && note.contains("closing line"), "{note}");
        let script = format!(
            "echo running 3 tests; echo 'test a::b has been running for over 60 seconds'; echo running 1 test
             echo 'test c ... FAILED'; echo '{FAILED}'; exit 101"
        );
        let (counts, note) = counted(&mut shell(&script), "why");
        assert_eq!(counts, Counts { passed: 2, failed: 2, skipped: 3 });
        assert!(note.contains("perhaps in a::b, c;") && note.ends_with("; why"), "{note}");
    }

    #[test]
    fn what_does_not_compile_is_a_failure() {
        let (counts, note) = counted(&mut shell("exit 101"), "");
        assert_eq!(counts.failed, 1);
        assert!(note.contains("101"), "{note}");
    }

    #[test]
    fn failed_tests_are_named_and_counted_once() {
        let script = format!("echo running 3 tests; echo 'test a::b ... FAILED'; echo '{FAILED}'; exit 101");
        let (counts, note) = counted(&mut shell(&script), "");
        assert_eq!(counts, Counts { passed: 2, failed: 1, skipped: 3 });
        assert!(note.starts_with("a::b; "), "{note}");
        let mut many = Tally::default();
        for number in 0..NAMED + 2 {
            many.read(&format!("test t{number} ... FAILED"));
        }
        assert!(many.note().unwrap().ends_with("t7, and 2 more"));
    }
}
