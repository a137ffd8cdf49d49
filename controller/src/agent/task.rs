//! Telling a robot where to go.

use super::{Agent, Goal, Guidance, Safety, Task, ToCells, ToWaypoints, Waypoint};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::wire::Wire;

/// A task that means nothing to the guidance law: it goes to other things, or by other means. The robot does what it did before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WrongTask;

impl core::fmt::Display for WrongTask {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the guidance law has no use for the task")
    }
}

impl core::error::Error for WrongTask {}

impl<S: Scalar, G: Guidance<S>, const N: usize, A: Safety<S>, W: Wire> Agent<S, G, N, A, W> {
    /// Gives the robot a goal of its own on the grid, which a new place in the formation does not move (one that
    /// comes as a [`GoalAssignment`](crate::wire::GoalAssignment) is the formation's and moves).
    pub const fn assign_goal(&mut self, goal: Cell)
    where
        G: Guidance<S, Destination = ToCells>,
    {
        self.goal = Some(Goal::Own(goal));
        self.last.target = goal;
    }

    /// Gives the robot a waypoint, number `index` of those that its guidance law has room for; whether it has.
    pub fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool
    where
        G: Guidance<S, Destination = ToWaypoints>,
    {
        self.guidance.assign_waypoint(index, waypoint)
    }

    /// Gives the robot what it has to do, for a law that is known only at run time.
    ///
    /// # Errors
    /// [`WrongTask`] unless its guidance law has a use for all of it.
    pub fn assign(&mut self, task: &Task) -> Result<(), WrongTask> {
        let is_of_use = match task {
            Task::Cell(goal) => {
                let goes_there = self.guidance.goes_to_cells();
                if goes_there {
                    self.goal = Some(Goal::Own(*goal));
                    self.last.target = *goal;
                }
                goes_there
            }
            Task::Waypoints(waypoints) => {
                let assign =
                    |(index, waypoint): &(u8, Waypoint<f32>)| self.guidance.assign_waypoint(*index, &waypoint.cast());
                waypoints.iter().map(assign).fold(true, |all, one| all & one)
            }
        };
        is_of_use.then_some(()).ok_or(WrongTask)
    }
}
