//! `cargo xtask python`: the package for Python, as a wheel in an environment of its own, and its tests.

use crate::python::{self, pytest};
use crate::repo::{Repo, output_of, run};
use crate::report::Report;
use std::fs;
use std::path::{Path, PathBuf};

const NAME: &str = "the package for Python";
const TESTS: &str = "tests/python-package";
const PACKAGE: &str = "sim-host/python/python/staya";
/// The environment, and in it the wheel.
const FOLDER: &str = "python-package";
/// Without it there is nothing in the crate.
pub const FEATURE: &str = "staya-python/module";
/// For lints on a machine that may have no Python: links against no libpython, as in a wheel, and asks no interpreter.
pub const WITHOUT_PYTHON: [(&str, &str); 2] = [("PYO3_BUILD_EXTENSION_MODULE", "1"), ("PYO3_NO_PYTHON", "1")];

/// The command: the wheel, types of what is not compiled, tests. `check` lints what is compiled.
pub fn run_command(repo: &Repo, report: &mut Report) {
    let python = match prepare(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip(NAME, &reason),
    };
    if !report.step("the wheel", || wheel(repo, &python)) {
        return report.skip(NAME, "it was not built");
    }
    let mut types = repo.command(&python);
    types.args(["-m", "mypy", "--strict", "--python-executable"]).arg(&python).arg(PACKAGE);
    types.arg("--cache-dir").arg(repo.target.join(FOLDER).join("mypy"));
    report.command("types of the package for Python", types);
    report.part(NAME, || {
        let mut tests = repo.command(&python);
        tests.args(["-m", "pytest", "-q", TESTS, "--color", "no", "--timeout", "300", "-p", "no:cacheprovider"]);
        pytest(&mut tests, "")
    });
}

/// The Python of the environment that [`run_command`] has made, with the wheel in it; makes it if it is not there. The error says why it
/// cannot.
pub fn installed(repo: &Repo) -> Result<PathBuf, String> {
    let python = prepare(repo)?;
    if output_of(repo.command(&python).args(["-c", "import staya"])).is_none() {
        wheel(repo, &python)?;
    }
    Ok(python)
}

/// An environment with what builds the wheel and what its tests need. Returns its Python; the error says why there is none.
fn prepare(repo: &Repo) -> Result<PathBuf, String> {
    let python = python::environment(repo, FOLDER)?;
    python::install(repo, &python, &format!("{TESTS}/requirements.txt"), &[])?;
    Ok(python)
}

/// Builds the wheel with the profile of tests, which is quick to compile and fast enough, and installs it.
fn wheel(repo: &Repo, python: &Path) -> Result<(), String> {
    let wheels = repo.target.join(FOLDER).join("wheels");
    // Nothing but the new one.
    let _ = fs::remove_dir_all(&wheels);
    let mut build = repo.command(python);
    build.args(["-m", "maturin", "build", "--locked", "--profile", "dev", "--target-dir"]).arg(&repo.target);
    run(build.arg("--out").arg(&wheels))?;
    let built = fs::read_dir(&wheels).map_err(|error| format!("{}: {error}", wheels.display()))?;
    let mut install = repo.command(python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--force-reinstall", "--no-deps"]);
    run(install.args(built.flatten().map(|wheel| wheel.path())))
}
