//! Parameters of a whole step ([`AvoidParams`]) and of one constraint ([`Params`]).

use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// Parameters of an [`Avoider`](super::Avoider).
///
/// Not `non_exhaustive`, so that a change can be written as `AvoidParams { margin_m,
/// ..AvoidParams::default() }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AvoidParams<S> {
    /// Time ahead for which collisions with robots are excluded, seconds; more than 0, usually 1 to
    /// 5. With a longer time robots give way earlier and a crowd becomes slower. A time shorter
    /// than the body needs to stop (speed / acceleration) is not safe.
    pub horizon_s: S,
    /// Time ahead for which collisions with static obstacles are excluded, seconds. It may be
    /// shorter than that for robots, since obstacles do nothing unexpected. In front of a wall a
    /// robot slows to (distance / this time), so a long time makes it slow in narrow places.
    pub wall_horizon_s: S,
    /// Own share of the correction towards robots that give way too; 1/2 if all use the same. Below
    /// 1/2 the two together do not avoid; above, they give way more than needed. Towards robots
    /// that do not give way it is 1.
    pub share: S,
    /// Error of the known positions, metres; added to the sum of the radii of two robots, and to
    /// the own radius towards obstacles. Positions in millimetres on both sides need 0.004. At 0.5
    /// m/s and 20 updates per second, 0.01 covers one lost update in ten, and 0.03 three in ten. If
    /// it is too small, robots come nearer to each other by the difference; if it is much too
    /// large, it closes narrow places and slows crowds.
    pub margin_m: S,
    /// The rule against symmetry and jams in the plane. Flying robots have a fixed rule
    /// ([`InSpace`](super::InSpace)).
    pub deadlock: DeadlockParams<S>,
}

impl<S: Scalar> Default for AvoidParams<S> {
    fn default() -> Self {
        Self {
            horizon_s: S::TWO,
            wall_horizon_s: S::ONE,
            share: S::HALF,
            margin_m: S::from_milli(4),
            deadlock: DeadlockParams::default(),
        }
    }
}

impl<S: Scalar> AvoidParams<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> AvoidParams<T> {
        AvoidParams {
            horizon_s: cast(self.horizon_s),
            wall_horizon_s: cast(self.wall_horizon_s),
            share: cast(self.share),
            margin_m: cast(self.margin_m),
            deadlock: self.deadlock.cast(),
        }
    }
}

/// Parameters of the rule against symmetry and jams in the plane.
///
/// They have no units: all lengths and times of the rule follow from the body, its speed and the
/// horizon, so that kilobots and cars behave alike at their own scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadlockParams<S> {
    /// How far the preferred velocity turns to the right while a robot is in the way, radians; 0
    /// disables it. A larger angle makes every path longer; with a smaller one, robots on a circle
    /// block each other for longer (below 0.25 forever). Use 0.4 to 0.6. Any value is safe, since
    /// the constraints of robots are unchanged.
    pub lean_rad: S,
    /// How long (up to twice as long) a robot leaves an empty gap to robots whose turn it is: the
    /// time in which it would travel this many own radii at its highest speed. If the value is less
    /// than other robots need from their waiting places (two or three radii), turns are skipped; a
    /// larger value costs time when a robot merely stands near a gap. Use 4 to 16.
    pub patience_radii: S,
}

impl<S: Scalar> Default for DeadlockParams<S> {
    fn default() -> Self {
        Self { lean_rad: S::from_milli(460), patience_radii: S::from_i32(5) }
    }
}

impl<S: Scalar> DeadlockParams<S> {
    /// Converts to another scalar type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> DeadlockParams<T> {
        DeadlockParams { lean_rad: cast(self.lean_rad), patience_radii: cast(self.patience_radii) }
    }
}

/// Parameters of the constraint of one neighbour.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Params<S> {
    /// Time ahead for which collisions are excluded, seconds (tau); more than 0. With a longer time
    /// robots give way earlier and a crowd becomes slower.
    pub horizon_s: S,
    /// Time within which overlapping robots must separate, seconds; more than 0. Use the control
    /// step; a shorter time demands speeds that no robot has.
    pub separation_s: S,
    /// Own share of the correction: 1/2 if the other robot does the same (ORCA), 1 if it does
    /// nothing (FVM's example). Below 1/2 the two together do not avoid.
    pub share: S,
}
