//! Python for tests: an environment of its own in the target folder.

use crate::apt;
use crate::repo::{Repo, output_of, run, run_reading};
use crate::report::Counts;
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGES: [&str; 2] = ["python3", "python3-venv"];
const REMEDY: &str = "on Debian run, as root, `apt-get update && apt-get install python3 python3-venv`";

/// The environment of clients and of what drives a browser.
pub const CLIENTS: &str = "python";

/// Makes an environment in a folder of the target folder if it is not there. Returns its Python; the error says why there is none.
pub fn environment(repo: &Repo, folder: &str) -> Result<PathBuf, String> {
    let folder = repo.target.join(folder);
    let python = folder.join("bin/python");
    if output_of(repo.command(&python).arg("--version")).is_some() {
        return Ok(python);
    }
    if output_of(repo.command("python3").args(["-c", "import venv, ensurepip"])).is_none() {
        apt::install(repo, &PACKAGES).map_err(|reason| format!("no Python 3 with venv ({reason}); {REMEDY}"))?;
    }
    let mut venv = repo.command("python3");
    run(venv.args(["-m", "venv", "--clear"]).arg(&folder))
        .map_err(|reason| format!("no environment for Python ({reason}); {REMEDY}"))?;
    Ok(python)
}

/// Brings it up to date with a list of packages from PyPI, a path from the top of the repository.
pub fn install(repo: &Repo, python: &Path, list: &str, options: &[&str]) -> Result<(), String> {
    let mut pip = repo.command(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip.args(options).args(["--requirement", list]);
    run(&mut pip).map_err(|reason| format!("pip could not install {list} from PyPI ({reason})"))
}

/// Before figures that a test prints for the closing table.
const FIGURES: &str = "figures: ";

/// Runs tests and reads how many did what. The note says what went wrong, else `why_skipped` if any were; and the figures that
/// were found last.
pub fn pytest(tests: &mut Command, why_skipped: &str) -> (Counts, String) {
    let (mut counts, mut figures) = (None, None);
    let ended = run_reading(tests, |line| {
        counts = closing_line(line).or(counts);
        figures = line.strip_prefix(FIGURES).map(String::from).or_else(|| figures.take());
    });
    let note = |why: &str| {
        [Some(why), figures.as_deref()]
            .into_iter()
            .flatten()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join(": ")
    };
    match (ended, counts) {
        (Ok(()), Some(counts)) if counts.skipped > 0 => (counts, note(why_skipped)),
        (Ok(()), Some(counts)) => (counts, note("")),
        (Err(_), Some(counts)) if counts.failed > 0 => (counts, note("see above")),
        (ended, counts) => {
            let reason = ended.err().unwrap_or_else(|| String::from("no closing line"));
            let mut counts = counts.unwrap_or_default();
            counts.failed += 1;
            (counts, format!("pytest: {reason}"))
        }
    }
}

/// The counts in pytest's last line: `1 failed, 2 passed, 1 skipped in 3.21s`.
fn closing_line(line: &str) -> Option<Counts> {
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
