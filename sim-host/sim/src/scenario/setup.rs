//! The controller's setup of each robot of a scenario.

use super::Scenario;
use staya_controller::agent::{GuidanceSetup, SafetySetup};

impl Scenario {
    /// How robot number `index` goes.
    #[must_use]
    pub fn guidance(&self, index: usize) -> GuidanceSetup {
        let mut guidance = match (&self.plane, &self.formation, self.published) {
            (Some(plane), ..) => plane.group(index).guidance.clone(),
            (None, None, _) => GuidanceSetup::Route { route: self.route, speed_mps: None },
            (None, Some(_), Some(formation)) => {
                GuidanceSetup::Published { route: self.route, formation, template: Default::default() }
            }
            (None, Some(_), None) => GuidanceSetup::Formation {
                route: self.route,
                formation: self.formation_params,
                template: Default::default(),
                speed_mps: None,
            },
        };
        if let GuidanceSetup::Formation { template, .. } | GuidanceSetup::Published { template, .. } = &mut guidance {
            let own = self.formation.as_ref().and_then(|graph| graph.templates.get(index));
            *template = own.cloned().unwrap_or_default();
        }
        guidance
    }

    /// How far from its place a member of the formation counts as found, cells.
    pub(crate) fn eps(&self) -> u8 {
        self.published.map_or(self.formation_params.eps, |published| published.eps)
    }

    /// What keeps robot number `index` clear.
    #[must_use]
    pub fn safety(&self, index: usize) -> SafetySetup {
        self.plane.as_ref().map_or(SafetySetup::None, |plane| plane.group(index).safety)
    }
}
