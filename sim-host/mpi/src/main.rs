//! The program `staya-mpi`: `mpirun -n 4 staya-mpi run SCENARIO`, with the trace hash of `staya
//! run`. Rank 0 writes and prints the results. docs/sweeps.md describes the build and the costs.

mod link;
mod run;

use anyhow::{Context as _, Result};
use clap::{Parser, Subcommand};
use mpi::traits::Communicator as _;
use staya_console::{Ended, Global, Stop, say};
use std::process::ExitCode;

/// Run one scenario on several processes connected by MPI; start it with mpirun or srun.
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
                say(&format!("staya-mpi: {error:#}"));
            }
            ExitCode::FAILURE
        }
    }
}

/// Runs a rank. An error on one rank ends all.
fn on_rank(cli: Cli) -> Result<Ended> {
    // By default a rank has one core.
    let threads = cli.global.threads.unwrap_or(1);
    rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global().context("cannot start threads")?;
    let stop = Stop::on_ctrl_c()?;
    let (universe, _) =
        mpi::initialize_with_threading(mpi::Threading::Funneled).context("MPI is already initialised")?;
    let world = universe.world();
    let rank = world.rank();
    let (link, server) = link::connect(universe.world(), stop.clone());
    let Command::Run(run) = cli.command;
    let run = std::thread::Builder::new().name(String::from("run")).spawn(move || {
        let ended = run.run(&cli.global, link, &stop);
        match &ended {
            Err(error) if !error.is::<run::Agreed>() => {
                say(&format!("staya-mpi: rank {rank}: {error:#}"));
                // MPI may wait for a rank that has ended; only the end of the process releases this
                // and the other ranks.
                std::process::exit(1);
            }
            _ => ended,
        }
    });
    let run = run.context("cannot start the run's thread")?;
    server.serve();
    match run.join() {
        Ok(ended) => ended,
        Err(_) => world.abort(101),
    }
}
