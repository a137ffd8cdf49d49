//! `cargo xtask mpi`: one world over ranks, with OpenMPI from Debian's packages. Missing
//! packages are unpacked into `target/tools`.

use crate::apt::Tools;
use crate::prelude::*;
use crate::python::{client_environment, suite};

const NAME: &str = "one world over ranks of OpenMPI";
const MPI: Tools = Tools {
    packages: "openmpi-bin libopenmpi-dev libclang1",
    programs: "mpirun.openmpi mpicc.openmpi",
    question: "test -f \"$1/mpirun.openmpi\"",
    ways: "unpack",
};

/// Builds `staya-mpi` and compares it with `staya`; with `is_scaling` times on 1, 2 and 4 ranks by
/// an optimised build, on a machine that does nothing else.
pub fn run(s: &mut Session, is_scaling: bool) {
    let mut variables = Vec::new();
    let is_built = s.report.step("staya-mpi", || {
        variables = find(&s.repo).map_err(|reason| skipped(format!("{reason:#}")))?;
        let mut build = s.repo.cargo("build --locked --package staya-mpi --features mpi");
        execute(build.args(is_scaling.then_some("--release")).envs(variables.iter().cloned()))
    });
    let is_ready = || if is_built { Ok(()) } else { Err(skipped("staya-mpi was not built")) };
    if is_scaling {
        s.report.step("200,000 robots on 1, 2 and 4 ranks", || {
            is_ready()?;
            let mut times = s.repo.command("python3");
            times.arg("tests/mpi/scaling.py").envs(variables).env("STAYA", s.repo.program("release", "staya"));
            execute(&mut times)
        });
    } else {
        suite(s, NAME, &["tests/mpi", "--timeout", "600"], &variables, |repo| {
            is_ready()?;
            client_environment(repo)
        });
    }
}

/// The variables by which programs find OpenMPI; none where it is installed.
pub fn find(repo: &Repo) -> Result<Vec<(&'static str, String)>> {
    if repo.says("mpirun --version && mpicc -show && ldconfig -p | grep libclang") {
        return Ok(Vec::new());
    }
    MPI.prepare(repo)?;
    let root = repo.target.join("tools/unpacked/usr");
    let libraries = files::entries(&root.join("lib"))?;
    let find = |file: &str| {
        let found = libraries.iter().find(|folder| folder.join(file).exists());
        found.map(|folder| folder.display()).with_context(|| format!("the packages hold no {file}"))
    };
    let openmpi = find("openmpi")?;
    // clang's own headers are a package more; the compiler's do as well.
    let headers = repo.answer("cc -print-file-name=include").context("no C compiler")?;
    Ok(vec![
        ("OPAL_PREFIX", root.display().to_string()),
        ("LD_LIBRARY_PATH", format!("{openmpi}:{openmpi}/openmpi/lib")),
        ("LIBCLANG_PATH", format!("{}/lib", find("lib/libclang.so.1")?)),
        ("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{headers}")),
        ("MPICC", repo.tools().join("mpicc.openmpi").display().to_string()),
        ("MPIRUN", String::from("mpirun.openmpi")),
    ])
}
