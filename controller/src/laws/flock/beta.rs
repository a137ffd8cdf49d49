//! Beta-agents: the effect of an obstacle on a robot (Olfati-Saber 2006, section VII, lemma 4).

use crate::geom::{Vec2, Vec3};
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;

/// A virtual robot at the point of an obstacle's border nearest to a robot, relative to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BetaAgent<S> {
    /// Unit vector out of the obstacle at the beta-agent: q^ - q = -distance_m normal.
    pub normal: Vec3<S>,
    /// How far the robot's centre is in front of the border, metres; negative inside.
    pub distance_m: S,
    /// Its velocity p^: the robot's own one along the border, m/s.
    pub velocity_mps: Vec3<S>,
}

/// The beta-agent of `obstacle` for a robot with this velocity.
///
/// - A plane: P = I - a a', p^ = P p.
/// - A ball of radius R at distance D: p^ = mu P p with mu = R / D, limited to 1 (inside). At its
///   exact centre the exit is backwards, or east for a stationary robot.
/// - A wall: beside it like a plane on the robot's side, beyond its end like a ball of radius 0.
///
/// `None` if the obstacle is not finite, a normal is zero or a radius negative. Constant work.
#[must_use]
pub fn beta_agent<S: Scalar>(obstacle: &Obstacle<S>, own_velocity_mps: Vec3<S>) -> Option<BetaAgent<S>> {
    let v = own_velocity_mps;
    let along = |normal: Vec3<S>| v - normal * v.dot(normal);
    let east = Vec3::new(S::ONE, S::ZERO, S::ZERO);
    match *obstacle {
        Obstacle::Plane { normal, distance_m } => {
            let normal = normal.normalized()?;
            distance_m.is_finite().then(|| BetaAgent { normal, distance_m, velocity_mps: along(normal) })
        }
        Obstacle::Ball { center_m, radius_m } => {
            let distance = center_m.norm();
            let is_sound = center_m.is_finite() && distance.is_finite() && radius_m.is_finite();
            if !(is_sound && radius_m >= S::ZERO) {
                return None;
            }
            let normal = (-center_m).normalized().or_else(|| (-v).normalized());
            let normal = normal.unwrap_or(east);
            let mu = radius_m.checked_div(distance).unwrap_or(S::ONE).min(S::ONE);
            Some(BetaAgent { normal, distance_m: distance - radius_m, velocity_mps: along(normal) * mu })
        }
        Obstacle::Wall([a, b]) => {
            let length = (b - a).norm();
            let direction = (b - a).normalized();
            let at = direction.map_or(S::ZERO, |unit| (-a).dot(unit).clamp(S::ZERO, length));
            let foot = a + direction.unwrap_or(Vec2::ZERO) * at;
            if !(foot.is_finite() && b.is_finite()) {
                return None;
            }
            let left = || direction.map(Vec2::perp);
            let normal = (-foot).normalized().or_else(left).unwrap_or(east.xy());
            let normal = normal.extend(S::ZERO);
            let is_beside = at > S::ZERO && at < length;
            Some(BetaAgent {
                normal,
                distance_m: foot.norm(),
                velocity_mps: if is_beside { along(normal) } else { Vec3::new(S::ZERO, S::ZERO, v.z) },
            })
        }
    }
}
