//! Other laws on the same landscapes: the paper's own, and ours without its waiting.

use super::Plan;
use anyhow::Result;
use clap::ValueEnum;
use serde::Serialize;
use staya_controller::cost::Gain;
use staya_controller::formation::NEVER;
use staya_controller::formation::published::PublishedParams;
use staya_controller::shuffle::Sharpness;
use staya_sim::scenario::Scenario;

/// A law by which the six keep their formation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// Staya's as planned
    Staya,
    /// Staya's, but nobody waits for those behind
    Unwaiting,
    /// The paper's: each robot weighs its own way against all neighbours that it finds
    Paper,
}

impl Law {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Staya => "staya",
            Self::Unwaiting => "unwaiting",
            Self::Paper => "paper",
        }
    }
}

/// How strictly the paper's shuffle follows the weights: half as likely for each half tick that a move costs more.
const SHUFFLE: Sharpness = Sharpness::HalvedPer(Gain::from_sixteenths(8));

impl Law {
    /// How far from its place a neighbour counts as found, cells.
    pub(super) const fn eps(self, plan: &Plan) -> u8 {
        match self {
            Self::Staya | Self::Unwaiting => plan.formation.eps,
            Self::Paper => plan.published.params.eps,
        }
    }

    /// `together`, as planned, under this law.
    ///
    /// # Errors
    /// A radius rho without a template.
    pub(super) fn on(self, plan: &Plan, together: &Scenario, loss: f64) -> Result<Scenario> {
        let mut scenario = together.clone();
        scenario.formation_params = plan.formation;
        scenario.radio.loss = loss;
        match self {
            Self::Staya => {}
            Self::Unwaiting => {
                (scenario.formation_params.halt_lag, scenario.formation_params.resume_lag) = (NEVER, NEVER);
            }
            Self::Paper => {
                let published = plan.published;
                scenario.published = Some(published.params);
                scenario.formation = Some(plan.graph_within(published.rho)?);
                scenario.route.sharpness = SHUFFLE;
            }
        }
        Ok(scenario)
    }
}

/// The paper's law as it is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Published {
    /// Its parameters.
    pub params: PublishedParams,
    /// Geodesic radius of its templates, 1 to 3: 1 gives the leaders of figure 5.
    pub rho: u8,
}

impl Default for Published {
    fn default() -> Self {
        Self { params: PublishedParams::default(), rho: 1 }
    }
}
