//! The commands `staya sweep`, `staya experiment` and `staya migrate`.

mod figure;
mod migrate;
mod sweep;

use crate::sweep::Shard;
use crate::sweep::shard::Existing;
use anyhow::Result;
use clap::{Args, Subcommand};
use staya_console::{Ended, Global};

/// Commands that run a swarm many times.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Run a scenario thousands of times with other values in its fields, here or on a cluster.
    Sweep(Box<sweep::SweepArgs>),
    /// Rerun experiments from papers, and benchmarks; without a name, they are listed.
    Experiment(Box<figure::FigureArgs>),
    /// Rewrite scenarios of earlier versions.
    Migrate(migrate::MigrateArgs),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Those of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match self {
            Self::Sweep(args) => args.run(global),
            Self::Experiment(args) => args.run(global),
            Self::Migrate(args) => args.run(global),
        }
    }
}

/// Treatment of rows.
#[derive(Args, Clone, Debug)]
struct RowArgs {
    /// Make one of N equal parts only, as in 3/8; `staya sweep merge PLAN` merges the parts.
    #[arg(long, value_name = "I/N", default_value_t = Shard::default())]
    shard: Shard,
    /// Make the missing runs.
    #[arg(long)]
    resume: bool,
    /// Replace existing rows.
    #[arg(long, conflicts_with = "resume")]
    restart: bool,
}

impl RowArgs {
    /// `usual`: without an option.
    fn existing(&self, usual: Existing) -> Existing {
        match (self.resume, self.restart) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Forget,
            _ => usual,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_all_commands_are_consistent() {
        Command::augment_subcommands(clap::Command::new("staya")).debug_assert();
    }
}
