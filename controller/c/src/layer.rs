//! The safety layers in this build, as one type. A digest contains only the layer inside.

use crate::one_of::one_of;
use crate::{HALF_PLANES, Number};
use serde::{Serialize, Serializer};
#[cfg(feature = "space")]
use staya_controller::agent::FlySafety;
#[cfg(feature = "push-out")]
use staya_controller::agent::PushOutSafety;
use staya_controller::agent::{OrcaSafety, Safety, SafetyInput, Unguarded};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::neighbor::StalenessInflation;
#[cfg(feature = "table")]
use staya_controller::orca::VoxelTable2k;
use staya_controller::orca::{HalfPlane, HalfSpaces, MovingBall, Params, half_plane};
use staya_controller::parameters::Parameters;
use staya_controller::rand::Rng;

/// The source of half-planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The formula.
    Formula,
    /// The table of 2 KiB.
    #[cfg(feature = "table")]
    Table,
}

impl Serialize for Source {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_unit_struct("Source")
    }
}

impl HalfSpaces<Number> for Source {
    type Velocity = Vec2<Number>;

    fn half_space(
        &self,
        own_velocity_mps: Vec2<Number>,
        disc: &MovingBall<Vec2<Number>>,
        params: &Params<Number>,
    ) -> Option<HalfPlane<Number>> {
        match self {
            Self::Formula => half_plane(own_velocity_mps, disc, params),
            #[cfg(feature = "table")]
            Self::Table => VoxelTable2k.half_space(own_velocity_mps, disc, params),
        }
    }
}

one_of! { $ each:
    /// A safety layer.
    #[expect(missing_docs, reason = "StayaSafety says what each is")]
    Layer {
        None(Unguarded),
        Orca(OrcaSafety<Number, HALF_PLANES, Source>),
        #[cfg(feature = "space")]
        Fly(FlySafety<Number, HALF_PLANES>),
        #[cfg(feature = "push-out")]
        PushOut(PushOutSafety<Number>),
    }
}

impl Safety<Number> for Layer {
    fn keep_clear(&mut self, input: &SafetyInput<'_, Number>, rng: &mut Rng) -> Vec3<Number> {
        each!(self, layer => layer.keep_clear(input, rng))
    }

    fn inflation(&self) -> Option<StalenessInflation<Number>> {
        each!(self, layer => Safety::<Number>::inflation(layer))
    }

    fn downwash(&self) -> Number {
        each!(self, layer => Safety::<Number>::downwash(layer))
    }

    fn waits_for_turn(&self) -> bool {
        each!(self, layer => Safety::<Number>::waits_for_turn(layer))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        each!(self, layer => Safety::<Number>::parameters(layer, visit));
    }
}
