//! The last layer before the body: from the velocity that the guidance law wishes to one that is safe.

use super::Parameter;
use crate::body::Body;
use crate::geom::Vec3;
use crate::neighbor::{Nearby, StalenessInflation};
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// What a safety layer may know.
#[derive(Clone, Copy, Debug)]
pub struct SafetyInput<'a, S> {
    /// Own body.
    pub body: Body<S>,
    /// The velocity that the guidance law wishes, m/s: finite, and zero when the robot should stand.
    pub wish_mps: Vec3<S>,
    /// The next place on its way that it goes to straight, relative to its own place, metres; `None` when it only
    /// roams, flocks or should stand.
    pub way_m: Option<Vec3<S>>,
    /// Who is near by, nearest first.
    pub nearby: &'a [Nearby<S>],
    /// What it sees that does not move.
    pub obstacles: &'a [Obstacle<S>],
}

/// Keeps the robot clear of others and of obstacles. It also runs while the robot stands, because others count on
/// its giving way.
pub trait Safety<S: Scalar> {
    /// A safe velocity near the wished one, m/s. The agent sees to it that the body can have it ([`Body::reach`]).
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, rng: &mut Rng) -> Vec3<S>;

    /// How neighbours that have fallen silent are to be seen; `None` when the layer leaves them to others, and the agent
    /// neither limits its velocities to the [`Room`](crate::neighbor::Room) that there is nor stands when it hears nobody.
    fn inflation(&self) -> Option<StalenessInflation<S>> {
        None
    }

    /// Whether it makes the robot wait for others who go first through a door, since the last step.
    fn waits_for_turn(&self) -> bool {
        false
    }

    /// What a parameter is now; `None` when it has no such one.
    fn parameter(&self, _parameter: Parameter) -> Option<S> {
        None
    }

    /// Changes a parameter; whether it has such one. `value` is within [`Parameter::range`].
    fn tune(&mut self, _parameter: Parameter, _value: S) -> bool {
        false
    }
}

/// No safety layer: the wish is the command. For robots that move cell by cell, and to see what a layer is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unguarded;

impl<S: Scalar> Safety<S> for Unguarded {
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, _: &mut Rng) -> Vec3<S> {
        input.wish_mps
    }
}
