//! Static obstacles as a robot sees them: relative to its own position.

mod grid_walls;

pub use grid_walls::grid_walls;

use crate::geom::{Vec2, Vec3};
use crate::scalar::Scalar;

/// An obstacle relative to the robot's centre, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Obstacle<S> {
    /// A vertical wall without thickness between two points; a polygon is several walls.
    Wall([Vec2<S>; 2]),
    /// A solid ball, in the plane a disc.
    Ball {
        /// Its centre.
        center_m: Vec3<S>,
        /// Its radius; more than 0.
        radius_m: S,
    },
    /// A half-space: everything behind a plane.
    Plane {
        /// Unit vector out of the obstacle.
        normal: Vec3<S>,
        /// How far the robot's centre is in front of the plane; negative behind it.
        distance_m: S,
    },
}

impl<S: Scalar> Obstacle<S> {
    /// The obstacle's point nearest to the robot's centre (the centre itself inside a ball or a
    /// half-space), and its distance, negative inside. `None` for an obstacle that is not finite,
    /// and at the centre of a ball.
    #[must_use]
    pub fn nearest_point(&self) -> Option<(Vec3<S>, S)> {
        match *self {
            Self::Wall([a, b]) => {
                let (unit, length) = (b - a).unit_and_norm();
                let foot = match unit {
                    Some(unit) => a + unit * (-a).dot(unit).clamp(S::ZERO, length),
                    None => a,
                };
                foot.is_finite().then(|| (foot.extend(S::ZERO), foot.norm()))
            }
            Self::Ball { center_m, radius_m } => {
                let ahead = center_m.normalized()?;
                let distance = center_m.norm() - radius_m;
                Some((ahead * distance, distance))
            }
            Self::Plane { normal, distance_m } => {
                let point = -normal * distance_m;
                point.is_finite().then_some((point, distance_m))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_points_lie_on_the_border_and_distances_are_signed() {
        let wall = Obstacle::Wall([Vec2::new(1.0, -1.0), Vec2::new(1.0, 3.0)]);
        assert_eq!(wall.nearest_point(), Some((Vec3::new(1.0, 0.0, 0.0), 1.0)));
        let beyond = Obstacle::Wall([Vec2::new(3.0, 4.0), Vec2::new(6.0, 8.0)]);
        assert_eq!(beyond.nearest_point(), Some((Vec3::new(3.0, 4.0, 0.0), 5.0)));
        let point = Obstacle::Wall([Vec2::new(0.0, 2.0), Vec2::new(0.0, 2.0)]);
        assert_eq!(point.nearest_point(), Some((Vec3::new(0.0, 2.0, 0.0), 2.0)));
        let ball = |x, radius_m| Obstacle::Ball { center_m: Vec3::new(x, 0.0, 0.0), radius_m };
        assert_eq!(ball(5.0, 2.0).nearest_point(), Some((Vec3::new(3.0, 0.0, 0.0), 3.0)));
        assert_eq!(ball(1.0, 2.0).nearest_point(), Some((Vec3::new(-1.0, 0.0, 0.0), -1.0)));
        assert_eq!(ball(0.0, 2.0).nearest_point(), None);
        let floor = Obstacle::Plane { normal: Vec3::new(0.0, 0.0, 1.0), distance_m: 2.0 };
        assert_eq!(floor.nearest_point(), Some((Vec3::new(0.0, 0.0, -2.0), 2.0)));
        assert_eq!(ball(f64::NAN, 2.0).nearest_point(), None);
        assert_eq!(Obstacle::Wall([Vec2::new(f64::NAN, 0.0); 2]).nearest_point(), None);
    }
}
