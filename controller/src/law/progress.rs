//! How far a robot is with its task.

use super::Wait;
use serde::{Deserialize, Serialize};

/// The progress of a robot, as its law sees it. The mode of the robot follows from it:
///
/// | progress | [`Mode`](crate::robot::Mode) |
/// | --- | --- |
/// | `Idle` | `Idle` |
/// | `Going`, `Recovering` | `Cruise`; `Hold` while others stop it |
/// | `Forming` | `Forming`; `Hold` while others stop it |
/// | `Waiting`, `Stuck` | `Hold` |
/// | `Arrived`, `Waiting(GoalTaken)` | `Arrived` |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// It has no goal.
    Idle,
    /// It goes to its goal, or as its law without a goal says.
    #[default]
    Going,
    /// It is too far from its place in the formation, and goes there.
    Forming,
    /// It stands for a reason. With [`Wait::GoalTaken`] it has arrived beside its occupied goal.
    Waiting(Wait),
    /// No exit of the window is reachable: it stands.
    Stuck,
    /// It is at its goal, and stands.
    Arrived,
    /// It heads for scattered followers, or for where an operator sends it, and therefore ignores
    /// requests to stop.
    Recovering,
}

impl Progress {
    /// Returns whether it is at its goal, or beside its occupied goal.
    #[must_use]
    pub const fn has_arrived(self) -> bool {
        matches!(self, Self::Arrived | Self::Waiting(Wait::GoalTaken))
    }

    /// [`Arrived`](Self::Arrived) if the robot is at its goal, otherwise [`Going`](Self::Going).
    #[must_use]
    pub const fn at_goal(is_at_goal: bool) -> Self {
        if is_at_goal { Self::Arrived } else { Self::Going }
    }

    /// [`Arrived`](Self::Arrived), or beside a goal that another robot occupies.
    #[must_use]
    pub const fn arrived(is_beside: bool) -> Self {
        if is_beside { Self::Waiting(Wait::GoalTaken) } else { Self::Arrived }
    }
}
