//! Fleets of emulated parts: the runner's tests that need the firmware and both emulators.

use crate::device::{Part, STM32F405};
use crate::emulate::QEMU;
use crate::firmware::{Profile, build_own};
use crate::install;
use crate::repo::{Repo, run_reading};
use crate::session::{MAIN, Session};
use crate::tally::counted;
use std::process::Command;

/// A crate with a guidance law of its own, as people copy it.
const OWN: &str = "examples/own_part";

/// Runs the tests on these parts with the firmware that was built before, or says why not.
pub fn run(s: &mut Session, parts: &[Part]) {
    const NAME: &str = "robots on emulated parts";
    let built = parts.iter().try_for_each(|part| Profile::Firmware.find(&s.repo, part, "lockstep").map(drop));
    if s.report.need(NAME, built.and_then(|()| QEMU.prepare(&s.repo))).is_none() {
        return;
    }
    if !build_own(s, STM32F405, &s.repo.root.join(OWN)) {
        return s.report.skip(NAME, &format!("no firmware of {OWN}"));
    }
    // The installed program finds its firmware beside itself, from a folder that knows of no
    // repository: it neither asks for cargo, which is not there, nor for this folder's.
    let prefix = s.repo.target.join("tmp/installed");
    if install::put_step(s, &prefix, "debug") {
        s.report.step("an installed program finds its firmware", || {
            let mut staya = s.repo.command(prefix.join("bin").join(MAIN));
            staya.arg("hil").arg(s.repo.root.join("scenarios/six-robots.toml"));
            staya.args(["--device", "qemu:stm32f405", "--ticks", "20"]).current_dir(&prefix).env("CARGO", "no-cargo");
            is_identical(staya.env_remove("STAYA_FIRMWARE").env_remove("CARGO_MANIFEST_DIR"))
        });
    }
    // Of the whole workspace, as the other tests: alone, the runner would be built once more with
    // other features.
    let mut tests = s.repo.cargo(&["test", "--locked", "--workspace", "--test", "emulated"]);
    tests.env("STAYA_FIRMWARE", s.repo.target.join("firmware"));
    tests.env("STAYA_PARTS", parts.iter().map(|part| part.name).collect::<Vec<_>>().join(","));
    s.report.part(NAME, || counted(&mut tests));
}

/// Ten emulated parts for a thousand steps, each compared with its shadow. The program is the one
/// that its own tests have brought.
pub fn run_ten(repo: &Repo) -> Result<(), String> {
    let mut staya = repo.command(repo.program("debug", MAIN));
    staya.args(["hil", "scenarios/ten-robots.toml", "--ticks", "1000"]);
    staya.args(["--device", "qemu:stm32f405", "--devices", "10"]);
    is_identical(staya.arg("--firmware").arg(repo.target.join("firmware")))
}

/// Runs `staya hil`, which fails by itself when a device and its shadow differ; the whole run must
/// also be the one without devices.
fn is_identical(staya: &mut Command) -> Result<(), String> {
    let mut verdict = Err(String::from("it did not come to its end"));
    run_reading(staya, |line| {
        if let Some(said) = line.trim_start().strip_prefix("without devices") {
            let is_identical = said.trim_end().ends_with(", identical");
            verdict = is_identical.then_some(()).ok_or_else(|| String::from("not the run without devices"));
        }
    })?;
    verdict
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_run_without_devices_will_do() {
        let said = |line| is_identical(Command::new("echo").arg(line));
        assert_eq!(said("  without devices 2dcb4dc319df1a21, identical"), Ok(()));
        assert!(said("  without devices 2dcb4dc319df1a21, another one: ...").is_err());
        assert!(said("  trace hash      2dcb4dc319df1a21").is_err());
        assert!(is_identical(&mut Command::new("false")).is_err());
    }
}
