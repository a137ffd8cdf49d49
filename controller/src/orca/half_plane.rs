//! What one neighbour forbids (ORCA section 4; FVM eqs. 6 to 13).

use crate::geom::Vec2;
use crate::scalar::Scalar;

/// Velocities v with (v - point) . normal >= 0 are permitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPlane<S> {
    /// A point of its border, m/s.
    pub point: Vec2<S>,
    /// Unit vector into the permitted side.
    pub normal: Vec2<S>,
}

impl<S: Scalar> HalfPlane<S> {
    /// How far `velocity` lies on the forbidden side, m/s; negative on the permitted one.
    #[must_use]
    pub fn penetration(&self, velocity: Vec2<S>) -> S {
        (self.point - velocity).dot(self.normal)
    }

    /// Unit vector along the border, the permitted side to its left.
    #[must_use]
    pub fn direction(&self) -> Vec2<S> {
        Vec2::new(self.normal.y, -self.normal.x)
    }
}

/// A disc to keep clear of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor<S> {
    /// Its centre minus the own one, metres.
    pub offset_m: Vec2<S>,
    /// Its velocity, m/s.
    pub velocity_mps: Vec2<S>,
    /// Sum of both radii, metres; more than 0.
    pub radii_m: S,
    /// Which way to go when both are in the same place with the same velocity: any vector, the
    /// opposite one on the other robot. East when zero.
    pub tie: Vec2<S>,
}

/// Parameters of avoidance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params<S> {
    /// Time ahead for which no collision may happen, seconds (tau); more than 0. Longer gives way earlier
    /// and slows everybody in a crowd.
    pub horizon_s: S,
    /// Time in which robots that overlap must be apart, seconds; more than 0. The step of control: shorter
    /// demands speeds that nobody has.
    pub separation_s: S,
    /// Own share of the correction: 1/2 when the other one does the same (ORCA), 1 when it does
    /// nothing (FVM's example). Below 1/2 both together do not avoid.
    pub share: S,
}

/// The velocities that avoid a neighbour for the time horizon, if it does its share.
///
/// The truncated velocity obstacle VO of relative velocities is a cone with its tip cut off by the disc of
/// radius r / tau around p / tau. The least change u brings the relative velocity to its border; the
/// half-plane lies at the own velocity plus the own share of u.
///
/// `None` when an input is not finite, or r or a time is not above 0. Constant work.
#[must_use]
#[inline]
pub fn half_plane<S: Scalar>(
    own_velocity_mps: Vec2<S>,
    neighbor: &Neighbor<S>,
    params: &Params<S>,
) -> Option<HalfPlane<S>> {
    let Neighbor {
        offset_m: p,
        velocity_mps,
        radii_m: r,
        tie,
    } = *neighbor;
    let v = own_velocity_mps - velocity_mps;
    if r <= S::ZERO {
        return None;
    }
    let squared = p.norm_squared();
    let is_plain = squared > r * r && squared > tiny() && squared < S::MAX;
    // What is not finite comes out as such, and is refused at the end.
    let (u, normal) = if S::IS_FLOATING && is_plain {
        let rate = S::ONE.checked_div(params.horizon_s)?;
        leave_cone(v, p, squared, r, rate)?
    } else if !(p.is_finite() && v.is_finite() && r.is_finite()) {
        return None;
    } else {
        match p.normalized() {
            Some(ahead) if p.norm() > r => leave_cone_by_angle(v, p, ahead, r, params.horizon_s)?,
            _ => {
                // Overlapping: apart again after the separation time, straight away from each other if
                // nothing else says where to.
                let tip = Vec2::new(
                    p.x.checked_div(params.separation_s)?,
                    p.y.checked_div(params.separation_s)?,
                );
                let away = (-p).normalized().or_else(|| tie.normalized());
                let away = away.unwrap_or(Vec2::new(S::ONE, S::ZERO));
                leave_disc(v - tip, r.checked_div(params.separation_s)?, away)
            }
        }
    };
    let point = own_velocity_mps + normal * (u * params.share);
    point.is_finite().then_some(HalfPlane { point, normal })
}

/// From the relative velocity `v` to the border of the cone to `p` (its squared length given) with its tip cut off
/// at `rate` times `p`: length of the change and outward normal.
///
/// One root and one reciprocal, and choices instead of branches: whether the disc or a leg is nearer, and which leg, no
/// branch predictor can know. Squares must be as precise as lengths.
#[inline(always)]
fn leave_cone<S: Scalar>(
    v: Vec2<S>,
    p: Vec2<S>,
    squared: S,
    r: S,
    rate: S,
) -> Option<(S, Vec2<S>)> {
    let w = v - p * rate;
    let (w_squared, towards) = (w.norm_squared(), w.dot(p));
    // Project on cut-off disc: w points back by more than the angle to the legs.
    let is_back = (towards < S::ZERO) & (towards * towards > r * r * w_squared);
    let is_disc = is_back & (w_squared > tiny());
    let choose = |disc: S, leg: S| if is_disc { disc } else { leg };
    let root = choose(w_squared, squared - r * r).sqrt();
    // Project on left leg or on right leg: the tangent is p turned by the angle with this sine and cosine.
    let signed = if p.det(w) > S::ZERO { root } else { -root };
    let across = Vec2::new(
        choose(w.x, -(p.y * signed + p.x * r)),
        choose(w.y, p.x * signed - p.y * r),
    );
    let scale = S::ONE.checked_div(choose(root, squared))?;
    let normal = across * scale;
    Some((choose(r * rate - root, -(v.dot(normal))), normal))
}

/// A square so small that lengths below its root (f32: 1e-14) have no direction.
fn tiny<S: Scalar>() -> S {
    let squared = S::EPSILON * S::EPSILON;
    squared * squared
}

/// The same for numbers whose squares lose precision: by unit vectors and angles.
fn leave_cone_by_angle<S: Scalar>(
    v: Vec2<S>,
    p: Vec2<S>,
    ahead: Vec2<S>,
    r: S,
    horizon_s: S,
) -> Option<(S, Vec2<S>)> {
    let tip = Vec2::new(p.x.checked_div(horizon_s)?, p.y.checked_div(horizon_s)?);
    let w = v - tip;
    let sin = r.checked_div(p.norm())?;
    if w.dot(ahead) < -(sin * w.norm()) {
        return Some(leave_disc(w, r.checked_div(horizon_s)?, -ahead));
    }
    let cos = (S::ONE - sin * sin).sqrt();
    let normal = if ahead.det(w) > S::ZERO {
        ahead.rotate(cos, sin).perp()
    } else {
        -ahead.rotate(cos, -sin).perp()
    };
    Some((-(v.dot(normal)), normal))
}

/// From `w`, relative to the disc's centre, to the disc's border: length of the change and outward
/// normal; `otherwise` is the normal at the centre.
fn leave_disc<S: Scalar>(w: Vec2<S>, radius: S, otherwise: Vec2<S>) -> (S, Vec2<S>) {
    let normal = w.normalized().unwrap_or(otherwise);
    (radius - w.norm(), normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// By squares and by angles the change is the same; the normal too, unless two ways out are equally long.
        #[test]
        fn both_ways_to_leave_the_cone_agree(
            p in (-9.0_f64..9.0, -9.0_f64..9.0), v in (-3.0_f64..3.0, -3.0_f64..3.0), r in 0.1_f64..2.0, horizon in 0.1_f64..9.0,
        ) {
            let (p, v) = (Vec2::new(p.0, p.1), Vec2::new(v.0, v.1));
            prop_assume!(p.norm() > r * 1.001);
            let ahead = p.normalized().unwrap_or_default();
            let w = v - p * (1.0 / horizon);
            let is_clear = (ahead.dot(w) + r / p.norm() * w.norm()).abs() > 1e-9 && ahead.det(w).abs() > 1e-9;
            prop_assume!(is_clear);
            let squares = leave_cone(v, p, p.norm_squared(), r, 1.0 / horizon);
            let angles = leave_cone_by_angle(v, p, ahead, r, horizon);
            let (Some((u, normal)), Some((by_angle, expected))) = (squares, angles) else {
                return Err(TestCaseError::fail("no way out"));
            };
            prop_assert!((u - by_angle).abs() < 1e-9, "{u} {by_angle}");
            prop_assert!((normal - expected).norm() < 1e-6, "{normal:?} {expected:?}");
        }
    }

    #[test]
    fn shortest_vectors_still_give_half_planes() {
        let params = Params {
            horizon_s: 2.0_f32,
            separation_s: 0.05,
            share: 0.5,
        };
        let tiny = [0.0, 1e-30, 1e-23, 1e-20, 1e-15, 1e-10];
        for (reach, off) in tiny.iter().flat_map(|reach| tiny.map(|off| (*reach, off))) {
            let neighbor = |offset_m: Vec2<f32>, radii_m: f32| Neighbor {
                offset_m,
                velocity_mps: Vec2::ZERO,
                radii_m,
                tie: Vec2::ZERO,
            };
            // A relative velocity that points at the disc's centre but for `off`, and robots of hardly any size.
            let own = Vec2::new(500.0 - off, off);
            let far = half_plane(own, &neighbor(Vec2::new(1000.0, 0.0), 1.0), &params);
            let small = half_plane(own, &neighbor(Vec2::new(reach * 3.0, 0.0), reach), &params);
            let is_unit = |plane: HalfPlane<f32>| (plane.normal.norm() - 1.0).abs() < 1e-5;
            assert!(far.is_some_and(is_unit), "{off}");
            assert!(reach == 0.0 || small.is_some_and(is_unit), "{reach} {off}");
        }
    }
}
