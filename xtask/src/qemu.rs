//! `cargo xtask qemu`: the emulators of the parts.

use crate::apt;
use crate::part::PARTS;
use crate::repo::{Repo, output_of};
use crate::report::Report;

/// Debian's packages of both emulators.
const PACKAGES: [&str; 2] = ["qemu-system-arm", "qemu-system-misc"];
const PROGRAMS: [&str; 2] = ["qemu-system-arm", "qemu-system-riscv32"];
const REMEDY: &str = "on Debian run, as root, \
    `apt-get update && apt-get install qemu-system-arm qemu-system-misc`";

/// The command: one step per emulator.
pub fn run(repo: &Repo, report: &mut Report) {
    let mut emulators: Vec<&str> = PARTS.iter().map(|part| part.emulator).collect();
    emulators.dedup();
    for emulator in emulators {
        match prepare(repo, emulator) {
            Ok(version) => {
                report.step(emulator, || {
                    println!("{version}");
                    Ok(())
                });
            }
            Err(reason) => report.skip(emulator, &reason),
        }
    }
}

/// Makes sure that an emulator is there: unpacks all of them on Debian. Returns what it says it is.
pub fn prepare(repo: &Repo, emulator: &str) -> Result<String, String> {
    let version = || {
        let said = output_of(repo.command(emulator).arg("--version"))?;
        Some(said.lines().next().unwrap_or_default().to_string())
    };
    if let Some(version) = version() {
        return Ok(version);
    }
    apt::unpack(repo, &PACKAGES, &PROGRAMS).map_err(|reason| format!("no {emulator} ({reason}); {REMEDY}"))?;
    version().ok_or_else(|| format!("no {emulator}; {REMEDY}"))
}
