//! `cargo xtask autopilots`: the companion beside ArduPilot's own code, in its own simulation, for whoever has built it.

use crate::clients;
use crate::python::pytest;
use crate::repo::{Repo, run, run_reading};
use crate::report::Report;
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

const KINDS: [Kind; 2] = [
    Kind {
        name: "rover",
        option: "--rover",
        variable: "STAYA_ROVER",
        files: &["test_rovers.py", "test_failures.py", "test_links.py"],
    },
    Kind { name: "copter", option: "--copter", variable: "STAYA_COPTER", files: &["test_copters.py"] },
];

/// What the command line asks for.
#[derive(Default, Debug, PartialEq)]
pub struct Request<'a> {
    /// The programs, by the places in [`KINDS`].
    programs: [Option<&'a str>; 2],
    defaults: Option<&'a str>,
    /// Of the tests those whose names contain it.
    name: Option<&'a str>,
}

impl<'a> Request<'a> {
    /// Reads `[--rover PATH] [--copter PATH] [--defaults FOLDER] [NAME]`.
    pub fn read(arguments: &[&'a str]) -> Option<Self> {
        let mut request = Self::default();
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let [rover, copter] = &mut request.programs;
            let place = match *argument {
                "--rover" => rover,
                "--copter" => copter,
                "--defaults" => &mut request.defaults,
                option if option.starts_with('-') => return None,
                name => {
                    request.name = Some(name);
                    continue;
                }
            };
            *place = Some(rest.next()?);
        }
        Some(request)
    }
}

/// A simulation that can be started, and the folder with its parameters.
struct Simulation {
    program: PathBuf,
    defaults: PathBuf,
}

/// The simulation of `kind` that is asked for; the error says why there is none.
fn simulation(repo: &Repo, request: &Request<'_>, kind: &Kind, program: Option<&str>) -> Result<Simulation, String> {
    let Kind { name, option, .. } = kind;
    let Some(program) = program else {
        return Err(format!("no program: {REMEDY}, `cargo xtask autopilots {option} PATH`"));
    };
    let absent = |error: std::io::Error| format!("{option} {program}: {error}; {REMEDY}");
    let program = Path::new(program).canonicalize().map_err(absent)?;
    // It ends with 1 after its help.
    let help = repo.command(&program).arg("--help").output();
    let help = help.map_err(|error| format!("{option} {}: cannot start: {error}; {REMEDY}", program.display()))?;
    let text = [help.stdout, help.stderr].concat();
    if !String::from_utf8_lossy(&text).contains("--model") {
        return Err(format!("{option} {}: not a simulation of ArduPilot (board sitl)", program.display()));
    }
    let file = format!("{name}.parm");
    let beside = || program.ancestors().map(|folder| folder.join(DEFAULTS)).find(|folder| folder.join(&file).is_file());
    let defaults = match request.defaults {
        Some(folder) => Path::new(folder).canonicalize().ok().filter(|folder| folder.join(&file).is_file()),
        None => beside(),
    };
    let defaults = defaults.ok_or_else(|| {
        format!(
            "no {file}, with which ArduPilot starts its simulation: name its folder, --defaults ARDUPILOT/{DEFAULTS}"
        )
    })?;
    Ok(Simulation { program, defaults })
}

/// The command: each flight is a row of the closing table, with its figures.
pub fn run_command(repo: &Repo, report: &mut Report, request: &Request<'_>) {
    let mut flights = Vec::new();
    for (kind, program) in KINDS.iter().zip(request.programs) {
        match simulation(repo, request, kind, program) {
            Ok(simulation) => flights.push((kind, simulation)),
            Err(reason) => report.skip(&format!("ArduPilot's {}s", kind.name), &reason),
        }
    }
    if flights.is_empty() {
        return;
    }
    let mut build = repo.cargo(&["build", "--locked", "--release", "--package", "staya"]);
    if !report.step("staya beside autopilots", || run(&mut build)) {
        return;
    }
    let python = match clients::environment(repo) {
        Ok(python) => python,
        Err(reason) => return report.skip("flights", &reason),
    };
    for (kind, simulation) in flights {
        let start = || {
            let mut tests = repo.command(&python);
            tests.args(["-m", "pytest", "-q", "--color", "no", "--timeout", LONGEST]);
            tests.env(kind.variable, &simulation.program).env("STAYA_AUTOPILOT_DEFAULTS", &simulation.defaults);
            let program = format!("staya{}", std::env::consts::EXE_SUFFIX);
            tests.env("STAYA", repo.target.join("release").join(program));
            tests
        };
        let mut list = start();
        list.arg("--collect-only").args(kind.files.iter().map(|file| format!("{TOP}/autopilots/{file}")));
        list.args(request.name.into_iter().flat_map(|name| ["-k", name]));
        for test in names(&mut list) {
            // One at a time: they go by the clock.
            let row = test.rsplit("::test_").next().unwrap_or(&test).replace('_', " ");
            report.part(&row, || pytest(start().arg("-s").arg(&test), "wanted, and not reached"));
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
    fn arguments_are_read() {
        let request = Request::read(&["--copter", "c", "hold", "--rover", "r", "--defaults", "d"]);
        let wanted = Request { programs: [Some("r"), Some("c")], defaults: Some("d"), name: Some("hold") };
        assert_eq!(request, Some(wanted));
        assert_eq!(Request::read(&[]), Some(Request::default()));
        assert_eq!(Request::read(&["--rover"]), None);
        assert_eq!(Request::read(&["--plane", "p"]), None);
    }

    #[test]
    fn what_cannot_be_started_is_refused_with_what_to_do() {
        let (repo, [rover, _]) = (Repo::find(), &KINDS);
        let refused = |program| simulation(&repo, &Request::default(), rover, program).err().unwrap_or_default();
        assert!(refused(None).contains("docs/autopilots.md"));
        assert!(refused(Some("/nowhere/ardurover")).contains("--rover /nowhere/ardurover: "));
        assert!(refused(Some("/bin/true")).contains("not a simulation"));
    }
}
