//! `cargo xtask autopilots`: the companion beside ArduPilot's own code, in its own simulation, for
//! whoever has built it.

use crate::prelude::*;
use crate::python;

/// Where pytest's settings are, from which it counts the names of tests.
const TOP: &str = "tests/python";
/// Seconds that one flight may take; a loaded machine needs long until all have positions.
const LONGEST: &str = "900";
const REMEDY: &str = "build ArduPilot's simulation (docs/autopilots.md) and name it";
/// Where a checkout of ArduPilot has the parameters that its own tests start vehicles with.
const DEFAULTS: &str = "Tools/autotest/default_params";

#[derive(clap::Args, Default)]
pub struct Options {
    /// ArduPilot's simulation of a rover
    #[arg(long, value_name = "PATH")]
    rover: Option<PathBuf>,
    /// ArduPilot's simulation of a copter
    #[arg(long, value_name = "PATH")]
    copter: Option<PathBuf>,
    /// The folder of ArduPilot with the parameters of both
    #[arg(long, value_name = "FOLDER")]
    defaults: Option<PathBuf>,
    /// Flights whose names contain this
    name: Option<String>,
}

/// The program that simulates this kind of vehicle, and the folder with its parameters; the error
/// says why there is none.
fn simulation(repo: &Repo, kind: &str, program: Option<&Path>, defaults: Option<&Path>) -> Result<[PathBuf; 2]> {
    let program = program.with_context(|| format!("no program: {REMEDY}, `cargo xtask autopilots --{kind} PATH`"))?;
    let shown = format!("--{kind} {}", program.display());
    let program = program.canonicalize().with_context(|| format!("{shown}: {REMEDY}"))?;
    // It ends with 1 after its help.
    let help = repo.command(&program).arg("--help").output().with_context(|| format!("{shown}: {REMEDY}"))?;
    let help = String::from_utf8_lossy(&[help.stdout, help.stderr].concat()).into_owned();
    ensure!(help.contains("--model"), "{shown}: not a simulation of ArduPilot (board sitl)");
    let file = format!("{kind}.parm");
    let beside = || program.ancestors().map(|folder| folder.join(DEFAULTS)).collect();
    let named = |folder: &Path| folder.canonicalize().into_iter().collect();
    let folders: Vec<PathBuf> = defaults.map_or_else(beside, named);
    let found = folders.into_iter().find(|folder| folder.join(&file).is_file());
    let remedy = format!("name its folder, --defaults ARDUPILOT/{DEFAULTS}");
    let found = found.with_context(|| format!("no {file}, with which ArduPilot starts its simulation: {remedy}"))?;
    Ok([program, found])
}

/// The command: each flight is a row of the closing table, with its figures.
pub fn run(s: &mut Session, options: &Options) {
    let is_any_named = options.rover.is_some() || options.copter.is_some();
    let staya = if is_any_named { s.staya("release") } else { Err(skipped(REMEDY)) };
    let mut flights = Vec::new();
    for (kind, program, variable, tests) in [
        ("rover", &options.rover, "STAYA_ROVER", &["test_rovers.py", "test_failures.py", "test_links.py"][..]),
        ("copter", &options.copter, "STAYA_COPTER", &["test_copters.py"]),
    ] {
        s.report.part(&format!("ArduPilot's {kind}s"), || {
            let found = simulation(&s.repo, kind, program.as_deref(), options.defaults.as_deref());
            let [program, defaults] = found.map_err(|error| skipped(format!("{error:#}")))?;
            let staya = staya.as_ref().map_err(|error| skipped(error.to_string()))?;
            let python = python::client_environment(&s.repo)?;
            let variables = [(variable, program), ("STAYA_AUTOPILOT_DEFAULTS", defaults), ("STAYA", staya.clone())];
            let mut list = python::pytest(&s.repo, &python, &["--collect-only"]);
            list.envs(variables.clone()).args(tests.iter().map(|file| format!("{TOP}/autopilots/{file}")));
            list.args(options.name.iter().flat_map(|name| ["-k", name]));
            // Without any test pytest says so.
            let _ = run_reading(&mut list, |line| {
                let flight = || (python.clone(), variables.clone(), format!("{TOP}/{line}"));
                flights.extend(line.contains("::test_").then(flight));
            });
            Ok((Counts::default(), String::new()))
        });
    }
    for (python, variables, test) in flights {
        // One at a time: they go by the clock.
        let row = test.rsplit("::test_").next().unwrap_or(&test).replace('_', " ");
        let arguments = ["--timeout", LONGEST, "-s", &test];
        let flight = || Ok(counted(python::pytest(&s.repo, &python, &arguments).envs(variables)));
        s.report.part(&row, flight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_cannot_be_started_is_refused_with_the_remedy() {
        let repo = Repo::find();
        let refused = |program: Option<&str>| {
            let found = simulation(&repo, "rover", program.map(Path::new), None);
            found.err().map(|error| format!("{error:#}")).unwrap_or_default()
        };
        assert!(refused(None).contains("docs/autopilots.md"));
        assert!(refused(Some("/nowhere/ardurover")).contains("--rover /nowhere/ardurover: "));
        assert!(refused(Some("/bin/true")).contains("not a simulation"));
    }
}
