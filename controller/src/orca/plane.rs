//! ORCA in the plane: the half-plane of one neighbour (ORCA section 4; Tolok et al., the functional
//! voxel model, FVM, eqs. 6 to 13), and linear programming on one border (RVO2's `linearProgram1`).

use super::deadlock::{Course, Patience, RightOfWay, around, lean};
use super::dimension::{Aim, Dimension, HalfPlane, HalfSpace, MovingBall, Situation, leave_ball};
use super::{AvoidParams, Params};
use crate::geom::{Vec2, Vec3};
use crate::rand::Rng;
use crate::scalar::Scalar;

impl<S: Scalar> Dimension for Vec2<S> {
    type Memory = (RightOfWay<S>, Patience<S>, Course<S>);
    const FRESH: Self::Memory = (RightOfWay::NEW, Patience::NEW, Course::NEW);
    const SHARES_CONTRADICTIONS: bool = false;

    fn at_height(self, height: S) -> Vec3<S> {
        self.extend(height)
    }

    #[inline]
    fn half_space(own_velocity_mps: Self, ball: &MovingBall<Self>, params: &Params<S>) -> Option<HalfSpace<Self>> {
        half_plane(own_velocity_mps, ball, params)
    }

    fn best_on_border(
        constraint: &HalfSpace<Self>,
        before: &[HalfSpace<Self>],
        speed: S,
        aim: Aim<Self>,
    ) -> Option<Self> {
        best_on_line(constraint, before, speed, aim)
    }

    /// In narrow places robots take turns; elsewhere they pass on the right or back off.
    #[inline(never)] // Its stack is free again for the solver.
    fn break_deadlock(
        memory: &mut Self::Memory,
        params: &AvoidParams<S>,
        situation: &Situation<'_, Self>,
        rng: &mut Rng,
    ) -> Self {
        let Some(goal) = situation.goal else {
            return situation.wish;
        };
        let (right_of_way, stuck, course) = memory;
        let patience = params.deadlock.patience_radii;
        let at_gap = right_of_way.wish(situation, goal, patience, rng);
        let wish = at_gap.unwrap_or_else(|| {
            let wish = around(course, situation, goal);
            lean(params, &Situation { wish, ..*situation }, goal)
        });
        // A robot that waits for its turn must not back off: its turn comes.
        if right_of_way.takes_turns() {
            *stuck = Patience::NEW;
            return wish;
        }
        stuck.wish(situation, wish, patience, rng)
    }

    fn waits_for_turn(memory: &Self::Memory) -> bool {
        memory.0.waits()
    }
}

/// The velocities that avoid a disc for the time horizon if the neighbour does its share.
///
/// The truncated velocity obstacle of relative velocities is a cone whose tip is cut off by the
/// disc of radius r / tau around p / tau. The least change u moves the relative velocity to its
/// border. The border of the half-plane passes through the own velocity plus the own share of u.
///
/// `None` if an input is not finite, or r or a time is not above 0. Constant work.
#[must_use]
#[inline]
pub fn half_plane<S: Scalar>(
    own_velocity_mps: Vec2<S>,
    disc: &MovingBall<Vec2<S>>,
    params: &Params<S>,
) -> Option<HalfPlane<S>> {
    let MovingBall { offset_m: p, velocity_mps, radii_m: r, tie } = *disc;
    let v = own_velocity_mps - velocity_mps;
    if r <= S::ZERO {
        return None;
    }
    let squared = p.norm_squared();
    let is_plain = squared > r * r && squared > tiny() && squared < S::MAX;
    // Values that are not finite propagate, and are rejected at the end.
    let (u, normal) = if S::IS_FLOATING && is_plain {
        let rate = S::ONE.checked_div(params.horizon_s)?;
        leave_cone(v, p, squared, r, rate)?
    } else if !(p.is_finite() && v.is_finite() && r.is_finite()) {
        return None;
    } else {
        match p.normalized() {
            // With floating-point numbers, only discs that touch within rounding reach this branch.
            Some(ahead) if !S::IS_FLOATING && p.norm() > r => leave_cone_by_angle(v, p, ahead, r, params.horizon_s)?,
            _ => {
                // Overlapping: separate, directly if no other direction follows.
                let tip = Vec2::new(p.x.checked_div(params.separation_s)?, p.y.checked_div(params.separation_s)?);
                let away = (-p).normalized().or_else(|| tie.normalized());
                let away = away.unwrap_or(Vec2::new(S::ONE, S::ZERO));
                leave_ball(v - tip, r.checked_div(params.separation_s)?, away)
            }
        }
    };
    let point = own_velocity_mps + normal * (u * params.share);
    point.is_finite().then_some(HalfPlane { point, normal })
}

/// Length and outward normal of the change from the relative velocity `v` to the border of the cone
/// around `p` (with its squared length) whose tip is cut off at `rate` times `p`.
///
/// It selects values instead of branching, since a branch predictor cannot know which border is the
/// nearest. Squares must be as precise as lengths.
#[inline(always)]
fn leave_cone<S: Scalar>(v: Vec2<S>, p: Vec2<S>, squared: S, r: S, rate: S) -> Option<(S, Vec2<S>)> {
    let w = v - p * rate;
    let (w_squared, towards) = (w.norm_squared(), w.dot(p));
    // Project on the cut-off disc: w points back by more than the angle to the legs.
    let is_back = (towards < S::ZERO) & (towards * towards > r * r * w_squared);
    let is_disc = is_back & (w_squared > tiny());
    let choose = |disc: S, leg: S| if is_disc { disc } else { leg };
    let root = choose(w_squared, squared - r * r).sqrt();
    // Left or right leg: the tangent is p turned by the angle with this sine and cosine.
    let signed = if p.det(w) > S::ZERO { root } else { -root };
    let across = Vec2::new(choose(w.x, -(p.y * signed + p.x * r)), choose(w.y, p.x * signed - p.y * r));
    let scale = S::ONE.checked_div(choose(root, squared))?;
    let normal = across * scale;
    Some((choose(r * rate - root, -(v.dot(normal))), normal))
}

/// A square so small that vectors shorter than its root (f32: 1e-14) have no direction.
fn tiny<S: Scalar>() -> S {
    let squared = S::EPSILON * S::EPSILON;
    squared * squared
}

/// Like [`leave_cone`], by unit vectors and angles, for numbers whose squares lose precision.
fn leave_cone_by_angle<S: Scalar>(v: Vec2<S>, p: Vec2<S>, ahead: Vec2<S>, r: S, horizon_s: S) -> Option<(S, Vec2<S>)> {
    let tip = Vec2::new(p.x.checked_div(horizon_s)?, p.y.checked_div(horizon_s)?);
    let w = v - tip;
    let sin = r.checked_div(p.norm())?;
    if w.dot(ahead) < -(sin * w.norm()) {
        return Some(leave_ball(w, r.checked_div(horizon_s)?, -ahead));
    }
    let cos = (S::ONE - sin * sin).sqrt();
    let normal = if ahead.det(w) > S::ZERO { ahead.rotate(cos, sin).perp() } else { -ahead.rotate(cos, -sin).perp() };
    Some((-(v.dot(normal)), normal))
}

fn best_on_line<S: Scalar>(
    plane: &HalfPlane<S>,
    before: &[HalfPlane<S>],
    speed: S,
    aim: Aim<Vec2<S>>,
) -> Option<Vec2<S>> {
    let direction = plane.direction();
    let distance = plane.point.dot(plane.normal);
    let foot = plane.normal * distance;
    if distance.abs() > speed {
        return None;
    }
    let half_chord = ((speed - distance) * (speed + distance)).sqrt();
    let (mut low, mut high) = (-half_chord, half_chord);
    let steep = S::EPSILON * S::from_i32(64);
    for other in before {
        let slope = direction.dot(other.normal);
        let gap = other.penetration(foot);
        let rises = slope > steep;
        if (rises || slope < -steep)
            && let Some(t) = gap.checked_div(slope)
        {
            if rises {
                low = if t > low { t } else { low };
            } else {
                high = if t < high { t } else { high };
            }
        } else if gap > rounding(speed, other) {
            // Parallel. Rounding between copies of one half-plane must not exclude the border.
            return None;
        }
    }
    if low > high {
        return None;
    }
    let t = match aim {
        Aim::Near(goal) => (goal - foot).dot(direction).clamp(low, high),
        Aim::Along(way) if way.dot(direction) > S::ZERO => high,
        Aim::Along(_) => low,
    };
    Some(foot + direction * t)
}

fn rounding<S: Scalar>(speed: S, plane: &HalfPlane<S>) -> S {
    let scale = speed + plane.point.x.abs() + plane.point.y.abs();
    S::EPSILON * S::from_i32(16) * scale.max(S::ONE)
}

#[cfg(test)]
mod tests;
