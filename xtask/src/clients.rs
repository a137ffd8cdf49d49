//! `cargo xtask clients`: real MAVLink clients against `staya`, from Python.

use crate::apt;
use crate::extent::{Extent, LONG};
use crate::repo::{Repo, output_of, run, run_reading};
use crate::report::{Counts, Report};
use std::path::PathBuf;

const NAME: &str = "MAVLink clients";
const TESTS: &str = "tests/python";
const PYTHON: [&str; 2] = ["python3", "python3-venv"];
/// Looks into a capture.
const TSHARK: &str = "tshark";
const REMEDY: &str = "on Debian run, as root, `apt-get update && apt-get install python3 python3-venv tshark`; \
    what Python needs comes from PyPI (tests/python/requirements.txt)";
/// Tests wait for real time more than they compute.
const WORKERS: &str = "4";

/// The command: builds the program, and runs the tests.
pub fn run_command(repo: &Repo, report: &mut Report, only: Option<&str>, extent: Extent) {
    let mut build = repo.cargo(&["build", "--locked", "--package", "staya"]);
    if report.step("staya for its clients", || run(&mut build)) {
        return run_tests(repo, report, only, extent);
    }
    report.skip(NAME, "the program was not built");
}

/// Makes the environment and runs the tests with the program that there is; `only` the tests whose names contain it,
/// and of those with the mark `long` none unless all are wanted.
pub fn run_tests(repo: &Repo, report: &mut Report, only: Option<&str>, extent: Extent) {
    let python = match prepare(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip(NAME, &reason),
    };
    report.part(NAME, || {
        let mut tests = repo.command(&python);
        tests.args(["-m", "pytest", "-q", TESTS, "-n", WORKERS]);
        tests.args(["--dist", "worksteal", "--color", "no"]);
        tests.args(only.into_iter().flat_map(|name| ["-k", name]));
        if extent == Extent::Short {
            // Deselected tests are counted as skipped, with the reason.
            tests.args(["-m", "not long"]);
        }
        let program = format!("staya{}", std::env::consts::EXE_SUFFIX);
        tests.env("STAYA", repo.target.join("debug").join(program));
        let mut counts = None;
        let ended = run_reading(&mut tests, |line| {
            counts = closing_line(line).or(counts);
        });
        match (ended, counts) {
            (Ok(()), Some(counts)) if counts.skipped > 0 && extent == Extent::Short => (counts, String::from(LONG)),
            (Ok(()), Some(counts)) => (counts, String::new()),
            (Err(_), Some(counts)) if counts.failed > 0 => (counts, String::from("see above")),
            (ended, counts) => {
                let reason = ended.err().unwrap_or_else(|| String::from("no closing line"));
                let mut counts = counts.unwrap_or_default();
                counts.failed += 1;
                (counts, format!("pytest: {reason}"))
            }
        }
    });
}

/// An environment of its own in the target folder, up to date. Returns its Python; the error says why there is none.
pub fn prepare(repo: &Repo) -> Result<PathBuf, String> {
    let folder = repo.target.join("python");
    let python = folder.join("bin/python");
    let system_python = || output_of(repo.command("python3").args(["-c", "import venv, ensurepip"]));
    if system_python().is_none() {
        apt::install(repo, &PYTHON).map_err(|reason| format!("no Python 3 with venv ({reason}); {REMEDY}"))?;
    }
    if output_of(repo.command(TSHARK).arg("--version")).is_none() {
        // For root it reads its data and scripts from where it was built for, and nowhere else. Without it one test is skipped.
        let unpack = |_| apt::unpack(repo, &[TSHARK], &[TSHARK]);
        if let Err(reason) = apt::install(repo, &[TSHARK]).or_else(unpack) {
            println!("no {TSHARK} ({reason}); {REMEDY}");
        }
    }
    if output_of(repo.command(&python).arg("--version")).is_none() {
        let mut venv = repo.command("python3");
        run(venv.args(["-m", "venv", "--clear"]).arg(&folder))
            .map_err(|reason| format!("no environment for Python ({reason}); {REMEDY}"))?;
    }
    for (list, options) in [("requirements.txt", &[][..]), ("mavproxy.txt", &["--no-deps"])] {
        let mut pip = repo.command(&python);
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        pip.args(options);
        pip.args(["--requirement", &format!("{TESTS}/{list}")]);
        run(&mut pip).map_err(|reason| format!("pip could not install tests/python/{list} ({reason}); {REMEDY}"))?;
    }
    let mut dialect = repo.command(&python);
    run(dialect.arg(format!("{TESTS}/dialect.py")))
        .map_err(|reason| format!("the dialect could not be made for Python ({reason})"))?;
    Ok(python)
}

/// The counts in pytest's last line: `1 failed, 2 passed, 1 skipped in 3.21s`.
pub fn closing_line(line: &str) -> Option<Counts> {
    let (counts, time) = line.trim_matches(['=', ' ']).rsplit_once(" in ")?;
    if !time.contains('s') || !time.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    let mut sum = Counts::default();
    for field in counts.split(", ") {
        let (number, what) = field.split_once(' ')?;
        let number: u64 = number.parse().ok()?;
        match what {
            "passed" => sum.passed += number,
            "failed" | "error" | "errors" | "xpassed" => sum.failed += number,
            "skipped" | "deselected" | "xfailed" => sum.skipped += number,
            _ => {}
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_line_is_counted() {
        let line = "==== 1 failed, 12 passed, 2 skipped, 1 error in 63.21s (0:01:03) ====";
        let counts = Counts { passed: 12, failed: 2, skipped: 2 };
        assert_eq!(closing_line(line), Some(counts));
        assert_eq!(closing_line("3 passed in 0.12s").map(|counts| counts.passed), Some(3));
    }

    #[test]
    fn other_lines_are_not() {
        for line in [
            "",
            "tests/python/test_a.py ....  [100%]",
            "FAILED test_a.py::test_b - assert 1 in (2, 3)",
            "no tests ran in 0.01s",
        ] {
            assert_eq!(closing_line(line), None, "{line}");
        }
    }
}
