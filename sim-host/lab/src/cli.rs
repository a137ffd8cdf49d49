//! The commands `staya sweep` and `staya experiment`. A module converts options that are not simply
//! the fields of a plan.

mod figure;
mod flock;
mod goals;
mod movingai;
mod route;
mod sweep;

use crate::boids;
use crate::experiment::Experiment as _;
use crate::experiment::rows::RowRetention;
use anyhow::Result;
use clap::{Args, Subcommand};
use staya_console::{Ended, Global, Stop};

/// Commands that run a swarm many times.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Run a scenario thousands of times with other values in its fields, here or on a cluster.
    Sweep(Box<sweep::SweepArgs>),
    /// Rerun experiments from papers, and benchmarks.
    Experiment(Box<ExperimentArgs>),
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
        }
    }
}

/// Rerun experiments from papers, and benchmarks; without a name, list them.
#[derive(Args, Clone, Debug)]
#[command(args_conflicts_with_subcommands = true)]
pub struct ExperimentArgs {
    #[command(subcommand)]
    experiment: Option<Experiment>,
    #[command(flatten)]
    figure: figure::FigureArgs,
    #[command(flatten)]
    keeping: RowRetention,
}

#[derive(Clone, Debug, Subcommand)]
enum Experiment {
    /// Windowed routing against the global optimum on random land (Kuznetsov, figures 2 to 4).
    Route(Box<route::RouteArgs>),
    /// Queries of a Moving AI benchmark: arrivals, and lengths compared with the optimal ones.
    Movingai(movingai::MovingAiArgs),
    /// Boids on a torus: cost of five neighbour searches (Starovoitova, section 2.3).
    Boids(Box<boids::Plan>),
    /// The five flocking simulations of Olfati-Saber 2006, and flocks driven at each other.
    Flock(Box<flock::FlockArgs>),
    /// Group order of 225 robots with three goals, and tuned gains (Pavlovsky and Pavlovsky).
    Goals(Box<goals::GoalsArgs>),
}

impl ExperimentArgs {
    /// Runs the experiment.
    ///
    /// # Errors
    /// A parameter is out of range, or a file cannot be read or written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let stop = Stop::on_ctrl_c()?;
        let keeping = &self.keeping;
        let Some(experiment) = &self.experiment else {
            return self.figure.run(keeping, global, &stop);
        };
        match experiment {
            Experiment::Route(args) => args.plan().command(&args.out, keeping, global, &stop),
            Experiment::Movingai(args) => args.plan()?.command(&args.out, keeping, global, &stop),
            Experiment::Boids(plan) => plan.command(&plan.out, keeping, global, &stop),
            Experiment::Flock(args) => match args.closing() {
                Some(closing) => closing.command(&args.plan.out.join("closing"), keeping, global, &stop),
                None => args.plan.command(&args.plan.out, keeping, global, &stop),
            },
            Experiment::Goals(args) => match args.tuning() {
                Some(tuning) => tuning.command(&args.plan.out.join("tuned"), keeping, global, &stop),
                None => args.plan.command(&args.plan.out, keeping, global, &stop),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_all_experiments_are_consistent() {
        ExperimentArgs::augment_args(clap::Command::new("experiment")).debug_assert();
    }
}
