//! Why a sweep cannot go on.

use staya_sim::record;
use staya_sim::scenario::ScenarioError;
use std::fmt::Display;

/// What is wrong, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The plan or its scenario.
    #[error(transparent)]
    Plan(#[from] ScenarioError),
    /// A file that cannot be written.
    #[error(transparent)]
    File(#[from] record::Error),
    /// Anything else.
    #[error("{place}: {what}; {remedy}")]
    Other {
        /// A file, often with a line, or an option.
        place: String,
        /// What is wrong.
        what: String,
        /// What to do about it.
        remedy: String,
    },
}

impl SweepError {
    /// That `what` is wrong at `place`.
    pub fn new(place: impl Display, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Other { place: place.to_string(), what: what.into(), remedy: remedy.into() }
    }
}
