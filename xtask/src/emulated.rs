//! Fleets of emulated parts: the runner's tests that need the firmware and both emulators.

use crate::device::Toolchains;
use crate::emulate;
use crate::firmware::{Profile, build_own};
use crate::install;
use crate::part::{PARTS, part};
use crate::repo::{Repo, run_reading};
use crate::report::Report;
use crate::tally::counted;
use std::process::Command;

/// A crate with a guidance law of its own, as people copy it.
const OWN: &str = "examples/own_part";

/// Runs the tests with the firmware that was built before, or says why not.
pub fn run(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
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
    let stm32f405 = part("stm32f405").unwrap_or(&PARTS[0]);
    if !build_own(repo, report, toolchains, stm32f405, &repo.root.join(OWN)) {
        return report.skip(name, &format!("no firmware of {OWN}"));
    }
    run_installed(repo, report);
    // Of the whole workspace, as the other tests: alone, the runner would be built anew with other features.
    let mut tests = repo.cargo(&["test", "--locked", "--workspace", "--test", "emulated"]);
    tests.env("STAYA_FIRMWARE", repo.target.join("firmware"));
    report.part(name, || counted(&mut tests, ""));
}

/// What `cargo xtask install` installs finds its firmware beside itself, from a folder that knows of no repository: it neither asks for
/// cargo, which is not there, nor for this folder's.
fn run_installed(repo: &Repo, report: &mut Report) {
    let prefix = repo.target.join("tmp/installed");
    if !install::put_step(repo, report, &install::Request::of_tests(prefix.clone())) {
        return;
    }
    report.step("an installed program finds its firmware", || {
        let mut staya = repo.command(prefix.join("bin/staya"));
        staya.arg("hil").arg(repo.root.join("scenarios/six-robots.toml"));
        staya.args(["--device", "qemu:stm32f405", "--ticks", "20"]);
        staya
            .current_dir(&prefix)
            .env("CARGO", "no-cargo")
            .env_remove("STAYA_FIRMWARE")
            .env_remove("CARGO_MANIFEST_DIR");
        is_the_same(&mut staya)
    });
}

/// Ten emulated parts for a thousand steps, each compared with its shadow: the run is the one without devices. The
/// program is the one that its own tests have brought.
pub fn run_ten(repo: &Repo, report: &mut Report) {
    report.step("ten robots of a formation as firmware, 1000 steps", || {
        let mut staya = repo.command(repo.target.join("debug").join(format!("staya{}", std::env::consts::EXE_SUFFIX)));
        staya.args(["hil", "scenarios/ten-robots.toml", "--ticks", "1000"]);
        staya.args(["--device", "qemu:stm32f405", "--devices", "10"]);
        staya.arg("--firmware").arg(repo.target.join("firmware"));
        is_the_same(&mut staya)
    });
}

/// Runs `staya hil`, which fails by itself when a device and its shadow differ; the whole run must also be the one without devices.
fn is_the_same(staya: &mut Command) -> Result<(), String> {
    let mut verdict = None;
    run_reading(staya, |line| {
        if let Some(said) = line.trim_start().strip_prefix("without devices") {
            verdict = Some(said.trim_end().ends_with(", identical"));
        }
    })?;
    match verdict {
        Some(true) => Ok(()),
        Some(false) => Err(String::from("not the run without devices")),
        None => Err(String::from("it did not come to its end")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(line: &str) -> Result<(), String> {
        is_the_same(Command::new("echo").arg(line))
    }

    #[test]
    fn only_the_run_without_devices_will_do() {
        assert_eq!(said("  without devices 2dcb4dc319df1a21, identical"), Ok(()));
        assert!(said("  without devices 2dcb4dc319df1a21, another one: ...").is_err());
        assert!(said("  trace hash      2dcb4dc319df1a21").is_err());
        assert!(is_the_same(&mut Command::new("false")).is_err());
    }
}
