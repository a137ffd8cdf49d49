//! Motion of the point that an alpha flock follows (gamma-agent; Olfati-Saber 2006, eq. 25).

use crate::geom::Vec3;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// How a reference moves.
///
/// A static one with a velocity hardly pulls back a robot that has passed it if c1_gamma is below
/// c1_alpha, so parts of a flock that obstacles have split stay apart; with c1_gamma above it, as
/// in the paper, they gather. A resting one (not in the paper) gathers them with either.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReferenceMotion<S> {
    /// Stays, and demands its velocity forever (a static gamma-agent).
    Static,
    /// Moves with its velocity (a dynamic gamma-agent).
    Dynamic,
    /// Stays, and demands a velocity that decreases linearly to zero within this distance, metres.
    ///
    /// The flock rests within that distance, and later robots join it. Below the flock's radius,
    /// part of it rests before the reference; at 0 or below, all of it at the reference.
    Resting(S),
}

impl<S: Scalar> ReferenceMotion<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(self) -> ReferenceMotion<T> {
        match self {
            Self::Static => ReferenceMotion::Static,
            Self::Dynamic => ReferenceMotion::Dynamic,
            Self::Resting(within_m) => ReferenceMotion::Resting(cast(within_m)),
        }
    }

    /// The demanded velocity, m/s; `offset_m` and `velocity_mps` are those of the reference.
    #[must_use]
    pub fn wanted(self, offset_m: Vec3<S>, velocity_mps: Vec3<S>) -> Vec3<S> {
        let (Self::Resting(within_m), Some(ahead)) = (self, velocity_mps.normalized()) else {
            return velocity_mps;
        };
        let behind_m = -offset_m.dot(ahead);
        let is_before = behind_m <= S::ZERO;
        if is_before {
            return velocity_mps;
        }
        let left = (within_m - behind_m).max(S::ZERO).checked_div(within_m).unwrap_or(S::ZERO);
        velocity_mps * left
    }
}
