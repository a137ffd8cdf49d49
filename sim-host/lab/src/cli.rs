//! The command line of `staya-lab`: `staya sweep`, and `staya experiment`, which repeats papers and
//! benchmarks.
//!
//! If the options of an experiment are not simply the fields of its plan, a module here converts
//! them.

mod crossing;
mod flock;
mod formation;
mod goals;
mod movingai;
mod route;
mod sweep;

use crate::experiment::Experiment as _;
use crate::experiment::rows::RowRetention;
use crate::{boids, scale, scouting};
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

/// Rerun experiments from papers, and benchmarks.
#[derive(Args, Clone, Debug)]
pub struct ExperimentArgs {
    #[command(subcommand)]
    experiment: Experiment,
    #[command(flatten)]
    keeping: RowRetention,
}

#[derive(Clone, Debug, Subcommand)]
enum Experiment {
    /// Windowed routing against the global optimum on random land (Kuznetsov, figures 2 to 4).
    Route(Box<route::RouteArgs>),
    /// What a map is worth on land that changes, with some of it blank or wrong.
    Scouting(Box<scouting::Plan>),
    /// Six robots in formation on natural land: error, arrivals, travel time (Kuznetsov, section 8,
    /// figure 6).
    Formation(Box<formation::FormationArgs>),
    /// Robots on a circle, each bound for the opposite side: who arrives, how late, how near they
    /// come.
    Swap(crossing::SwapArgs),
    /// Two crowds pass one gap in opposite directions.
    Doorway(crossing::DoorwayArgs),
    /// Fourteen ways to get in each other's way: crossings, doors, corridors, sizes, intruders,
    /// dead ends, in space.
    Crossing(Box<crossing::CrossingArgs>),
    /// The queries of a Moving AI benchmark: how many robots arrive, and how much longer they take.
    Movingai(movingai::MovingAiArgs),
    /// Boids on a torus: what three ways to find neighbours cost, with equal flights (Starovoitova,
    /// section 2.3).
    Boids(Box<boids::Plan>),
    /// The five flocking simulations of Olfati-Saber 2006, and flocks driven at each other.
    Flock(Box<flock::FlockArgs>),
    /// 225 robots travel to three goals: how much of a group they are, and gains tuned (Pavlovsky
    /// and Pavlovsky).
    Goals(Box<goals::GoalsArgs>),
    /// What a robot costs in time and memory, in swarms of a thousand to a million, on the grid and
    /// in the plane.
    Scale(Box<scale::Plan>),
}

impl ExperimentArgs {
    /// Runs the experiment.
    ///
    /// # Errors
    /// A parameter is out of range, or a file cannot be read or written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let stop = Stop::on_ctrl_c()?;
        let keeping = &self.keeping;
        match &self.experiment {
            Experiment::Route(args) => match args.share() {
                Some(plan) => plan.command(&args.out.join("share"), keeping, global, &stop),
                None => args.plan().command(&args.out, keeping, global, &stop),
            },
            Experiment::Scouting(plan) => plan.command(&plan.out, keeping, global, &stop),
            Experiment::Formation(args) => args.plan()?.command(&args.out, keeping, global, &stop),
            Experiment::Swap(args) => args.plan().command(&args.out(), keeping, global, &stop),
            Experiment::Doorway(args) => args.plan().command(&args.out(), keeping, global, &stop),
            Experiment::Crossing(args) => args.plan().command(&args.out, keeping, global, &stop),
            Experiment::Movingai(args) => match args.share()? {
                Some(plan) => plan.command(&args.out.join("share"), keeping, global, &stop),
                None => args.plan()?.command(&args.out, keeping, global, &stop),
            },
            Experiment::Boids(plan) => plan.command(&plan.out, keeping, global, &stop),
            Experiment::Flock(args) => match args.closing() {
                Some(closing) => closing.command(&args.plan.out.join("closing"), keeping, global, &stop),
                None => args.plan.command(&args.plan.out, keeping, global, &stop),
            },
            Experiment::Goals(args) => match args.tuning() {
                Some(tuning) => tuning.command(&args.plan.out.join("tuned"), keeping, global, &stop),
                None => args.plan.command(&args.plan.out, keeping, global, &stop),
            },
            Experiment::Scale(plan) => plan.command(&plan.out, keeping, global, &stop),
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
