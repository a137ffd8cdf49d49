//! Half-spaces and balls in any dimension, and all differences of the plane and space.

use super::{AvoidParams, Params};
use crate::body::Body;
use crate::geom::{Vec2, Vec3, Vector};
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::Scalar;
use core::fmt::Debug;
use serde::Serialize;

/// Permits the velocities v with (v - point) . normal >= 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HalfSpace<V> {
    /// A point of the border, m/s.
    pub point: V,
    /// Unit vector into the permitted side.
    pub normal: V,
}

/// A half-space of the plane.
pub type HalfPlane<S> = HalfSpace<Vec2<S>>;

impl<V: Vector> HalfSpace<V> {
    /// How far `velocity` lies on the forbidden side, m/s; negative on the permitted side.
    #[must_use]
    #[inline]
    pub fn penetration(&self, velocity: V) -> V::Scalar {
        (self.point - velocity).dot(self.normal)
    }
}

impl<S: Scalar> HalfPlane<S> {
    /// Unit vector along the border, with the permitted side to its left.
    #[must_use]
    pub fn direction(&self) -> Vec2<S> {
        Vec2::new(self.normal.y, -self.normal.x)
    }
}

/// A moving ball, in the plane a disc, that the robot's centre must stay out of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MovingBall<V: Vector> {
    /// Its centre minus the robot's, metres.
    pub offset_m: V,
    /// Its velocity, m/s.
    pub velocity_mps: V,
    /// Sum of both radii, metres; more than 0.
    pub radii_m: V::Scalar,
    /// Direction to leave one common place and velocity, opposite on the other robot; zero: east.
    pub tie: V,
}

/// The objective of a linear program: the point nearest to a goal, or the farthest in a direction.
#[derive(Clone, Copy)]
pub enum Aim<V> {
    Near(V),
    Along(V),
}

/// The input of the rule against deadlocks.
pub struct Situation<'a, V: Vector> {
    pub(super) body: &'a Body<V::Scalar>,
    /// Finite and within the speed limit.
    pub(super) wish: V,
    pub(super) goal: Option<V>,
    pub(super) nearby: &'a [Nearby<V::Scalar>],
    pub(super) obstacles: &'a [Obstacle<V::Scalar>],
}

/// Velocities in the plane ([`Vec2`]) or in space ([`Vec3`]), with the operations that differ: the
/// geometry of one constraint, linear programming on one border, and the rule against deadlocks.
pub trait Dimension: Vector + From<Vec3<<Self as Vector>::Scalar>> {
    /// State of the rule against deadlocks between steps.
    type Memory: Clone + Debug + PartialEq + Serialize;
    /// The initial state.
    const FRESH: Self::Memory;

    /// The policy for obstacles that together forbid every velocity. If true, all constraints are
    /// violated as little as possible. If false, the nearest obstacles are obeyed as far as
    /// possible and later constraints ignored (as in RVO2).
    const SHARES_CONTRADICTIONS: bool;

    /// Converts to a vector in space; a vector in the plane gets this height.
    fn at_height(self, height: Self::Scalar) -> Vec3<Self::Scalar>;

    /// The velocities that avoid `ball` for the time horizon if the neighbour does its share (ORCA
    /// section 4). `None` if an input is invalid.
    fn half_space(
        own_velocity_mps: Self,
        ball: &MovingBall<Self>,
        params: &Params<Self::Scalar>,
    ) -> Option<HalfSpace<Self>>;

    /// The best velocity no faster than `speed` on the border of `constraint` that those `before`
    /// it permit; `None` if there is none.
    fn best_on_border(
        constraint: &HalfSpace<Self>,
        before: &[HalfSpace<Self>],
        speed: Self::Scalar,
        aim: Aim<Self>,
    ) -> Option<Self>;

    /// The preferred velocity to pass to ORCA so that no robot waits forever.
    fn break_deadlock(
        memory: &mut Self::Memory,
        params: &AvoidParams<Self::Scalar>,
        situation: &Situation<'_, Self>,
        rng: &mut Rng,
    ) -> Self;

    /// Whether that rule made the robot wait for others at a gap.
    fn waits_for_turn(memory: &Self::Memory) -> bool;
}

/// Length and outward normal of the change from `w`, relative to the ball's centre, to its border;
/// `otherwise` is the normal at the centre.
pub(super) fn leave_ball<V: Vector>(w: V, radius: V::Scalar, otherwise: V) -> (V::Scalar, V) {
    let normal = w.normalized().unwrap_or(otherwise);
    (radius - w.norm(), normal)
}
