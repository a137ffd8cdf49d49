//! What becomes of the place that an alpha flock follows (the gamma-agent; Olfati-Saber 2006, eq. 25).

use crate::geom::Vec3;
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// How a reference goes on.
///
/// The paper's obstacle courses have a static one with a velocity. Who passes it is hardly drawn back: the parts of a flock that
/// obstacles have split go on side by side and behind each other at one speed for ever. Resting, they come to one place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReferenceMotion<S> {
    /// It stays, and its velocity is wanted for ever all the same (a static gamma-agent).
    Static,
    /// It goes where its velocity takes it (a dynamic gamma-agent).
    Dynamic,
    /// Not in the paper: it stays, and the velocity that is wanted falls evenly to nothing over this way behind it, metres. So the
    /// flock comes to rest within that way, and whoever comes later joins it there. Longer: farther behind the
    /// reference and later. Shorter than the flock's own radius: part of it rests before the reference. What is not
    /// above 0 rests at the reference.
    Resting(S),
}

impl<S: Scalar> ReferenceMotion<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(self) -> ReferenceMotion<T> {
        match self {
            Self::Static => ReferenceMotion::Static,
            Self::Dynamic => ReferenceMotion::Dynamic,
            Self::Resting(within_m) => ReferenceMotion::Resting(cast(within_m)),
        }
    }

    /// The velocity that a robot should have, m/s, given its way to the reference, metres, and the reference's velocity.
    /// Constant work.
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
        // Zero also for what has no quotient.
        let left = (within_m - behind_m).max(S::ZERO).checked_div(within_m).unwrap_or(S::ZERO);
        velocity_mps * left
    }
}
