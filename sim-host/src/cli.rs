//! The command line of `staya`.
//!
//! A command is a module with a `clap::Args` struct and `run(&self, &Global) -> Result<Ended>`, and
//! a variant of [`Command`]. Exit codes: 0 success, 1 error, 2 invalid usage, 130 stopped by Ctrl-C
//! (with the results so far).

use crate::programs::{self, VIEW};
use crate::{page, run, terrain};
use anyhow::Result;
use clap::{CommandFactory as _, FromArgMatches as _, Subcommand};
use staya_console::{Ended, Global, Line};
use std::process::ExitCode;

/// Commands of `staya` itself; [`programs`] has the others.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Create a project with your own guidance law: scenario, test, firmware.
    New(staya_new::NewArgs),
    /// Run a scenario.
    Run(run::RunArgs),
    /// Make one HTML file of a run, for any browser, without server or network.
    Page(page::PageArgs),
    /// Generate, measure and draw terrain.
    Terrain(terrain::TerrainArgs),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Any error of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match self {
            Self::New(args) => args.run(global),
            // `staya-view` runs the same command with more observers.
            Self::Run(args) if args.needs_view() => programs::hand_over(VIEW),
            Self::Run(args) => args.run(global),
            Self::Page(args) => args.run(global),
            Self::Terrain(args) => args.run(global),
        }
    }
}

/// Parses the command line, runs the command or its program, and reports errors.
#[must_use]
pub fn main() -> ExitCode {
    let matches = programs::with_commands(Line::<Command>::command()).try_get_matches();
    let matches = matches.unwrap_or_else(|error| staya_console::refuse(error));
    let ended = match matches.subcommand() {
        Some(("help", asked)) => return help(asked.get_one::<String>("command").map(String::as_str)),
        Some((name, _)) if let Some(program) = programs::of(name) => programs::hand_over(program),
        _ => {
            let line = Line::<Command>::from_arg_matches(&matches).unwrap_or_else(|error| staya_console::refuse(error));
            line.global.begin().and_then(|()| line.command.run(&line.global))
        }
    };
    staya_console::exit("staya", ended)
}

fn help(command: Option<&str>) -> ExitCode {
    let ended = match command.and_then(programs::of) {
        Some(program) => {
            let arguments = [command.unwrap_or_default(), "--help"].map(Into::into);
            programs::hand_over_as(program, &arguments)
        }
        None => {
            let line = ["staya"].into_iter().chain(command).chain(["--help"]);
            match programs::with_commands(Line::<Command>::command()).try_get_matches_from(line) {
                Ok(_) => Ok(Ended::Done),
                Err(text) => text.exit(),
            }
        }
    };
    staya_console::exit("staya", ended)
}
