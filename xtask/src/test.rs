//! `cargo xtask test`: everything that shows by running whether it is right.

use crate::device::PARTS;
use crate::report::Counts;
use crate::session::Session;
use crate::tally::counted;

/// Properties are tried on the same random cases each time, so that a failure is the change's;
/// `cargo test` alone takes new ones.
const SEED: (&str, &str) = ("PROPTEST_RNG_SEED", "1");

/// Host tests and clients, then what other targets and other workspaces can show. Without `is_all`
/// the tests that every change should pass: no long ones, and two parts, with an FPU and without.
pub fn run(s: &mut Session, is_all: bool) {
    let arguments = ["test", "--locked", "--workspace", "--no-fail-fast"];
    let mut build = s.repo.cargo(&arguments);
    build.arg("--no-run");
    s.report.command("tests on the host, compiled", build);
    // Tests of the command line start the programs; without them these tests say so.
    let _ = s.staya("debug");
    let mut tests = s.repo.cargo(&arguments);
    tests.arg("--").args(is_all.then_some("--include-ignored"));
    if std::env::var_os(SEED.0).is_none() {
        tests.env(SEED.0, SEED.1);
    }
    // Tests wait more than they compute, the clients' most of all.
    let firmware = is_all.then(|| crate::firmware::begin(s)).flatten();
    s.report.part("tests on the host", || counted(&mut tests));
    crate::python::clients(s, None, is_all);
    crate::python::pogema(s, is_all);
    if !is_all {
        crate::project::run(s, is_all);
        crate::swarms::run_short(s, &PARTS[..2]);
        return crate::emulated::run(s, &PARTS[..2]);
    }
    crate::python::book(s);
    crate::python::browser(s);
    crate::python::cluster(s);
    crate::mpi::run(s);
    crate::python::package(s);
    if let Some(mut firmware) = firmware {
        s.report.part("the rest of the firmware, begun during the tests", || {
            let _ = firmware.wait();
            (Counts::default(), String::new())
        });
    }
    crate::swarms::run(s);
    crate::c::run(s);
    crate::size::run(s, false);
    crate::swarms::faults(s, &[]);
    crate::emulated::run(s, &PARTS);
    s.report.step("ten robots of a formation as firmware, 1000 steps", || crate::emulated::run_ten(&s.repo));
    // Cargo takes a copy of the firmware for the same packages, and builds those again afterwards.
    crate::plants::run(s, false);
    crate::soak::run_short(s);
    crate::firmware::example(s);
    crate::project::run(s, is_all);
    let mut peers = s.repo.cargo_in("tests/peers", &["test", "--locked"]);
    s.report.part("same results as peers", || counted(&mut peers));
    let mut fuzz = s.repo.cargo_in("tests/fuzz", &["test", "--locked", "--no-default-features"]);
    s.report.part("fuzz targets on random bytes", || counted(&mut fuzz));
    crate::mutants::run_shard(s, None);
    crate::bench::run_goals(s);
}
