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

/// Run the experiments of papers and benchmarks again.
#[derive(Args, Clone, Debug)]
pub struct ExperimentArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Clone, Debug, Subcommand)]
enum Experiment {
    /// Windowed routing against the global optimum on random land (KUZ section 5, figures 2 to 4).
    Route(Box<route::RouteArgs>),
    /// Six robots in formation on natural land: error, arrivals, travel time (KUZ section 8, figure 6).
    Formation(Box<formation::FormationArgs>),
    /// Robots on a circle, each bound for the opposite side: who arrives, how late, how near they come.
    Swap(crossing::SwapArgs),
    /// Two crowds in opposite directions through one gap.
    Doorway(crossing::DoorwayArgs),
    /// The queries of a Moving AI benchmark: how many robots arrive, and at what loss.
    Movingai(movingai::MovingAiArgs),
    /// Boids on a torus: three ways to find neighbours, equal flights, and what they cost (STA section 2.3).
    Boids(boids::BoidsArgs),
    /// The five flocking simulations of Olfati-Saber 2006, and flocks driven at each other.
    Flock(Box<flock::FlockArgs>),
    /// 225 robots that go to three goals as a group, more or less (Pavlovsky and Pavlovsky).
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
