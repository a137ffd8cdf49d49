//! The command line: `staya new | run | sweep | view | page | hil | bridge | formation | companion | terrain | orca | voxel | experiment`,
//! and `completions | man` for its users' shells.
//!
//! A new command is a module with a `clap::Args` struct and `run(&self, &Global) -> Result<Ended>`,
//! and one line in `Command`. Results go to standard output, progress and errors to standard
//! error. Exit codes: 0 done, 1 failed, 2 wrong usage, 130 stopped by Ctrl-C (what was done until
//! then is kept).

mod bridge;
mod companion;
mod formation;
mod hil;
mod page;
mod run;
mod shell;
mod sweep;
mod terrain;
mod view;

use anyhow::Result;
use clap::{CommandFactory as _, Parser, Subcommand};
use staya_console::{Ended, Global, exit};
use staya_papers::cli as papers;
use std::process::ExitCode;

/// Swarms of robots, each with its own onboard controller, in one world with a lossy radio.
#[derive(Debug, Parser)]
#[command(name = "staya", version = staya_sweep::VERSION, propagate_version = true)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make a project of your own: a guidance law, its scenario, a test, firmware.
    New(staya_new::NewArgs),
    /// Run a scenario.
    Run(run::RunArgs),
    /// Run a scenario thousands of times, with other values in its fields, on this machine or on a cluster.
    Sweep(sweep::SweepArgs),
    /// Look at a run in the browser, and take hold of it; or play a recording.
    View(view::ViewArgs),
    /// Make one HTML file of a run, for any browser, without server or network.
    Page(page::PageArgs),
    /// Run some robots of a scenario as firmware, on emulated microcontrollers or boards.
    Hil(hil::HilCommand),
    /// Let ground stations and scripts see and command a simulated swarm over MAVLink.
    Bridge(bridge::BridgeArgs),
    /// Tell a swarm in formation to take another shape and to go elsewhere, over MAVLink.
    Formation(formation::FormationArgs),
    /// Steer ArduPilot or PX4 vehicles as a swarm.
    Companion(companion::CompanionArgs),
    /// Make, measure and draw terrain.
    Terrain(terrain::TerrainArgs),
    /// Draw what ORCA forbids two robots, and measure the tables that it can be looked up in.
    Orca(papers::orca::OrcaArgs),
    /// Make, draw and measure functional voxel models: functions as tables of planes for a microcontroller.
    Voxel(staya_fvm::cli::VoxelArgs),
    /// Rerun experiments from papers, and benchmarks.
    Experiment(papers::ExperimentArgs),
    /// Print what a shell completes `staya` by.
    Completions(shell::CompletionsArgs),
    /// Write a manual page for each command.
    Man(shell::ManArgs),
}

/// Parses the command line, runs the command and reports its errors.
fn main() -> ExitCode {
    let cli = Cli::parse();
    exit("staya", run(&cli))
}

fn run(cli: &Cli) -> Result<Ended> {
    cli.global.begin()?;
    match &cli.command {
        Command::New(args) => args.run(&cli.global),
        Command::Run(args) => args.run(&cli.global),
        Command::Sweep(args) => args.run(&cli.global),
        Command::View(args) => args.run(&cli.global),
        Command::Page(args) => args.run(&cli.global),
        Command::Hil(args) => args.run(&cli.global),
        Command::Bridge(args) => args.run(&cli.global),
        Command::Formation(args) => args.run(&cli.global),
        Command::Companion(args) => args.run(&cli.global),
        Command::Terrain(args) => args.run(&cli.global),
        Command::Orca(args) => args.run(&cli.global),
        Command::Voxel(args) => args.run(&cli.global),
        Command::Experiment(args) => args.run(&cli.global),
        Command::Completions(args) => args.run(Cli::command()),
        Command::Man(args) => args.run(Cli::command(), &cli.global),
    }
}
