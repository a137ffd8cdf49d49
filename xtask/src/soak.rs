//! `cargo xtask soak`: all of `staya` at once among hostile clients, for minutes or hours.
//! `tests/python/soak.py` does it and judges.

use crate::device::STM32F405;
use crate::emulate;
use crate::firmware::{self, Profile};
use crate::options::Options;
use crate::python;
use crate::repo::Repo;
use crate::session::Session;
use crate::tally::counted;

const NAME: &str = "soak";
/// Parts of the soak, as `tests/python/soak.py` names them; the last one needs firmware.
const PARTS: [&str; 4] = ["flood", "key", "companion", HIL];
const HIL: &str = "hil";

/// The command, with the program as users have it.
pub fn run_command(s: &mut Session, options: &Options<'_>) {
    let parts = if options.names.is_empty() { PARTS.to_vec() } else { options.names.clone() };
    if parts.contains(&HIL) {
        firmware::build(s, STM32F405, Profile::Firmware, &["lockstep"]);
    }
    run(s, "release", options, parts);
}

/// A short one with the program and the firmware that tests have brought, so that the command
/// itself does not rot.
pub fn run_short(s: &mut Session) {
    let options = Options::read("soak [--minutes N]", &["--minutes", "0.15"]).unwrap_or_default();
    run(s, "debug", &options, PARTS.to_vec());
}

fn run(s: &mut Session, profile: &'static str, options: &Options<'_>, mut parts: Vec<&str>) {
    if !cfg!(target_os = "linux") {
        return s.report.skip(NAME, "it looks at processes as Linux shows them");
    }
    let Some(program) = s.staya(profile) else {
        return s.report.skip(NAME, "the program was not built");
    };
    let python = match python::client_tools(&s.repo) {
        Ok(python) => python,
        Err(reason) => return s.report.skip(NAME, &reason),
    };
    if let Some(Err(reason)) = parts.contains(&HIL).then(|| has_firmware(&s.repo)) {
        parts.retain(|part| *part != HIL);
        s.report.skip("soak of firmware", &reason);
    }
    if parts.is_empty() {
        return;
    }
    let mut soak = s.repo.command(&python);
    soak.arg("tests/python/soak.py").env("STAYA", program).env("STAYA_FIRMWARE", s.repo.target.join("firmware"));
    for option in ["--minutes", "--json"] {
        soak.args(options.value(option).into_iter().flat_map(|value| [option, value]));
    }
    s.report.part(NAME, || counted(soak.args(parts), ""));
}

/// An error if firmware in the loop cannot run here.
fn has_firmware(repo: &Repo) -> Result<(), String> {
    if !Profile::Firmware.elf(repo, STM32F405, "lockstep").is_file() {
        return Err(format!("no firmware for {}", STM32F405.name));
    }
    emulate::prepare(repo, STM32F405)
}
