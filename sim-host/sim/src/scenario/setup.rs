//! The controller's setup of each robot of a scenario.

use super::Scenario;
use staya_controller::agent::{GuidanceSetup, SafetySetup};

impl Scenario {
    /// How robot number `index` goes.
    #[must_use]
    pub fn guidance(&self, index: usize) -> GuidanceSetup {
        let mut guidance = match (&self.plane, &self.formation) {
            (Some(plane), _) => plane.group(index).guidance.clone(),
            (None, None) => GuidanceSetup::Route { route: self.route, speed_mps: None },
            (None, Some(_)) => GuidanceSetup::Formation {
                route: self.route,
                formation: self.formation_params,
                template: Default::default(),
                speed_mps: None,
            },
        };
        if let GuidanceSetup::Formation { template, .. } = &mut guidance {
            let own = self.formation.as_ref().and_then(|graph| graph.templates.get(index));
            *template = own.cloned().unwrap_or_default();
        }
        guidance
    }

    /// What keeps robot number `index` clear.
    #[must_use]
    pub fn safety(&self, index: usize) -> SafetySetup {
        self.plane.as_ref().map_or(SafetySetup::None, |plane| plane.group(index).safety)
    }
}
