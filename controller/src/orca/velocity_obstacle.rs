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

#[cfg(test)]
mod tests {
    use super::*;

    type V = Vec2<f64>;

    fn near(one: V, x: f64, y: f64) -> bool {
        (one - V::new(x, y)).norm() < 1e-12
    }

    /// A cone with the half angle of the triangle 3, 4, 5.
    #[test]
    fn parts_and_predicates_of_an_obstacle_are_signed_distances() {
        let obstacle = VelocityObstacle::new(V::new(4.0, 3.0), 3.0, 2.0).unwrap();
        let ((tip, radius), [left, right]) = (obstacle.disc(), obstacle.legs());
        assert!(near(obstacle.ahead(), 0.8, 0.6) && near(tip, 2.0, 1.5) && radius == 1.5);
        assert!(near(left, 0.28, 0.96) && near(right, 1.0, 0.0));
        for (velocity, predicates, value) in [
            ((2.0, 1.5), [1.5, 1.5, 0.0, 0.0, 1.5], 1.5),
            ((0.0, 0.0), [0.0, 0.0, -2.0, -2.0, -1.0], -1.0),
            ((8.0, 6.0), [6.0, 6.0, 6.0, 6.0, -6.0], 6.0),
            ((8.0, 1.0), [7.4, 1.0, 1.2, 6.0, 1.5 - 36.25_f64.sqrt()], 1.0),
            ((8.0, -1.0), [7.96, -1.0, -0.72, 6.0, 1.5 - 42.25_f64.sqrt()], -1.0),
            ((2.0, 5.0), [0.52, 5.0, 3.36, 0.0, -2.0], 0.52),
        ] {
            let velocity = V::new(velocity.0, velocity.1);
            for (got, wanted) in obstacle.predicates(velocity).into_iter().zip(predicates) {
                assert!((got - wanted).abs() < 1e-9, "{velocity:?}: {:?}", obstacle.predicates(velocity));
            }
            assert!((obstacle.value(velocity) - value).abs() < 1e-9, "{velocity:?}: {}", obstacle.value(velocity));
        }
    }

    #[test]
    fn overlapping_and_invalid_robots_have_no_velocity_obstacle() {
        let is_some =
            |x: f64, radii: f64, horizon: f64| VelocityObstacle::new(V::new(x, 0.0), radii, horizon).is_some();
        assert!(is_some(1.01, 1.0, 2.0));
        assert!(!is_some(1.0, 1.0, 2.0) && !is_some(0.5, 1.0, 2.0) && !is_some(0.0, 1.0, 2.0));
        assert!(!is_some(3.0, 0.0, 2.0) && !is_some(3.0, -1.0, 2.0) && !is_some(3.0, f64::NAN, 2.0));
        assert!(!is_some(3.0, 1.0, 0.0) && !is_some(3.0, 1.0, -2.0) && !is_some(3.0, 1.0, f64::NAN));
        assert!(!is_some(f64::NAN, 1.0, 2.0) && !is_some(f64::INFINITY, 1.0, 2.0));
    }
}
