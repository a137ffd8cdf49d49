//! Assigns goals to an agent.

use super::{Agent, Goal, Guidance, Safety, Task, ToCells, ToWaypoints, Waypoint};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::wire::Wire;

/// The guidance law has another kind of goal, or moves by other means. The previous task continues.
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
    /// Sets a goal cell for this robot, regardless of its place in a formation (unlike a received
    /// [`GoalAssignment`](crate::wire::GoalAssignment)).
    pub const fn assign_goal(&mut self, goal: Cell)
    where
        G: Guidance<S, Destination = ToCells>,
    {
        self.goal = Some(Goal::Own(goal));
        self.last.target = goal;
    }

    /// Sets waypoint `index`. Returns whether the guidance law accepted it.
    pub fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<S>) -> bool
    where
        G: Guidance<S, Destination = ToWaypoints>,
    {
        self.guidance.assign_waypoint(index, waypoint)
    }

    /// Assigns a task to a law that is chosen at run time.
    ///
    /// # Errors
    /// [`WrongTask`] if the guidance law cannot perform all of it.
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
