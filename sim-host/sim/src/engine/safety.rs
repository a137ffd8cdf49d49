//! The safety layers of robots in a scenario: those of the controller, and ORCA on a model.

use crate::voxel::{ModelInSpace, NeighborModel};
use serde::{Deserialize, Serialize};
use staya_controller::agent::{AnySafety, HALF_PLANES, LayerSettings, OrcaSafety, OrcaSettings, Safety, SafetyInput};
use staya_controller::geom::Vec3;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::InSpace;
use staya_controller::parameters::Parameters;
use staya_controller::rand::Rng;

/// A safety layer of a robot in a scenario. Those on models are rare, so they are on the heap.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum ScenarioSafety {
    BuiltIn(AnySafety<f32, HALF_PLANES>),
    Voxel(Box<OrcaSafety<f32, HALF_PLANES, NeighborModel>>),
    VoxelInSpace(Box<OrcaSafety<f32, HALF_PLANES, ModelInSpace>>),
}

impl ScenarioSafety {
    /// Creates the layer with these settings, and the model that replaces its formula. Layers other
    /// than ORCA do not use it.
    #[must_use]
    pub fn new(settings: &LayerSettings, model: Option<&NeighborModel>) -> Self {
        match (model, settings.orca()) {
            (Some(model), Some(OrcaSettings { params, inflation })) => {
                let model = model.clone();
                match settings {
                    LayerSettings::Fly(fly) => {
                        let source = ModelInSpace { model, space: InSpace { downwash: fly.downwash } };
                        Self::VoxelInSpace(Box::new(OrcaSafety::with_source(*params, *inflation, source)))
                    }
                    _ => Self::Voxel(Box::new(OrcaSafety::with_source(*params, *inflation, model))),
                }
            }
            _ => Self::BuiltIn(settings.layer()),
        }
    }

    fn inside(&self) -> &dyn Safety<f32> {
        match self {
            Self::BuiltIn(layer) => layer,
            Self::Voxel(layer) => &**layer,
            Self::VoxelInSpace(layer) => &**layer,
        }
    }

    fn inside_mut(&mut self) -> &mut dyn Safety<f32> {
        match self {
            Self::BuiltIn(layer) => layer,
            Self::Voxel(layer) => &mut **layer,
            Self::VoxelInSpace(layer) => &mut **layer,
        }
    }
}

impl Safety<f32> for ScenarioSafety {
    fn keep_clear(&mut self, input: &SafetyInput<'_, f32>, rng: &mut Rng) -> Vec3<f32> {
        self.inside_mut().keep_clear(input, rng)
    }

    fn inflation(&self) -> Option<StalenessInflation<f32>> {
        self.inside().inflation()
    }

    fn downwash(&self) -> f32 {
        self.inside().downwash()
    }

    fn waits_for_turn(&self) -> bool {
        self.inside().waits_for_turn()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.inside_mut().parameters(visit);
    }
}
