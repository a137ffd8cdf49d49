//! Straight lines through waypoints to a goal.

use super::goal_occupancy::{Claim, GoalOccupancy};
use super::make_way::MakeWay;
use super::protocol::{WAYPOINTS, Waypoint, WaypointOrder, Waypoints};
use crate::geom::{Vec2, Vec3};
use crate::law::{Action, BadInput, Decision, InPlane, Law, Progress, Scene, Tools, View};
use crate::list::SparseVec;
use crate::parameters::{Parameters, SPEED, TOLERANCE};
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};

crate::parameters! {
    impl[S: Scalar] WaypointGuidance<S> { SPEED => speed_mps, TOLERANCE.of_body("tolerance_m") => tolerance_m }
}

/// Within this distance, in own radii, an intermediate waypoint is passed, even if it is occupied.
const PASSED_RADII: i32 = 3;

/// Moves straight to a waypoint, stays there, and follows a waypoint that moves. If another robot
/// occupies the last one, it arrives beside that robot. If it blocks a robot in a narrow place, it
/// makes way and returns.
///
/// Index 0 starts a new course, the next free index extends it, and an existing index moves that
/// waypoint. The course is passed in the order of indices.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WaypointGuidance<S> {
    course: SparseVec<Waypoint<S>, WAYPOINTS, u8>,
    leg: u8,
    beside: GoalOccupancy<S>,
    make_way: MakeWay<S>,
    tolerance_m: S,
    speed_mps: S,
}

impl<S: Scalar> WaypointGuidance<S> {
    /// Creates the law without waypoints. `tolerance_m`: distance that counts as arrived, at least
    /// some millimetres, because waypoints are rounded to millimetres.
    #[must_use]
    pub const fn new(speed_mps: S, tolerance_m: S) -> Self {
        Self {
            course: SparseVec::new(),
            leg: 0,
            beside: GoalOccupancy::NEW,
            make_way: MakeWay::NEW,
            tolerance_m,
            speed_mps,
        }
    }

    /// Starts a new course.
    pub(crate) fn begin(&mut self, waypoint: &Waypoint<S>) {
        self.course.clear();
        self.leg = 0;
        let _ = self.course.push(*waypoint);
    }

    /// Offset, metres, and velocity of the current waypoint. Advances when one is passed.
    fn next(&mut self, view: &Scene<'_, S>) -> Option<(Vec3<S>, Vec3<S>)> {
        let passed_m = self.tolerance_m.max(view.body.radius_m * S::from_i32(PASSED_RADII));
        let mut ahead = self.course.iter_mut().skip(usize::from(self.leg));
        let mut waypoint = ahead.next()?;
        let mut way = waypoint.way(view.state.position, view.now);
        for next in ahead {
            if way.norm() > passed_m {
                break;
            }
            self.leg = self.leg.saturating_add(1);
            waypoint = next;
            way = waypoint.way(view.state.position, view.now);
        }
        Some((way, waypoint.velocity_mps))
    }

    /// Heads for the waypoint before again, if other robots pushed this one far away from it.
    fn goes_back(&mut self, view: &Scene<'_, S>, makes_way: bool) {
        let Scene { state, now, body, .. } = view;
        let mut way = |leg: u8| Some(self.course.get_mut(usize::from(leg))?.way(state.position, *now));
        let before = self.leg.saturating_sub(1);
        let (Some(next), Some(last)) = (way(self.leg), way(before)) else {
            return;
        };
        let far_m = self.tolerance_m.max(body.radius_m * S::from_i32(PASSED_RADII)) * S::TWO;
        let leaves = |way: Vec3<S>| way.dot(body.velocity_mps) < S::ZERO;
        if leaves(last) && (makes_way || leaves(next)) && last.norm() > far_m {
            self.leg = before;
        }
    }

    /// The rest of the course, metres, with `distance` to the current waypoint.
    fn left_m(&self, distance: S) -> S {
        let ahead = self.course.get(usize::from(self.leg)..).unwrap_or_default();
        let legs = ahead.windows(2).map(|pair| match pair {
            [from, to] => to.position.since::<S>(from.position).norm(),
            _ => S::ZERO,
        });
        legs.fold(distance, |sum, leg| sum + leg)
    }

    pub(crate) fn head(&mut self, view: &Scene<'_, S>) -> Result<Decision<S>, BadInput> {
        view.can_move()?;
        let (way, velocity_mps) = self.next(view).ok_or(BadInput)?;
        let from_body = way + view.ahead_m;
        // The body itself, behind the point ahead, keeps up with a moving waypoint.
        let way = way + velocity_mps * view.lag_s;
        let is_last = usize::from(self.leg) + 1 >= self.course.len();
        let distance = way.norm();
        let speed = self.speed_mps.min(view.body.max_speed_mps);
        let ahead = way.normalized().unwrap_or_default();
        let claim = match is_last && velocity_mps == Vec3::ZERO {
            true => self.beside.claim(view, way, self.tolerance_m),
            false => Claim::Goes,
        };
        let pace = match claim {
            Claim::Yields(room_m) if distance < room_m => -speed,
            Claim::Yields(_) => S::ZERO,
            Claim::Goes | Claim::IsBeside => {
                let left_m = if view.body.has_inertia() { self.left_m(distance) } else { distance };
                view.body.stopping_speed(left_m).min(speed)
            }
        };
        let is_beside = claim == Claim::IsBeside;
        // A body that is too fast to stop there passes the goal.
        let slides_m = if velocity_mps == Vec3::ZERO { view.body.stopping_way() } else { Vec3::ZERO };
        let is_near = is_last && distance.max((way - slides_m).norm()) <= self.tolerance_m;
        let is_at_goal = is_near && from_body.norm() <= self.tolerance_m || is_beside;
        // A point ahead that is a little past the goal does not turn the body back.
        let pace = if is_near && way.dot(from_body) < S::ZERO { S::ZERO } else { pace };
        // A robot that lets another one go first does not head anywhere, so it is not in a jam.
        let way_m = (!matches!(claim, Claim::Yields(_))).then_some(way);
        let action = Action::Velocity { wish_mps: velocity_mps + ahead * pace, way_m };
        let progress = if is_at_goal { Progress::arrived(is_beside) } else { Progress::Going };
        // A robot that stopped at a moving waypoint would lose it.
        let makes_way = is_at_goal && velocity_mps != Vec3::ZERO;
        Ok(Decision { makes_way, ..Decision::new(action, progress) })
    }
}

impl<S: Scalar> Law<S> for WaypointGuidance<S> {
    type Surroundings<'a> = InPlane<'a, S>;
    type Protocol = Waypoints;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, S, Waypoints>,
        here: &InPlane<'_, S>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        if self.course.is_empty() {
            return Ok(Decision::idle());
        }
        let mut decision = self.head(view)?;
        let to_goal = match decision.action {
            Action::Velocity { way_m: Some(way), .. } => way.xy(),
            _ => Vec2::ZERO,
        };
        let stays = decision.progress.has_arrived() && !decision.makes_way;
        let away = self.make_way.way(view, here.obstacles, stays, to_goal, tools.rng);
        if self.leg > 0 && MakeWay::is_blocked(view, here.obstacles) {
            self.goes_back(view, away.is_some());
        }
        if let Some(way) = away {
            let wish_mps = way * self.speed_mps.min(view.body.max_speed_mps);
            let action = Action::Velocity { wish_mps, way_m: None };
            decision = Decision { makes_way: true, ..Decision::new(action, Progress::Going) };
        }
        Ok(decision)
    }

    fn order(&mut self, &WaypointOrder { index, waypoint }: &WaypointOrder) -> bool {
        let waypoint = waypoint.cast();
        if index == 0 {
            self.begin(&waypoint);
            return true;
        }
        match self.course.get_mut(usize::from(index)) {
            Some(known) => {
                *known = waypoint;
                true
            }
            None => usize::from(index) == self.course.len() && self.course.push(waypoint).is_ok(),
        }
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
    }
}
