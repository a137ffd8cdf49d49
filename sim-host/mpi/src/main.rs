//! The command line: `mpirun -n 4 staya-mpi run SCENARIO`. One world over ranks, with the trace hash of `staya run`.
//!
//! Rank 0 writes the results and prints them. docs/sweeps.md says how to build it, and what it costs.

mod link;
mod run;

use anyhow::{Context as _, Result};
use clap::{Parser, Subcommand};
use mpi::traits::Communicator as _;
use staya_console::{Ended, Global, Stop};
use std::io::Write as _;
use std::process::ExitCode;

/// One world of robots over many processes, connected by MPI. To be started by mpirun or srun.
#[derive(Debug, Parser)]
#[command(name = "staya-mpi", version, propagate_version = true)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario.
    Run(run::RunArgs),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match on_rank(cli) {
        Ok(Ended::Done) => ExitCode::SUCCESS,
        Ok(Ended::Interrupted) => ExitCode::from(130),
        Err(error) => {
            if !error.is::<run::Agreed>() {
                let _ = writeln!(std::io::stderr(), "staya-mpi: {error:#}");
            }
            ExitCode::FAILURE
        }
    }
}

/// The whole life of a rank. An error on one ends all.
fn on_rank(cli: Cli) -> Result<Ended> {
    // A rank has one core unless somebody says otherwise.
    let threads = cli.global.threads.unwrap_or(1);
    rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global().context("no threads")?;
    let stop = Stop::on_ctrl_c()?;
    let (universe, _) =
        mpi::initialize_with_threading(mpi::Threading::Funneled).context("MPI has been initialised before")?;
    let world = universe.world();
    let rank = world.rank();
    let (link, server) = link::connect(universe.world(), stop.clone());
    let Command::Run(run) = cli.command;
    let run = std::thread::Builder::new().name(String::from("run")).spawn(move || {
        let ended = run.run(&cli.global, link, &stop);
        match &ended {
            Err(error) if !error.is::<run::Agreed>() => {
                let _ = writeln!(std::io::stderr(), "staya-mpi: rank {rank}: {error:#}");
                // MPI may wait for somebody who is gone: nothing but the end gets the main thread out of it, and the others.
                std::process::exit(1);
            }
            _ => ended,
        }
    });
    let run = run.context("no thread")?;
    server.serve();
    match run.join() {
        Ok(ended) => ended,
        // The panic has been printed.
        Err(_) => world.abort(101),
    }
}
