//! Robots with Staya's laws, or with a law of the caller.

use crate::firmware::Program;
use anyhow::Result;
use staya_controller::scalar::NumberFormat;
use staya_link::robot::Controller;
use staya_runner::Shadow;
use staya_sim::engine::{ExternalController, Outcome, Watch};
use staya_sim::scenario::Scenario;

pub(crate) type MakeRobot = Box<dyn Fn() -> Box<dyn Controller + Send>>;

pub(crate) trait Swarm {
    fn program(&self) -> Program;

    /// `None` for those of Staya's laws.
    fn shadows(&self) -> Option<Vec<Shadow>>;

    /// Creates robots of this process that compute in `numbers`.
    fn robot_in(&self, numbers: NumberFormat) -> Result<MakeRobot>;

    /// Encoded law of each robot; empty if its name is enough.
    fn law(&self) -> Box<dyn Fn(usize) -> Vec<u8> + Send>;

    fn simulate(
        &self,
        scenario: &Scenario,
        external: Option<Box<dyn ExternalController>>,
        watch: &mut Watch<'_>,
    ) -> Result<Outcome>;
}
