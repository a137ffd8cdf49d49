//! `cargo xtask soak`: all of `staya` at once among clients that mean no good, for minutes or hours. `tests/python/soak.py` does it and judges.

use crate::device::Toolchains;
use crate::emulate;
use crate::firmware::{self, Profile};
use crate::part::part;
use crate::repo::{Repo, run_reading};
use crate::report::{Counts, Report};

const NAME: &str = "soak";
/// What it runs firmware on.
const PART: &str = "stm32f405";
/// What can be asked for alone, as `tests/python/soak.py` names it; the last one needs firmware.
const PARTS: [&str; 4] = ["flood", "key", "companion", HIL];
const HIL: &str = "hil";
/// Minutes of a short one.
const SHORT: &str = "0.15";

/// What `cargo xtask soak` is asked for.
#[derive(Debug, Default, PartialEq)]
pub struct Request<'a> {
    minutes: Option<&'a str>,
    json: Option<&'a str>,
    /// All of them if none is named.
    parts: Vec<&'a str>,
}

impl<'a> Request<'a> {
    /// Reads the command line: `[--minutes N] [--json FILE] [PART...]`.
    pub fn read(arguments: &[&'a str]) -> Option<Self> {
        let mut request = Self::default();
        let mut arguments = arguments.iter().copied();
        while let Some(argument) = arguments.next() {
            match argument {
                "--minutes" => {
                    let minutes = arguments.next()?;
                    minutes.parse().ok().filter(|minutes: &f64| *minutes > 0.0 && minutes.is_finite())?;
                    request.minutes = Some(minutes);
                }
                "--json" => request.json = Some(arguments.next()?),
                name if PARTS.contains(&name) => request.parts.push(name),
                _ => return None,
            }
        }
        Some(request)
    }

    fn wants(&self, part: &str) -> bool {
        self.parts.is_empty() || self.parts.contains(&part)
    }
}

/// The command, with the program as users have it.
pub fn run_command(repo: &Repo, report: &mut Report, request: &Request<'_>) {
    let build = repo.cargo(&["build", "--release", "--locked", "--package", "staya"]);
    if !report.command("staya for the soak", build) {
        return report.skip(NAME, "the program was not built");
    }
    if let Some(part) = part(PART).filter(|_| request.wants(HIL)) {
        firmware::build_some(repo, report, &mut Toolchains::default(), part, Profile::Firmware, &["lockstep"]);
    }
    run(repo, report, request, "release");
}

/// A short one with the program and the firmware that tests have brought, so that the command itself does not rot.
pub fn run_short(repo: &Repo, report: &mut Report) {
    run(repo, report, &Request { minutes: Some(SHORT), ..Request::default() }, "debug");
}

fn run(repo: &Repo, report: &mut Report, request: &Request<'_>, profile: &str) {
    if !cfg!(target_os = "linux") {
        return report.skip(NAME, "it looks at processes as Linux shows them");
    }
    let python = match crate::clients::prepare(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip(NAME, &reason),
    };
    let mut parts: Vec<&str> = PARTS.into_iter().filter(|part| request.wants(part)).collect();
    if let Some(reason) = parts.contains(&HIL).then(|| missing(repo)).flatten() {
        parts.retain(|part| *part != HIL);
        report.skip("soak of firmware", &reason);
    }
    if parts.is_empty() {
        return;
    }
    let program = repo.target.join(profile).join(format!("staya{}", std::env::consts::EXE_SUFFIX));
    let mut soak = repo.command(&python);
    soak.arg("tests/python/soak.py").env("STAYA", program).env("STAYA_FIRMWARE", repo.target.join("firmware"));
    soak.args(request.minutes.iter().flat_map(|minutes| ["--minutes", minutes]));
    soak.args(request.json.iter().flat_map(|file| ["--json", file]));
    soak.args(parts);
    report.part(NAME, || {
        let mut counts = None;
        let ended = run_reading(&mut soak, |line| counts = closing_line(line).or(counts));
        match (ended, counts) {
            (Ok(()), Some(counts)) => (counts, String::new()),
            (Err(_), Some(counts)) if counts.failed > 0 => (counts, String::from("see above")),
            (ended, _) => (
                Counts { failed: 1, ..Counts::default() },
                ended.err().unwrap_or_else(|| String::from("no closing line")),
            ),
        }
    });
}

/// What firmware in the loop lacks here, if anything.
fn missing(repo: &Repo) -> Option<String> {
    let part = part(PART)?;
    if !Profile::Firmware.elf(repo, part, "lockstep").is_file() {
        return Some(format!("no firmware for {PART}"));
    }
    emulate::prepare(repo, part).err()
}

/// The counts of the last line: `soak: 20 passed, 1 failed in 3.0 minutes; ...`.
fn closing_line(line: &str) -> Option<Counts> {
    let (passed, rest) = line.strip_prefix("soak: ")?.split_once(" passed, ")?;
    let (failed, _) = rest.split_once(" failed in ")?;
    Some(Counts { passed: passed.parse().ok()?, failed: failed.parse().ok()?, skipped: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_has_a_time_a_file_and_parts() {
        let request = Request::read(&["--minutes", "0.5", "flood", "--json", "a.json", "key"]).expect("sound");
        assert_eq!(request, Request { minutes: Some("0.5"), json: Some("a.json"), parts: vec!["flood", "key"] });
        assert!(Request::read(&[]).is_some_and(|all| PARTS.iter().all(|part| all.wants(part))));
        for wrong in [&["--minutes"][..], &["--minutes", "0"], &["--minutes", "x"], &["--json"], &["--all"], &["flod"]]
        {
            assert_eq!(Request::read(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn closing_line_is_counted() {
        let line = "soak: 27 passed, 1 failed in 3.0 minutes; load of the machine 1.9";
        assert_eq!(closing_line(line), Some(Counts { passed: 27, failed: 1, skipped: 0 }));
        assert_eq!(closing_line("flood     ok      memory is flat"), None);
    }
}
