//! What is left (ORCA section 5): incremental linear programming in the plane (de Berg et al., "Computational
//! geometry", section 4.4), as `lp1`, `lp2` and `lp3` of the reference work.

use super::HalfPlane;
use crate::geom::Vec2;
use crate::scalar::Scalar;
use heapless::Vec;

/// A chosen velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<S> {
    /// The velocity, m/s: within the speed limit.
    pub velocity_mps: Vec2<S>,
    /// How far it lies on the forbidden side of the half-plane that it violates most, m/s; 0 when it
    /// violates none.
    pub penetration_mps: S,
}

/// What to optimise: the point nearest to a goal, or the farthest in a direction.
#[derive(Clone, Copy)]
enum Aim<S> {
    Near(Vec2<S>),
    Along(Vec2<S>),
}

/// The velocity nearest to `preferred_mps` that all half-planes permit and that is no faster than
/// `max_speed_mps`; if there is none, the one that violates the `hard` first half-planes (static
/// obstacles) not at all if possible, and the others as little as possible.
///
/// Result within rounding of the best; a preferred velocity that is not finite counts as zero. Work: O(n^2) in the worst case, O(n) for most; n^3 when there is no solution. At most `N`
/// half-planes count.
#[must_use]
pub fn solve<S: Scalar, const N: usize>(
    planes: &[HalfPlane<S>],
    hard: usize,
    preferred_mps: Vec2<S>,
    max_speed_mps: S,
) -> Solution<S> {
    let planes = planes.get(..N).unwrap_or(planes);
    let goal = if preferred_mps.is_finite() {
        preferred_mps
    } else {
        Vec2::ZERO
    };
    let (velocity, failed) = lp2(planes, max_speed_mps, Aim::Near(goal));
    let Some(at) = failed else {
        return Solution {
            velocity_mps: velocity,
            penetration_mps: S::ZERO,
        };
    };
    let velocity = lp3::<S, N>(planes, hard, at, velocity, max_speed_mps);
    let worst = planes
        .iter()
        .map(|plane| plane.penetration(velocity))
        .fold(S::ZERO, S::max);
    Solution {
        velocity_mps: velocity,
        penetration_mps: worst,
    }
}

/// The best velocity on the border of `planes[at]` that the planes before it and the speed disc permit.
fn lp1<S: Scalar>(
    before: &[HalfPlane<S>],
    plane: &HalfPlane<S>,
    speed: S,
    aim: Aim<S>,
) -> Option<Vec2<S>> {
    let direction = plane.direction();
    // The border's point nearest to the origin, and half of the chord that the disc cuts out.
    let distance = plane.point.dot(plane.normal);
    let foot = plane.normal * distance;
    if distance.abs() > speed {
        return None;
    }
    let half_chord = ((speed - distance) * (speed + distance)).sqrt();
    let (mut low, mut high) = (-half_chord, half_chord);
    // Choices instead of branches: which side a plane cuts off, no predictor can know.
    let mut is_shut = false;
    for other in before {
        let slope = direction.dot(other.normal);
        let gap = other.penetration(foot);
        let crossing = gap.checked_div(slope);
        let t = crossing.unwrap_or(S::ZERO);
        let is_crossed = crossing.is_some() & (slope.abs() > S::EPSILON * S::from_i32(64));
        // Parallel: all of the border is permitted, or nothing. What rounding leaves between two copies of one
        // half-plane (walls that share a corner) is not nothing.
        is_shut |= !is_crossed & (gap > rounding(speed, other));
        let rises = slope > S::ZERO;
        low = if is_crossed & rises & (t > low) {
            t
        } else {
            low
        };
        high = if is_crossed & !rises & (t < high) {
            t
        } else {
            high
        };
    }
    if is_shut || low > high {
        return None;
    }
    let t = match aim {
        Aim::Near(goal) => (goal - foot).dot(direction).clamp(low, high),
        Aim::Along(way) if way.dot(direction) > S::ZERO => high,
        Aim::Along(_) => low,
    };
    Some(foot + direction * t)
}

/// How far off a penetration may be by rounding.
fn rounding<S: Scalar>(speed: S, plane: &HalfPlane<S>) -> S {
    let scale = speed + plane.point.x.abs() + plane.point.y.abs();
    S::EPSILON * S::from_i32(16) * scale.max(S::ONE)
}

/// The best velocity that all planes and the speed disc permit, or the best for those before the first
/// plane that leaves nothing, with that plane's index.
fn lp2<S: Scalar>(planes: &[HalfPlane<S>], speed: S, aim: Aim<S>) -> (Vec2<S>, Option<usize>) {
    let mut best = match aim {
        Aim::Near(goal) => goal.clamp_norm(speed),
        Aim::Along(way) => way * speed,
    };
    for (index, plane) in planes.iter().enumerate() {
        if plane.penetration(best) > S::ZERO {
            let before = planes.get(..index).unwrap_or_default();
            match lp1(before, plane, speed, aim) {
                Some(better) => best = better,
                None => return (best, Some(index)),
            }
        }
    }
    (best, None)
}

/// The velocity of least penetration: from the plane `from` on, each plane that is violated more than
/// those before is moved back together with them until a velocity is left.
fn lp3<S: Scalar, const N: usize>(
    planes: &[HalfPlane<S>],
    hard: usize,
    from: usize,
    start: Vec2<S>,
    speed: S,
) -> Vec2<S> {
    let mut best = start;
    let mut depth = S::ZERO;
    for (index, plane) in planes.iter().enumerate().skip(from) {
        if plane.penetration(best) <= depth {
            continue;
        }
        // Velocities that violate this plane no more than another one lie on one side of their bisector.
        let mut bisectors = Vec::<HalfPlane<S>, N>::new();
        for (other_index, other) in planes.iter().enumerate().take(index) {
            let bisector = if other_index < hard {
                Some(*other)
            } else {
                bisector(plane, other)
            };
            if let Some(bisector) = bisector {
                // As many places as planes.
                let _ = bisectors.push(bisector);
            }
        }
        // A failure here is one of rounding: what was found before stays.
        if let (better, None) = lp2(&bisectors, speed, Aim::Along(plane.normal)) {
            best = better;
        }
        depth = plane.penetration(best);
    }
    best
}

/// The half-plane of velocities that violate `other` no more than `plane`; `None` when that is everything.
fn bisector<S: Scalar>(plane: &HalfPlane<S>, other: &HalfPlane<S>) -> Option<HalfPlane<S>> {
    // penetration_plane(v) >= penetration_other(v)  <=>  v . (n_o - n_p) >= c_o - c_p with c = point . n.
    let normal = (other.normal - plane.normal).normalized()?;
    let difference = other.normal - plane.normal;
    let offset = other.point.dot(other.normal) - plane.point.dot(plane.normal);
    let distance = offset.checked_div(difference.norm())?;
    Some(HalfPlane {
        point: normal * distance,
        normal,
    })
}
