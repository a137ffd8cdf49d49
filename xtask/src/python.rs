//! Tests in Python, each suite in an environment of its own in the target folder.

use crate::apt::Tools;
use crate::prelude::*;

const PYTHON: Tools = Tools {
    packages: "python3 python3-venv",
    programs: "Python 3 with venv",
    question: "python3 -c 'import venv, ensurepip'",
    ways: "install",
};
/// Looks into a capture.
const TSHARK: Tools = Tools {
    packages: "tshark",
    programs: "tshark",
    question: "tshark --version",
    // For root it reads its data from where it was built for, and nowhere else.
    ways: "install unpack",
};
/// A browser without windows, and its fonts.
const CHROMIUM: Tools = Tools {
    packages: "chromium-headless-shell chromium-common fontconfig-config fonts-dejavu-core",
    programs: "chromium-headless-shell",
    question: "chromium-headless-shell --version",
    ways: "unpack",
};
/// Slurm's daemons and clients, and GNU parallel.
const CLUSTER: Tools = Tools {
    packages: "slurmctld slurmd slurm-client parallel",
    programs: "slurmctld-wlm slurmd-wlm slurmstepd-wlm sbatch squeue scontrol scancel parallel",
    // Slurm's clients want a configuration before they say anything.
    question: "slurmctld-wlm -V && slurmd-wlm -V && command -v sbatch && parallel --version",
    ways: "unpack",
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
    suite(s, "pages in a browser", &["tests/browser", "--timeout", "120"], &[], |repo| {
        CHROMIUM.prepare(repo)?;
        environment(repo, "python", "tests/browser/requirements.txt")
    });
}

/// Sweeps on Slurm and GNU parallel.
pub fn cluster(s: &mut Session) {
    suite(s, "sweeps on Slurm and GNU parallel", &["tests/cluster", "--timeout", "300"], &[], |repo| {
        CLUSTER.prepare(repo)?;
        client_environment(repo)
    });
}

/// The package for Python: a wheel, the types of its Python code, tests.
pub fn package(s: &mut Session) {
    let (repo, python) = (&s.repo, s.repo.target.join(PACKAGE).join("bin/python"));
    let make = || package_environment(repo).and_then(|python| wheel(repo, &python, HERE, &[]));
    let is_made = s.report.step("the wheel", make);
    let wheel_is_there = || if is_made { Ok(()) } else { Err(skipped("the wheel was not built")) };
    s.report.step("types of the package for Python", || {
        wheel_is_there()?;
        let mut types = repo.command(&python);
        types.words("-m mypy --strict sim-host/python/python/staya --python-executable").arg(&python);
        execute(types.arg("--cache-dir").arg(repo.target.join(PACKAGE).join("mypy")))
    });
    s.report.part("the package for Python", || {
        wheel_is_there()?;
        Ok(counted(&mut pytest(repo, &python, &["tests/python-package", "--timeout", "300"])))
    });
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
    suite(s, "robots in POGEMA's world", &arguments, &[], |repo| {
        let python = environment(repo, "python-pogema", "tests/pogema/requirements.txt")?;
        pip(repo, &python, "--no-deps --requirement tests/pogema/toolbox.txt", &[])?;
        wheel(repo, &python, HERE, &[]).map(|()| python)
    });
}

/// The pages as a book with search, in `target/book`; warnings of Sphinx are errors.
pub fn book(s: &mut Session) {
    let (repo, book) = (&s.repo, s.repo.target.join("book"));
    s.report.step("book", || {
        let python = environment(repo, "python-book", "docs/requirements.txt")?;
        files::make_empty(&book)?;
        let mut sphinx = repo.command(python);
        sphinx.words("-m sphinx --quiet --fail-on-warning --fresh-env --conf-dir docs --doctree-dir");
        execute(sphinx.arg(repo.target.join("book-trees")).arg(".").arg(&book))?;
        let index = book.join("index.html");
        println!("{}", index.display());
        files::write(&index, "<meta http-equiv=\"refresh\" content=\"0; url=README.html\">\n")
    });
}

#[derive(clap::Args)]
pub struct Figures {
    /// Where the figures are written [default: target/figures.csv]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Figures before a change, to compare with
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
}

/// The figures of all scenarios and experiments. Paths begin at the top of the repository.
pub fn figures(s: &mut Session, options: &Figures) {
    let program = s.staya("release");
    s.report.step("figures of scenarios and experiments", || {
        let mut figures = s.repo.command("python3");
        figures.arg("xtask/figures.py").env("STAYA", program?);
        for (name, file) in [("--out", &options.out), ("--against", &options.against)] {
            figures.args(file.iter().flat_map(|file| [name.as_ref(), file.as_os_str()]));
        }
        execute(&mut figures)
    });
}

/// Runs a suite on `staya` with further variables and the Python that `prepare` gives.
pub fn suite(
    s: &mut Session,
    name: &str,
    arguments: &[&str],
    variables: &[(&str, String)],
    prepare: impl FnOnce(&Repo) -> Result<PathBuf>,
) {
    let program = s.staya("debug");
    s.report.part(name, || {
        let program = program?;
        let mut tests = pytest(&s.repo, &prepare(&s.repo)?, arguments);
        tests.env("STAYA", program).env("STAYA_TOOLS", s.repo.target.join("tools"));
        tests.env("STAYA_TABLES", &s.repo.target).env("CHROMIUM", CHROMIUM.programs);
        Ok(counted(tests.envs(variables.iter().cloned())))
    });
}

/// pytest with these arguments.
pub fn pytest(repo: &Repo, python: &Path, arguments: &[&str]) -> Command {
    let mut tests = repo.command(python);
    tests.words("-m pytest -q --color no -p no:cacheprovider").args(arguments);
    tests
}

/// An environment in a folder of the target folder, brought up to date with a list of packages from
/// PyPI. Returns its Python. Without it a part is skipped.
fn environment(repo: &Repo, folder: &str, list: &str) -> Result<PathBuf> {
    let folder = repo.target.join(folder);
    let python = folder.join("bin/python");
    if output_of(repo.command(&python).arg("--version")).is_none() {
        PYTHON.prepare(repo)?;
        let made = execute(repo.command("python3").words("-m venv --clear").arg(&folder));
        made.map_err(|reason| skipped(format!("no environment for Python ({reason:#})")))?;
    }
    pip(repo, &python, "--requirement", &[Path::new(list)])?;
    Ok(python)
}

/// Installs packages into an environment. Without them a part is skipped.
pub fn pip(repo: &Repo, python: &Path, options: &str, packages: &[&Path]) -> Result<()> {
    let mut pip = repo.command(python);
    pip.words("-m pip install --quiet --disable-pip-version-check").words(options).args(packages);
    execute(&mut pip).map_err(|reason| skipped(format!("pip could not install packages ({reason:#}), see above")))
}

/// The environment of clients: pytest, pymavlink and the dialect.
pub fn client_environment(repo: &Repo) -> Result<PathBuf> {
    let python = environment(repo, "python", "tests/python/requirements.txt")?;
    let dialect = execute(repo.command(&python).arg("tests/python/dialect.py"));
    dialect.map_err(|reason| skipped(format!("the dialect could not be made for Python ({reason:#})")))?;
    Ok(python)
}

/// The same with MAVProxy, DroneKit and tshark. Without tshark one test is skipped.
pub fn client_tools(repo: &Repo) -> Result<PathBuf> {
    let python = client_environment(repo)?;
    TSHARK.prepare(repo).unwrap_or_else(|reason| println!("{reason}"));
    pip(repo, &python, "--no-deps --requirement tests/python/without-dependencies.txt", &[])?;
    Ok(python)
}

/// The environment with RVO2.
pub fn rvo2_environment(repo: &Repo) -> Result<PathBuf> {
    environment(repo, "python-rvo2", "tests/rvo2/requirements.txt")
}

/// The environment in which the package is tested.
pub fn package_environment(repo: &Repo) -> Result<PathBuf> {
    environment(repo, PACKAGE, "tests/python-package/requirements.txt")
}

/// The Python of an environment in which the wheel is.
pub fn with_wheel(repo: &Repo) -> Result<PathBuf> {
    let python = package_environment(repo)?;
    if output_of(repo.command(&python).args(["-c", "import staya"])).is_none() {
        wheel(repo, &python, HERE, &[])?;
    }
    Ok(python)
}

/// Options of pip for the environment itself.
const HERE: &str = "--force-reinstall --no-deps";

/// Builds the wheel with the profile of tests, which is quick to compile and fast enough, and
/// installs it by pip with these options and further arguments.
pub fn wheel(repo: &Repo, python: &Path, options: &str, further: &[&Path]) -> Result<()> {
    let wheels = repo.target.join(PACKAGE).join("wheels");
    files::make_empty(&wheels)?;
    let mut build = repo.command(python);
    build.words("-m maturin build --locked --profile dev --target-dir").arg(&repo.target);
    execute(build.arg("--out").arg(&wheels))?;
    let built = files::entries(&wheels)?;
    pip(repo, python, options, &further.iter().copied().chain(built.iter().map(PathBuf::as_path)).collect::<Vec<_>>())
}
