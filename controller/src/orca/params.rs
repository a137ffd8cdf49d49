use crate::parameters::{BY_BODY, row};
use crate::scalar::{Scalar, cast};
use serde::{Deserialize, Serialize};

/// The look-ahead of [`AvoidParams::for_body`]: a time, and how many thousandths of its radius the
/// body covers in the rest.
const HORIZON_MS: i32 = 500;
const HORIZON_MILLIRADII: i32 = 1200;

/// Parameters of an [`Avoider`](super::Avoider). Not `non_exhaustive`, so that a change can be
/// written as `AvoidParams { margin_m, ..AvoidParams::default() }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AvoidParams<S> {
    /// Time ahead without collisions with robots, seconds; more than 0, usually 1 to 5. A longer
    /// time makes robots give way earlier and slows crowds. A body with inertia looks ahead for at
    /// least twice its braking time ([`Body::least_horizon_s`](crate::body::Body)).
    pub horizon_s: S,
    /// Time ahead without collisions with static obstacles, seconds. A robot in front of a wall
    /// slows to (distance / this time), so a long time makes it slow in narrow places.
    pub wall_horizon_s: S,
    /// Own share of the correction towards robots that give way; 1/2 if all use the same. Below 1/2
    /// two robots together do not avoid. Towards robots that do not give way it is 1.
    pub share: S,
    /// Error of the known positions, metres; added to the sum of two radii (obstacles: to the own).
    ///
    /// Positions in millimetres on both sides need 0.004. At 0.5 m/s and 20 updates per second,
    /// 0.01 covers one lost update in ten, 0.03 three in ten. Robots come nearer to each other by
    /// what is missing; a value that is much too large closes narrow places.
    pub margin_m: S,
    /// The rule against jams in the plane; in space it is fixed ([`InSpace`](super::InSpace)).
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
    /// The default with a look-ahead that suits bodies of `radius_m`, metres, and `max_speed_mps`,
    /// m/s: 0.5 s and the time for 1.2 of their radii, at most that of the default. Small or quick
    /// robots with the look-ahead of large or slow ones make way for others that are far away.
    ///
    /// The two numbers were chosen in swaps, crowds and 500 scenes with bad radios
    /// (`docs/limits.md`).
    #[must_use]
    pub fn for_body(radius_m: S, max_speed_mps: S) -> Self {
        let radii_m = radius_m * S::from_milli(HORIZON_MILLIRADII);
        let radii_s = radii_m.checked_div(max_speed_mps).unwrap_or(S::TWO);
        let longest_s = Self::default().horizon_s;
        Self { horizon_s: (S::from_milli(HORIZON_MS) + radii_s).min(longest_s), ..Self::default() }
    }

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

crate::parameters! {
    impl[S: Scalar] AvoidParams<S> {
        row("horizon_s", "ORCA_HORIZON_S", "s", [0.01, 60.0], "time ahead without a collision with a robot")
            .depends(BY_BODY) => horizon_s,
        row("wall_horizon_s", "ORCA_WALL_S", "s", [0.01, 60.0], "time ahead without a collision with an obstacle")
            => wall_horizon_s,
        row("share", "ORCA_SHARE", "", [0.0, 1.0], "own share of a correction") => share,
        row("margin_m", "ORCA_MARGIN_M", "m", [0.0, 10.0], "distance kept on top of the radii") => margin_m,
        row("lean_rad", "ORCA_LEAN_RAD", "rad", [0.0, 1.5], "how far to turn right when a robot is in the way")
            => deadlock.lean_rad,
        row("patience_radii", "ORCA_PATIENCE_R", "radii", [0.0, 100.0], "how long to wait for the robots whose turn it is")
            => deadlock.patience_radii,
    }
}

/// Parameters of the rule against symmetry and jams in the plane. They have no units: lengths and
/// times follow from the body, its speed and the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadlockParams<S> {
    /// How far the preferred velocity turns to the right while a robot is in the way, radians; 0
    /// disables it. Use 0.4 to 0.6. A larger angle lengthens paths; with a smaller one, robots on a
    /// circle block each other for longer (below 0.25 forever). Any value is safe.
    pub lean_rad: S,
    /// How long (up to twice as long) a robot leaves an empty gap to others: the time to travel
    /// this many own radii at its highest speed. Use 4 to 16. Less than others need from their
    /// waiting places (two or three radii) skips turns; more wastes time.
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
    /// Time ahead without collisions, seconds (tau); more than 0.
    pub horizon_s: S,
    /// Time within which overlapping robots must separate, seconds; more than 0. Use the control
    /// step; a shorter time demands speeds that no robot has.
    pub separation_s: S,
    /// Own share of the correction: 1/2 if the other robot does the same (ORCA), 1 if it does
    /// nothing (FVM's example). Below 1/2 the two together do not avoid.
    pub share: S,
}
