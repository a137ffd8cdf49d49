//! Tests in Python, each suite in an environment of its own in the target folder.

use crate::apt::Tools;
use crate::files;
use crate::options::Options;
use crate::repo::{Repo, output_of, run};
use crate::session::Session;
use crate::tally::counted;
use std::path::{Path, PathBuf};
use std::process::Command;

const PYTHON: Tools = Tools {
    packages: &["python3", "python3-venv"],
    programs: &["Python 3 with venv"],
    question: "python3 -c 'import venv, ensurepip'",
};
/// Looks into a capture.
const TSHARK: Tools = Tools { packages: &["tshark"], programs: &["tshark"], question: "tshark --version" };
/// A browser without windows, and its fonts.
const CHROMIUM: Tools = Tools {
    packages: &["chromium-headless-shell", "chromium-common", "fontconfig-config", "fonts-dejavu-core"],
    programs: &["chromium-headless-shell"],
    question: "chromium-headless-shell --version",
};
/// Slurm's daemons and clients, and GNU parallel.
const CLUSTER: Tools = Tools {
    packages: &["slurmctld", "slurmd", "slurm-client", "parallel"],
    programs: &["slurmctld-wlm", "slurmd-wlm", "slurmstepd-wlm", "sbatch", "squeue", "scontrol", "scancel", "parallel"],
    // Slurm's clients want a configuration before they say anything.
    question: "slurmctld-wlm -V && slurmd-wlm -V && command -v sbatch && parallel --version",
};
/// The package for Python, which has nothing in it without this feature.
pub const FEATURE: &str = "staya-python/module";
/// For lints on a machine that may have no Python: links against no libpython, as in a wheel, and
/// asks no interpreter.
pub const WITHOUT_PYTHON: [(&str, &str); 2] = [("PYO3_BUILD_EXTENSION_MODULE", "1"), ("PYO3_NO_PYTHON", "1")];
/// The environment with the wheel.
const PACKAGE: &str = "python-package";

/// MAVLink clients against `staya`: the tests whose names contain `only`; long ones only if all are
/// wanted.
pub fn clients(s: &mut Session, only: Option<&str>, is_all: bool) {
    // Tests wait for real time more than they compute.
    let mut arguments = vec!["tests/python", "-n", "12", "--dist", "worksteal"];
    arguments.extend(only.into_iter().flat_map(|name| ["-k", name]));
    arguments.extend(if is_all { &[][..] } else { &["-m", "not long"] });
    suite(s, "MAVLink clients", &arguments, &[], client_tools);
}

/// Pages of `staya view` in a browser.
pub fn browser(s: &mut Session) {
    let variables = [("CHROMIUM", CHROMIUM.programs[0].to_string())];
    suite(s, "pages in a browser", &["tests/browser", "--timeout", "120"], &variables, |repo| {
        CHROMIUM.prepare(repo)?;
        environment(repo, "python", "tests/browser/requirements.txt")
    });
}

/// Sweeps on Slurm and GNU parallel.
pub fn cluster(s: &mut Session) {
    let variables = [("STAYA_TOOLS", s.repo.target.join("tools").display().to_string())];
    suite(s, "sweeps on Slurm and GNU parallel", &["tests/cluster", "--timeout", "300"], &variables, |repo| {
        CLUSTER.prepare(repo)?;
        client_environment(repo)
    });
}

/// The package for Python: a wheel, the types of its Python code, tests.
pub fn package(s: &mut Session) {
    const NAME: &str = "the package for Python";
    let Some(python) = s.report.need(NAME, package_environment(&s.repo)) else { return };
    if !s.report.step("the wheel", || wheel(&s.repo, &python)) {
        return s.report.skip(NAME, "the wheel was not built");
    }
    let mut types = s.repo.command(&python);
    types.args(["-m", "mypy", "--strict", "--python-executable"]).arg(&python).arg("sim-host/python/python/staya");
    types.arg("--cache-dir").arg(s.repo.target.join(PACKAGE).join("mypy"));
    s.report.command("types of the package for Python", types);
    let mut tests = pytest(&s.repo, &python, &["tests/python-package", "--timeout", "300"]);
    s.report.part(NAME, || counted(&mut tests));
}

/// Robots that negotiate in POGEMA's world and by its rules in the simulator: a few maps, or all of
/// its tables, which it writes to `target/pogema.csv` and `target/pogema`.
pub fn pogema(s: &mut Session, is_all: bool) {
    let mut arguments = vec!["tests/pogema"];
    if is_all {
        let _ = std::fs::remove_file(s.repo.target.join("pogema.csv"));
    } else {
        arguments.extend(["-m", "not long"]);
    }
    let variables = [("STAYA_TABLES", s.repo.target.display().to_string())];
    suite(s, "robots in POGEMA's world", &arguments, &variables, |repo| {
        let python = environment(repo, "python-pogema", "tests/pogema/requirements.txt")?;
        pip(repo, &python, &["--no-deps", "--requirement", "tests/pogema/toolbox.txt"])?;
        wheel(repo, &python).map(|()| python)
    });
}

/// The pages as a book with search, in `target/book`; warnings of Sphinx are errors.
pub fn book(s: &mut Session) {
    let (repo, book) = (&s.repo, s.repo.target.join("book"));
    s.report.step_with("book", environment(repo, "python-book", "docs/requirements.txt"), |python| {
        files::make_empty(&book)?;
        let mut sphinx = repo.command(python);
        sphinx.args(["-m", "sphinx", "--quiet", "--fail-on-warning", "--fresh-env", "--conf-dir", "docs"]);
        run(sphinx.arg("--doctree-dir").arg(repo.target.join("book-trees")).arg(".").arg(&book))?;
        let index = book.join("index.html");
        println!("{}", index.display());
        files::write(&index, "<meta http-equiv=\"refresh\" content=\"0; url=README.html\">\n")
    });
}

/// The figures of all scenarios and experiments, in `target/figures.csv` or `--out`, compared with
/// those of `--against`. Paths begin at the top of the repository.
pub fn figures(s: &mut Session, options: &Options<'_>) {
    let program = s.staya("release");
    s.report.step_with("figures of scenarios and experiments", program, |staya| {
        let mut figures = s.repo.command("python3");
        figures.arg("xtask/figures.py").args(options.all_of(&["--out", "--against"]));
        run(figures.env("STAYA", staya))
    });
}

/// Runs a suite on `staya`, which is in the variable `STAYA`, with further variables and the Python
/// that `prepare` gives.
pub fn suite(
    s: &mut Session,
    name: &str,
    arguments: &[&str],
    variables: &[(&str, String)],
    prepare: impl FnOnce(&Repo) -> Result<PathBuf, String>,
) {
    let program = s.staya("debug");
    let ready = program.and_then(|program| Ok((program, prepare(&s.repo)?)));
    if let Some((program, python)) = s.report.need(name, ready) {
        let mut tests = pytest(&s.repo, &python, arguments);
        tests.env("STAYA", program).envs(variables.iter().cloned());
        s.report.part(name, || counted(&mut tests));
    }
}

/// pytest with these arguments.
pub fn pytest(repo: &Repo, python: &Path, arguments: &[&str]) -> Command {
    let mut tests = repo.command(python);
    tests.args(["-m", "pytest", "-q", "--color", "no", "-p", "no:cacheprovider"]).args(arguments);
    tests
}

/// An environment in a folder of the target folder, brought up to date with a list of packages from
/// PyPI. Returns its Python.
fn environment(repo: &Repo, folder: &str, list: &str) -> Result<PathBuf, String> {
    let folder = repo.target.join(folder);
    let python = folder.join("bin/python");
    if output_of(repo.command(&python).arg("--version")).is_none() {
        PYTHON.prepare_with(repo, Tools::install)?;
        run(repo.command("python3").args(["-m", "venv", "--clear"]).arg(&folder))
            .map_err(|reason| format!("no environment for Python ({reason})"))?;
    }
    pip(repo, &python, &["--requirement", list])?;
    Ok(python)
}

/// Installs packages into an environment.
pub fn pip(repo: &Repo, python: &Path, arguments: &[&str]) -> Result<(), String> {
    let mut pip = repo.command(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(arguments);
    run(&mut pip).map_err(|reason| format!("pip could not install {} ({reason})", arguments.join(" ")))
}

/// The environment of clients: pytest, pymavlink and the dialect.
pub fn client_environment(repo: &Repo) -> Result<PathBuf, String> {
    let python = environment(repo, "python", "tests/python/requirements.txt")?;
    run(repo.command(&python).arg("tests/python/dialect.py"))
        .map_err(|reason| format!("the dialect could not be made for Python ({reason})"))?;
    Ok(python)
}

/// The same with MAVProxy and tshark.
pub fn client_tools(repo: &Repo) -> Result<PathBuf, String> {
    let python = client_environment(repo)?;
    // For root it reads its data from where it was built for, and nowhere else. Without it one test
    // is skipped.
    let tshark = TSHARK.prepare_with(repo, |tools, repo| tools.install(repo).or_else(|_| tools.unpack(repo)));
    tshark.unwrap_or_else(|reason| println!("{reason}"));
    pip(repo, &python, &["--no-deps", "--requirement", "tests/python/mavproxy.txt"])?;
    Ok(python)
}

fn package_environment(repo: &Repo) -> Result<PathBuf, String> {
    environment(repo, PACKAGE, "tests/python-package/requirements.txt")
}

/// The Python of an environment in which the wheel is.
pub fn with_wheel(repo: &Repo) -> Result<PathBuf, String> {
    let python = package_environment(repo)?;
    if output_of(repo.command(&python).args(["-c", "import staya"])).is_none() {
        wheel(repo, &python)?;
    }
    Ok(python)
}

/// Builds the wheel with the profile of tests, which is quick to compile and fast enough, and
/// installs it.
fn wheel(repo: &Repo, python: &Path) -> Result<(), String> {
    let wheels = repo.target.join(PACKAGE).join("wheels");
    files::make_empty(&wheels)?;
    let mut build = repo.command(python);
    build.args(["-m", "maturin", "build", "--locked", "--profile", "dev", "--target-dir"]).arg(&repo.target);
    run(build.arg("--out").arg(&wheels))?;
    let built: Vec<String> = files::entries(&wheels)?.iter().map(|wheel| wheel.display().to_string()).collect();
    let wheels = built.iter().map(String::as_str);
    pip(repo, python, &["--force-reinstall", "--no-deps"].into_iter().chain(wheels).collect::<Vec<_>>())
}
