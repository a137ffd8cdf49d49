//! `cargo xtask soak`: all of `staya` at once among hostile clients, for minutes or hours.
//! `tests/python/soak.py` does it and judges.

use crate::device::STM32F405;
use crate::emulate::QEMU;
use crate::firmware::{self, Profile};
use crate::options::Options;
use crate::python;
use crate::session::Session;
use crate::tally::counted;

const NAME: &str = "soak";
/// Parts of the soak, as `tests/python/soak.py` names them; the last one needs firmware.
const PARTS: [&str; 4] = ["flood", "key", "companion", HIL];
const HIL: &str = "hil";

/// The command, with the program as users have it.
pub fn run_command(s: &mut Session, options: &Options<'_>) {
    if options.names.is_empty() || options.names.contains(&HIL) {
        firmware::build(s, STM32F405, Profile::Firmware, &["lockstep"]);
    }
    run(s, "release", options);
}

/// A short one with the program and the firmware that tests have brought, so that the command
/// itself does not rot.
pub fn run_short(s: &mut Session) {
    let options = Options::read("soak [--minutes N]", &["--minutes", "0.15"]).unwrap_or_default();
    run(s, "debug", &options);
}

fn run(s: &mut Session, profile: &'static str, options: &Options<'_>) {
    if !cfg!(target_os = "linux") {
        return s.report.skip(NAME, "it looks at processes as Linux shows them");
    }
    let program = s.staya(profile);
    let ready = program.and_then(|program| Ok((program, python::client_tools(&s.repo)?)));
    let Some((program, python)) = s.report.need(NAME, ready) else { return };
    let mut parts = if options.names.is_empty() { PARTS.to_vec() } else { options.names.clone() };
    if parts.contains(&HIL) {
        let firmware = Profile::Firmware.find(&s.repo, STM32F405, "lockstep").and_then(|_| QEMU.prepare(&s.repo));
        if s.report.need("soak of firmware", firmware).is_none() {
            parts.retain(|part| *part != HIL);
        }
    }
    if parts.is_empty() {
        return;
    }
    let mut soak = s.repo.command(&python);
    soak.arg("tests/python/soak.py").env("STAYA", program).env("STAYA_FIRMWARE", s.repo.target.join("firmware"));
    soak.args(options.all_of(&["--minutes", "--json"]));
    s.report.part(NAME, || counted(soak.args(parts)));
}
