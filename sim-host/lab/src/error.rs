//! Errors of sweeps.

use staya_sim::record;
use staya_sim::scenario::ScenarioError;
use staya_sim::shown::one_line;
use staya_sim::terrain::TerrainError;
use std::fmt::Display;

/// An error with its place, cause and remedy.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The plan or its scenario is wrong.
    #[error(transparent)]
    Plan(#[from] ScenarioError),
    /// A terrain file cannot be read.
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] record::Error),
    /// Any other error.
    #[error("{}: {}; {}", one_line(.place), one_line(.what), one_line(.remedy))]
    Other {
        /// A file, often with a line, or an option.
        place: String,
        /// The cause.
        what: String,
        /// The remedy.
        remedy: String,
    },
}

impl SweepError {
    /// Creates an error.
    pub fn new(place: impl Display, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Other { place: place.to_string(), what: what.into(), remedy: remedy.into() }
    }
}
