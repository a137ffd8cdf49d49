//! The reasons why robots wait.

use crate::names::named;

named! {
    /// The reason why a robot with a goal does not advance:
    /// [`Outputs::wait`](crate::agent::Outputs::wait).
    ///
    /// | reason | ends when |
    /// | --- | --- |
    /// | [`Team`](Self::Team) | the robots arrive, or after [`patience`] decisions |
    /// | [`Stopped`](Self::Stopped) | a resume request arrives, or the request expires |
    /// | [`Route`](Self::Route) | the visible terrain changes |
    /// | [`Radio`](Self::Radio) | a robot is in contact, by its [policy] |
    /// | [`Turn`](Self::Turn) | its turn comes; a turn that is not taken passes on |
    /// | [`Robots`](Self::Robots) | the robots leave; robots lean to the right to pass each other |
    /// | [`GoalTaken`](Self::GoalTaken) | its place is free; until then it has arrived beside it |
    ///
    /// [policy]: crate::agent::ContactLossPolicy
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
