//! The goal flock as a law.

use super::{GoalParams, Goals, Stage, wish};
use crate::geom::{Position, Vec3};
use crate::law::{Action, BadInput, Decision, InPlane, Law, Progress, Tools, View};
use crate::laws::waypoint::{WAYPOINTS, Waypoint, WaypointOrder, Waypoints};
use crate::parameters::{Parameters, TOLERANCE};
use crate::scalar::Scalar;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// Goals that a robot of a goal flock can store.
pub const GOALS: usize = WAYPOINTS;

crate::parameters! {
    impl[S: Scalar] GoalFlockGuidance<S> { TOLERANCE.depends("`neighborhood_m`") => arrival_m }
}

/// The goal flock (V. E. and V. V. Pavlovsky, PAV): moves to the centre of the goals together, then
/// each robot draws one goal. Goals may move; the centre and the robots follow them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GoalFlockGuidance<S> {
    params: GoalParams<S>,
    arrival_m: S,
    seed: u64,
    goals: Goals<GOALS>,
    moving: [Option<Waypoint<S>>; GOALS],
}

impl<S: Scalar> GoalFlockGuidance<S> {
    /// Creates the law. `arrival_m`: distance at which the robot counts as arrived, about the
    /// neighbourhood radius for a crowd. `seed`: seed of the draws.
    #[must_use]
    pub const fn new(params: GoalParams<S>, arrival_m: S, seed: u64) -> Self {
        Self { params, arrival_m, seed, goals: Goals::new(), moving: [None; GOALS] }
    }

    fn follow_goals(&mut self, own: Position, now: Instant) {
        for (index, waypoint) in self.moving.iter_mut().enumerate() {
            let place = waypoint.as_mut().and_then(|waypoint| own.moved(waypoint.way(own, now)));
            if let Some(place) = place {
                let _ = self.goals.set_goal(index, place);
            }
        }
    }

    /// The stage of the robot's route.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.goals.stage()
    }

    /// Whether it is near its goal and blocked by robots. Stopping earlier would block other
    /// robots.
    fn is_there(&self, own: Position, way_m: Option<Vec3<S>>, wish_mps: Vec3<S>) -> bool {
        let is_drawn = matches!(self.goals.stage(), Stage::Goal(_));
        let is_near = is_drawn && self.goals.has_arrived(own, self.arrival_m);
        let way_m = way_m.unwrap_or_default();
        let is_kept_off = way_m.dot(wish_mps) <= S::ZERO;
        is_near && (is_kept_off || way_m.norm() <= self.params.min_distance_m)
    }
}

impl<S: Scalar> Law<S> for GoalFlockGuidance<S> {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        _: &InPlane<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let own = view.state.position;
        self.follow_goals(own, view.now);
        let _ = self.goals.update(own, self.arrival_m, self.seed, view.id);
        let goal = self.goals.current();
        let wish_mps = wish(&self.params, &view.body, own, goal, view.nearby);
        let way_m = goal.map(|goal| goal.since(own));
        let is_there = self.is_there(own, way_m, wish_mps);
        let progress = Progress::at_goal(is_there);
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, progress))
    }

    fn order(&mut self, &WaypointOrder { index, waypoint }: &WaypointOrder) -> bool {
        let (index, position) = (usize::from(index), waypoint.position);
        let is_taken = self.goals.set_goal(index, position)
            || (index == self.goals.as_slice().len() && self.goals.push(position).is_ok());
        if let Some(moving) = self.moving.get_mut(index).filter(|_| is_taken) {
            let waypoint = waypoint.cast::<S>();
            *moving = (waypoint.velocity_mps != Vec3::ZERO).then_some(waypoint);
        }
        is_taken
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }
}
