//! `cargo xtask clients`: real MAVLink clients against `staya`, from Python.

use crate::apt;
use crate::extent::{Extent, LONG};
use crate::python::{self, pytest};
use crate::repo::{Repo, output_of, run};
use crate::report::Report;
use std::path::PathBuf;

const NAME: &str = "MAVLink clients";
const TESTS: &str = "tests/python";
/// Looks into a capture.
const TSHARK: &str = "tshark";
/// Tests wait for real time more than they compute.
const WORKERS: &str = "12";

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
        let is_short = extent == Extent::Short;
        if is_short {
            // Deselected tests are counted as skipped, with the reason.
            tests.args(["-m", "not long"]);
        }
        let program = format!("staya{}", std::env::consts::EXE_SUFFIX);
        tests.env("STAYA", repo.target.join("debug").join(program));
        pytest(&mut tests, if is_short { LONG } else { "" })
    });
}

/// An environment with pytest, pymavlink and the dialect, up to date. Returns its Python; the error says why there is none.
pub fn environment(repo: &Repo) -> Result<PathBuf, String> {
    let python = python::environment(repo, python::CLIENTS)?;
    python::install(repo, &python, &format!("{TESTS}/requirements.txt"), &[])?;
    let mut dialect = repo.command(&python);
    run(dialect.arg(format!("{TESTS}/dialect.py")))
        .map_err(|reason| format!("the dialect could not be made for Python ({reason})"))?;
    Ok(python)
}

/// The same with all that clients need.
pub fn prepare(repo: &Repo) -> Result<PathBuf, String> {
    let python = environment(repo)?;
    if output_of(repo.command(TSHARK).arg("--version")).is_none() {
        // For root it reads its data and scripts from where it was built for, and nowhere else. Without it one test is skipped.
        let unpack = |_| apt::unpack(repo, &[TSHARK], &[TSHARK]);
        if let Err(reason) = apt::install(repo, &[TSHARK]).or_else(unpack) {
            println!("no {TSHARK} ({reason}); on Debian run, as root, `apt-get update && apt-get install {TSHARK}`");
        }
    }
    python::install(repo, &python, &format!("{TESTS}/mavproxy.txt"), &["--no-deps"])?;
    Ok(python)
}
