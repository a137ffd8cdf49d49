//! `cargo xtask test`: everything that shows by running whether it is right.

use crate::device::{PARTS, Part};
use crate::extent::Extent;
use crate::report::Counts;
use crate::session::Session;
use crate::tally::counted;

/// The parts that every change is tested on: one with an FPU, one without.
const SHORT: [&Part; 2] = [&PARTS[0], &PARTS[1]];

/// Properties are tried on the same random cases each time, so that a failure is the change's;
/// `cargo test` alone takes new ones.
const SEED: (&str, &str) = ("PROPTEST_RNG_SEED", "1");

/// Host tests and clients, then what other targets and other workspaces can show.
pub fn run(s: &mut Session, extent: Extent) {
    let repo = &s.repo;
    let options: &[&str] = if extent == Extent::All { &["--include-ignored"] } else { &[] };
    let arguments = ["test", "--locked", "--workspace", "--no-fail-fast"];
    let mut build = repo.cargo(&arguments);
    build.arg("--no-run");
    s.report.command("tests on the host, compiled", build);
    // Tests of the command line start them.
    s.staya("debug");
    let repo = &s.repo;
    let mut tests = repo.cargo(&arguments);
    tests.arg("--").args(options);
    if std::env::var_os(SEED.0).is_none() {
        tests.env(SEED.0, SEED.1);
    }
    // Tests wait more than they compute, the clients' most of all.
    let firmware = (extent == Extent::All).then(|| crate::firmware::begin(s)).flatten();
    s.report.part("tests on the host", || counted(&mut tests, ""));
    crate::python::clients(s, None, extent);
    crate::python::pogema(s, extent);
    if extent == Extent::Short {
        crate::project::run(s, extent);
        crate::swarms::run_short(s, &SHORT);
        return crate::emulated::run(s, &SHORT);
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
    crate::emulated::run(s, &PARTS.each_ref());
    crate::emulated::run_ten(s);
    // Cargo takes a copy of the firmware for the same packages, and builds those again afterwards.
    crate::plants::run(s, false);
    crate::soak::run_short(s);
    crate::firmware::example(s);
    crate::project::run(s, extent);
    let mut peers = s.repo.cargo_in("tests/peers", &["test", "--locked"]);
    s.report.part("same results as peers", || counted(&mut peers, ""));
    let fuzz = ["test", "--locked", "--no-default-features"];
    let mut fuzz = s.repo.cargo_in("tests/fuzz", &fuzz);
    s.report.part("fuzz targets on random bytes", || counted(&mut fuzz, ""));
    crate::mutants::run_shard(s, None);
    crate::bench::run_goals(s);
}
