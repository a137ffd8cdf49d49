//! A program of the firmware in the emulator of its part, from its start to its end, and fleets of
//! emulated parts: the tests of the runner that need the firmware and both emulators.

use crate::apt::Tools;
use crate::device::{Part, STM32F405};
use crate::firmware::{self, FIRMWARE, Numbers, Profile, build_own};
use crate::install;
use crate::prelude::*;
use crate::repo::shown;

/// Seconds after which a program counts as hanging: the longest takes a minute on a busy machine.
const PATIENCE: &str = "600";

/// Debian's packages of both emulators.
pub const QEMU: Tools = Tools {
    packages: "qemu-system-arm qemu-system-misc",
    programs: "qemu-system-arm qemu-system-riscv32",
    question: "qemu-system-arm --version && qemu-system-riscv32 --version && timeout --foreground 1 true",
    ways: "unpack",
};

/// The command that fetches the emulators.
pub fn fetch(s: &mut Session) {
    s.report.step("the emulators of the parts", || QEMU.prepare(&s.repo));
}

/// A step with programs of the firmware on a part: builds them, all if none is named. Skipped if
/// program or emulator is missing.
pub fn on_part(
    s: &mut Session,
    name: &str,
    part: &Part,
    (profile, bins): (&Profile, &[&str]),
    work: impl FnOnce(&Repo) -> Result<()>,
) {
    let is_built = firmware::build(s, part, profile, bins);
    s.report.step(name, || {
        ensure!(is_built, skipped("there is no firmware"));
        QEMU.prepare(&s.repo)?;
        work(&s.repo)
    });
}

/// Runs a program with these arguments that ends by itself, with the part's UART on one of QEMU's
/// devices, `none` or `stdio`; what it printed. Each instruction takes a nanosecond of the part's
/// time.
pub fn run(repo: &Repo, part: &Part, elf: &Path, line: &str, arguments: &[&str]) -> Result<String> {
    let arguments: String = arguments.iter().map(|argument| format!(",arg={argument}")).collect();
    let mut command = repo.command("timeout");
    command
        .args(["--foreground", PATIENCE, part.emulator])
        .words(part.machine)
        .words("-icount shift=0 -display none -monitor none -serial")
        .arg(line);
    command.arg("-semihosting-config").arg(format!("enable=on,target=native{arguments}")).arg("-kernel").arg(elf);
    println!("$ {}", shown(&command));
    let output = command.output().with_context(|| format!("cannot start {}", part.emulator))?;
    let [said, complaints] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    if !output.status.success() {
        print!("{said}");
        let late = if output.status.code() == Some(124) { ": it did not end in time" } else { "" };
        let last = said.lines().last().unwrap_or_default();
        bail!("{}{late}; {last} {}", output.status, complaints.lines().next().unwrap_or_default());
    }
    Ok(said)
}

/// A crate with a guidance law of its own, as people copy it.
const OWN: &str = "examples/own_part";

/// Runs the tests on these parts with the firmware that was built before, or says why not.
pub fn run_fleets(s: &mut Session, parts: &[Part]) {
    let is_own_built = build_own(s, STM32F405, FIRMWARE, &s.repo.root.join(OWN));
    // The installed program finds its firmware beside itself, from a folder that knows of no
    // repository: it neither asks for cargo, which is not there, nor for this folder's.
    let prefix = s.repo.target.join("tmp/installed");
    if install::put_step(s, &prefix, "debug") {
        s.report.step("an installed program finds its firmware", || {
            is_ready(&s.repo, parts)?;
            let mut staya = s.repo.command(prefix.join("bin").join(MAIN));
            staya.arg("hil").arg(s.repo.root.join("scenarios/six-robots.toml"));
            staya.words("--device qemu:stm32f405 --ticks 20").current_dir(&prefix).env("CARGO", "no-cargo");
            is_identical(staya.env_remove("STAYA_FIRMWARE").env_remove("CARGO_MANIFEST_DIR"))
        });
    }
    s.report.part("robots on emulated parts", || {
        is_ready(&s.repo, parts)?;
        ensure!(is_own_built, skipped(format!("no firmware of {OWN}")));
        // Of the whole workspace, as the other tests: alone, the runner would be built once more
        // with other features.
        let mut tests = s.repo.cargo("test --locked --workspace --test emulated");
        tests.env("STAYA_FIRMWARE", s.repo.target.join("firmware"));
        Ok(counted(tests.env("STAYA_PARTS", parts.iter().map(|part| part.name).collect::<Vec<_>>().join(","))))
    });
}

/// Whether the firmware of these parts and the emulators are there.
fn is_ready(repo: &Repo, parts: &[Part]) -> Result<()> {
    parts.iter().try_for_each(|part| FIRMWARE.find(repo, part, "lockstep").map(drop))?;
    QEMU.prepare(repo)
}

/// Ten emulated parts for a thousand steps, each compared with its shadow. The program is the one
/// that its own tests have brought.
pub fn run_ten(repo: &Repo) -> Result<()> {
    let mut staya = repo.command(repo.program("debug", MAIN));
    staya.words("hil scenarios/ten-robots.toml --ticks 1000 --device qemu:stm32f405 --devices 10 --firmware");
    is_identical(staya.arg(repo.target.join("firmware")))
}

/// A swarm in each other number format, two of its robots on an emulated part.
pub fn run_numbers(s: &mut Session) {
    for numbers in [Numbers::Fast32, Numbers::Q16] {
        let profile = FIRMWARE.in_numbers(Some(numbers));
        let is_built = firmware::build(s, STM32F405, &profile, &["lockstep"]);
        let name = numbers.name();
        s.report.step(&format!("robots on an emulated part in {name}"), || {
            ensure!(is_built, skipped(format!("no firmware in {name}")));
            QEMU.prepare(&s.repo)?;
            let mut staya = s.repo.command(s.repo.program("debug", MAIN));
            staya.words("hil scenarios/swap-circle.toml --device qemu:stm32f405 --devices 2 --ticks 100 --set");
            is_identical(staya.arg(format!("numbers={name}")).arg("--firmware").arg(s.repo.target.join("firmware")))
        });
    }
}

/// Runs `staya hil`, which fails by itself when a device and its shadow differ; the whole run must
/// also be the one without devices.
pub fn is_identical(staya: &mut Command) -> Result<()> {
    let mut last = None;
    run_reading(staya, |line| {
        let said = line.trim_start().strip_prefix("without devices");
        last = said.map(|said| said.ends_with(", identical")).or(last);
    })?;
    ensure!(last.context("it did not come to its end")?, "not the run without devices");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_run_without_devices_will_do() {
        let said = |line| is_identical(Command::new("echo").arg(line));
        assert!(said("  without devices 2dcb4dc319df1a21, identical").is_ok());
        assert!(said("  without devices 2dcb4dc319df1a21, another one: ...").is_err());
        assert!(said("  trace hash      2dcb4dc319df1a21").is_err());
        assert!(is_identical(&mut Command::new("false")).is_err());
    }
}
