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
    if !(p.is_finite() && v.is_finite() && r > S::ZERO) {
        return None;
    }
    let distance = p.norm();
    let (u, normal) = match p.normalized() {
        Some(ahead) if distance > r => {
            let tip = Vec2::new(
                p.x.checked_div(params.horizon_s)?,
                p.y.checked_div(params.horizon_s)?,
            );
            let w = v - tip;
            // The tangents leave the line of centres at the angle with this sine.
            let sin = r.checked_div(distance)?;
            if w.dot(ahead) < -(sin * w.norm()) {
                // Nearest to the cut-off disc.
                leave_disc(w, r.checked_div(params.horizon_s)?, -ahead)
            } else {
                let cos = (S::ONE - sin * sin).sqrt();
                let normal = if ahead.det(w) > S::ZERO {
                    // Nearest to the left leg.
                    ahead.rotate(cos, sin).perp()
                } else {
                    // Nearest to the right leg.
                    -ahead.rotate(cos, -sin).perp()
                };
                (-(v.dot(normal)), normal)
            }
        }
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
    };
    let point = own_velocity_mps + normal * (u * params.share);
    point.is_finite().then_some(HalfPlane { point, normal })
}

/// From `w`, relative to the disc's centre, to the disc's border: length of the change and outward
/// normal; `otherwise` is the normal at the centre.
fn leave_disc<S: Scalar>(w: Vec2<S>, radius: S, otherwise: Vec2<S>) -> (S, Vec2<S>) {
    let normal = w.normalized().unwrap_or(otherwise);
    (radius - w.norm(), normal)
}
