//! `cargo xtask test`: everything that shows by running whether it is right.

use crate::device::Toolchains;
use crate::repo::{Repo, run_reading};
use crate::report::{Counts, Report, parse_test_result};
use std::process::Command;

/// Tests in a module of this name read data beside the repository, which CI has.
const NEEDS_SHARED: &str = "needs_shared::";

/// Why tests are left out that only [`Extent::All`] runs.
pub const LONG: &str = "long proofs run with `cargo xtask test --all`";

/// How much is tested.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// What every change should pass: all tests on the host but the long ones, clients, each part once.
    Short,
    /// All there is: besides, peers, every program on every part, debug builds, budgets, long tests.
    All,
}

/// Host tests and clients, then what other targets and other workspaces can show.
pub fn run(repo: &Repo, report: &mut Report, extent: Extent) {
    let mut why_skipped = Vec::new();
    let mut options = Vec::new();
    match extent {
        Extent::Short => why_skipped.push(String::from(LONG)),
        Extent::All => options.push("--include-ignored"),
    }
    let shared = std::env::var_os("STAYA_SHARED")
        .map_or_else(|| repo.root.join("../shared"), std::path::PathBuf::from);
    if !shared.is_dir() {
        options.extend(["--skip", NEEDS_SHARED]);
        let folder = shared.display();
        why_skipped.push(format!("{NEEDS_SHARED}* need {folder}, which is not there"));
    }
    let why_skipped = why_skipped.join("; ");
    let arguments = ["test", "--locked", "--workspace", "--no-fail-fast"];
    let mut build = repo.cargo(&arguments);
    report.command("tests on the host, compiled", {
        build.arg("--no-run");
        build
    });
    let mut tests = repo.cargo(&arguments);
    tests.arg("--").args(options);
    report.part("tests on the host", || counted(&mut tests, &why_skipped));
    crate::clients::run_command(repo, report, None, extent);
    let mut toolchains = Toolchains::default();
    if extent == Extent::Short {
        crate::swarms::run_short(repo, report, &mut toolchains);
        return crate::emulated::run(repo, report);
    }
    crate::swarms::run(repo, report, &mut toolchains);
    crate::size::run(repo, report, &mut toolchains, false);
    crate::faults::run(repo, report, &mut toolchains);
    crate::emulated::run(repo, report);
    crate::emulated::run_ten(repo, report);
    crate::device::run(repo, report);
    crate::example::run(repo, report);
    let mut peers = repo.cargo_in("tests/peers", &["test", "--locked"]);
    report.part("same results as peers", || counted(&mut peers, ""));
    let fuzz = ["test", "--locked", "--no-default-features"];
    let mut fuzz = repo.cargo_in("tests/fuzz", &fuzz);
    report.part("fuzz targets on random bytes", || counted(&mut fuzz, ""));
}

/// Runs test programs and adds up their closing lines. A program that ends without one (it
/// crashed, or did not compile) is one failure. `why_skipped` is the note if anything was.
pub fn counted(tests: &mut Command, why_skipped: &str) -> (Counts, String) {
    let mut sum = Counts::default();
    let ended = run_reading(tests, |line| {
        if let Some(counts) = parse_test_result(line) {
            sum += counts;
        }
    });
    let mut notes = Vec::new();
    match ended {
        Err(reason) if sum.failed == 0 => {
            sum.failed = 1;
            notes.push(format!("cargo test: {reason}"));
        }
        Err(_) => notes.push(String::from("see above")),
        Ok(()) => {}
    }
    if sum.skipped > 0 && !why_skipped.is_empty() {
        notes.push(why_skipped.to_string());
    }
    (sum, notes.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn closing_lines_add_up() {
        let line = "test result: ok. 2 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out";
        let (counts, note) = counted(&mut shell(&format!("echo '{line}'; echo '{line}'")), "why");
        assert_eq!(
            counts,
            Counts {
                passed: 4,
                failed: 0,
                skipped: 2
            }
        );
        assert_eq!(note, "why");
    }

    #[test]
    fn crash_without_a_closing_line_is_a_failure() {
        let (counts, note) = counted(&mut shell("echo running 3 tests; exit 101"), "");
        assert_eq!(counts.failed, 1);
        assert!(note.contains("101"), "{note}");
    }

    #[test]
    fn failure_does_not_hide_why_something_was_skipped() {
        let line = "test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 3 filtered out";
        let (counts, note) = counted(&mut shell(&format!("echo '{line}'; exit 101")), "why");
        assert_eq!((counts.failed, counts.skipped), (1, 3));
        assert_eq!(note, "see above; why");
    }

    #[test]
    fn failure_is_counted_once() {
        let line = "test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured";
        let (counts, _) = counted(&mut shell(&format!("echo '{line}'; exit 101")), "");
        assert_eq!(
            counts,
            Counts {
                passed: 2,
                failed: 1,
                skipped: 0
            }
        );
    }
}
