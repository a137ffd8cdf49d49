//! The command line of `staya-mav`.

mod bridge;
mod companion;
mod formation;

use anyhow::Result;
use clap::Subcommand;
use staya_console::{Ended, Global};

/// Commands that speak MAVLink.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Let ground stations and scripts see and command a simulated swarm over MAVLink.
    Bridge(Box<bridge::BridgeArgs>),
    /// Tell a swarm in formation to take another shape and to go elsewhere, over MAVLink.
    Formation(Box<formation::FormationArgs>),
    /// Steer ArduPilot or PX4 vehicles as a swarm.
    Companion(Box<companion::CompanionArgs>),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Those of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match self {
            Self::Bridge(args) => args.run(global),
            Self::Formation(args) => args.run(global),
            Self::Companion(args) => args.run(global),
        }
    }
}
