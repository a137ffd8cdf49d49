//! The constraint of a static obstacle (ORCA section 5.4): a segment; a polygon has several.

use super::dimension::HalfPlane;
use crate::geom::{Vec2, Vec3};
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;

struct Nearest<S> {
    distance: S,
    plane: HalfPlane<S>,
}

/// The velocities that keep a robot of `radius_m` off a wall for `horizon_s` seconds. The wall runs
/// from `ends_m[0]` to `ends_m[1]`, relative to the robot's centre, metres.
///
/// The wall widened by the robot is a capsule C. The velocities that meet it within the horizon are
/// K = {c / t : c in C, 0 < t <= horizon}, a convex set bounded by two tangents from the origin and
/// the near side of C / horizon. The half-plane touches K at the point nearest to the own velocity.
/// A robot that touches or overlaps the wall may not come nearer. RVO2 processes chains of vertices
/// instead of single segments; at a convex corner both segments forbid what the corner would.
///
/// `None` if an input is not finite, or radius or horizon is not above 0. Constant work.
#[must_use]
pub fn wall<S: Scalar>(
    own_velocity_mps: Vec2<S>,
    ends_m: [Vec2<S>; 2],
    radius_m: S,
    horizon_s: S,
) -> Option<HalfPlane<S>> {
    wall_from(own_velocity_mps, ends_m, Obstacle::Wall(ends_m).nearest_point(), radius_m, horizon_s)
}

/// [`wall`], given [`Obstacle::nearest_point`] of the wall.
pub(super) fn wall_from<S: Scalar>(
    own_velocity_mps: Vec2<S>,
    ends_m: [Vec2<S>; 2],
    nearest_point: Option<(Vec3<S>, S)>,
    radius_m: S,
    horizon_s: S,
) -> Option<HalfPlane<S>> {
    let [a, b] = ends_m;
    let v = own_velocity_mps;
    let is_sound = a.is_finite() && b.is_finite() && v.is_finite();
    if !(is_sound && radius_m > S::ZERO && horizon_s > S::ZERO) {
        return None;
    }
    if let Some((foot, distance)) = nearest_point
        && distance <= radius_m
    {
        // On the wall's centre line: to its left.
        let normal = (-foot.xy()).normalized().or_else(|| (b - a).perp().normalized());
        let normal = normal.unwrap_or(Vec2::new(S::ONE, S::ZERO));
        return Some(HalfPlane { point: Vec2::ZERO, normal });
    }
    let (left, right) = if a.det(b) > S::ZERO { (b, a) } else { (a, b) };
    let rate = S::ONE.checked_div(horizon_s)?;
    let (near_left, near_right) = (left * rate, right * rate);
    let reach = radius_m * rate;
    let ends = Tangent::new(left, radius_m, rate).zip(Tangent::new(right, radius_m, rate));
    let leg = |is_left| ends.as_ref().map(|ends| leg(v, ends, is_left));
    let pieces = [
        leg(true),
        leg(false),
        cap(v, near_left, near_right, reach),
        cap(v, near_right, near_left, reach),
        side(v, near_left, near_right, reach),
    ];
    pieces.into_iter().flatten().min_by(|one, other| one.distance.order(other.distance)).map(|nearest| nearest.plane)
}

/// `None` unless the point is on the near side, where the normal points back towards the origin.
fn near_side<S: Scalar>(v: Vec2<S>, point: Vec2<S>, normal: Vec2<S>) -> Option<Nearest<S>> {
    let is_near = normal.dot(point) <= S::ZERO;
    is_near.then(|| Nearest { distance: (v - point).norm(), plane: HalfPlane { point, normal } })
}

fn cap<S: Scalar>(v: Vec2<S>, end: Vec2<S>, other: Vec2<S>, reach: S) -> Option<Nearest<S>> {
    let normal = (v - end).normalized().or_else(|| (-end).normalized())?;
    // Both caps may claim the rounding gap between cap and side.
    let is_beyond = normal.dot(end - other) >= -(S::EPSILON * reach);
    is_beyond.then(|| near_side(v, end + normal * reach, normal)).flatten()
}

fn side<S: Scalar>(v: Vec2<S>, left: Vec2<S>, right: Vec2<S>, reach: S) -> Option<Nearest<S>> {
    let along = (left - right).normalized()?;
    let across = along.perp();
    let normal = if across.dot(left) > S::ZERO { -across } else { across };
    let t = (v - right).dot(along);
    let is_beside = t >= S::ZERO && t <= (left - right).norm();
    is_beside.then(|| near_side(v, right + along * t + normal * reach, normal)).flatten()
}

/// The tangents from the origin to the disc at one end of the wall.
struct Tangent<S> {
    ahead: Vec2<S>,
    sin: S,
    cos: S,
    /// Distance of the point where it touches the disc, divided by the horizon.
    start: S,
}

impl<S: Scalar> Tangent<S> {
    fn new(end: Vec2<S>, radius: S, rate: S) -> Option<Self> {
        let (ahead, distance) = end.unit_and_norm();
        let sin = radius.checked_div(distance)?;
        let cos = (S::ONE - sin * sin).sqrt();
        Some(Self { ahead: ahead?, sin, cos, start: distance * cos * rate })
    }
}

/// A tangent from the origin to the capsule, beyond its near side.
#[inline(never)]
fn leg<S: Scalar>(v: Vec2<S>, (left, right): &(Tangent<S>, Tangent<S>), is_left: bool) -> Nearest<S> {
    // The outermost tangent of the two end discs: seen from outside, one disc may hide the other.
    let tangent = |end: &Tangent<S>| {
        let direction = end.ahead.rotate(end.cos, if is_left { end.sin } else { -end.sin });
        (direction, end.start)
    };
    let (one, other) = (tangent(left), tangent(right));
    let is_outside = one.0.det(other.0) > S::ZERO;
    let (direction, start) = if is_outside == is_left { other } else { one };
    let along = v.dot(direction).max(start);
    let point = direction * along;
    let normal = if is_left { direction.perp() } else { -direction.perp() };
    Nearest { distance: (v - point).norm(), plane: HalfPlane { point, normal } }
}

#[cfg(test)]
mod tests;
