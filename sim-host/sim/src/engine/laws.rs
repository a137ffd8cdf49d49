//! The laws of robots in a scenario: Staya's, those of papers, and one of the caller.

use crate::own_law::Own;
use crate::scenario::Scenario;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    AnyLaw, FormationGuidance, GridWorkspace, GuidanceSetup, LEARNED, MAP_TILES, SharedMap, TEMPLATE, VISITS,
};
use staya_controller::laws;
use staya_papers::criteria::PublishedParams;
use staya_papers::{Course, PublishedFormation};

/// Cells of a search for windows up to radius 16 with their border: (2 * 16 + 3)^2.
pub const WIDE: usize = 1225;

type Map = Option<Box<SharedMap<MAP_TILES>>>;

laws! {
    /// A law of a robot in a scenario.
    #[derive(Clone, Debug, Serialize, Deserialize)]
    #[expect(missing_docs, reason = "each variant's type says it")]
    pub enum ScenarioLaw[] of f32, in GridWorkspace<WIDE>, [] for [] {
        BuiltIn(AnyLaw<f32, WIDE, VISITS, TEMPLATE, LEARNED, Map>),
        Published(Box<PublishedFormation<WIDE, VISITS, TEMPLATE>>, large),
        LooksAhead(Box<FormationGuidance<WIDE, VISITS, TEMPLATE, LEARNED, Course, Map>>, large),
        Own(Own),
    }
}

/// Which law of a paper replaces Staya's formation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Papers {
    published: Option<PublishedParams>,
    looks_ahead: bool,
}

impl Papers {
    pub(super) const fn of(scenario: &Scenario) -> Self {
        Self { published: scenario.published, looks_ahead: scenario.looks_ahead }
    }

    pub(super) fn law(&self, setup: &GuidanceSetup, map: Map) -> ScenarioLaw {
        match (setup, self.published) {
            (GuidanceSetup::Formation { route, template, .. }, Some(params)) => {
                let law = PublishedFormation::new(route.params, params, template.clone());
                ScenarioLaw::Published(Box::new(law.sharpness(route.sharpness)))
            }
            (GuidanceSetup::Formation { route, formation, template, .. }, None) if self.looks_ahead => {
                let law = FormationGuidance::steered(route.params, *formation, template.clone(), Course::new(), map);
                ScenarioLaw::LooksAhead(Box::new(law.sharpness(route.sharpness)))
            }
            _ => ScenarioLaw::BuiltIn(setup.law(map)),
        }
    }
}
