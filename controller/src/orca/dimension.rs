//! What ORCA is made of in any dimension (half-spaces and balls), and all in which the plane differs from space.

use super::{AvoidParams, Params};
use crate::body::Body;
use crate::geom::{Vec2, Vec3, Vector};
use crate::neighbor::Nearby;
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::scalar::Scalar;
use core::fmt::Debug;
use serde::Serialize;

/// Velocities v with (v - point) . normal >= 0 are permitted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HalfSpace<V> {
    /// A point of its border, m/s.
    pub point: V,
    /// Unit vector into the permitted side.
    pub normal: V,
}

/// A half-space of the plane.
pub type HalfPlane<S> = HalfSpace<Vec2<S>>;

impl<V: Vector> HalfSpace<V> {
    /// How far `velocity` lies on the forbidden side, m/s; negative on the permitted one.
    #[must_use]
    #[inline]
    pub fn penetration(&self, velocity: V) -> V::Scalar {
        (self.point - velocity).dot(self.normal)
    }
}

impl<S: Scalar> HalfPlane<S> {
    /// Unit vector along the border, the permitted side to its left.
    #[must_use]
    pub fn direction(&self) -> Vec2<S> {
        Vec2::new(self.normal.y, -self.normal.x)
    }
}

/// A moving ball, in the plane a disc, to keep the own centre out of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MovingBall<V: Vector> {
    /// Its centre minus the own one, metres.
    pub offset_m: V,
    /// Its velocity, m/s.
    pub velocity_mps: V,
    /// Sum of both radii, metres; more than 0.
    pub radii_m: V::Scalar,
    /// Which way to go when both are in the same place with the same velocity: any vector, the
    /// opposite one on the other robot. East when zero.
    pub tie: V,
}

/// What a linear program optimises: the point nearest to a goal, or the farthest in a direction.
#[derive(Clone, Copy)]
pub enum Aim<V> {
    Near(V),
    Along(V),
}

/// What the rule against deadlocks sees.
pub struct Situation<'a, V: Vector> {
    pub(super) body: &'a Body<V::Scalar>,
    /// Finite, within the speed limit.
    pub(super) wish: V,
    /// The way to the goal, finite.
    pub(super) goal: Option<V>,
    pub(super) nearby: &'a [Nearby<V::Scalar>],
    pub(super) obstacles: &'a [Obstacle<V::Scalar>],
}

/// Velocities in the plane ([`Vec2`]) or in space ([`Vec3`]): the geometry of one constraint, linear programming on
/// one border, and the way out of deadlocks. All else is the same in both.
pub trait Dimension: Vector + From<Vec3<<Self as Vector>::Scalar>> {
    /// What the rule against deadlocks remembers from step to step.
    type Memory: Clone + Debug + PartialEq + Serialize;
    /// Nothing to remember yet.
    const FRESH: Self::Memory;

    /// What becomes of obstacles that together leave nothing: whether all they forbid, and what robots forbid, is
    /// violated as little as possible. Otherwise the nearest ones are obeyed as far as they go, and what comes after
    /// them counts no more (as in RVO2).
    const SHARES_CONTRADICTIONS: bool;

    /// The vector in space; in the plane one that is so high.
    fn at_height(self, height: Self::Scalar) -> Vec3<Self::Scalar>;

    /// The velocities that avoid `ball` for the time horizon, if it does its share (ORCA section 4). `None` when an
    /// input makes no sense.
    fn half_space(
        own_velocity_mps: Self,
        ball: &MovingBall<Self>,
        params: &Params<Self::Scalar>,
    ) -> Option<HalfSpace<Self>>;

    /// The best velocity no faster than `speed` on the border of `constraint` that those `before` it permit; `None`
    /// when there is none.
    fn best_on_border(
        constraint: &HalfSpace<Self>,
        before: &[HalfSpace<Self>],
        speed: Self::Scalar,
        aim: Aim<Self>,
    ) -> Option<Self>;

    /// The wish to give to ORCA so that nobody waits for ever.
    fn break_deadlock(
        memory: &mut Self::Memory,
        params: &AvoidParams<Self::Scalar>,
        situation: &Situation<'_, Self>,
        rng: &mut Rng,
    ) -> Self;

    /// Whether that rule made the robot wait for others at a gap.
    fn waits_for_turn(memory: &Self::Memory) -> bool;
}

/// From `w`, relative to the ball's centre, to the ball's border: length of the change and outward
/// normal; `otherwise` is the normal at the centre.
pub(super) fn leave_ball<V: Vector>(w: V, radius: V::Scalar, otherwise: V) -> (V::Scalar, V) {
    let normal = w.normalized().unwrap_or(otherwise);
    (radius - w.norm(), normal)
}
