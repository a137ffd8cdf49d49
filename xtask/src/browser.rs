//! `cargo xtask browser`: the page of `staya view` in a real browser.
//!
//! Not yet a part of `cargo xtask test`: a browser is 150 MB of packages, and has been seen to work from `target/tools` on no bare
//! machine yet.

use crate::apt;
use crate::clients::{closing_line, prepare};
use crate::repo::{Repo, output_of, run, run_reading};
use crate::report::Report;

const NAME: &str = "pages in a browser";
const TESTS: &str = "tests/browser";
const CHROMIUM: &str = "chromium";
const REMEDY: &str = "on Debian run, as root, `apt-get update && apt-get install chromium`; \
    what Python needs comes from PyPI (tests/browser/requirements.txt)";

/// The command: builds the program, and runs the tests with it.
pub fn run_command(repo: &Repo, report: &mut Report) {
    let mut build = repo.cargo(&["build", "--locked", "--package", "staya"]);
    if !report.step("staya for its pages", || run(&mut build)) {
        return report.skip(NAME, "the program was not built");
    }
    if output_of(repo.command(CHROMIUM).arg("--version")).is_none()
        && let Err(reason) = apt::install(repo, &[CHROMIUM])
    {
        return report.skip(NAME, &format!("no {CHROMIUM} ({reason}); {REMEDY}"));
    }
    let python = match prepare(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip(NAME, &reason),
    };
    let mut pip = repo.command(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip.args(["--requirement", &format!("{TESTS}/requirements.txt")]);
    if let Err(reason) = run(&mut pip) {
        return report.skip(NAME, &format!("pip could not install {TESTS}/requirements.txt ({reason}); {REMEDY}"));
    }
    report.part(NAME, || {
        let mut tests = repo.command(&python);
        tests.args(["-m", "pytest", "-q", TESTS, "--color", "no", "--timeout", "120"]);
        let program = format!("staya{}", std::env::consts::EXE_SUFFIX);
        tests.env("STAYA", repo.target.join("debug").join(program));
        let mut counts = None;
        let ended = run_reading(&mut tests, |line| counts = closing_line(line).or(counts));
        let mut counts = counts.unwrap_or_default();
        match ended {
            Ok(()) => (counts, String::new()),
            Err(reason) => {
                counts.failed = counts.failed.max(1);
                (counts, format!("pytest: {reason}, see above"))
            }
        }
    });
}
