//! The flocks as guidance laws.

use super::law::{Action, BadInput, Decision, Law, Status, Tools, View};
use super::protocol::{WaypointOrder, Waypoints};
use super::{InPlane, WAYPOINTS, Waypoint};
use crate::flock::boids::BoidsParams;
use crate::flock::goal::{GoalParams, Goals, Stage, wish};
use crate::flock::lattice::{LatticeParams, Reference, ReferenceMotion, acceleration};
use crate::geom::{Position, Vec2, Vec3};
use crate::parameters::{Parameters, SPEED, TOLERANCE};
use crate::scalar::Scalar;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

crate::parameters! {
    impl[S: Scalar] GoalFlockGuidance<S> { TOLERANCE => arrival_m }
}

crate::parameters! {
    impl[S: Scalar] BoidsGuidance<S> { SPEED => speed_mps }
}

/// Goals that a robot of a goal flock can store.
pub const GOALS: usize = WAYPOINTS;

/// The alpha flock (R. Olfati-Saber 2006, OLF): equal distances, with waypoint 0 as the reference.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct LatticeGuidance<S> {
    params: LatticeParams<S>,
    reference: Option<Waypoint<S>>,
    motion: ReferenceMotion<S>,
}

impl<S: Scalar> LatticeGuidance<S> {
    /// Creates the law. `moves`: the reference moves with its velocity (a dynamic gamma-agent) or
    /// only has one (a static one, as in the obstacle courses of the paper).
    #[must_use]
    pub const fn new(params: LatticeParams<S>, moves: bool) -> Self {
        Self::following(params, if moves { ReferenceMotion::Dynamic } else { ReferenceMotion::Static })
    }

    /// Creates the law with a reference of the given motion.
    #[must_use]
    pub const fn following(params: LatticeParams<S>, motion: ReferenceMotion<S>) -> Self {
        Self { params, reference: None, motion }
    }
}

impl<S: Scalar> Law<S> for LatticeGuidance<S> {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        here: &InPlane<'_, S>,
        _: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let motion = self.motion;
        let reference = self.reference.as_mut().map(|waypoint| {
            let offset_m = if motion == ReferenceMotion::Dynamic {
                waypoint.way(view.state.position, view.now)
            } else {
                waypoint.position.since(view.state.position)
            };
            Reference { offset_m, velocity_mps: motion.wanted(offset_m, waypoint.velocity_mps) }
        });
        let body = &view.body;
        let change = acceleration(&self.params, body, view.nearby, here.obstacles, reference.as_ref());
        let wish_mps = body.velocity_mps + change * body.step_s;
        if !wish_mps.is_finite() {
            return Err(BadInput);
        }
        Ok(Decision { action: Action::Velocity { wish_mps, way_m: None }, status: Status::default() })
    }

    fn order(&mut self, &WaypointOrder { index, waypoint }: &WaypointOrder) -> bool {
        if index == 0 {
            self.reference = Some(waypoint.cast());
        }
        index == 0
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
    }
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
        Ok(Decision {
            action: Action::Velocity { wish_mps, way_m: None },
            status: Status { is_at_goal: self.is_there(own, way_m, wish_mps), ..Status::default() },
        })
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

/// Boids (V. A. Starovoitova 2018, STA): constant speed, headings that follow the neighbours.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct BoidsGuidance<S> {
    params: BoidsParams<S>,
    speed_mps: S,
    heading: Option<Vec2<S>>,
}

impl<S: Scalar> BoidsGuidance<S> {
    /// Creates the law. The first heading is that of the body, or random if it stands.
    #[must_use]
    pub const fn new(params: BoidsParams<S>, speed_mps: S) -> Self {
        Self { params, speed_mps, heading: None }
    }
}

impl<S: Scalar> Law<S> for BoidsGuidance<S> {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        _: &InPlane<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let mut draw = || {
            let turn = S::from_ratio(tools.rng.below(20_000).cast_signed() - 10_000, 10_000);
            let (sin, cos) = (turn * S::PI).sin_cos();
            Vec2::new(cos, sin)
        };
        let moving = view.body.velocity_mps.xy().normalized();
        let heading = moving.or(self.heading).unwrap_or_else(&mut draw);
        let heading = self.params.steer(view.id, heading, view.nearby);
        self.heading = Some(heading);
        Ok(Decision {
            action: Action::Velocity { wish_mps: (heading * self.speed_mps).extend(S::ZERO), way_m: None },
            status: Status::default(),
        })
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(&mut self.params);
        visit(self);
    }
}
