//! The motion of the point that an alpha flock follows (the gamma-agent; Olfati-Saber 2006, eq.
//! 25).

use crate::geom::Vec3;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// How a reference moves.
///
/// The paper's obstacle courses have a static one with a velocity. It hardly pulls back a robot
/// that has passed it, so the parts of a flock that obstacles have split move side by side and
/// behind each other at one speed forever. A resting reference gathers them in one place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReferenceMotion<S> {
    /// It stays, and its velocity is demanded forever (a static gamma-agent).
    Static,
    /// It moves with its velocity (a dynamic gamma-agent).
    Dynamic,
    /// Not in the paper: it stays, and the velocity that it demands decreases linearly to zero over
    /// this distance behind it, metres. So the flock comes to rest within that distance, and later
    /// robots join it there. With a longer distance it rests farther behind the reference and
    /// later. With one shorter than the flock's own radius, part of it rests before the reference.
    /// A distance that is not above 0 rests at the reference.
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

    /// The velocity that a robot should have, m/s, given its vector to the reference, metres, and
    /// the reference's velocity. Constant work.
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
        // Zero also if the quotient is undefined.
        let left = (within_m - behind_m).max(S::ZERO).checked_div(within_m).unwrap_or(S::ZERO);
        velocity_mps * left
    }
}
