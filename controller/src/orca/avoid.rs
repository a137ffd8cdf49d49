//! Collision avoidance in the plane as one stateful step: what robots and obstacles near by forbid, and a wish
//! that finds its way out of symmetry and jams.
//!
//! [`Avoider::velocity`] gathers the half-planes, lets [`escape`](super::escape) bend the wish where ORCA alone would
//! stand still for ever, and solves. The rule of escape sees only what the robot knows and changes only the
//! preferred velocity, never a half-plane: what ORCA guarantees, it guarantees here.

use super::escape::{Escape, EscapeParams, Scene};
use super::{HalfPlane, Neighbor, Params, Solution, half_plane, solve, wall};
use crate::body::Body;
use crate::geom::Vec2;
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::{Scalar, cast};
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod simulation;
#[cfg(test)]
mod tests;

/// Where the half-plane of a moving neighbour comes from.
pub trait HalfPlanes<S: Scalar> {
    /// What `neighbor` forbids a robot with `own_velocity_mps`; `None` when an input makes no sense.
    fn half_plane(
        &self,
        own_velocity_mps: Vec2<S>,
        neighbor: &Neighbor<S>,
        params: &Params<S>,
    ) -> Option<HalfPlane<S>>;
}

/// Half-planes by [`half_plane`], exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Analytic;

impl<S: Scalar> HalfPlanes<S> for Analytic {
    fn half_plane(
        &self,
        own_velocity_mps: Vec2<S>,
        neighbor: &Neighbor<S>,
        params: &Params<S>,
    ) -> Option<HalfPlane<S>> {
        half_plane(own_velocity_mps, neighbor, params)
    }
}

/// Parameters of an [`Avoider`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AvoidParams<S> {
    /// Time ahead for which no collision with a robot may happen, seconds; more than 0, usually 1 to 5. Longer gives
    /// way earlier and slows everybody in a crowd. Shorter than the time that the body needs to
    /// stop (speed / acceleration) is not safe.
    pub horizon_s: S,
    /// The same for what does not move, seconds. It may be shorter, since obstacles do nothing unforeseen; a robot
    /// slows to (distance / this time) in front of a wall, hence passes narrow places slowly when it is long.
    pub wall_horizon_s: S,
    /// Own share of the correction towards robots that give way too, 1/2 when all use the same. Below 1/2 both together do not
    /// avoid; above, they give way more than needed. Towards robots that do not give way it is 1.
    pub share: S,
    /// Added to the sum of the radii of two robots, and to the own radius towards obstacles, metres: the error of what is known of
    /// places. Places in millimetres on both sides call for 0.004; at 0.5 m/s and 20 updates a second 0.01 cover one lost update in
    /// ten, and 0.03 three in ten. Robots may come nearer to each other than they think by what is missing here;
    /// much more than needed closes narrow places and slows crowds.
    pub margin_m: S,
    /// The way out of symmetry and jams.
    pub escape: EscapeParams<S>,
}

impl<S: Scalar> Default for AvoidParams<S> {
    fn default() -> Self {
        Self {
            horizon_s: S::TWO,
            wall_horizon_s: S::ONE,
            share: S::HALF,
            margin_m: S::from_milli(4),
            escape: EscapeParams::default(),
        }
    }
}

impl<S: Scalar> AvoidParams<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> AvoidParams<T> {
        AvoidParams {
            horizon_s: cast(self.horizon_s),
            wall_horizon_s: cast(self.wall_horizon_s),
            share: cast(self.share),
            margin_m: cast(self.margin_m),
            escape: self.escape.cast(),
        }
    }
}

/// Collision avoidance of one robot; at most `K` half-planes count.
///
/// Bytes: those of [`AvoidParams`] and the few of the rule of escape; 16 K bytes of stack (`f32`), three times that when no
/// velocity is permitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Avoider<S, const K: usize, P = Analytic> {
    params: AvoidParams<S>,
    source: P,
    escape: Escape<S>,
}

impl<S: Scalar, const K: usize> Avoider<S, K> {
    /// An avoider with exact half-planes.
    #[must_use]
    pub const fn new(params: AvoidParams<S>) -> Self {
        Self::with_source(params, Analytic)
    }
}

impl<S: Scalar, const K: usize, P> Avoider<S, K, P> {
    /// An avoider whose half-planes come from `source`.
    #[must_use]
    pub const fn with_source(params: AvoidParams<S>, source: P) -> Self {
        Self {
            params,
            source,
            escape: Escape::new(),
        }
    }

    /// The parameters.
    #[must_use]
    pub const fn params(&self) -> &AvoidParams<S> {
        &self.params
    }

    /// The parameters, to be changed between two steps.
    pub const fn params_mut(&mut self) -> &mut AvoidParams<S> {
        &mut self.params
    }
}

impl<S: Scalar, const K: usize, P: HalfPlanes<S>> Avoider<S, K, P> {
    /// The velocity to take until the next step: the nearest to `wish_mps`, bent by the rule of escape, that
    /// robots and obstacles permit; where they permit none, the one that violates them least, obstacles
    /// first. Call it once each [`Body::step_s`].
    ///
    /// `goal_m` is the way to the goal, if there is one: near it nobody swerves. `nearby` is nearest first. Obstacles
    /// count before robots, the nearest first, though robots get up to half of the `K` places.
    ///
    /// A body with inertia gets the best of the velocities that it can [reach](Body::reach) within the step, so that it may
    /// violate a half-plane which came up faster than it can brake: choose horizons longer than
    /// speed / acceleration. What is not finite counts as absent (wish: as zero). Work: as [`solve`], at most
    /// twice, and O(obstacles x K + `nearby`).
    #[must_use]
    pub fn velocity(
        &mut self,
        body: &Body<S>,
        wish_mps: Vec2<S>,
        goal_m: Option<Vec2<S>>,
        nearby: &[Nearby<S>],
        obstacles: &[Obstacle<S>],
        rng: &mut Rng,
    ) -> Solution<S> {
        let mut planes = Vec::new();
        let hard = self.planes(body, nearby, obstacles, &mut planes);
        let wish = wish_mps.clamp_norm(body.max_speed_mps);
        let scene = Scene {
            body,
            wish,
            goal: goal_m.filter(|goal| goal.is_finite()),
            nearby,
            obstacles,
        };
        let wish = self
            .escape
            .wish(&self.params.escape, &scene, rng)
            .clamp_norm(body.max_speed_mps);
        reachable::<S, K>(body, &mut planes, hard, wish)
    }

    /// What obstacles (their number is the answer), then robots forbid.
    fn planes(
        &self,
        body: &Body<S>,
        nearby: &[Nearby<S>],
        obstacles: &[Obstacle<S>],
        planes: &mut Vec<HalfPlane<S>, K>,
    ) -> usize {
        self.obstacle_planes(body, nearby.len(), obstacles, planes);
        let hard = planes.len();
        self.robot_planes(body, nearby, planes);
        hard
    }

    /// What obstacles forbid a robot with `others` near by: the nearest first, as many as leave robots their half of the places.
    /// Not inlined, so that its stack is free again for the solver.
    #[inline(never)]
    fn obstacle_planes(
        &self,
        body: &Body<S>,
        others: usize,
        obstacles: &[Obstacle<S>],
        planes: &mut Vec<HalfPlane<S>, K>,
    ) {
        let own = finite_or_zero(body.velocity_mps.xy());
        // Half for each; what one leaves is the other's.
        let room = K.saturating_sub(others.min(K >> 1));
        let mut distances = Vec::<S, K>::new();
        for obstacle in obstacles {
            let Some((_, distance)) = obstacle.nearest_point() else {
                continue;
            };
            let Some(plane) = self.obstacle_plane(body, own, obstacle) else {
                continue;
            };
            insert_nearest(&mut distances, planes, room, distance, plane);
        }
    }

    /// What robots forbid, as many as there is room for.
    #[inline(never)]
    fn robot_planes(
        &self,
        body: &Body<S>,
        nearby: &[Nearby<S>],
        planes: &mut Vec<HalfPlane<S>, K>,
    ) {
        let own = finite_or_zero(body.velocity_mps.xy());
        for other in nearby {
            let neighbor = Neighbor {
                offset_m: other.offset_m.xy(),
                velocity_mps: other.velocity_mps.xy(),
                radii_m: body.radius_m + other.radius_m + self.params.margin_m,
                tie: if body.id < other.id {
                    Vec2::new(-S::ONE, S::ZERO)
                } else {
                    Vec2::new(S::ONE, S::ZERO)
                },
            };
            let share = if other.gives_way {
                self.params.share
            } else {
                S::ONE
            };
            let rules = self.rules(body, self.params.horizon_s, share);
            let plane = self.source.half_plane(own, &neighbor, &rules);
            if let Some(plane) = plane
                && planes.push(plane).is_err()
            {
                break;
            }
        }
    }

    fn rules(&self, body: &Body<S>, horizon_s: S, share: S) -> Params<S> {
        Params {
            horizon_s,
            separation_s: body.step_s,
            share,
        }
    }

    fn obstacle_plane(
        &self,
        body: &Body<S>,
        own: Vec2<S>,
        obstacle: &Obstacle<S>,
    ) -> Option<HalfPlane<S>> {
        let horizon_s = self.params.wall_horizon_s;
        match *obstacle {
            Obstacle::Wall(ends_m) => {
                wall(own, ends_m, body.radius_m + self.params.margin_m, horizon_s)
            }
            Obstacle::Ball { center_m, radius_m } => {
                let ball = Neighbor {
                    offset_m: center_m.xy(),
                    velocity_mps: Vec2::ZERO,
                    radii_m: body.radius_m + radius_m + self.params.margin_m,
                    tie: Vec2::ZERO,
                };
                let rules = self.rules(body, horizon_s, S::ONE);
                half_plane(own, &ball, &rules)
            }
            Obstacle::Plane { normal, distance_m } => {
                // What the plane cuts out of the robot's height; a floor cuts out nothing.
                let upright = normal.xy().normalized()?;
                let away = distance_m.checked_div(normal.xy().norm())?
                    - body.radius_m
                    - self.params.margin_m;
                let closing = away.max(S::ZERO).checked_div(horizon_s)?;
                let point = -upright * closing;
                point.is_finite().then_some(HalfPlane {
                    point,
                    normal: upright,
                })
            }
        }
    }
}

fn finite_or_zero<S: Scalar>(velocity: Vec2<S>) -> Vec2<S> {
    if velocity.is_finite() {
        velocity
    } else {
        Vec2::ZERO
    }
}

/// Puts `plane` in its place of the at most `room` nearest, and its distance beside it; of equal ones the earlier stays in front.
fn insert_nearest<S: Scalar, const K: usize>(
    distances: &mut Vec<S, K>,
    planes: &mut Vec<HalfPlane<S>, K>,
    room: usize,
    distance: S,
    plane: HalfPlane<S>,
) {
    if distances.len() >= room {
        let is_nearer = distances.last().is_some_and(|last| distance < *last);
        if !is_nearer {
            return;
        }
        distances.pop();
        planes.pop();
    }
    if distances.push(distance).is_err() || planes.push(plane).is_err() {
        return;
    }
    let mut at = distances.len().saturating_sub(1);
    // By pattern: `swap` would leave a panic in the firmware.
    while let Some(before) = at.checked_sub(1)
        && let Some([one, other]) = distances.get_mut(before..=at)
        && let Some([first, second]) = planes.get_mut(before..=at)
        && *other < *one
    {
        core::mem::swap(one, other);
        core::mem::swap(first, second);
        at = before;
    }
}

/// The best velocity that the body can have after one step.
///
/// With inertia these are a disc around its velocity: the same problem with that as origin, and the speed limit as one
/// more hard half-plane, ahead of the velocity. Moves `planes` to that origin.
fn reachable<S: Scalar, const K: usize>(
    body: &Body<S>,
    planes: &mut [HalfPlane<S>],
    hard: usize,
    wish: Vec2<S>,
) -> Solution<S> {
    let own = body.velocity_mps.xy();
    let change = body.max_acceleration_mps2 * body.step_s;
    let is_held = change < body.max_speed_mps + body.max_speed_mps;
    if !is_held || !own.is_finite() {
        return solve::<S, K>(planes, hard, wish, body.max_speed_mps);
    }
    for plane in planes.iter_mut() {
        plane.point -= own;
    }
    let solved = solve::<S, K>(planes, hard, wish - own, change);
    let velocity = body.reach((own + solved.velocity_mps).extend(S::ZERO)).xy();
    let worst = planes
        .iter()
        .map(|plane| plane.penetration(velocity - own))
        .fold(S::ZERO, S::max);
    Solution {
        velocity_mps: velocity,
        penetration_mps: worst,
    }
}
