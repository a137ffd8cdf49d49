//! Studies: what a plan with `study = "NAME"` does instead of runs of its scenario. Their
//! parameters are the fields `study.*`.

pub mod boids;
pub mod flock;
pub mod fvm;
pub mod minima;
pub mod movingai;
pub mod remembered;
mod rings;
pub mod route;
pub mod tune;
mod walk;

use crate::error::SweepError;
use crate::measure::Job;
use staya_sim::scenario::{Overrides, Read, Scenario, ScenarioError, Source};
use std::fmt::Debug;
use std::path::{Path, PathBuf};

const LIST: &str = "docs/sweeps.md";

/// A kind of run.
pub trait Study: Debug + Sync {
    /// Name in plans.
    fn name(&self) -> &'static str;

    /// Names of the measures, with their meanings.
    fn measures(&self) -> Vec<(String, &'static str)>;

    /// Whether a run needs the machine for itself because it is timed.
    fn is_timed(&self) -> bool {
        false
    }

    /// Reads and checks the fields of a run.
    ///
    /// # Errors
    /// Names the field that is wrong, or a file that cannot be read.
    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError>;

    /// Whether the fields besides `study.*` are those of a scenario.
    fn takes_scenario(&self) -> bool {
        false
    }

    /// Draws a run into files that begin with `stem`, and returns them. By default there are none.
    ///
    /// # Errors
    /// As for [`Study::read`], or a file cannot be written.
    fn draw(&self, given: &Given<'_>, title: &str, stem: &Path) -> Result<Vec<PathBuf>, SweepError> {
        let _ = (given, title, stem);
        Ok(Vec::new())
    }
}

/// All studies.
pub const ALL: [&dyn Study; 10] = [
    &boids::Boids,
    &boids::dimensions::Dimensions,
    &boids::listing::Listing,
    &flock::Flock,
    &fvm::Fvm,
    &minima::Minima,
    &movingai::MovingAi,
    &remembered::RememberedLand,
    &route::Route,
    &tune::Tune,
];

/// Fields of a run.
#[derive(Clone, Debug)]
pub struct Given<'a> {
    /// Fields of the scenario and, in `study`, of the study.
    pub source: Source<'a>,
    /// Measures of the plan; empty while it is read.
    pub measures: &'a [String],
    /// Seed of the run.
    pub seed: u64,
}

impl Given<'_> {
    /// The parameters of the study.
    ///
    /// # Errors
    /// A field is unknown, missing, or of another type.
    pub fn parameters<T: Read>(&self) -> Result<T, ScenarioError> {
        self.source.read_table("study", LIST)
    }

    /// The scenario.
    ///
    /// # Errors
    /// The scenario is wrong.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::read(self.source.clone(), &Overrides { seed: Some(self.seed), ticks: None })
    }

    /// An error about a parameter of the study.
    pub fn error(&self, field: &str, what: impl Into<String>, remedy: impl Into<String>) -> SweepError {
        self.source.error(&format!("study.{field}"), what, remedy).into()
    }
}
