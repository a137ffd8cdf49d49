//! The parts of a command: passed, failed, or skipped with a reason.

use anyhow::Result;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

/// Counts of tests or steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Ran and was right.
    pub passed: u64,
    /// Ran and was wrong, or could not run although it should have.
    pub failed: u64,
    /// Did not run.
    pub skipped: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

/// The error of a part that cannot run here: what is missing, and the remedy.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct Skipped(String);

/// The error that skips a part instead of failing it.
pub fn skipped(reason: impl Into<String>) -> anyhow::Error {
    Skipped(reason.into()).into()
}

/// Prints all faults. The error counts them and shows the first.
pub fn none_of(faults: &[String], what: &str) -> Result<()> {
    faults.iter().for_each(|fault| println!("{fault}"));
    faults.first().map_or(Ok(()), |first| Err(anyhow::anyhow!("{} {what}, first: {first}", faults.len())))
}

/// One row of the closing table.
struct Part {
    name: String,
    counts: Counts,
    took: Duration,
    /// Time of all processors in the commands that it ran, if the system tells.
    worked: Option<Duration>,
    /// The reason of a failure or a skip, or the findings.
    note: String,
}

/// The rows so far.
#[derive(Default)]
pub struct Report {
    parts: Vec<Part>,
    /// Skipped parts count as failed.
    is_strict: bool,
}

impl Report {
    /// Under `CI=true` all that is skipped is a failure: a machine that lacks something must not
    /// look like one that passes.
    pub fn new() -> Self {
        Self { is_strict: std::env::var_os("CI").is_some_and(|value| value == "true"), ..Self::default() }
    }

    /// Runs one part that counts by itself; announces it first. `work` returns its counts and a
    /// note for the table. Returns whether all passed.
    pub fn part(&mut self, name: &str, work: impl FnOnce() -> Result<(Counts, String)>) -> bool {
        println!("\n== {name}");
        let start = Instant::now();
        let before = processor_time();
        let (mut counts, mut note) = work().unwrap_or_else(|error| {
            let skipped = u64::from(error.is::<Skipped>());
            println!("{}: {error:#}", if skipped > 0 { "skipped" } else { "failed" });
            (Counts { failed: 1 - skipped, skipped, passed: 0 }, format!("{error:#}"))
        });
        let worked = before.and_then(|before| processor_time()?.checked_sub(before));
        if self.is_strict && counts.skipped > 0 {
            counts.failed += std::mem::take(&mut counts.skipped);
            note = format!("with CI=true nothing may be skipped: {note}");
        }
        let took = start.elapsed();
        println!("-- {} s, of processors {} s", seconds(Some(took)), seconds(worked));
        self.parts.push(Part { name: name.to_string(), counts, took, worked, note });
        counts.failed + counts.skipped == 0
    }

    /// Runs one part that succeeds, fails or is skipped. Returns whether it succeeded.
    pub fn step(&mut self, name: &str, work: impl FnOnce() -> Result<()>) -> bool {
        self.part(name, || work().map(|()| (Counts { passed: 1, ..Counts::default() }, String::new())))
    }

    /// Runs one command as a part.
    pub fn command(&mut self, name: &str, command: &mut Command) -> bool {
        self.step(name, || crate::repo::execute(command))
    }

    /// Prints the table and the closing line.
    pub fn close(self) -> ExitCode {
        let mut total = Counts::default();
        let width = self.parts.iter().map(|part| part.name.chars().count()).max().unwrap_or(0);
        println!("\n{:width$}  passed  failed  skipped  seconds  of processors", "part");
        for part in &self.parts {
            let Part { name, counts: Counts { passed, failed, skipped }, note, .. } = part;
            let (took, worked) = (seconds(Some(part.took)), seconds(part.worked));
            let row = format!("{name:width$}  {passed:>6}  {failed:>6}  {skipped:>7}  {took:>7}  {worked:>13}  {note}");
            println!("{}", row.trim_end());
            total += part.counts;
        }
        let took: Duration = self.parts.iter().map(|part| part.took).sum();
        println!("{:.0} seconds in all", took.as_secs_f64());
        println!("{}", closing_line(total));
        ExitCode::from(u8::from(total.failed > 0))
    }
}

fn closing_line(Counts { passed, failed, skipped }: Counts) -> String {
    format!("{passed} passed, {failed} failed, {skipped} skipped")
}

/// Seconds to a tenth, for people.
fn seconds(time: Option<Duration>) -> String {
    time.map_or(String::from("-"), |time| format!("{:.1}", time.as_secs_f64()))
}

/// Processor time so far of this program and of the commands that have ended, by `/proc/self/stat`
/// of Linux: on a shared machine parts take longer, but hardly more processor time. Programs that a
/// server starts do not count.
pub fn processor_time() -> Option<Duration> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    Some(Duration::from_millis(hundredths_worked(&stat)?.checked_mul(10)?))
}

/// The fields utime, stime, cutime and cstime of proc_pid_stat(5): hundredths of seconds on every
/// Linux of today.
fn hundredths_worked(stat: &str) -> Option<u64> {
    // The name in brackets may hold blanks; behind it the fields begin with the third.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    fields.get(11..15)?.iter().map(|field| field.parse::<u64>().ok()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_of_processors_is_that_of_the_program_and_its_commands() {
        let stat = "42 (a (b) c) S 1 42 42 0 -1 4194304 900 80 0 0 3 5 700 11000 20 0 1 0 99 1 1";
        assert_eq!(hundredths_worked(stat), Some(3 + 5 + 700 + 11000));
        for wrong in ["", "42 (a) S 1 2", "42 (a) S 1 42 42 0 -1 4194304 900 80 0 0 3 x 700 11000 20"] {
            assert_eq!(hundredths_worked(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn closing_line_is_plain() {
        let counts = Counts { passed: 7, failed: 0, skipped: 2 };
        assert_eq!(closing_line(counts), "7 passed, 0 failed, 2 skipped");
    }

    #[test]
    fn exit_code_tells_a_failure_from_a_skip() {
        let mut skips = Report::default();
        assert!(!skips.step("a", || Err(skipped("because"))));
        assert_eq!(skips.close(), ExitCode::SUCCESS);
        let mut failed = Report::default();
        assert!(failed.step("a", || Ok(())));
        assert!(!failed.step("b", || anyhow::bail!("because")));
        assert_eq!(failed.close(), ExitCode::FAILURE);
    }

    #[test]
    fn what_is_skipped_has_failed_where_it_must_run() {
        let mut report = Report { is_strict: true, ..Report::default() };
        report.step("a", || Err(skipped("no emulator")));
        let part = &report.parts[0];
        assert_eq!((part.counts.failed, part.counts.skipped), (1, 0));
        assert!(part.note.contains("no emulator"));
        assert_eq!(report.close(), ExitCode::FAILURE);
    }
}
