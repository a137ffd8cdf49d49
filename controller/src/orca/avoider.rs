//! One step of ORCA for one robot, in the plane or in space (RVO2's `Agent::computeNewVelocity`).
//!
//! [`Avoider::velocity`] collects the constraints of the nearest obstacles and robots, bends the
//! preferred velocity against [deadlocks](super::deadlock), and [solves](super::linear_program)
//! within the velocities that the body can reach.

use super::dimension::{Dimension, HalfPlane, HalfSpace, MovingBall, Situation};
use super::linear_program::{Solution, solve};
use super::wall::wall_from;
use super::{AvoidParams, Params, half_plane, half_space};
use crate::body::Body;
use crate::geom::{Vec2, Vec3, Vector};
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::Scalar;
use heapless::Vec;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod scale;
#[cfg(test)]
mod simulation;
#[cfg(test)]
mod space;
#[cfg(test)]
mod tests;

/// The look-ahead beside a moving robot that does not give way, in units of that beside others.
const ALONE: i32 = 4;

/// The space in which robots avoid each other, and the constraint of a moving neighbour.
pub trait HalfSpaces<S: Scalar> {
    /// Velocities: [`Vec2`] in the plane, [`Vec3`] in space.
    type Velocity: Dimension<Scalar = S>;

    /// The constraint of `ball` on a robot with `own_velocity_mps`; `None` if an input is invalid.
    fn half_space(
        &self,
        own_velocity_mps: Self::Velocity,
        ball: &MovingBall<Self::Velocity>,
        params: &Params<S>,
    ) -> Option<HalfSpace<Self::Velocity>>;

    /// Returns the ratio of vertical to horizontal distance between robots, at least 1.
    fn downwash(&self) -> S {
        S::ONE
    }
}

/// The plane, with exact half-planes ([`half_plane`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Analytic;

impl<S: Scalar> HalfSpaces<S> for Analytic {
    type Velocity = Vec2<S>;

    fn half_space(
        &self,
        own_velocity_mps: Vec2<S>,
        disc: &MovingBall<Vec2<S>>,
        params: &Params<S>,
    ) -> Option<HalfPlane<S>> {
        half_plane(own_velocity_mps, disc, params)
    }
}

/// Space, with exact half-spaces ([`half_space`]).
///
/// While a robot is in the way, robots turn by 25 degrees to the right and, depending on their
/// numbers, somewhat up or down; [`DeadlockParams`](super::DeadlockParams) has no effect. Walls are
/// vertical and have no top: only the horizontal velocity counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InSpace<S> {
    /// Ratio of vertical to horizontal distance between robots, the same for all; at least 1.
    ///
    /// Rotors blow downwards, and a robot that flies through the stream of another sinks. Use 2.5
    /// (W. Hönig et al. 2018) or more for small quadrotors. A larger value closes gaps.
    pub downwash: S,
}

impl<S: Scalar> Default for InSpace<S> {
    fn default() -> Self {
        Self { downwash: S::ONE }
    }
}

impl<S: Scalar> InSpace<S> {
    /// The half-space of robots with this downwash, from that of balls by `find`. In a scaled space
    /// the ellipsoid around a robot is a ball, and half-spaces remain half-spaces.
    #[inline]
    pub fn stretched(
        &self,
        own_velocity_mps: Vec3<S>,
        ball: &MovingBall<Vec3<S>>,
        find: impl FnOnce(Vec3<S>, &MovingBall<Vec3<S>>) -> Option<HalfSpace<Vec3<S>>>,
    ) -> Option<HalfSpace<Vec3<S>>> {
        let high = self.downwash;
        let is_higher = high > S::ONE;
        if !is_higher {
            return find(own_velocity_mps, ball);
        }
        let lowered = |v: Vec3<S>| Some(Vec3::new(v.x, v.y, v.z.checked_div(high)?));
        let ball = MovingBall { offset_m: lowered(ball.offset_m)?, velocity_mps: lowered(ball.velocity_mps)?, ..*ball };
        let HalfSpace { point, normal } = find(lowered(own_velocity_mps)?, &ball)?;
        let point = Vec3::new(point.x, point.y, point.z * high);
        let normal = lowered(normal)?.normalized()?;
        point.is_finite().then_some(HalfSpace { point, normal })
    }
}

impl<S: Scalar> HalfSpaces<S> for InSpace<S> {
    type Velocity = Vec3<S>;

    fn half_space(
        &self,
        own_velocity_mps: Vec3<S>,
        ball: &MovingBall<Vec3<S>>,
        params: &Params<S>,
    ) -> Option<HalfSpace<Vec3<S>>> {
        self.stretched(own_velocity_mps, ball, |own, ball| half_space(own, ball, params))
    }

    fn downwash(&self) -> S {
        self.downwash
    }
}

/// Collision avoidance of one robot, with at most `K` constraints.
///
/// `P` is the space and method: [`Analytic`] or [`VoxelTable2k`](super::VoxelTable2k) in the plane,
/// [`InSpace`] in space. Memory: [`AvoidParams`], the state of the rule against deadlocks, and 16 K
/// bytes of stack (`f32`; 24 K in space), three times that if no velocity is permitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(
    deserialize = "P: serde::Deserialize<'de>, <P::Velocity as Dimension>::Memory: serde::Deserialize<'de>"
))]
pub struct Avoider<S: Scalar, const K: usize, P: HalfSpaces<S> = Analytic> {
    params: AvoidParams<S>,
    source: P,
    memory: <P::Velocity as Dimension>::Memory,
}

impl<S: Scalar, const K: usize> Avoider<S, K> {
    /// Creates an avoider in the plane with exact half-planes.
    #[must_use]
    pub const fn new(params: AvoidParams<S>) -> Self {
        Self::with_source(params, Analytic)
    }
}

impl<S: Scalar, const K: usize> Avoider<S, K, InSpace<S>> {
    /// Creates an avoider in space, with robots as balls.
    #[must_use]
    pub const fn in_space(params: AvoidParams<S>) -> Self {
        Self::with_source(params, InSpace { downwash: S::ONE })
    }
}

impl<S: Scalar, const K: usize, P: HalfSpaces<S>> Avoider<S, K, P> {
    /// Creates an avoider that gets the constraints of moving neighbours from `source`.
    #[must_use]
    pub const fn with_source(params: AvoidParams<S>, source: P) -> Self {
        Self { params, source, memory: P::Velocity::FRESH }
    }

    /// The parameters.
    #[must_use]
    pub const fn params(&self) -> &AvoidParams<S> {
        &self.params
    }

    /// Mutable access to the parameters, which may change between two steps.
    pub const fn params_mut(&mut self) -> &mut AvoidParams<S> {
        &mut self.params
    }

    /// The source of the constraints of moving neighbours.
    #[must_use]
    pub const fn source(&self) -> &P {
        &self.source
    }

    /// Whether the robot had to wait in the last step for robots that go first through a gap.
    #[must_use]
    pub fn waits_for_turn(&self) -> bool {
        P::Velocity::waits_for_turn(&self.memory)
    }

    /// The velocity to take until the next step. Call it once per [`Body::step_s`].
    ///
    /// The result is the permitted velocity nearest to `wish_mps` as bent by the rule against
    /// deadlocks; if none is permitted, the one with the least violation, obstacles first. `goal_m`
    /// is the vector to the goal, if any; near it robots do not turn aside. `nearby` is sorted,
    /// nearest first. Obstacles count before robots, nearest first (ties: slice order), but robots
    /// get up to half of the `K` places.
    ///
    /// A body with inertia gets the best velocity that it can [reach](Body::reach) within the step.
    /// It may violate a constraint that appeared faster than it can brake, so choose horizons
    /// longer than speed / acceleration. Values that are not finite count as absent (a wish: as
    /// zero). Work: [`solve`] at most twice, and O(obstacles x K + `nearby`).
    #[must_use]
    pub fn velocity(
        &mut self,
        body: &Body<S>,
        wish_mps: P::Velocity,
        goal_m: Option<P::Velocity>,
        nearby: &[Nearby<S>],
        obstacles: &[Obstacle<S>],
        rng: &mut Rng,
    ) -> Solution<P::Velocity> {
        let mut constraints = Vec::new();
        let hard = self.constraints(body, nearby, obstacles, &mut constraints);
        let situation = Situation {
            body,
            wish: wish_mps.clamp_norm(body.max_speed_mps),
            goal: goal_m.filter(|goal| goal.is_finite()),
            nearby,
            obstacles,
        };
        let wish = Dimension::break_deadlock(&mut self.memory, &self.params, &situation, rng);
        let wish = wish.clamp_norm(body.max_speed_mps);
        reachable::<P::Velocity, K>(body, &mut constraints, hard, wish)
    }

    /// The constraints that [`Avoider::velocity`] uses for the same arguments: first those of
    /// obstacles, whose number is returned, then those of robots.
    #[must_use]
    pub fn half_spaces(
        &self,
        body: &Body<S>,
        nearby: &[Nearby<S>],
        obstacles: &[Obstacle<S>],
    ) -> (usize, Vec<HalfSpace<P::Velocity>, K>) {
        let mut constraints = Vec::new();
        let hard = self.constraints(body, nearby, obstacles, &mut constraints);
        (hard, constraints)
    }

    fn constraints(
        &self,
        body: &Body<S>,
        nearby: &[Nearby<S>],
        obstacles: &[Obstacle<S>],
        constraints: &mut Vec<HalfSpace<P::Velocity>, K>,
    ) -> usize {
        let room = K.saturating_sub(nearby.len().min(K >> 1));
        nearest_obstacles(&self.params, body, obstacles, room, constraints);
        let hard = constraints.len();
        self.robots(body, nearby, constraints);
        hard
    }

    /// Not inlined, so that the solver can reuse its stack.
    #[inline(never)]
    fn robots(&self, body: &Body<S>, nearby: &[Nearby<S>], constraints: &mut Vec<HalfSpace<P::Velocity>, K>) {
        let own = own_velocity(body);
        let horizon_s = self.params.horizon_s.max(body.least_horizon_s());
        for other in nearby {
            let tie = if body.id < other.id { -S::ONE } else { S::ONE };
            // Beside a moving robot that does not give way, it makes all of the room alone, also
            // for a turn of that robot in this step.
            let is_alone = !other.gives_way && other.velocity_mps != Vec3::ZERO;
            let turn_m = if is_alone { body.max_speed_mps * body.step_s } else { S::ZERO };
            let ball = MovingBall {
                offset_m: other.offset_m.into(),
                velocity_mps: other.velocity_mps.into(),
                radii_m: body.radius_m + other.radius_m + self.params.margin_m + turn_m,
                tie: Vec3::new(tie, S::ZERO, S::ZERO).into(),
            };
            let params = Params {
                horizon_s: if is_alone { horizon_s * S::from_i32(ALONE) } else { horizon_s },
                separation_s: body.step_s,
                share: if other.gives_way { self.params.share } else { S::ONE },
            };
            if let Some(constraint) = self.source.half_space(own, &ball, &params)
                && constraints.push(constraint).is_err()
            {
                break;
            }
        }
    }
}

fn own_velocity<V: Dimension>(body: &Body<V::Scalar>) -> V {
    let own = V::from(body.velocity_mps);
    if own.is_finite() { own } else { V::ZERO }
}

/// Writes the at most `room` nearest obstacles, nearest first, into the empty `constraints`. Not
/// inlined, so that the solver can reuse its stack.
#[inline(never)]
fn nearest_obstacles<V: Dimension, const K: usize>(
    params: &AvoidParams<V::Scalar>,
    body: &Body<V::Scalar>,
    obstacles: &[Obstacle<V::Scalar>],
    room: usize,
    constraints: &mut Vec<HalfSpace<V>, K>,
) {
    let own = own_velocity(body);
    // A separate list: pairs would need both lists twice on the stack.
    let mut distances = Vec::<V::Scalar, K>::new();
    for obstacle in obstacles {
        let nearest_point = obstacle.nearest_point();
        let distance = nearest_point.map_or(-V::Scalar::MAX, |(_, distance)| distance);
        let Some(constraint) = static_obstacle(params, body, own, obstacle, nearest_point) else {
            continue;
        };
        if distances.len() >= room {
            let is_nearer = distances.last().is_some_and(|farthest| distance < *farthest);
            if !is_nearer {
                continue;
            }
            distances.pop();
            constraints.pop();
        }
        if distances.push(distance).is_err() || constraints.push(constraint).is_err() {
            continue;
        }
        // Slice patterns instead of `swap`, which would leave a panic in the firmware.
        let mut at = distances.len().saturating_sub(1);
        while let Some(before) = at.checked_sub(1)
            && let Some([nearer, farther]) = distances.get_mut(before..=at)
            && let Some([one, other]) = constraints.get_mut(before..=at)
            && *farther < *nearer
        {
            core::mem::swap(nearer, farther);
            core::mem::swap(one, other);
            at = before;
        }
    }
}

fn static_obstacle<V: Dimension>(
    params: &AvoidParams<V::Scalar>,
    body: &Body<V::Scalar>,
    own: V,
    obstacle: &Obstacle<V::Scalar>,
    nearest_point: Option<(Vec3<V::Scalar>, V::Scalar)>,
) -> Option<HalfSpace<V>> {
    let zero = V::Scalar::ZERO;
    let horizon_s = params.wall_horizon_s;
    match *obstacle {
        Obstacle::Wall(ends_m) => {
            let own = own.at_height(zero).xy();
            let plane = wall_from(own, ends_m, nearest_point, body.radius_m + params.margin_m, horizon_s)?;
            Some(HalfSpace { point: plane.point.extend(zero).into(), normal: plane.normal.extend(zero).into() })
        }
        Obstacle::Ball { center_m, radius_m } => {
            let ball = MovingBall {
                offset_m: center_m.into(),
                velocity_mps: V::ZERO,
                radii_m: body.radius_m + radius_m + params.margin_m,
                tie: Vec3::new(zero, zero, V::Scalar::ONE).into(),
            };
            let params = Params { horizon_s, separation_s: body.step_s, share: V::Scalar::ONE };
            V::half_space(own, &ball, &params)
        }
        Obstacle::Plane { normal, distance_m } => {
            // A floor has no effect in the plane.
            let normal = V::from(normal);
            let length = normal.norm();
            let normal = normal.normalized()?;
            let away = distance_m.checked_div(length)? - body.radius_m - params.margin_m;
            let closing = away.max(zero).checked_div(horizon_s)?;
            let point = -normal * closing;
            point.is_finite().then_some(HalfSpace { point, normal })
        }
    }
}

/// With inertia the reachable velocities are a disc (ball) around the current velocity, so this
/// moves `constraints` to that origin; a result that is too fast is [shortened](Body::reach).
fn reachable<V: Dimension, const K: usize>(
    body: &Body<V::Scalar>,
    constraints: &mut [HalfSpace<V>],
    hard: usize,
    wish: V,
) -> Solution<V> {
    let own = V::from(body.velocity_mps);
    let change = body.max_acceleration_mps2 * body.step_s;
    let is_held = change < body.max_speed_mps + body.max_speed_mps;
    if !is_held || !own.is_finite() {
        return solve::<V, K>(constraints, hard, wish, body.max_speed_mps);
    }
    for constraint in constraints.iter_mut() {
        constraint.point = constraint.point - own;
    }
    let solved = solve::<V, K>(constraints, hard, wish - own, change);
    let velocity = body.reach((own + solved.velocity_mps).at_height(V::Scalar::ZERO));
    let velocity = V::from(velocity);
    Solution { velocity_mps: velocity, ..Solution::of(velocity - own, constraints) }
}
