//! Finds the best permitted velocity (ORCA section 5) by incremental linear programming (de Berg et
//! al., "Computational geometry", section 4.4), in the plane and in space.
//!
//! [`optimum`] is RVO2's `linearProgram2` (RVO2-3D: `3`), [`least_penetration`] its
//! `linearProgram3` (`4`); [`Dimension::best_on_border`] is the step on one border.

use super::dimension::{Aim, Dimension, HalfSpace};
use crate::geom::Vector;
use crate::scalar::Scalar;
use heapless::Vec;

/// A chosen velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Solution<V: Vector> {
    /// The velocity, m/s; within the speed limit.
    pub velocity_mps: V,
    /// Penetration of the constraint that it violates most, m/s; 0 if it violates none.
    pub penetration_mps: V::Scalar,
}

impl<V: Dimension> Solution<V> {
    pub(super) fn of(velocity_mps: V, constraints: &[HalfSpace<V>]) -> Self {
        let depths = constraints.iter().map(|one| one.penetration(velocity_mps));
        Self { velocity_mps, penetration_mps: depths.fold(V::Scalar::ZERO, V::Scalar::max) }
    }
}

/// The velocity nearest to `preferred_mps` that all constraints and `max_speed_mps` permit.
///
/// If there is none, the result violates the first `hard` constraints (static obstacles) not at all
/// if possible, and the others as little as possible. If the hard constraints alone forbid every
/// velocity, see [`Dimension::SHARES_CONTRADICTIONS`].
///
/// The result is within rounding of the best; a preferred velocity that is not finite counts as
/// zero. At most `N` constraints count. Work in the plane: O(n) mostly, O(n^2) at worst, O(n^3)
/// without a solution; in space O(n), O(n^3) and O(n^4).
#[must_use]
pub fn solve<V: Dimension, const N: usize>(
    constraints: &[HalfSpace<V>],
    hard: usize,
    preferred_mps: V,
    max_speed_mps: V::Scalar,
) -> Solution<V> {
    let constraints = constraints.get(..N).unwrap_or(constraints);
    let goal = if preferred_mps.is_finite() { preferred_mps } else { V::ZERO };
    match optimum(constraints, max_speed_mps, Aim::Near(goal)) {
        (velocity_mps, None) => Solution { velocity_mps, penetration_mps: V::Scalar::ZERO },
        (start, Some(from)) => {
            let is_torn = from < hard && V::SHARES_CONTRADICTIONS;
            let hard = if is_torn { 0 } else { hard };
            let least = least_penetration::<V, N>(constraints, hard, from, start, max_speed_mps);
            Solution::of(least, constraints)
        }
    }
}

/// Without a permitted velocity, the best before the first impossible constraint, and its index.
fn optimum<V: Dimension>(constraints: &[HalfSpace<V>], speed: V::Scalar, aim: Aim<V>) -> (V, Option<usize>) {
    let mut best = match aim {
        Aim::Near(goal) => goal.clamp_norm(speed),
        Aim::Along(way) => way * speed,
    };
    for (index, constraint) in constraints.iter().enumerate() {
        if constraint.penetration(best) > V::Scalar::ZERO {
            let before = constraints.get(..index).unwrap_or_default();
            match V::best_on_border(constraint, before, speed, aim) {
                Some(better) => best = better,
                None => return (best, Some(index)),
            }
        }
    }
    (best, None)
}

/// From the constraint `from` on, each constraint that is violated more than those before is moved
/// back together with them until a velocity is permitted.
fn least_penetration<V: Dimension, const N: usize>(
    constraints: &[HalfSpace<V>],
    hard: usize,
    from: usize,
    start: V,
    speed: V::Scalar,
) -> V {
    let mut best = start;
    let mut depth = V::Scalar::ZERO;
    for (index, constraint) in constraints.iter().enumerate().skip(from) {
        if constraint.penetration(best) <= depth {
            continue;
        }
        // Velocities that violate this constraint less lie on one side of a bisector.
        let mut bisectors = Vec::<HalfSpace<V>, N>::new();
        for (other_index, other) in constraints.iter().enumerate().take(index) {
            let bisector = if other_index < hard { Some(*other) } else { bisector(constraint, other) };
            if let Some(bisector) = bisector {
                let _ = bisectors.push(bisector);
            }
        }
        // Rounding or contradictory hard constraints: keep the previous result.
        if let (better, None) = optimum(&bisectors, speed, Aim::Along(constraint.normal)) {
            best = better;
        }
        depth = constraint.penetration(best);
    }
    best
}

/// The velocities that violate `other` no more than `one`; `None` if that holds for all.
fn bisector<V: Dimension>(one: &HalfSpace<V>, other: &HalfSpace<V>) -> Option<HalfSpace<V>> {
    // penetration_one(v) >= penetration_other(v) <=> v . (n_o - n) >= c_o - c with c = point . n.
    let (normal, length) = (other.normal - one.normal).unit_and_norm();
    let normal = normal?;
    let offset = other.point.dot(other.normal) - one.point.dot(one.normal);
    let distance = offset.checked_div(length)?;
    Some(HalfSpace { point: normal * distance, normal })
}
