//! ORCA, paths and programmes by functional voxel models (A. Tolok, M. Loktev and others, FVM).
//!
//! A plan names one task, whose measures it has; those of other tasks are empty.

mod example;
mod half_planes;
mod path;
mod programme;
mod ridges;
#[cfg(test)]
mod tests;

use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch};
use staya_sim::{choice, defaults, table};
use std::path::{Path, PathBuf};

/// The study.
#[derive(Debug)]
pub struct Fvm;

choice! {
    /// Kind of run.
    pub enum Task {
        /// The worked example of the paper, and its equations 1 to 15 on random pairs of robots.
        Example = "example",
        /// Half-planes of random pairs of robots beside the formula.
        HalfPlanes = "half_planes",
        /// A path by descent on a model of travel times (figure 1a).
        Path = "path",
        /// The velocity nearest to a wish within half-planes.
        Programme = "programme",
        /// Routes by the ridges of a function (figure 1b).
        Ridges = "ridges",
    }
}

choice! {
    /// Where half-planes come from.
    pub enum Source {
        /// The formula of the controller.
        Formula = "formula",
        /// The controller's table of 2 KiB.
        Table = "table",
        /// A model of three variables for all pairs of robots.
        Neighbor = "neighbor",
        /// A model of the velocity obstacle of the example by distances.
        Distance = "distance",
        /// A model of that obstacle by R-functions, as in equation 15.
        RFunction = "r_function",
    }
}

table! {
    /// Parameters of a run.
    #[derive(Copy)]
    pub struct Parameters {
        /// Kind of run.
        pub task: Task = Task::Example;
        /// Source of the half-planes.
        pub source: Source = Source::Formula;
        /// Share of the correction that the robot makes.
        pub share: f64 = 1.0, 0.0..=1.0, "";
        /// Nodes of a model along each axis; `neighbor` has half and a quarter along the others.
        pub nodes: u16 = 65, 5.0..=1000.0, "";
        /// Bits per component of a model.
        pub depth: u8 = 16, 4.0..=16.0, "";
        /// Random pairs of robots, or wishes.
        pub pairs: u32 = 2000, 1.0..=1e7, "";
        /// Obstacles of the natural land of 100 x 100 cells, as in KUZ, or of the room of `ridges`.
        pub obstacles: u32 = 70, 1.0..=5000.0, "";
        /// Half-planes of a programme.
        pub half_planes: u32 = 10, 1.0..=16.0, "";
    }
}

defaults!(Parameters);

/// Measures of one task.
type Values = Vec<(&'static str, Option<f64>)>;

impl Parameters {
    fn measure(&self, seed: u64, watch: &Watch<'_>) -> Result<Measured, String> {
        if !watch(0) {
            return Ok(Measured { is_cut: true, ..Measured::default() });
        }
        let values = match self.task {
            Task::Example => example::measure(self, seed),
            Task::HalfPlanes => half_planes::measure(self, seed),
            Task::Path => path::Trip::new(self, seed).map(|trip| trip.measure()),
            Task::Programme => programme::measure(self, seed),
            Task::Ridges => ridges::Room::new(self, seed).map(|room| room.measure()),
        };
        Ok(Measured::of(values?))
    }
}

impl Study for Fvm {
    fn name(&self) -> &'static str {
        "fvm"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [example::MEASURES, half_planes::MEASURES, path::MEASURES, programme::MEASURES, ridges::MEASURES]
            .concat()
            .into_iter()
            .map(|(name, meaning)| (name.to_owned(), meaning))
            .collect()
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let (parameters, seed): (Parameters, _) = (given.parameters()?, given.seed);
        let is_possible = match parameters.task {
            Task::HalfPlanes => !matches!(parameters.source, Source::Distance | Source::RFunction),
            _ => true,
        };
        if !is_possible {
            let what = "a model of one velocity obstacle has no half-planes of other pairs";
            return Err(given.error("source", what, "give \"formula\", \"table\" or \"neighbor\""));
        }
        Ok(Box::new(move |watch| parameters.measure(seed, watch)))
    }

    /// Figures 2 to 6 of the example, a path on its land, or the ridges of a room.
    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let parameters: Parameters = given.parameters()?;
        let wrong = |what: String| given.error("task", what, "change the parameters of the task");
        match parameters.task {
            Task::Example => example::draw(&parameters, stem).map_err(wrong),
            Task::Path => Ok(path::Trip::new(&parameters, given.seed).map_err(wrong)?.draw(title).write(stem)?),
            Task::Ridges => Ok(ridges::Room::new(&parameters, given.seed).map_err(wrong)?.draw(title).write(stem)?),
            Task::HalfPlanes | Task::Programme => Ok(Vec::new()),
        }
    }
}
