//! `cargo xtask soak`: all of `staya` at once among hostile clients, for minutes or hours.
//! `tests/python/soak.py` does it and judges.

use crate::device::STM32F405;
use crate::emulate::QEMU;
use crate::firmware::{self, FIRMWARE};
use crate::prelude::*;
use crate::python;

/// Parts of the soak, as `tests/python/soak.py` names them; the last one needs firmware.
const PARTS: [&str; 4] = ["flood", "key", "companion", HIL];
const HIL: &str = "hil";

#[derive(clap::Args)]
pub struct Options {
    /// How long
    #[arg(long, value_name = "N", value_parser = above_zero)]
    minutes: Option<f64>,
    /// Where judgements and samples are written
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[arg(value_name = "PART", value_parser = PARTS, default_values = PARTS)]
    parts: Vec<String>,
}

fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| String::from("it is not a number above 0"))
}

/// The command, with the program as users have it.
pub fn run_command(s: &mut Session, options: &Options) {
    if options.parts.iter().any(|part| part == HIL) {
        firmware::build(s, STM32F405, FIRMWARE, &["lockstep"]);
    }
    run(s, "release", options);
}

/// A short one with the program and the firmware that tests have brought, so that the command
/// itself does not rot.
pub fn run_short(s: &mut Session) {
    let parts = PARTS.map(String::from).to_vec();
    run(s, "debug", &Options { minutes: Some(0.15), json: None, parts });
}

fn run(s: &mut Session, profile: &'static str, options: &Options) {
    let program = s.staya(profile);
    let mut parts = options.parts.clone();
    if parts.iter().any(|part| part == HIL) {
        let firmware = FIRMWARE.find(&s.repo, STM32F405, "lockstep");
        if let Err(reason) = firmware.and_then(|_| QEMU.prepare(&s.repo)) {
            s.report.step("soak of firmware", || Err(reason));
            parts.retain(|part| part != HIL);
        }
    }
    if parts.is_empty() {
        return;
    }
    s.report.part("soak", || {
        ensure!(cfg!(target_os = "linux"), skipped("it looks at processes as Linux shows them"));
        let program = program?;
        let mut soak = s.repo.command(python::client_tools(&s.repo)?);
        soak.arg("tests/python/soak.py").env("STAYA", program);
        soak.env("STAYA_FIRMWARE", s.repo.target.join("firmware"));
        soak.args(options.minutes.iter().map(|minutes| format!("--minutes={minutes}")));
        soak.args(options.json.iter().flat_map(|file| ["--json".as_ref(), file.as_os_str()]));
        Ok(counted(soak.args(parts)))
    });
}
