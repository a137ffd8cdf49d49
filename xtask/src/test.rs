//! `cargo xtask test`: everything that shows by running whether it is right. `cargo xtask bless`
//! rewrites the golden files of tests.

use crate::device::PARTS;
use crate::prelude::*;
use crate::repo::BLESS;
use crate::{
    bench, c, claims, emulate, firmware, law, mpi, mutants, plants, project, proof, python, size, soak, swarms,
};

/// Properties are tried on the same random cases each time, so that a failure is the change's;
/// `cargo test` alone takes new ones.
const SEED: (&str, &str) = ("PROPTEST_RNG_SEED", "1");

/// Host tests and clients, then what other targets and other workspaces can show. Without `is_all`
/// the tests that every change should pass: no long ones, and two parts, with an FPU and without.
pub fn run(s: &mut Session, is_all: bool) {
    let tests = "test --locked --workspace --no-fail-fast";
    s.report.command("tests on the host, compiled", &mut s.repo.cargo(&format!("{tests} --no-run")));
    // Tests of the command line start the programs; without them these tests say so.
    let _ = s.staya("debug");
    let mut tests = s.repo.cargo(&format!("{tests} -- {}", if is_all { "--include-ignored" } else { "" }));
    if std::env::var_os(SEED.0).is_none() {
        tests.env(SEED.0, SEED.1);
    }
    // Tests wait more than they compute, the clients' most of all.
    let firmware = is_all.then(|| firmware::begin(s)).flatten();
    s.report.part("tests on the host", || Ok(counted(&mut tests)));
    python::clients(s, None, is_all);
    python::pogema(s, is_all);
    if !is_all {
        project::run(s, is_all);
        law::run(s, is_all);
        swarms::run_short(s, &PARTS[..2]);
        emulate::run_fleets(s, &PARTS[..2]);
        return size::run_short(s);
    }
    python::book(s);
    python::browser(s);
    python::cluster(s);
    mpi::run(s, false);
    python::package(s);
    if let Some(mut firmware) = firmware {
        s.report.part("the rest of the firmware, begun during the tests", || {
            let _ = firmware.wait();
            Ok((Counts::default(), String::new()))
        });
    }
    swarms::run(s);
    c::run(s);
    size::run(s, &size::Options::default());
    swarms::faults(s, &PARTS);
    emulate::run_fleets(s, &PARTS);
    s.report.step("ten robots of a formation as firmware, 1000 steps", || emulate::run_ten(&s.repo));
    emulate::run_numbers(s);
    // Cargo takes a copy of the firmware for the same packages, and builds those again afterwards.
    plants::run(s, false);
    proof::run(s);
    soak::run_short(s);
    firmware::example(s);
    project::run(s, is_all);
    law::run(s, is_all);
    for (name, folder, line) in [
        ("same results as peers", "tests/peers", "test --locked"),
        ("fuzz targets on random bytes", "tests/fuzz", "test --locked --no-default-features"),
    ] {
        s.report.part(name, || Ok(counted(&mut s.repo.cargo_in(folder, line))));
    }
    let staya = s.staya("release");
    s.report.step("experiments show what they should, with few seeds", || {
        execute(s.repo.command(staya?).args(["experiment", "--all", "--quick", "--restart"]))
    });
    claims::planted::run(s);
    mutants::run(s, &mutants::Options::default());
    bench::run_goals(s);
}

/// Runs the tests whose name contains `name` with the variable that makes them write, runs them
/// again without it, and lists what changed.
pub fn bless(s: &mut Session, name: &str) {
    let tests = || s.repo.cargo(&format!("test --workspace --no-fail-fast {name}"));
    s.report.step("rewrite golden files", || execute(tests().env(BLESS, "1")));
    s.report.command("compare again", &mut tests());
    let files = ["*golden*", "*.md", "*/settings.py", "*/staya.h"];
    match output_of(s.repo.command("git").args(["status", "--short", "--"]).args(files)) {
        Some(changed) if changed.is_empty() => println!("\nNo golden file changed."),
        Some(changed) => {
            println!("\nGolden files that differ from the last commit; look at each, and commit them apart:");
            println!("{changed}");
        }
        None => println!("\nNo git here: see for yourself which golden files changed."),
    }
}
