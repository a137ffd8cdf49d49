//! ORCA in space: the half-space of one neighbour (ORCA section 4, whose geometry holds in any
//! dimension), and linear programming on one border (RVO2-3D's `linearProgram2` and `1`).
//!
//! If everything lies in one horizontal plane, the result equals that of the plane. Robots that fly
//! exactly at each other turn right, or to opposite sides if one is above the other (RVO2-3D:
//! undefined).

use super::deadlock::spread;
use super::dimension::{Aim, Dimension, HalfSpace, MovingBall, Situation, leave_ball};
use super::{AvoidParams, Params};
use crate::geom::Vec3;
use crate::rand::Rng;
use crate::scalar::Scalar;

#[cfg(test)]
mod tests;

impl<S: Scalar> Dimension for Vec3<S> {
    type Memory = ();
    const FRESH: Self::Memory = ();
    const SHARES_CONTRADICTIONS: bool = true;

    fn at_height(self, _: S) -> Self {
        self
    }

    fn half_space(own_velocity_mps: Self, ball: &MovingBall<Self>, params: &Params<S>) -> Option<HalfSpace<Self>> {
        half_space(own_velocity_mps, ball, params)
    }

    fn best_on_border(
        constraint: &HalfSpace<Self>,
        before: &[HalfSpace<Self>],
        speed: S,
        aim: Aim<Self>,
    ) -> Option<Self> {
        best_on_plane(constraint, before, speed, aim)
    }

    #[inline(never)] // Its stack is free again for the solver.
    fn break_deadlock(
        _: &mut Self::Memory,
        params: &AvoidParams<S>,
        situation: &Situation<'_, Self>,
        _: &mut Rng,
    ) -> Self {
        // A flock has no goal of its own; the rule would pull it apart.
        match situation.goal {
            Some(_) => spread(params.horizon_s, situation),
            None => situation.wish,
        }
    }

    fn waits_for_turn((): &Self::Memory) -> bool {
        false
    }
}

/// The velocities that avoid a ball for the time horizon if the neighbour does its share: like
/// [`half_plane`](super::half_plane).
///
/// `None` if an input is not finite, or r or a time is not above 0. Constant work.
#[must_use]
pub fn half_space<S: Scalar>(
    own_velocity_mps: Vec3<S>,
    ball: &MovingBall<Vec3<S>>,
    params: &Params<S>,
) -> Option<HalfSpace<Vec3<S>>> {
    let MovingBall { offset_m: p, velocity_mps, radii_m: r, tie } = *ball;
    let v = own_velocity_mps - velocity_mps;
    let times_are_sound = params.horizon_s > S::ZERO && params.separation_s > S::ZERO;
    if !(p.is_finite() && v.is_finite() && r > S::ZERO && times_are_sound) {
        return None;
    }
    let distance = p.norm();
    let (u, normal) = match p.normalized() {
        Some(ahead) if distance > r => {
            let w = v - divided(p, params.horizon_s)?;
            // The angle between the sides of the cone and the line of centres has this sine.
            let sin = r.checked_div(distance)?;
            if w.dot(ahead) < -(sin * w.norm()) {
                leave_ball(w, r.checked_div(params.horizon_s)?, -ahead)
            } else {
                // The side of the cone, in the plane of axis and velocity.
                let cos = (S::ONE - sin * sin).sqrt();
                let side = (w - ahead * w.dot(ahead)).normalized();
                let normal = side.unwrap_or_else(|| right_of(ahead)) * cos - ahead * sin;
                (-(v.dot(normal)), normal)
            }
        }
        _ => {
            let away = (-p).normalized().or_else(|| tie.normalized());
            let away = away.unwrap_or(Vec3::new(S::ONE, S::ZERO, S::ZERO));
            let w = v - divided(p, params.separation_s)?;
            leave_ball(w, r.checked_div(params.separation_s)?, away)
        }
    };
    let point = own_velocity_mps + normal * (u * params.share);
    point.is_finite().then_some(HalfSpace { point, normal })
}

fn divided<S: Scalar>(v: Vec3<S>, by: S) -> Option<Vec3<S>> {
    Some(Vec3::new(v.x.checked_div(by)?, v.y.checked_div(by)?, v.z.checked_div(by)?))
}

/// A unit vector perpendicular to `ahead`, opposite for `-ahead`; to the right if that is defined.
fn right_of<S: Scalar>(ahead: Vec3<S>) -> Vec3<S> {
    let right = Vec3::new(ahead.y, -ahead.x, S::ZERO);
    let east = if ahead.z > S::ZERO { S::ONE } else { -S::ONE };
    let otherwise = Vec3::new(east, S::ZERO, S::ZERO);
    right.normalized().unwrap_or(otherwise)
}

struct Line<S> {
    foot: Vec3<S>,
    direction: Vec3<S>,
}

fn best_on_plane<S: Scalar>(
    space: &HalfSpace<Vec3<S>>,
    before: &[HalfSpace<Vec3<S>>],
    speed: S,
    aim: Aim<Vec3<S>>,
) -> Option<Vec3<S>> {
    let foot = foot(space);
    let radius = half_width(foot, speed)?;
    let in_border = |v: Vec3<S>| v - space.normal * v.dot(space.normal);
    let mut best = foot
        + match aim {
            Aim::Near(goal) => in_border(goal - foot).clamp_norm(radius),
            // Perpendicular to the border, all its points are equally good. If little of the
            // direction remains in the border, rounding has turned it out: project it back.
            Aim::Along(way) => in_border(in_border(way).normalized().unwrap_or(Vec3::ZERO)) * radius,
        };
    for (index, other) in before.iter().enumerate() {
        if other.penetration(best) > S::ZERO {
            let line = intersection(space, other)?;
            let before = before.get(..index).unwrap_or_default();
            best = best_on_line(&line, before, speed, aim)?;
        }
    }
    Some(best)
}

fn best_on_line<S: Scalar>(
    line: &Line<S>,
    before: &[HalfSpace<Vec3<S>>],
    speed: S,
    aim: Aim<Vec3<S>>,
) -> Option<Vec3<S>> {
    let half_chord = half_width(line.foot, speed)?;
    let (mut low, mut high) = (-half_chord, half_chord);
    for other in before {
        let slope = line.direction.dot(other.normal);
        let gap = other.penetration(line.foot);
        match gap.checked_div(slope) {
            Some(t) if slope.abs() > S::EPSILON => {
                if slope > S::ZERO {
                    low = low.max(t);
                } else {
                    high = high.min(t);
                }
            }
            _ if gap > S::ZERO => return None,
            _ => {}
        }
        if low > high {
            return None;
        }
    }
    let t = match aim {
        Aim::Near(goal) => (goal - line.foot).dot(line.direction).clamp(low, high),
        Aim::Along(way) if way.dot(line.direction) > S::ZERO => high,
        Aim::Along(_) => low,
    };
    Some(line.foot + line.direction * t)
}

fn foot<S: Scalar>(space: &HalfSpace<Vec3<S>>) -> Vec3<S> {
    space.normal * space.point.dot(space.normal)
}

/// Half the width that the speed ball cuts out of a line or plane with this `foot`.
fn half_width<S: Scalar>(foot: Vec3<S>, speed: S) -> Option<S> {
    let distance = foot.norm();
    (distance <= speed).then(|| ((speed - distance) * (speed + distance)).sqrt())
}

fn intersection<S: Scalar>(space: &HalfSpace<Vec3<S>>, other: &HalfSpace<Vec3<S>>) -> Option<Line<S>> {
    let cross = space.normal.cross(other.normal);
    // The intersection of nearly parallel borders has a direction that is mere rounding.
    if cross.norm_squared() <= S::EPSILON {
        return None;
    }
    let direction = cross.normalized()?;
    let across = direction.cross(space.normal);
    let foot = foot(space);
    let t = other.penetration(foot).checked_div(across.dot(other.normal))?;
    let point = foot + across * t;
    Some(Line { foot: point - direction * point.dot(direction), direction })
}
