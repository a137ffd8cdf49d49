//! The last layer before the body: turns the desired velocity into a safe one.

mod half_planes;
pub(crate) mod list;
mod orca;
mod push_out;
mod settings;
#[cfg(test)]
mod tests;

pub use half_planes::AnyHalfPlanes;
pub use list::{AnySafety, LayerSettings};
pub use orca::{FlySafety, OrcaSafety};
pub use push_out::PushOutSafety;
pub use settings::{FlySettings, MakesLayer, OrcaSettings, PushOutSettings, TableSettings, UnguardedSettings};

use crate::body::Body;
use crate::geom::Vec3;
use crate::neighbor::{Nearby, StalenessInflation};
use crate::obstacle::Obstacle;
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Inputs of a safety layer.
#[derive(Clone, Copy, Debug)]
pub struct SafetyInput<'a, S> {
    /// Own body.
    pub body: Body<S>,
    /// The velocity desired by the guidance law, m/s: finite; zero if the robot should stand.
    pub wish_mps: Vec3<S>,
    /// Offset of the point that the robot heads straight for, metres; `None` if there is none.
    pub way_m: Option<Vec3<S>>,
    /// Nearby robots, nearest first.
    pub nearby: &'a [Nearby<S>],
    /// Visible static obstacles.
    pub obstacles: &'a [Obstacle<S>],
}

/// Avoids other robots and obstacles, also while the robot stands, because others rely on it.
pub trait Safety<S: Scalar> {
    /// Returns a safe velocity near the desired one, m/s; the agent limits it by [`Body::reach`].
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, rng: &mut Rng) -> Vec3<S>;

    /// Returns how the balls of silent neighbours grow. With `None` they are ignored: there is no
    /// [`GapLimit`](crate::neighbor::GapLimit), and no stop on contact loss.
    fn inflation(&self) -> Option<StalenessInflation<S>> {
        None
    }

    /// Returns the ratio of vertical to horizontal distance between robots, at least 1.
    fn downwash(&self) -> S {
        S::ONE
    }

    /// Returns whether the robot waits for other robots to pass a door first.
    fn waits_for_turn(&self) -> bool {
        false
    }

    /// Calls `visit` with each of its tables of parameters.
    fn parameters(&mut self, _visit: &mut dyn FnMut(&mut dyn Parameters)) {}
}

/// No safety layer, for robots that move cell by cell and as a baseline for comparisons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unguarded;

impl<S: Scalar> Safety<S> for Unguarded {
    fn keep_clear(&mut self, input: &SafetyInput<'_, S>, _: &mut Rng) -> Vec3<S> {
        input.wish_mps
    }
}

/// A slower wish counts as arrived, thousandths of the top speed.
const SLOW: i32 = 100;

/// Whether `velocity_mps` gives less than a quarter of the progress that the body could make.
pub(crate) fn is_hindered<S: Scalar>(input: &SafetyInput<'_, S>, velocity_mps: Vec3<S>) -> bool {
    let SafetyInput { body, wish_mps: wish, .. } = input;
    let possible = body.reach(*wish).dot(*wish);
    possible > S::ZERO
        && wish.norm() >= body.max_speed_mps * S::from_milli(SLOW)
        && velocity_mps.dot(*wish) < possible * S::HALF * S::HALF
}
