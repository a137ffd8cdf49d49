//! Words for the actions of robots: the same in summaries, on the page and beside an autopilot.

use staya_controller::agent::{Goals, Wait};
use staya_controller::robot::Mode;

/// The action of a robot in this mode, behind its name. `goals`: those that its law takes.
#[must_use]
pub const fn does(mode: Mode, goals: Goals) -> &'static str {
    match (mode, goals) {
        (Mode::Idle, _) => "has no goal",
        (Mode::Forming, _) => "takes its place in the formation",
        (Mode::Hold, _) => "stands",
        (Mode::Arrived, _) => "is at its goal",
        (Mode::Fault, _) => "stands: it is down, off the map, or without an input",
        (Mode::Passive, _) => "is not steered by its agent",
        (Mode::Cruise, Goals::None) => "moves; its law has no goal",
        (Mode::Cruise, Goals::Shared(_)) => "moves with its flock",
        (Mode::Cruise, Goals::Cell | Goals::Waypoints) => "moves to its goal",
    }
}

/// Why a robot waits, a clause.
#[must_use]
pub const fn because(wait: Wait) -> &'static str {
    match wait {
        Wait::Team => "the leader or followers are not in their places yet",
        Wait::Stopped => "another robot asked for a stop",
        Wait::Route => "terrain or walls block the way",
        Wait::Radio => "the places of silent robots are unknown",
        Wait::Turn => "other robots go first",
        Wait::Robots => "other robots are in the way",
        Wait::GoalTaken => "another robot occupies the goal",
    }
}
