//! Half-planes of ORCA by the formula or from the table, chosen at run time.

use crate::geom::Vec2;
use crate::orca::{self, HalfPlane, HalfSpaces, MovingBall};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Any source of half-planes: the formula, or the voxel table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnyHalfPlanes {
    #[default]
    Analytic,
    #[cfg(feature = "list_table")]
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
            #[cfg(feature = "list_table")]
            Self::Template2k => orca::VoxelTable2k.half_space(own, disc, params),
        }
    }
}
