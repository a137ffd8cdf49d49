//! A program of the firmware in the emulator of its part, from its start to its end.

use crate::apt::Tools;
use crate::device::Part;
use crate::firmware::{self, Profile};
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
