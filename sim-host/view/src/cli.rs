//! The command line.

use crate::command::ViewArgs;
use crate::observers;
use anyhow::Result;
use clap::Subcommand;
use staya::run::RunArgs;
use staya_console::{Ended, Global};

/// Commands with a live page or an MCAP file.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Watch a run in the browser and interact with it, or play a recording.
    View(ViewArgs),
    /// Run a scenario.
    #[command(hide = true)]
    Run(RunArgs),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Any error of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match self {
            Self::View(args) => args.run(global),
            Self::Run(args) => args.run_with(global, &observers::of_run),
        }
    }
}
