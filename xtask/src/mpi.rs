//! `cargo xtask mpi`: one world over ranks, with OpenMPI from Debian's packages. Missing
//! packages are unpacked into `target/tools`.

use crate::apt::Tools;
use crate::files;
use crate::python::{client_environment, suite};
use crate::repo::{Repo, run as run_command};
use crate::session::Session;
use std::path::{Path, PathBuf};

const NAME: &str = "one world over ranks of OpenMPI";
const MPI: Tools = Tools {
    packages: &["openmpi-bin", "libopenmpi-dev", "libclang1"],
    programs: &["mpirun.openmpi", "mpicc.openmpi"],
    question: "test -f \"$1/mpirun.openmpi\"",
};

/// Builds `staya-mpi` and compares it with `staya`.
pub fn run(s: &mut Session) {
    if let Some(variables) = build(s, &[]) {
        suite(s, NAME, &["tests/mpi", "--timeout", "600"], &variables, client_environment);
    }
}

/// Times on 1, 2 and 4 ranks by an optimised build, on a machine that does nothing else.
pub fn run_scaling(s: &mut Session) {
    let Some(variables) = build(s, &["--release"]) else { return };
    let mut times = s.repo.command("python3");
    times.arg("tests/mpi/scaling.py").envs(variables).env("STAYA", s.repo.program("release", "staya"));
    s.report.command("200,000 robots on 1, 2 and 4 ranks", times);
}

/// Makes OpenMPI ready and builds `staya-mpi`. Returns the variables of both; none if it cannot be
/// built.
fn build(s: &mut Session, options: &[&str]) -> Option<Vec<(&'static str, String)>> {
    let variables = s.report.need(NAME, variables(&s.repo))?;
    let mut build = s.repo.cargo(&["build", "--locked", "--package", "staya-mpi", "--features", "mpi"]);
    build.args(options).envs(variables.iter().cloned());
    s.report.step("staya-mpi", || run_command(&mut build)).then_some(variables)
}

/// The variables by which programs find OpenMPI; none where it is installed.
fn variables(repo: &Repo) -> Result<Vec<(&'static str, String)>, String> {
    if repo.says("mpirun --version && mpicc -show && ldconfig -p | grep libclang") {
        return Ok(Vec::new());
    }
    MPI.prepare(repo)?;
    let root = repo.target.join("tools/unpacked/usr");
    let libraries = files::entries(&root.join("lib"))?;
    let find = |file: &str| -> Result<&PathBuf, String> {
        let found = libraries.iter().find(|folder| folder.join(file).exists());
        found.ok_or_else(|| format!("the packages hold no {file}"))
    };
    let openmpi = find("openmpi")?.display();
    // clang's own headers are a package more; the compiler's do as well.
    let headers = repo.answer("cc -print-file-name=include").ok_or("no C compiler")?;
    let shown = |path: &Path| path.display().to_string();
    Ok(vec![
        ("OPAL_PREFIX", shown(&root)),
        ("LD_LIBRARY_PATH", format!("{openmpi}:{openmpi}/openmpi/lib")),
        ("LIBCLANG_PATH", shown(&find("lib/libclang.so.1")?.join("lib"))),
        ("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{headers}")),
        ("MPICC", shown(&repo.tools().join(MPI.programs[1]))),
        ("MPIRUN", MPI.programs[0].to_string()),
    ])
}
