//! Fleets of emulated parts: the runner's tests that need the firmware and both emulators.

use crate::device::{Part, STM32F405};
use crate::emulate;
use crate::firmware::{Profile, build_own};
use crate::install;
use crate::repo::run_reading;
use crate::session::{MAIN, Session};
use crate::tally::counted;
use std::process::Command;

/// A crate with a guidance law of its own, as people copy it.
const OWN: &str = "examples/own_part";

/// Runs the tests on these parts with the firmware that was built before, or says why not.
pub fn run(s: &mut Session, parts: &[&'static Part]) {
    let name = "robots on emulated parts";
    let mut missing = Vec::new();
    for part in parts {
        if !Profile::Firmware.elf(&s.repo, part, "lockstep").is_file() {
            missing.push(format!("no firmware for {}", part.name));
        }
        missing.extend(emulate::prepare(&s.repo, part).err());
    }
    missing.dedup();
    if !missing.is_empty() {
        return s.report.skip(name, &missing.join("; "));
    }
    if !build_own(s, STM32F405, &s.repo.root.join(OWN)) {
        return s.report.skip(name, &format!("no firmware of {OWN}"));
    }
    run_installed(s);
    // Of the whole workspace, as the other tests: alone, the runner would be built once more with
    // other features.
    let mut tests = s.repo.cargo(&["test", "--locked", "--workspace", "--test", "emulated"]);
    tests.env("STAYA_FIRMWARE", s.repo.target.join("firmware"));
    tests.env("STAYA_PARTS", parts.iter().map(|part| part.name).collect::<Vec<_>>().join(","));
    s.report.part(name, || counted(&mut tests, ""));
}

/// What `cargo xtask install` installs finds its firmware beside itself, from a folder that knows
/// of no repository: it neither asks for cargo, which is not there, nor for this folder's.
fn run_installed(s: &mut Session) {
    let prefix = s.repo.target.join("tmp/installed");
    if !install::put_step(s, &prefix, "debug") {
        return;
    }
    s.report.step("an installed program finds its firmware", || {
        let mut staya = s.repo.command(prefix.join("bin").join(MAIN));
        staya.arg("hil").arg(s.repo.root.join("scenarios/six-robots.toml"));
        staya.args(["--device", "qemu:stm32f405", "--ticks", "20"]).current_dir(&prefix).env("CARGO", "no-cargo");
        is_the_same(staya.env_remove("STAYA_FIRMWARE").env_remove("CARGO_MANIFEST_DIR"))
    });
}

/// Ten emulated parts for a thousand steps, each compared with its shadow: the run is the one
/// without devices. The program is the one that its own tests have brought.
pub fn run_ten(s: &mut Session) {
    s.report.step("ten robots of a formation as firmware, 1000 steps", || {
        let mut staya = s.repo.command(s.repo.program("debug", MAIN));
        staya.args([
            "hil",
            "scenarios/ten-robots.toml",
            "--ticks",
            "1000",
            "--device",
            "qemu:stm32f405",
            "--devices",
            "10",
        ]);
        is_the_same(staya.arg("--firmware").arg(s.repo.target.join("firmware")))
    });
}

/// Runs `staya hil`, which fails by itself when a device and its shadow differ; the whole run must
/// also be the one without devices.
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
