//! The command line of `staya-mav`.

mod bridge;
mod companion;
mod formation;

use crate::terminal::{number, say};
use anyhow::Result;
use clap::Subcommand;
use staya_console::{Ended, Global};
use staya_mavlink::signing::Signing;
use staya_sim::key::{KeyFile, timestamp};
use std::path::Path;

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

/// Signatures with the key in a file, under a number that no other sender with this key uses.
fn signing(path: Option<&Path>, link: u8) -> Result<Option<Signing>> {
    let Some(path) = path else { return Ok(None) };
    let KeyFile { key, remark } = KeyFile::read(path)?;
    remark.iter().for_each(|remark| say(remark));
    Ok(Some(Signing::new(key, link, timestamp())))
}
