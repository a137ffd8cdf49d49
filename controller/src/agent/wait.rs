//! What robots wait for, so that somebody can see it.

use super::safety::SafetyInput;
use crate::geom::Vec3;
use crate::names::named;
use crate::scalar::Scalar;

named! {
    /// What a robot that has somewhere to go and does not get on waits for ([`Outputs::wait`](super::Outputs)).
    ///
    /// | it waits for | until |
    /// | --- | --- |
    /// | [`Formation`](Self::Formation) | they are there, at most [`patience`](crate::formation::FormationParams::patience) decisions |
    /// | [`Request`](Self::Request) | it is told to resume, or the request is no longer valid |
    /// | [`Way`](Self::Way) | the land in sight changes |
    /// | [`Radio`](Self::Radio) | somebody speaks ([`Silence`](super::Silence)) |
    /// | [`Turn`](Self::Turn) | its turn comes; one that is not taken passes on |
    /// | [`Others`](Self::Others) | they get out of its way; robots lean to the right so that they do |
    /// | [`Place`](Self::Place) | its place is free; it has arrived beside it |
    pub enum Wait {
        /// Its leader or its followers are not there yet.
        Formation = "formation",
        /// Somebody asked it to stop.
        Request = "request",
        /// Nothing but land or walls is in its way.
        Way = "way",
        /// It does not know where others are: they are not heard.
        Radio = "radio",
        /// At a door others go first.
        Turn = "turn",
        /// Other robots are in its way.
        Others = "others",
        /// Somebody stands on its goal.
        Place = "place",
    }
}

/// Thousandths of the top speed: who wishes less is as good as there.
const SLOW: i32 = 100;

/// Whether `velocity_mps` makes less than a quarter of the headway that the body could make by its wish.
pub(super) fn is_hindered<S: Scalar>(input: &SafetyInput<'_, S>, velocity_mps: Vec3<S>) -> bool {
    let SafetyInput { body, wish_mps: wish, .. } = input;
    let possible = body.reach(*wish).dot(*wish);
    possible > S::ZERO
        && wish.norm() >= body.max_speed_mps * S::from_milli(SLOW)
        && velocity_mps.dot(*wish) < possible * S::HALF * S::HALF
}
