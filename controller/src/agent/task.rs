//! Assigns a host's task to an agent.

use super::{Agent, AnyOrder, GridOrder, InAny, Law, Perception, Safety, Task, WaypointOrder, WrongTask};
use crate::scalar::Scalar;
use crate::wire::Wire;

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Gives the law a task as orders.
    ///
    /// # Errors
    /// [`WrongTask`] if the law cannot perform all of it.
    pub fn assign(&mut self, task: &Task) -> Result<(), WrongTask>
    where
        L::Protocol: InAny,
    {
        let mut give = |order| L::Protocol::order_in(&order).is_some_and(|order| self.order(&order));
        let is_of_use = match task {
            Task::Cell(goal) => give(AnyOrder::Grid(GridOrder::Goal(*goal))),
            Task::Waypoints(waypoints) => waypoints
                .iter()
                .map(|&(index, waypoint)| give(AnyOrder::Waypoint(WaypointOrder { index, waypoint })))
                .fold(true, |all, one| all & one),
        };
        is_of_use.then_some(()).ok_or(WrongTask)
    }
}
