//! Finds the programs of commands: `staya NAME` runs the program with the command NAME.
//!
//! In a checkout, cargo first builds the package into this program's folder (0.2 s if up to date);
//! else the program is in the folder of this one or in the PATH.

use anyhow::{Context as _, Result, bail};
use clap::{Arg, Command};
use staya_console::Ended;
use staya_console::say;
use staya_sim::shown::Shown as _;
use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A program with some of the commands.
#[derive(Debug)]
pub struct Program {
    /// Name of the program.
    pub name: &'static str,
    /// Package that contains it.
    pub package: &'static str,
    /// Its commands with their lines in `staya --help`.
    pub commands: &'static [(&'static str, &'static str)],
}

/// The program for live pages and MCAP.
pub const VIEW: &Program = &PROGRAMS[1];

/// All programs beside `staya`.
pub const PROGRAMS: [Program; 5] = [
    Program {
        name: "staya-lab",
        package: "staya-lab",
        commands: &[
            ("sweep", "Run a scenario thousands of times with other values in its fields, here or on a cluster"),
            ("experiment", "Rerun experiments from papers, and benchmarks; without a name, they are listed"),
            ("migrate", "Rewrite scenarios of earlier versions"),
        ],
    },
    Program {
        name: "staya-view",
        package: "staya-view",
        commands: &[("view", "Watch a run in the browser and interact with it, or play a recording")],
    },
    Program {
        name: "staya-hil",
        package: "staya-hil",
        commands: &[("hil", "Run some robots of a scenario as firmware, on emulated microcontrollers or boards")],
    },
    Program {
        name: "staya-mav",
        package: "staya-mav",
        commands: &[
            ("bridge", "Connect a simulated swarm to ground stations and scripts over MAVLink"),
            ("formation", "Send a new shape or goal to a formation over MAVLink"),
            ("companion", "Control ArduPilot or PX4 vehicles as a swarm"),
        ],
    },
    Program {
        name: "staya-voxel",
        package: "staya-fvm",
        commands: &[
            ("orca", "Draw the velocities that ORCA forbids two robots, and measure its lookup tables"),
            ("voxel", "Make, draw and measure functional voxel models: functions as tables for a microcontroller"),
        ],
    },
];

/// The program with the command `command`.
#[must_use]
pub fn of(command: &str) -> Option<&'static Program> {
    PROGRAMS.iter().find(|program| program.commands.iter().any(|(name, _)| *name == command))
}

/// Adds the commands of all programs and `help` to the command line of `staya`.
#[must_use]
pub fn with_commands(line: Command) -> Command {
    let rest = || Arg::new("arguments").num_args(0..).allow_hyphen_values(true).trailing_var_arg(true).hide(true);
    let stub = |&(name, about): &(&'static str, &'static str)| {
        Command::new(name).about(about).disable_help_flag(true).disable_version_flag(true).arg(rest())
    };
    let help = Command::new("help").about("Print this message, or the help of a command").arg(Arg::new("command"));
    let stubs = PROGRAMS.iter().flat_map(|program| program.commands).map(stub);
    line.subcommands(stubs).disable_help_subcommand(true).subcommand(help)
}

/// Runs a program with this process's arguments; on Unix it replaces this process.
///
/// # Errors
/// The program cannot be built or found.
pub fn hand_over(program: &Program) -> Result<Ended> {
    hand_over_as(program, &env::args_os().skip(1).collect::<Vec<_>>())
}

/// Runs a program with these arguments.
///
/// # Errors
/// The program cannot be built or found.
pub fn hand_over_as(program: &Program, arguments: &[OsString]) -> Result<Ended> {
    let path = find(program)?;
    let mut command = std::process::Command::new(&path);
    command.args(arguments);
    become_it(command).with_context(|| format!("cannot start {}", path.shown()))
}

#[cfg(unix)]
fn become_it(mut command: std::process::Command) -> Result<Ended> {
    use std::os::unix::process::CommandExt as _;
    Err(command.exec().into())
}

#[cfg(not(unix))]
fn become_it(mut command: std::process::Command) -> Result<Ended> {
    let status = command.status()?;
    std::process::exit(status.code().unwrap_or(1));
}

fn find(program: &Program) -> Result<PathBuf> {
    let file = format!("{}{}", program.name, env::consts::EXE_SUFFIX);
    let own = env::current_exe().context("cannot find the path of this program")?;
    let beside = own.with_file_name(&file);
    if let Some(place) = Place::of(&own) {
        place.build(program, &beside)?;
        return Ok(beside);
    }
    let on_path = env::var_os("PATH").map_or_else(Vec::new, |path| env::split_paths(&path).collect());
    let mut files = std::iter::once(beside).chain(on_path.into_iter().map(|folder| folder.join(&file)));
    match files.find(|file| file.is_file()) {
        Some(file) => Ok(file),
        None => bail!(
            "{file} is neither beside this program nor on the PATH; in a checkout of Staya, run `cargo xtask install` to install all \
            programs"
        ),
    }
}

struct Place {
    manifest: PathBuf,
    target: PathBuf,
    profile: String,
}

impl Place {
    fn of(own: &Path) -> Option<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
        let folder = own.parent()?;
        let target = folder.parent()?;
        let is_checkout = root.join("Cargo.lock").is_file() && target.join(".rustc_info.json").is_file();
        let profile = match folder.file_name()?.to_str()? {
            "debug" => "dev",
            name => name,
        };
        is_checkout.then(|| Self {
            manifest: root.join("Cargo.toml"),
            target: target.to_owned(),
            profile: profile.to_owned(),
        })
    }

    fn build(&self, program: &Program, file: &Path) -> Result<()> {
        let is_there = file.is_file();
        if !is_there {
            say(&format!("building {} (once)", program.name));
        }
        let mut cargo = std::process::Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(["build", "--quiet", "--package", program.package, "--bin", program.name]);
        cargo.args(["--profile", &self.profile]).arg("--target-dir").arg(&self.target);
        cargo.arg("--manifest-path").arg(&self.manifest);
        match cargo.status() {
            Ok(status) if status.success() => Ok(()),
            Ok(_) => bail!("cargo could not build {}; see the messages above", program.name),
            Err(_) if is_there => Ok(()),
            Err(error) => bail!("cannot start cargo to build {}: {error}; install Rust", program.name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_belongs_to_one_program() {
        let commands: Vec<_> = PROGRAMS.iter().flat_map(|program| program.commands).map(|(name, _)| name).collect();
        let mut different = commands.clone();
        different.sort_unstable();
        different.dedup();
        assert_eq!(different.len(), commands.len());
        assert_eq!(VIEW.name, "staya-view");
        assert!(of("run").is_none() && of("sweep").is_some_and(|program| program.name == "staya-lab"));
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory as _;
        with_commands(staya_console::Line::<crate::cli::Command>::command()).debug_assert();
    }

    #[test]
    fn a_program_outside_a_target_folder_counts_as_installed() {
        assert!(Place::of(Path::new("/usr/local/bin/staya")).is_none());
    }
}
