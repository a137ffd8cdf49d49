//! Safety layer chosen at run time, for simulators and configurable firmware.

use super::orca::{FlySafety, OrcaSafety};
use super::push_out::PushOutSafety;
use super::{Safety, SafetyInput, Unguarded};
use crate::geom::{Vec2, Vec3};
use crate::neighbor::StalenessInflation;
use crate::orca::{self, HalfPlane, HalfSpaces, MovingBall};
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Any source of half-planes: the formula, or the voxel table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyHalfPlanes {
    #[default]
    Analytic,
    Template2k,
}

impl<S: Scalar> HalfSpaces<S> for AnyHalfPlanes {
    type Velocity = Vec2<S>;

    fn half_space(
        &self,
        own_velocity_mps: Vec2<S>,
        disc: &MovingBall<Vec2<S>>,
        params: &orca::Params<S>,
    ) -> Option<HalfPlane<S>> {
        let own = own_velocity_mps;
        match self {
            Self::Analytic => orca::half_plane(own, disc, params),
            Self::Template2k => orca::VoxelTable2k.half_space(own, disc, params),
        }
    }
}

/// Any safety layer, with at most `K` half-planes.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(deserialize = ""))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnySafety<S: Scalar, const K: usize> {
    Unguarded(Unguarded),
    Orca(OrcaSafety<S, K, AnyHalfPlanes>),
    Fly(FlySafety<S, K>),
    PushOut(PushOutSafety<S>),
}

impl<S: Scalar, const K: usize> Safety<S> for AnySafety<S, K> {
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, rng: &mut Rng) -> Vec3<S> {
        match self {
            Self::Unguarded(safety) => safety.keep_clear(input, rng),
            Self::Orca(safety) => safety.keep_clear(input, rng),
            Self::Fly(safety) => safety.keep_clear(input, rng),
            Self::PushOut(safety) => safety.keep_clear(input, rng),
        }
    }

    fn inflation(&self) -> Option<StalenessInflation<S>> {
        match self {
            Self::Orca(safety) => safety.inflation(),
            Self::Fly(safety) => safety.inflation(),
            Self::Unguarded(_) | Self::PushOut(_) => None,
        }
    }

    fn downwash(&self) -> S {
        match self {
            Self::Fly(safety) => safety.downwash(),
            Self::Unguarded(_) | Self::Orca(_) | Self::PushOut(_) => S::ONE,
        }
    }

    fn waits_for_turn(&self) -> bool {
        match self {
            Self::Orca(safety) => safety.waits_for_turn(),
            Self::Unguarded(_) | Self::Fly(_) | Self::PushOut(_) => false,
        }
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        match self {
            Self::Unguarded(_) => {}
            Self::Orca(safety) => safety.parameters(visit),
            Self::Fly(safety) => safety.parameters(visit),
            Self::PushOut(safety) => safety.parameters(visit),
        }
    }
}
