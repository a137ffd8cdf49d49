//! `cargo xtask mpi`: one world over ranks, with OpenMPI from Debian's packages. Missing
//! packages are unpacked into `target/tools`.

use crate::apt::{Tools, unpacked};
use crate::files;
use crate::python::{Suite, client_environment, suite};
use crate::repo::{Repo, output_of, run as run_command};
use crate::session::Session;

const NAME: &str = "one world over ranks of OpenMPI";
const MPI: Tools =
    Tools { packages: &["openmpi-bin", "libopenmpi-dev", "libclang1"], programs: &["mpirun.openmpi", "mpicc.openmpi"] };

/// Builds `staya-mpi` and compares it with `staya`.
pub fn run(s: &mut Session) {
    let program = s.staya("debug");
    let Some(environment) = build(s, &[]) else { return };
    suite(s, NAME, Suite { program, environment, arguments: &["tests/mpi", "--timeout", "600"] }, client_environment);
}

/// Times on 1, 2 and 4 ranks by an optimised build, on a machine that does nothing else.
pub fn run_scaling(s: &mut Session) {
    let Some(environment) = build(s, &["--release"]) else { return };
    let mut times = s.repo.command("python3");
    times.arg("tests/mpi/scaling.py").envs(environment).env("STAYA", s.repo.program("release", "staya"));
    s.report.command("200,000 robots on 1, 2 and 4 ranks", times);
}

/// Makes OpenMPI ready and builds `staya-mpi`. Returns the environment of both; none if it cannot
/// be built.
fn build(s: &mut Session, options: &[&str]) -> Option<Vec<(&'static str, String)>> {
    let environment = environment(&s.repo).map_err(|reason| s.report.skip(NAME, &reason)).ok()?;
    let mut build = s.repo.cargo(&["build", "--locked", "--package", "staya-mpi", "--features", "mpi"]);
    build.args(options).envs(environment.iter().cloned());
    s.report.step("staya-mpi", || run_command(&mut build)).then_some(environment)
}

/// The variables by which programs find OpenMPI; none where it is installed.
fn environment(repo: &Repo) -> Result<Vec<(&'static str, String)>, String> {
    let question = "mpirun --version && mpicc -show && ldconfig -p | grep libclang";
    if output_of(repo.command("sh").args(["-c", question])).is_some() {
        return Ok(Vec::new());
    }
    MPI.prepare(repo, || repo.tools().join(MPI.programs[0]).is_file())?;
    let root = repo.target.join("tools/unpacked/usr");
    let clang = files::entries(&root.join("lib"))?.into_iter().map(|folder| folder.join("lib"));
    let clang =
        clang.into_iter().find(|lib| lib.join("libclang.so.1").exists()).ok_or("the packages hold no libclang")?;
    // clang's own headers are a package more; the compiler's do as well.
    let headers = output_of(repo.command("cc").arg("-print-file-name=include")).ok_or("no C compiler")?;
    let openmpi = unpacked(repo, "openmpi").ok_or("the packages hold no libraries of OpenMPI")?;
    let libraries = openmpi.parent().unwrap_or(&openmpi).display().to_string();
    Ok(vec![
        ("OPAL_PREFIX", root.display().to_string()),
        ("LD_LIBRARY_PATH", format!("{libraries}:{libraries}/openmpi/lib")),
        ("LIBCLANG_PATH", clang.display().to_string()),
        ("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{headers}")),
        ("MPICC", repo.tools().join(MPI.programs[1]).display().to_string()),
        ("MPIRUN", MPI.programs[0].to_string()),
    ])
}
