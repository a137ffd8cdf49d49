//! The reasons why robots wait.

use super::safety::SafetyInput;
use crate::geom::Vec3;
use crate::names::named;
use crate::scalar::Scalar;

named! {
    /// The reason why a robot with a goal does not advance ([`Outputs::wait`](super::Outputs)).
    ///
    /// | reason | ends when |
    /// | --- | --- |
    /// | [`Team`](Self::Team) | the robots arrive, or after [`patience`] decisions |
    /// | [`Stopped`](Self::Stopped) | a resume request arrives, or the request expires |
    /// | [`Route`](Self::Route) | the visible terrain changes |
    /// | [`Radio`](Self::Radio) | a robot is in contact: [policy](super::ContactLossPolicy) |
    /// | [`Turn`](Self::Turn) | its turn comes; a turn that is not taken passes on |
    /// | [`Robots`](Self::Robots) | the robots leave; robots lean to the right to pass each other |
    /// | [`GoalTaken`](Self::GoalTaken) | its place is free; until then it has arrived beside it |
    ///
    /// [`patience`]: crate::formation::FormationParams::patience
    pub enum Wait {
        /// Its leader or its followers are not in their places yet.
        Team = "team",
        /// Another robot asked it to stop.
        Stopped = "stopped",
        /// Terrain or walls block its way, and no robot does.
        Route = "route",
        /// It does not know where silent robots are.
        Radio = "radio",
        /// Other robots go first through a narrow place, such as a door.
        Turn = "turn",
        /// Other robots are in its way.
        Robots = "robots",
        /// Another robot occupies its goal.
        GoalTaken = "goal_taken",
    }
}

/// A slower wish counts as arrived, thousandths of the top speed.
const SLOW: i32 = 100;

/// Whether `velocity_mps` gives less than a quarter of the progress that the body could make.
pub(super) fn is_hindered<S: Scalar>(input: &SafetyInput<'_, S>, velocity_mps: Vec3<S>) -> bool {
    let SafetyInput { body, wish_mps: wish, .. } = input;
    let possible = body.reach(*wish).dot(*wish);
    possible > S::ZERO
        && wish.norm() >= body.max_speed_mps * S::from_milli(SLOW)
        && velocity_mps.dot(*wish) < possible * S::HALF * S::HALF
}
