//! The same in space, for robots that fly: what a neighbour and an obstacle forbid is a half-space, and what is
//! left is found by one more step of linear programming.
//!
//! Source: van den Berg et al. 2011 (ORCA), sections 4 and 5, whose geometry holds in any dimension; the steps
//! [`solve`] takes as in RVO2-3D: `lp1` on a line, `lp2` in a plane, `lp3` in space, `lp4` for the
//! least penetration.
//!
//! Everything is relative to the robot. Where all robots, velocities and the preference lie in one
//! horizontal plane, so does the result, and it is that of the plane.
//! What differs from RVO2-3D is what differs in the plane (see [`super`]), and that two robots that fly
//! exactly at each other turn right, or if one is above the other, to opposite sides, where the reference
//! has no direction.

use super::{Params, wall};
use crate::geom::Vec3;
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use heapless::Vec;

#[cfg(test)]
mod tests;

/// Velocities v with (v - point) . normal >= 0 are permitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace<S> {
    /// A point of its border, m/s.
    pub point: Vec3<S>,
    /// Unit vector into the permitted side.
    pub normal: Vec3<S>,
}

impl<S: Scalar> HalfSpace<S> {
    /// How far `velocity` lies on the forbidden side, m/s; negative on the permitted one.
    #[must_use]
    pub fn penetration(&self, velocity: Vec3<S>) -> S {
        (self.point - velocity).dot(self.normal)
    }

    /// The border's point nearest to the origin.
    fn foot(&self) -> Vec3<S> {
        self.normal * self.point.dot(self.normal)
    }
}

/// A ball to keep clear of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor<S> {
    /// Its centre minus the own one, metres.
    pub offset_m: Vec3<S>,
    /// Its velocity, m/s.
    pub velocity_mps: Vec3<S>,
    /// Sum of both radii, metres; more than 0.
    pub radii_m: S,
    /// Which way to go when both are in the same place with the same velocity: any vector, the
    /// opposite one on the other robot. East when zero.
    pub tie: Vec3<S>,
}

/// A chosen velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<S> {
    /// The velocity, m/s: within the speed limit.
    pub velocity_mps: Vec3<S>,
    /// How far it lies on the forbidden side of the half-space that it violates most, m/s; 0 when it
    /// violates none.
    pub penetration_mps: S,
}

/// The velocities that avoid a neighbour for the time horizon, if it does its share: as
/// [`super::half_plane`], with a ball for the disc.
///
/// `None` when an input is not finite, or r or a time is not above 0. Constant work.
#[must_use]
pub fn half_space<S: Scalar>(
    own_velocity_mps: Vec3<S>,
    neighbor: &Neighbor<S>,
    params: &Params<S>,
) -> Option<HalfSpace<S>> {
    let Neighbor {
        offset_m: p,
        velocity_mps,
        radii_m: r,
        tie,
    } = *neighbor;
    let v = own_velocity_mps - velocity_mps;
    let times_are_sound = params.horizon_s > S::ZERO && params.separation_s > S::ZERO;
    if !(p.is_finite() && v.is_finite() && r > S::ZERO && times_are_sound) {
        return None;
    }
    let distance = p.norm();
    let (u, normal) = match p.normalized() {
        Some(ahead) if distance > r => {
            let w = v - divided(p, params.horizon_s)?;
            // The cone's sides leave the line of centres at the angle with this sine.
            let sin = r.checked_div(distance)?;
            if w.dot(ahead) < -(sin * w.norm()) {
                // Nearest to the cut-off ball.
                leave_ball(w, r.checked_div(params.horizon_s)?, -ahead)
            } else {
                // Nearest to the cone's side, on the own side of its axis: what follows happens in
                // the plane of axis and velocity.
                let cos = (S::ONE - sin * sin).sqrt();
                let side = (w - ahead * w.dot(ahead)).normalized();
                let normal = side.unwrap_or_else(|| right_of(ahead)) * cos - ahead * sin;
                (-(v.dot(normal)), normal)
            }
        }
        _ => {
            // Overlapping: apart again after the separation time.
            let away = (-p).normalized().or_else(|| tie.normalized());
            let away = away.unwrap_or(Vec3::new(S::ONE, S::ZERO, S::ZERO));
            let w = v - divided(p, params.separation_s)?;
            leave_ball(w, r.checked_div(params.separation_s)?, away)
        }
    };
    let point = own_velocity_mps + normal * (u * params.share);
    point.is_finite().then_some(HalfSpace { point, normal })
}

/// The velocities that keep a robot of `radius_m` off an obstacle for `horizon_s` seconds. Obstacles do nothing to
/// avoid, so the whole correction is the robot's; one that touches or overlaps may not come nearer.
///
/// Walls are upright and have no top: only the horizontal velocity counts.
///
/// `None` when an input is not finite, or a radius or the horizon is not above 0. Constant work.
#[must_use]
pub fn obstacle<S: Scalar>(
    own_velocity_mps: Vec3<S>,
    obstacle: &Obstacle<S>,
    radius_m: S,
    horizon_s: S,
) -> Option<HalfSpace<S>> {
    if !(own_velocity_mps.is_finite() && radius_m > S::ZERO && horizon_s > S::ZERO) {
        return None;
    }
    match *obstacle {
        Obstacle::Wall(ends_m) => {
            let plane = wall(own_velocity_mps.xy(), ends_m, radius_m, horizon_s)?;
            Some(HalfSpace {
                point: plane.point.extend(S::ZERO),
                normal: plane.normal.extend(S::ZERO),
            })
        }
        Obstacle::Ball {
            center_m,
            radius_m: ball_m,
        } => {
            let radii_m = radius_m + ball_m;
            if !(center_m.is_finite() && ball_m > S::ZERO && radii_m.is_finite()) {
                return None;
            }
            if center_m.norm() <= radii_m {
                // In the very centre: up.
                let up = Vec3::new(S::ZERO, S::ZERO, S::ONE);
                return Some(HalfSpace {
                    point: Vec3::ZERO,
                    normal: (-center_m).normalized().unwrap_or(up),
                });
            }
            let neighbor = Neighbor {
                offset_m: center_m,
                velocity_mps: Vec3::ZERO,
                radii_m,
                tie: Vec3::ZERO,
            };
            let params = Params {
                horizon_s,
                separation_s: horizon_s,
                share: S::ONE,
            };
            half_space(own_velocity_mps, &neighbor, &params)
        }
        Obstacle::Plane { normal, distance_m } => {
            let gap = (distance_m - radius_m).max(S::ZERO);
            let normal = normal.normalized()?;
            let point = -normal * gap.checked_div(horizon_s)?;
            point.is_finite().then_some(HalfSpace { point, normal })
        }
    }
}

fn divided<S: Scalar>(v: Vec3<S>, by: S) -> Option<Vec3<S>> {
    Some(Vec3::new(
        v.x.checked_div(by)?,
        v.y.checked_div(by)?,
        v.z.checked_div(by)?,
    ))
}

/// A unit vector square to `ahead`; that of `-ahead` is the opposite one. To the right where there is a right.
fn right_of<S: Scalar>(ahead: Vec3<S>) -> Vec3<S> {
    let right = Vec3::new(ahead.y, -ahead.x, S::ZERO);
    let east = if ahead.z > S::ZERO { S::ONE } else { -S::ONE };
    let otherwise = Vec3::new(east, S::ZERO, S::ZERO);
    right.normalized().unwrap_or(otherwise)
}

/// From `w`, relative to the ball's centre, to the ball's border: length of the change and outward
/// normal; `otherwise` is the normal at the centre.
fn leave_ball<S: Scalar>(w: Vec3<S>, radius: S, otherwise: Vec3<S>) -> (S, Vec3<S>) {
    let normal = w.normalized().unwrap_or(otherwise);
    (radius - w.norm(), normal)
}

/// What to optimise: the point nearest to a goal, or the farthest in a direction.
#[derive(Clone, Copy)]
enum Aim<S> {
    Near(Vec3<S>),
    Along(Vec3<S>),
}

/// A line in space.
struct Line<S> {
    /// Its point nearest to the origin.
    foot: Vec3<S>,
    /// Unit vector.
    direction: Vec3<S>,
}

/// The velocity nearest to `preferred_mps` that all half-spaces permit and that is no faster than
/// `max_speed_mps`; if there is none, the one that violates the `hard` first half-spaces (static
/// obstacles) not at all if possible, and the others as little as possible. If the hard ones alone leave nothing,
/// all are violated as little as possible.
///
/// Result within rounding of the best; a preferred velocity that is not finite counts as zero. Work: O(n) for most,
/// O(n^3) in the worst case; n^4 when there is no solution. At most `N` half-spaces count.
#[must_use]
pub fn solve<S: Scalar, const N: usize>(
    spaces: &[HalfSpace<S>],
    hard: usize,
    preferred_mps: Vec3<S>,
    max_speed_mps: S,
) -> Solution<S> {
    let spaces = spaces.get(..N).unwrap_or(spaces);
    let goal = if preferred_mps.is_finite() {
        preferred_mps
    } else {
        Vec3::ZERO
    };
    let (velocity, failed) = lp3(spaces, max_speed_mps, Aim::Near(goal));
    let velocity = match failed {
        None => velocity,
        Some(at) => {
            let hard = if at < hard { 0 } else { hard };
            lp4::<S, N>(spaces, hard, at, velocity, max_speed_mps)
        }
    };
    let worst = spaces
        .iter()
        .map(|space| space.penetration(velocity))
        .fold(S::ZERO, S::max);
    Solution {
        velocity_mps: velocity,
        penetration_mps: worst,
    }
}

/// The best velocity on a line that the half-spaces and the speed ball permit.
fn lp1<S: Scalar>(
    before: &[HalfSpace<S>],
    line: &Line<S>,
    speed: S,
    aim: Aim<S>,
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
            // Parallel: all of the line is permitted, or nothing.
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

/// The best velocity on the border of `space` that the half-spaces before it and the speed ball permit.
fn lp2<S: Scalar>(
    before: &[HalfSpace<S>],
    space: &HalfSpace<S>,
    speed: S,
    aim: Aim<S>,
) -> Option<Vec3<S>> {
    let foot = space.foot();
    let radius = half_width(foot, speed)?;
    let in_border = |v: Vec3<S>| v - space.normal * v.dot(space.normal);
    let mut best = foot
        + match aim {
            Aim::Near(goal) => in_border(goal - foot).clamp_norm(radius),
            // Square to the border everything on it is equally good.
            Aim::Along(way) => in_border(way).normalized().unwrap_or(Vec3::ZERO) * radius,
        };
    for (index, other) in before.iter().enumerate() {
        if other.penetration(best) > S::ZERO {
            let line = intersection(space, other)?;
            let before = before.get(..index).unwrap_or_default();
            best = lp1(before, &line, speed, aim)?;
        }
    }
    Some(best)
}

/// The best velocity that all half-spaces and the speed ball permit, or the best for those before the
/// first one that leaves nothing, with that one's index.
fn lp3<S: Scalar>(spaces: &[HalfSpace<S>], speed: S, aim: Aim<S>) -> (Vec3<S>, Option<usize>) {
    let mut best = match aim {
        Aim::Near(goal) => goal.clamp_norm(speed),
        Aim::Along(way) => way * speed,
    };
    for (index, space) in spaces.iter().enumerate() {
        if space.penetration(best) > S::ZERO {
            let before = spaces.get(..index).unwrap_or_default();
            match lp2(before, space, speed, aim) {
                Some(better) => best = better,
                None => return (best, Some(index)),
            }
        }
    }
    (best, None)
}

/// The velocity of least penetration: from the half-space `from` on, each one that is violated more than
/// those before is moved back together with them until a velocity is left.
fn lp4<S: Scalar, const N: usize>(
    spaces: &[HalfSpace<S>],
    hard: usize,
    from: usize,
    start: Vec3<S>,
    speed: S,
) -> Vec3<S> {
    let mut best = start;
    let mut depth = S::ZERO;
    for (index, space) in spaces.iter().enumerate().skip(from) {
        if space.penetration(best) <= depth {
            continue;
        }
        // Velocities that violate this one no more than another lie on one side of their bisector.
        let mut bisectors = Vec::<HalfSpace<S>, N>::new();
        for (other_index, other) in spaces.iter().enumerate().take(index) {
            let bisector = if other_index < hard {
                Some(*other)
            } else {
                bisector(space, other)
            };
            if let Some(bisector) = bisector {
                // As many places as half-spaces.
                let _ = bisectors.push(bisector);
            }
        }
        // A failure here is one of rounding: what was found before stays.
        if let (better, None) = lp3(&bisectors, speed, Aim::Along(space.normal)) {
            best = better;
        }
        depth = space.penetration(best);
    }
    best
}

/// Half the width of what the speed ball cuts out of a line or plane whose point nearest to the origin is
/// `foot`; `None` when it is out of reach.
fn half_width<S: Scalar>(foot: Vec3<S>, speed: S) -> Option<S> {
    let distance = foot.norm();
    (distance <= speed).then(|| ((speed - distance) * (speed + distance)).sqrt())
}

/// Where two borders meet; `None` when they are parallel.
fn intersection<S: Scalar>(space: &HalfSpace<S>, other: &HalfSpace<S>) -> Option<Line<S>> {
    let cross = space.normal.cross(other.normal);
    // Nearly parallel borders meet along a line whose direction is rounding.
    if cross.norm_squared() <= S::EPSILON {
        return None;
    }
    let direction = cross.normalized()?;
    // On the one border, square to the line, until the other one.
    let across = direction.cross(space.normal);
    let foot = space.foot();
    let t = other
        .penetration(foot)
        .checked_div(across.dot(other.normal))?;
    let point = foot + across * t;
    Some(Line {
        foot: point - direction * point.dot(direction),
        direction,
    })
}

/// The half-space of velocities that violate `other` no more than `space`; `None` when that is everything.
fn bisector<S: Scalar>(space: &HalfSpace<S>, other: &HalfSpace<S>) -> Option<HalfSpace<S>> {
    let difference = other.normal - space.normal;
    let normal = difference.normalized()?;
    let offset = other.point.dot(other.normal) - space.point.dot(space.normal);
    let distance = offset.checked_div(difference.norm())?;
    Some(HalfSpace {
        point: normal * distance,
        normal,
    })
}
