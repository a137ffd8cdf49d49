//! The command line of `staya-mav`.

mod bridge;
mod companion;
mod formation;

use anyhow::Result;
use clap::Subcommand;
use staya_console::{Ended, Global};

/// Commands that use MAVLink.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Connect a simulated swarm to ground stations and scripts over MAVLink.
    Bridge(Box<bridge::BridgeArgs>),
    /// Send a new shape or goal to a formation over MAVLink.
    Formation(Box<formation::FormationArgs>),
    /// Control ArduPilot or PX4 vehicles as a swarm.
    Companion(Box<companion::CompanionArgs>),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Any error of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match self {
            Self::Bridge(args) => args.run(global),
            Self::Formation(args) => args.run(global),
            Self::Companion(args) => args.run(global),
        }
    }
}
