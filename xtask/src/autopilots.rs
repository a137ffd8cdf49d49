//! `cargo xtask autopilots`: the companion beside ArduPilot's own code, in its own simulation, for
//! whoever has built it.

use crate::options::Options;
use crate::python;
use crate::repo::{Repo, run_reading};
use crate::session::Session;
use crate::tally::counted;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where pytest's settings are, from which it counts the names of tests.
const TOP: &str = "tests/python";
/// Seconds that one flight may take; a loaded machine needs long until all have positions.
const LONGEST: &str = "900";
const REMEDY: &str = "build ArduPilot's simulation (docs/autopilots.md) and name it";
/// Where a checkout of ArduPilot has the parameters that its own tests start vehicles with.
const DEFAULTS: &str = "Tools/autotest/default_params";

/// A vehicle, the tests that need it, and the program that a person names.
struct Kind {
    name: &'static str,
    option: &'static str,
    variable: &'static str,
    files: &'static [&'static str],
}

const ROVER: Kind = Kind {
    name: "rover",
    option: "--rover",
    variable: "STAYA_ROVER",
    files: &["test_rovers.py", "test_failures.py", "test_links.py"],
};
const COPTER: Kind = Kind { name: "copter", option: "--copter", variable: "STAYA_COPTER", files: &["test_copters.py"] };

/// The program that simulates this kind of vehicle, and the folder with its parameters; the error
/// says why there is none.
fn simulation(repo: &Repo, options: &Options<'_>, kind: &Kind) -> Result<[PathBuf; 2], String> {
    let Kind { name, option, .. } = kind;
    let program = options.value(option);
    let program = program.ok_or_else(|| format!("no program: {REMEDY}, `cargo xtask autopilots {option} PATH`"))?;
    let absent = |error: std::io::Error| format!("{option} {program}: {error}; {REMEDY}");
    let program = Path::new(program).canonicalize().map_err(absent)?;
    // It ends with 1 after its help.
    let help = repo.command(&program).arg("--help").output().map_err(absent)?;
    if !String::from_utf8_lossy(&[help.stdout, help.stderr].concat()).contains("--model") {
        return Err(format!("{option} {}: not a simulation of ArduPilot (board sitl)", program.display()));
    }
    let file = format!("{name}.parm");
    let beside = || program.ancestors().map(|folder| folder.join(DEFAULTS)).collect();
    let named = |folder| Path::new(folder).canonicalize().into_iter().collect();
    let folders: Vec<PathBuf> = options.value("--defaults").map_or_else(beside, named);
    match folders.into_iter().find(|folder| folder.join(&file).is_file()) {
        Some(defaults) => Ok([program, defaults]),
        None => Err(format!(
            "no {file}, with which ArduPilot starts its simulation: name its folder, --defaults ARDUPILOT/{DEFAULTS}"
        )),
    }
}

/// The command: each flight is a row of the closing table, with its figures.
pub fn run_command(s: &mut Session, options: &Options<'_>) {
    let mut flights = Vec::new();
    for kind in [ROVER, COPTER] {
        let simulation = simulation(&s.repo, options, &kind);
        flights.extend(s.report.need(&format!("ArduPilot's {}s", kind.name), simulation).map(|found| (kind, found)));
    }
    if flights.is_empty() {
        return;
    }
    let program = s.staya("release");
    let ready = program.and_then(|program| Ok((program, python::client_environment(&s.repo)?)));
    let Some((staya, python)) = s.report.need("flights", ready) else { return };
    for (kind, [program, defaults]) in flights {
        let start = || {
            let mut tests = python::pytest(&s.repo, &python, &["--timeout", LONGEST]);
            tests.env(kind.variable, &program).env("STAYA_AUTOPILOT_DEFAULTS", &defaults).env("STAYA", &staya);
            tests
        };
        let mut list = start();
        list.arg("--collect-only").args(kind.files.iter().map(|file| format!("{TOP}/autopilots/{file}")));
        list.args(options.name().into_iter().flat_map(|name| ["-k", name]));
        for test in names(&mut list) {
            // One at a time: they go by the clock.
            let row = test.rsplit("::test_").next().unwrap_or(&test).replace('_', " ");
            s.report.part(&row, || counted(start().arg("-s").arg(&test)));
        }
    }
}

/// The tests that pytest would run.
fn names(list: &mut Command) -> Vec<String> {
    let mut names = Vec::new();
    // Without any it says so, and that is all there is to say.
    let _ = run_reading(list, |line| names.extend(line.contains("::test_").then(|| format!("{TOP}/{line}"))));
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_cannot_be_started_is_refused_with_the_remedy() {
        let repo = Repo::find();
        let refused = |arguments: &[&str]| {
            let options = Options::read("autopilots [--rover PATH]", arguments).expect("sound");
            simulation(&repo, &options, &ROVER).err().unwrap_or_default()
        };
        assert!(refused(&[]).contains("docs/autopilots.md"));
        assert!(refused(&["--rover", "/nowhere/ardurover"]).contains("--rover /nowhere/ardurover: "));
        assert!(refused(&["--rover", "/bin/true"]).contains("not a simulation"));
    }
}
