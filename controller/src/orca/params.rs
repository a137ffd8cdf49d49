//! What can be chosen: of a whole step ([`AvoidParams`]), and of one constraint ([`Params`]).

use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// Parameters of an [`Avoider`](super::Avoider).
///
/// Not `non_exhaustive`: a change is `AvoidParams { margin_m, ..AvoidParams::default() }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AvoidParams<S> {
    /// Time ahead for which no collision with a robot may happen, seconds; more than 0, usually 1 to 5. Longer gives
    /// way earlier and slows everybody in a crowd. Shorter than the time that the body needs to
    /// stop (speed / acceleration) is not safe.
    pub horizon_s: S,
    /// The same for what does not move, seconds. It may be shorter, since obstacles do nothing unforeseen; a robot
    /// slows to (distance / this time) in front of a wall, hence passes narrow places slowly when it is long.
    pub wall_horizon_s: S,
    /// Own share of the correction towards robots that give way too, 1/2 when all use the same. Below 1/2 both
    /// together do not avoid; above, they give way more than needed. Towards robots that do not give way it is 1.
    pub share: S,
    /// Added to the sum of the radii of two robots, and to the own radius towards obstacles, metres: the error of
    /// what is known of places. Places in millimetres on both sides call for 0.004; at 0.5 m/s and 20 updates a
    /// second 0.01 cover one lost update in ten, and 0.03 three in ten. Robots may come nearer to each other than
    /// they think by what is missing here; much more than needed closes narrow places and slows crowds.
    pub margin_m: S,
    /// The way out of symmetry and jams in the plane; robots that fly have a fixed rule
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
    /// The same in another kind of number.
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

/// Parameters of the way out of symmetry and jams in the plane. They have no units: all lengths and times of the rule
/// follow from the body, its speed and the horizon, so that kilobots and cars do the same at their own scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadlockParams<S> {
    /// How far to the right of the wish to lean while a robot is in the way, radians; 0: never. More makes every way
    /// longer; less leaves robots on a circle in each other's way for longer (below 0.25 for ever). 0.4 to 0.6. No
    /// danger: what robots forbid stays forbidden.
    pub lean_rad: S,
    /// For how long (to twice as long) a robot leaves an empty gap to those whose turn it is: the time in which it
    /// would go so many own radii at its highest speed. Less than others need to come from where they wait (two or
    /// three radii) lets turns be skipped; more costs time when somebody merely stands near a gap. 4 to 16.
    pub patience_radii: S,
}

impl<S: Scalar> Default for DeadlockParams<S> {
    fn default() -> Self {
        Self { lean_rad: S::from_milli(460), patience_radii: S::from_i32(5) }
    }
}

impl<S: Scalar> DeadlockParams<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> DeadlockParams<T> {
        DeadlockParams { lean_rad: cast(self.lean_rad), patience_radii: cast(self.patience_radii) }
    }
}

/// What one neighbour's constraint depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Params<S> {
    /// Time ahead for which no collision may happen, seconds (tau); more than 0. Longer gives way earlier
    /// and slows everybody in a crowd.
    pub horizon_s: S,
    /// Time in which robots that overlap must be apart, seconds; more than 0. The step of control: shorter
    /// demands speeds that nobody has.
    pub separation_s: S,
    /// Own share of the correction: 1/2 when the other one does the same (ORCA), 1 when it does
    /// nothing (FVM's example). Below 1/2 both together do not avoid.
    pub share: S,
}
