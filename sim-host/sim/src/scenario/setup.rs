//! The controller's setup of each robot of a scenario.

use super::{GuidanceName, PlaneSetup, SafetyName, Scenario};
use staya_controller::agent::{AnyHalfPlanes, GuidanceSetup, RouteSetup, SafetySetup};

impl Scenario {
    /// How robot number `index` goes.
    #[must_use]
    pub fn guidance(&self, index: usize) -> GuidanceSetup {
        let Some(setup) = &self.plane else {
            return match self.formation {
                None => self.route_guidance(None),
                Some(_) => self.formation_guidance(index, None),
            };
        };
        let speed_mps = setup.cruise_mps as f32;
        match setup.guidance {
            GuidanceName::Waypoint => GuidanceSetup::Waypoint { speed_mps, tolerance_m: setup.tolerance_m as f32 },
            GuidanceName::Lattice => GuidanceSetup::Lattice { params: setup.lattice.0, moves: setup.lattice.1 },
            GuidanceName::GoalFlock => {
                GuidanceSetup::GoalFlock { params: setup.goal_flock.0, arrival_m: setup.goal_flock.1, seed: self.seed }
            }
            GuidanceName::Boids => GuidanceSetup::Boids { params: setup.boids, speed_mps },
            GuidanceName::Route => self.route_guidance(Some(speed_mps)),
            GuidanceName::Formation => self.formation_guidance(index, Some(speed_mps)),
        }
    }

    /// What keeps the robots clear.
    #[must_use]
    pub fn safety(&self) -> SafetySetup {
        self.plane.as_ref().map_or(SafetySetup::None, PlaneSetup::safety_setup)
    }

    fn route_setup(&self) -> RouteSetup {
        RouteSetup { params: self.route.params, replan: self.route.replan, sharpness: self.route.sharpness }
    }

    fn route_guidance(&self, speed_mps: Option<f32>) -> GuidanceSetup {
        GuidanceSetup::Route { route: self.route_setup(), speed_mps }
    }

    fn formation_guidance(&self, index: usize, speed_mps: Option<f32>) -> GuidanceSetup {
        let templates = self.formation.as_ref().map(|graph| &graph.templates);
        let template = templates.and_then(|templates| templates.get(index));
        GuidanceSetup::Formation {
            route: self.route_setup(),
            formation: self.formation_params,
            template: template.cloned().unwrap_or_default(),
            speed_mps,
        }
    }
}

impl PlaneSetup {
    fn safety_setup(&self) -> SafetySetup {
        let (orca, inflation) = (self.orca, self.inflation);
        let by = |source| SafetySetup::Orca { params: orca, inflation, source };
        match self.safety {
            SafetyName::None => SafetySetup::None,
            SafetyName::Orca => by(AnyHalfPlanes::Analytic),
            SafetyName::Template2k => by(AnyHalfPlanes::Template2k),
            SafetyName::Template8k => by(AnyHalfPlanes::Template8k),
            SafetyName::Template16k => by(AnyHalfPlanes::Template16k),
            SafetyName::Template64k => by(AnyHalfPlanes::Template64k),
            SafetyName::Fly => SafetySetup::Fly { params: orca, inflation },
            SafetyName::PushOut => SafetySetup::PushOut { params: self.push_out },
        }
    }
}
