//! The truncated velocity obstacle as one function of the velocity (FVM, eqs. 1 to 4, 13 and 15).

use crate::geom::Vec2;
use crate::scalar::Scalar;

/// The relative velocities that collide within a time horizon: a cone whose tip a disc cuts off.
///
/// Differences to the paper: its lines y = x tg(angle) fail for vertical lines and for x < 0. Here
/// each predicate is the signed distance to its line. Eq. 13 places the disc's centre at -(p_B -
/// p_A) / tau; it is at +(p_B - p_A) / tau, as in figure 4. Eq. 3 is headed Pr1 but means Pr3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VelocityObstacle<S> {
    ahead: Vec2<S>,
    tip_mps: Vec2<S>,
    radius_mps: S,
    sin: S,
    cos: S,
}

impl<S: Scalar> VelocityObstacle<S> {
    /// The velocity obstacle of a neighbour at `offset_m`, with the sum of both radii. `None` if
    /// the robots overlap (every velocity collides), or an input is not finite or not above 0.
    #[must_use]
    pub fn new(offset_m: Vec2<S>, radii_m: S, horizon_s: S) -> Option<Self> {
        let sound = offset_m.is_finite() && radii_m > S::ZERO && horizon_s > S::ZERO;
        let distance = offset_m.norm();
        if !(sound && distance > radii_m) {
            return None;
        }
        let sin = radii_m.checked_div(distance)?;
        Some(Self {
            ahead: offset_m.normalized()?,
            tip_mps: Vec2::new(offset_m.x.checked_div(horizon_s)?, offset_m.y.checked_div(horizon_s)?),
            radius_mps: radii_m.checked_div(horizon_s)?,
            sin,
            cos: (S::ONE - sin * sin).sqrt(),
        })
    }

    /// Unit vector to the neighbour.
    #[must_use]
    pub const fn ahead(&self) -> Vec2<S> {
        self.ahead
    }

    /// Centre (m/s) and radius (m/s) of the disc that cuts off the cone's tip.
    #[must_use]
    pub const fn disc(&self) -> (Vec2<S>, S) {
        (self.tip_mps, self.radius_mps)
    }

    /// Unit vectors along the left and the right leg, away from the origin.
    #[must_use]
    pub fn legs(&self) -> [Vec2<S>; 2] {
        [self.ahead.rotate(self.cos, self.sin), self.ahead.rotate(self.cos, -self.sin)]
    }

    /// The predicates, m/s: Pr1, Pr2 (right of the left leg, left of the right one), Pr3, Pr4
    /// (beyond the perpendiculars from the disc's centre to the legs) and Disc. Each is the signed
    /// distance to its line or circle, positive inside.
    #[must_use]
    pub fn predicates(&self, velocity_mps: Vec2<S>) -> [S; 5] {
        let [left, right] = self.legs();
        let from_tip = velocity_mps - self.tip_mps;
        [
            -(left.det(velocity_mps)),
            right.det(velocity_mps),
            left.dot(from_tip),
            right.dot(from_tip),
            self.radius_mps - from_tip.norm(),
        ]
    }

    /// Pr1 and Pr2 and (Pr3 or Pr4) or Disc, with the R-functions min for "and" and max for "or":
    /// positive inside the velocity obstacle, negative outside, zero on its border.
    ///
    /// The sign is exact. The value is the distance to the border only outside the tip, so the
    /// gradient does not always lead out by the shortest path. Therefore the
    /// [table](super::half_plane_from_table) stores the normal to the nearest border.
    #[must_use]
    pub fn value(&self, velocity_mps: Vec2<S>) -> S {
        let [pr1, pr2, pr3, pr4, disc] = self.predicates(velocity_mps);
        pr1.min(pr2).min(pr3.max(pr4)).max(disc)
    }
}
