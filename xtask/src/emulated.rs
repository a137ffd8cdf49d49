//! Fleets of emulated parts: the runner's tests that need the firmware and both emulators.

use crate::emulate;
use crate::firmware::{PARTS, Profile};
use crate::repo::Repo;
use crate::report::Report;
use crate::test::counted;

/// Runs the tests with the firmware that was built before, or says why not.
pub fn run(repo: &Repo, report: &mut Report) {
    let name = "robots on emulated parts";
    let mut missing = Vec::new();
    for part in &PARTS {
        if !Profile::Firmware.elf(repo, part, "lockstep").is_file() {
            missing.push(format!("no firmware for {}", part.name));
        }
        missing.extend(emulate::prepare(repo, part).err());
    }
    missing.dedup();
    if !missing.is_empty() {
        return report.skip(name, &missing.join("; "));
    }
    let mut tests = repo.cargo(&["test", "--locked", "--package", "staya-runner"]);
    tests.args(["--test", "emulated"]);
    tests.env("STAYA_FIRMWARE", repo.target.join("firmware"));
    report.part(name, || counted(&mut tests, ""));
}
