//! The laws of robots in a scenario: Staya's, those of papers, and one of the caller.

use crate::own_law::Own;
use crate::scenario::Scenario;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    AnyLaw, AnyMessage, AnyOrder, AnyPayload, AnyProtocol, AnySurroundings, BadInput, Decision, FormationGuidance,
    GridWorkspace, GuidanceSetup, LEARNED, Law, MAP_TILES, Radio, Report, SharedMap, TEMPLATE, Tools, VISITS, View,
    decide_as, order_as, payload_as, receive_as,
};
use staya_controller::grid::Dir;
use staya_controller::parameters::Parameters;
use staya_controller::robot::RobotId;
use staya_papers::criteria::PublishedParams;
use staya_papers::{Course, PublishedFormation};

/// Cells of a search for windows up to radius 16 with their border: (2 * 16 + 3)^2.
pub const WIDE: usize = 1225;

type Map = Option<Box<SharedMap<MAP_TILES>>>;

/// A law of a robot in a scenario.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "nearly all robots have a built-in law")]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum ScenarioLaw {
    BuiltIn(AnyLaw<f32, WIDE, VISITS, TEMPLATE, LEARNED, Map>),
    Published(Box<PublishedFormation<WIDE, VISITS, TEMPLATE>>),
    LooksAhead(Box<FormationGuidance<WIDE, VISITS, TEMPLATE, LEARNED, Course, Map>>),
    Own(Own),
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

macro_rules! each {
    ($any:expr, $law:ident => $action:expr) => {
        match $any {
            ScenarioLaw::BuiltIn($law) => $action,
            ScenarioLaw::Published(law) => {
                let $law = &mut **law;
                $action
            }
            ScenarioLaw::LooksAhead(law) => {
                let $law = &mut **law;
                $action
            }
            ScenarioLaw::Own($law) => $action,
        }
    };
    (ref $any:expr, $law:ident => $action:expr) => {
        match $any {
            ScenarioLaw::BuiltIn($law) => $action,
            ScenarioLaw::Published(law) => {
                let $law = &**law;
                $action
            }
            ScenarioLaw::LooksAhead(law) => {
                let $law = &**law;
                $action
            }
            ScenarioLaw::Own($law) => $action,
        }
    };
}

impl Law<f32> for ScenarioLaw {
    type Surroundings<'a> = AnySurroundings<'a, f32>;
    type Protocol = AnyProtocol;
    type Workspace = GridWorkspace<WIDE>;

    fn decide(
        &mut self,
        view: &View<'_, f32, AnyProtocol>,
        here: &AnySurroundings<'_, f32>,
        tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let Tools { rng, mut radio, workspace } = tools;
        let sends = (rng, &mut radio);
        match self {
            Self::BuiltIn(law) => decide_as(law, view, here, sends, workspace),
            Self::Published(law) => decide_as(&mut **law, view, here, sends, workspace),
            Self::LooksAhead(law) => decide_as(&mut **law, view, here, sends, workspace),
            Self::Own(law) => decide_as(law, view, here, sends, &mut ()),
        }
    }

    fn payload(
        &mut self,
        here: &AnySurroundings<'_, f32>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload {
        each!(self, law => payload_as(law, here, heading, radio))
    }

    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool {
        each!(self, law => receive_as::<f32, _, _>(law, from, message, radio))
    }

    fn order(&mut self, order: &AnyOrder) -> bool {
        each!(self, law => order_as::<f32, _, _>(law, order))
    }

    fn needs(&self, id: RobotId) -> bool {
        each!(ref self, law => Law::<f32>::needs(law, id))
    }

    fn report(&self) -> Report {
        each!(ref self, law => Law::<f32>::report(law))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        each!(self, law => Law::<f32>::parameters(law, visit));
    }
}
