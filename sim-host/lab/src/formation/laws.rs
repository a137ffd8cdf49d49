//! Other laws on the same landscapes.

use super::Plan;
use anyhow::Result;
use clap::ValueEnum;
use serde::Serialize;
use staya_controller::cost::Gain;
use staya_controller::formation::{FormationParams, NEVER};
use staya_controller::grid::UNIT;
use staya_controller::land::MapParams;
use staya_controller::shuffle::Sharpness;
use staya_papers::criteria::PublishedParams;
use staya_sim::scenario::Scenario;

/// A law by which robots keep their formation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// Staya's law as planned
    Staya,
    /// Staya's law; followers plan to the future places of their cells
    Lookahead,
    /// Like lookahead; the leader waits from a lag of 12 cells
    Loose,
    /// Staya's law, with maps shared over the radio
    Shared,
    /// Staya's law; no robot waits for others
    Unwaiting,
    /// The paper's law: each robot weighs its own route against all neighbours that it finds
    Paper,
}

impl Law {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Staya => "staya",
            Self::Lookahead => "lookahead",
            Self::Loose => "loose",
            Self::Shared => "shared",
            Self::Unwaiting => "unwaiting",
            Self::Paper => "paper",
        }
    }
}

/// Half as likely for each half tick of additional cost.
const SHUFFLE: Sharpness = Sharpness::HalvedPer(Gain::from_sixteenths(8));

/// Makes the formation about as loose as the paper's; tuned on seed 1.
const LOOSE: u16 = 12 * UNIT as u16;

impl Law {
    pub(super) const ALL: [Self; 6] =
        [Self::Staya, Self::Lookahead, Self::Loose, Self::Shared, Self::Unwaiting, Self::Paper];

    pub(super) const fn eps(self, plan: &Plan) -> u8 {
        match self {
            Self::Paper => plan.published.params.eps,
            _ => plan.formation.eps,
        }
    }

    pub(super) fn params(self, plan: &Plan) -> FormationParams {
        let ahead = FormationParams { eps: plan.formation.eps, ..FormationParams::looking_ahead() };
        match self {
            Self::Staya | Self::Shared | Self::Paper => plan.formation,
            Self::Lookahead => ahead,
            Self::Loose => FormationParams { halt_lag: LOOSE, resume_lag: LOOSE, ..ahead },
            Self::Unwaiting => FormationParams { halt_lag: NEVER, resume_lag: NEVER, ..plan.formation },
        }
    }

    pub(super) fn on(self, plan: &Plan, together: &Scenario, loss: f64) -> Result<Scenario> {
        let mut scenario = together.clone();
        scenario.formation_params = self.params(plan);
        scenario.radio.loss = loss;
        match self {
            Self::Staya | Self::Unwaiting => {}
            Self::Lookahead | Self::Loose => scenario.looks_ahead = true,
            Self::Shared => scenario.maps = Some(MapParams::default()),
            Self::Paper => {
                let published = plan.published;
                scenario.published = Some(published.params);
                scenario.formations = vec![plan.graph_within(published.rho)?];
                scenario.route.sharpness = SHUFFLE;
            }
        }
        Ok(scenario)
    }
}

/// The paper's law, as tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Published {
    /// Parameters of the law.
    pub params: PublishedParams,
    /// Geodesic radius of its templates, 1 to 3; 1 gives the leaders of figure 5.
    pub rho: u8,
}

impl Default for Published {
    fn default() -> Self {
        Self { params: PublishedParams::default(), rho: 1 }
    }
}
