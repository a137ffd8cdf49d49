//! `staya experiment route | formation | movingai | swap | doorway | boids | flock | goals`: papers and benchmarks, run again.
//!
//! A further experiment is a module with a `clap::Args` struct and `run(&self, &Global) -> Result<Ended>`, and one
//! line each in [`Experiment`] and [`ExperimentArgs::run`].

mod boids;
mod crossing;
mod flock;
mod formation;
mod goals;
mod movingai;
pub mod orca;
pub mod params;
mod results;
mod route;

use anyhow::Result;
use clap::{Args, Subcommand};
use staya_console::{Ended, Global};

/// Rerun experiments from papers, and benchmarks.
#[derive(Args, Clone, Debug)]
pub struct ExperimentArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Clone, Debug, Subcommand)]
enum Experiment {
    /// Windowed routing against the global optimum on random land (Kuznetsov, figures 2 to 4).
    Route(Box<route::RouteArgs>),
    /// Six robots in formation on natural land: error, arrivals, travel time (Kuznetsov, figure 6).
    Formation(Box<formation::FormationArgs>),
    /// Robots on a circle, each bound for the opposite side: who arrives, how late, how near they come.
    Swap(crossing::SwapArgs),
    /// Two crowds pass one gap in opposite directions.
    Doorway(crossing::DoorwayArgs),
    /// The queries of a Moving AI benchmark: how many robots arrive, and how much longer they take.
    Movingai(movingai::MovingAiArgs),
    /// Boids on a torus: what three ways to find neighbours cost, with equal flights (Starovoitova, section 2.3).
    Boids(boids::BoidsArgs),
    /// The five flocking simulations of Olfati-Saber 2006, and flocks driven at each other.
    Flock(Box<flock::FlockArgs>),
    /// 225 robots travel to three goals: how much of a group they stay (Pavlovsky and Pavlovsky).
    Goals(Box<goals::GoalsArgs>),
}

impl ExperimentArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, a file that cannot be read or written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.experiment {
            Experiment::Route(args) => args.run(global),
            Experiment::Formation(args) => args.run(global),
            Experiment::Swap(args) => args.run(global),
            Experiment::Doorway(args) => args.run(global),
            Experiment::Movingai(args) => args.run(global),
            Experiment::Boids(args) => args.run(global),
            Experiment::Flock(args) => args.run(global),
            Experiment::Goals(args) => args.run(global),
        }
    }
}
