//! The command line of `staya-hil`.

pub use crate::command::HilCommand;
use anyhow::Result;
use clap::Subcommand;
use staya_console::{Ended, Global};

/// Commands for hardware in the loop.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Run some robots of a scenario as firmware, on emulated microcontrollers or boards.
    Hil(Box<HilCommand>),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Any error of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let Self::Hil(args) = self;
        args.run(global)
    }
}
