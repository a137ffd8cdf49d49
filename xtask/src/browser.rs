//! `cargo xtask browser`: the page of `staya view` in a real browser.

use crate::apt;
use crate::python::{self, pytest};
use crate::repo::{Repo, output_of, run};
use crate::report::{Counts, Report};
use std::path::PathBuf;

const NAME: &str = "pages in a browser";
const TESTS: &str = "tests/browser";
/// Chromium without windows, and what it shows text with.
const PACKAGES: [&str; 4] = [CHROMIUM, "chromium-common", "fontconfig-config", "fonts-dejavu-core"];
const CHROMIUM: &str = "chromium-headless-shell";
const REMEDY: &str = "on Debian run, as root, `apt-get update && apt-get install chromium-headless-shell`";

/// The command: builds the program, and runs the tests with it.
pub fn run_command(repo: &Repo, report: &mut Report) {
    let mut build = repo.cargo(&["build", "--locked", "--package", "staya"]);
    if report.step("staya for its pages", || run(&mut build)) {
        return run_tests(repo, report);
    }
    report.skip(NAME, "the program was not built");
}

/// Makes browser and environment ready, and runs the tests with the program that there is.
pub fn run_tests(repo: &Repo, report: &mut Report) {
    report.part(NAME, || {
        let python = match prepare(repo) {
            Ok(python) => python,
            Err(reason) => {
                println!("skipped: {reason}");
                return (Counts { skipped: 1, ..Counts::default() }, reason);
            }
        };
        let mut tests = repo.command(&python);
        tests.args(["-m", "pytest", "-q", TESTS, "--color", "no", "--timeout", "120", "-p", "no:cacheprovider"]);
        let program = format!("staya{}", std::env::consts::EXE_SUFFIX);
        tests.env("STAYA", repo.target.join("debug").join(program)).env("CHROMIUM", CHROMIUM);
        pytest(&mut tests, "")
    });
}

/// Browser and environment. Returns the Python that drives it; the error says what is missing.
fn prepare(repo: &Repo) -> Result<PathBuf, String> {
    chromium(repo)?;
    let python = python::environment(repo, python::CLIENTS)?;
    python::install(repo, &python, &format!("{TESTS}/requirements.txt"), &[])?;
    Ok(python)
}

/// Makes sure that the browser is there: unpacks it on Debian. The error says why it is not.
fn chromium(repo: &Repo) -> Result<(), String> {
    let starts = || output_of(repo.command(CHROMIUM).arg("--version")).is_some();
    if starts() {
        return Ok(());
    }
    apt::unpack(repo, &PACKAGES, &[CHROMIUM]).map_err(|reason| format!("no {CHROMIUM} ({reason}); {REMEDY}"))?;
    if starts() { Ok(()) } else { Err(format!("{CHROMIUM} does not start; {REMEDY}")) }
}
