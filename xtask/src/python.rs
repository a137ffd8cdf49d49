//! Tests in Python, each suite in an environment of its own in the target folder.

use crate::apt::Tools;
use crate::extent::Extent;
use crate::files;
use crate::repo::{Repo, output_of, run};
use crate::session::Session;
use crate::tally::counted;
use std::path::{Path, PathBuf};
use std::process::Command;

const PYTHON: Tools = Tools { packages: &["python3", "python3-venv"], programs: &["Python 3 with venv"] };
/// Looks into a capture.
const TSHARK: Tools = Tools { packages: &["tshark"], programs: &["tshark"] };
/// A browser without windows, and its fonts.
const CHROMIUM: Tools = Tools {
    packages: &["chromium-headless-shell", "chromium-common", "fontconfig-config", "fonts-dejavu-core"],
    programs: &["chromium-headless-shell"],
};
/// Slurm's daemons and clients, and GNU parallel.
const CLUSTER: Tools = Tools {
    packages: &["slurmctld", "slurmd", "slurm-client", "parallel"],
    programs: &["slurmctld-wlm", "slurmd-wlm", "slurmstepd-wlm", "sbatch", "squeue", "scontrol", "scancel", "parallel"],
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
pub fn clients(s: &mut Session, only: Option<&str>, extent: Extent) {
    // Tests wait for real time more than they compute.
    let mut arguments = vec!["tests/python", "-n", "12", "--dist", "worksteal"];
    arguments.extend(only.into_iter().flat_map(|name| ["-k", name]));
    if extent == Extent::Short {
        arguments.extend(["-m", "not long"]);
    }
    let program = s.staya("debug");
    suite(s, "MAVLink clients", Suite { program, arguments: &arguments, ..Suite::default() }, client_tools);
}

/// Pages of `staya view` in a browser.
pub fn browser(s: &mut Session) {
    let prepare = |repo: &Repo| {
        CHROMIUM.prepare(repo, || output_of(repo.command(CHROMIUM.programs[0]).arg("--version")).is_some())?;
        environment(repo, "python", "tests/browser/requirements.txt")
    };
    let program = s.staya("debug");
    let environment = vec![("CHROMIUM", CHROMIUM.programs[0].to_string())];
    let arguments = &["tests/browser", "--timeout", "120"];
    suite(s, "pages in a browser", Suite { program, environment, arguments }, prepare);
}

/// Sweeps on Slurm and GNU parallel.
pub fn cluster(s: &mut Session) {
    let prepare = |repo: &Repo| {
        // Slurm's clients want a configuration before they say anything.
        let question = "slurmctld-wlm -V && slurmd-wlm -V && command -v sbatch && parallel --version";
        CLUSTER.prepare(repo, || output_of(repo.command("sh").args(["-c", question])).is_some())?;
        client_environment(repo)
    };
    let program = s.staya("debug");
    let environment = vec![("STAYA_TOOLS", s.repo.target.join("tools").display().to_string())];
    let arguments = &["tests/cluster", "--timeout", "300"];
    suite(s, "sweeps on Slurm and GNU parallel", Suite { program, environment, arguments }, prepare);
}

/// The package for Python: a wheel, the types of its Python code, tests.
pub fn package(s: &mut Session) {
    const NAME: &str = "the package for Python";
    let python = match package_environment(&s.repo) {
        Ok(python) => python,
        Err(reason) => return s.report.skip(NAME, &reason),
    };
    if !s.report.step("the wheel", || wheel(&s.repo, &python)) {
        return s.report.skip(NAME, "the wheel was not built");
    }
    let mut types = s.repo.command(&python);
    types.args(["-m", "mypy", "--strict", "--python-executable"]).arg(&python).arg("sim-host/python/python/staya");
    types.arg("--cache-dir").arg(s.repo.target.join(PACKAGE).join("mypy"));
    s.report.command("types of the package for Python", types);
    let arguments = &["tests/python-package", "--timeout", "300"];
    suite(s, NAME, Suite { program: Some(python), arguments, ..Suite::default() }, package_environment);
}

/// Robots that negotiate in POGEMA's world and by its rules in the simulator: a few maps, or all of
/// its tables, which it writes to `target/pogema.csv` and `target/pogema`.
pub fn pogema(s: &mut Session, extent: Extent) {
    let prepare = |repo: &Repo| {
        let python = environment(repo, "python-pogema", "tests/pogema/requirements.txt")?;
        pip(repo, &python, &["--no-deps", "--requirement", "tests/pogema/toolbox.txt"])?;
        wheel(repo, &python)?;
        Ok(python)
    };
    let tables = s.repo.target.display().to_string();
    let arguments = match extent {
        Extent::Short => &["tests/pogema", "-m", "not long"][..],
        Extent::All => {
            let _ = std::fs::remove_file(s.repo.target.join("pogema.csv"));
            &["tests/pogema"]
        }
    };
    let program = s.staya("debug");
    let suite_of = Suite { program, environment: vec![("STAYA_TABLES", tables)], arguments };
    suite(s, "robots in POGEMA's world", suite_of, prepare);
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

/// The setting of a suite.
#[derive(Default)]
pub struct Suite<'a> {
    /// The program under test, in the variable `STAYA`; the suite is skipped without it.
    pub program: Option<PathBuf>,
    /// Further variables.
    pub environment: Vec<(&'static str, String)>,
    /// pytest's arguments.
    pub arguments: &'a [&'a str],
}

/// Runs a suite with the Python that `prepare` gives.
pub fn suite(s: &mut Session, name: &str, suite: Suite<'_>, prepare: impl FnOnce(&Repo) -> Result<PathBuf, String>) {
    let program = suite.program.ok_or_else(|| String::from("the program was not built"));
    match program.and_then(|program| Ok((program, prepare(&s.repo)?))) {
        Err(reason) => s.report.skip(name, &reason),
        Ok((program, python)) => {
            let mut tests = pytest(&s.repo, &python, suite.arguments);
            tests.env("STAYA", program).envs(suite.environment);
            s.report.part(name, || counted(&mut tests, ""));
        }
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
        let has_venv = || output_of(repo.command("python3").args(["-c", "import venv, ensurepip"])).is_some();
        if !has_venv() {
            PYTHON.install(repo)?;
        }
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
    if output_of(repo.command("tshark").arg("--version")).is_none() {
        // For root it reads its data from where it was built for, and nowhere else. Without it one
        // test is skipped.
        if let Err(reason) = TSHARK.install(repo).or_else(|_| TSHARK.unpack(repo)) {
            println!("no tshark ({reason}); on Debian run, as root, `apt-get update && apt-get install tshark`");
        }
    }
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
