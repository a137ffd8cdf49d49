//! `cargo xtask test`: everything that shows by running whether it is right.

use crate::device::Toolchains;
use crate::extent::{Extent, LONG};
use crate::repo::Repo;
use crate::report::{Counts, Report};
use crate::tally::counted;

/// Properties are tried on the same random cases each time, so that a failure is the change's; `cargo test` alone takes
/// new ones.
const SEED: (&str, &str) = ("PROPTEST_RNG_SEED", "1");

/// Host tests and clients, then what other targets and other workspaces can show.
pub fn run(repo: &Repo, report: &mut Report, extent: Extent) {
    let (options, why_skipped): (&[&str], _) = match extent {
        Extent::Short => (&[], LONG),
        Extent::All => (&["--include-ignored"], ""),
    };
    let arguments = ["test", "--locked", "--workspace", "--no-fail-fast"];
    let mut build = repo.cargo(&arguments);
    build.arg("--no-run");
    let is_compiled = report.command("tests on the host, compiled", build);
    let mut tests = repo.cargo(&arguments);
    tests.arg("--").args(options);
    if std::env::var_os(SEED.0).is_none() {
        tests.env(SEED.0, SEED.1);
    }
    let mut toolchains = Toolchains::default();
    // Tests wait more than they compute, the clients' most of all.
    let firmware = (extent == Extent::All).then(|| crate::firmware::begin(repo, &mut toolchains)).flatten();
    report.part("tests on the host", || counted(&mut tests, why_skipped));
    if is_compiled {
        // The program's own tests have brought it.
        crate::clients::run_tests(repo, report, None, extent);
    } else {
        crate::clients::run_command(repo, report, None, extent);
    }
    if extent == Extent::Short {
        crate::project::run(repo, report, &mut toolchains, extent, is_compiled);
        crate::swarms::run_short(repo, report, &mut toolchains);
        return crate::emulated::run(repo, report, &mut toolchains);
    }
    if is_compiled {
        crate::browser::run_tests(repo, report);
        crate::cluster::run_tests(repo, report);
        crate::mpi::run_tests(repo, report);
    } else {
        crate::browser::run_command(repo, report);
        crate::cluster::run_command(repo, report);
        crate::mpi::run_command(repo, report);
    }
    crate::python_package::run_command(repo, report);
    if let Some(mut firmware) = firmware {
        report.part("the rest of the firmware, begun during the tests", || {
            let _ = firmware.wait();
            (Counts::default(), String::new())
        });
    }
    crate::swarms::run(repo, report, &mut toolchains);
    crate::c::run(repo, report, &mut toolchains);
    crate::size::run(repo, report, &mut toolchains, false);
    crate::faults::run(repo, report, &mut toolchains);
    crate::emulated::run(repo, report, &mut toolchains);
    crate::emulated::run_ten(repo, report);
    // Cargo takes a copy of the firmware for the same packages, and builds those anew afterwards.
    crate::plants::run(repo, report, &mut toolchains);
    crate::soak::run_short(repo, report);
    crate::example::run(repo, report);
    crate::project::run(repo, report, &mut toolchains, extent, is_compiled);
    let mut peers = repo.cargo_in("tests/peers", &["test", "--locked"]);
    report.part("same results as peers", || counted(&mut peers, ""));
    let fuzz = ["test", "--locked", "--no-default-features"];
    let mut fuzz = repo.cargo_in("tests/fuzz", &fuzz);
    report.part("fuzz targets on random bytes", || counted(&mut fuzz, ""));
}
