//! Static obstacles in the plane.

use super::shape::Shape;
use serde::{Deserialize, Serialize};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::obstacle::Obstacle;

/// An obstacle in world coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Solid {
    /// An upright wall without thickness between two points.
    Wall([[f64; 2]; 2]),
    /// A ball; in the plane a disc.
    Ball {
        /// Centre.
        center_m: [f64; 3],
        /// Radius.
        radius_m: f64,
    },
    /// A half-space.
    Plane {
        /// A point on its border.
        point_m: [f64; 3],
        /// Unit vector out of the obstacle.
        normal: [f64; 3],
    },
}

impl Solid {
    /// The obstacles that a shape consists of.
    #[must_use]
    pub fn of(shape: &Shape) -> Vec<Self> {
        match shape {
            Shape::Circle { center_m: [x, y], radius_m } => {
                vec![Self::Ball { center_m: [*x, *y, 0.0], radius_m: *radius_m }]
            }
            Shape::Ball { center_m, radius_m } => vec![Self::Ball { center_m: *center_m, radius_m: *radius_m }],
            Shape::Segment { from_m, to_m } => vec![Self::Wall([*from_m, *to_m])],
            Shape::Polygon { points_m } => {
                let next = points_m.iter().cycle().skip(1);
                points_m.iter().zip(next).map(|(from, to)| Self::Wall([*from, *to])).collect()
            }
        }
    }

    /// The obstacle, displaced by (`x`, `y`) metres.
    #[must_use]
    pub fn moved(&self, [x, y]: [f64; 2]) -> Self {
        let flat = |point: [f64; 2]| [point[0] + x, point[1] + y];
        let way = |point: [f64; 3]| [point[0] + x, point[1] + y, point[2]];
        match *self {
            Self::Wall(ends) => Self::Wall(ends.map(flat)),
            Self::Ball { center_m, radius_m } => Self::Ball { center_m: way(center_m), radius_m },
            Self::Plane { point_m, normal } => Self::Plane { point_m: way(point_m), normal },
        }
    }

    /// The obstacle relative to a position, in the precision of `f64`.
    #[must_use]
    pub fn seen_from(&self, place_m: [f64; 3]) -> Obstacle<f64> {
        let flat = |point: [f64; 2]| Vec2::new(point[0] - place_m[0], point[1] - place_m[1]);
        let way = |point: [f64; 3]| Vec3::new(point[0] - place_m[0], point[1] - place_m[1], point[2] - place_m[2]);
        match *self {
            Self::Wall(ends) => Obstacle::Wall(ends.map(flat)),
            Self::Ball { center_m, radius_m } => Obstacle::Ball { center_m: way(center_m), radius_m },
            Self::Plane { point_m, normal } => {
                let normal = Vec3::new(normal[0], normal[1], normal[2]);
                Obstacle::Plane { normal, distance_m: -way(point_m).dot(normal) }
            }
        }
    }

    /// Distance from a position to the obstacle, metres; negative inside.
    #[must_use]
    pub fn distance_m(&self, place_m: [f64; 3]) -> f64 {
        match (self.seen_from(place_m).nearest_point(), *self) {
            (Some((_, distance_m)), _) => distance_m,
            (None, Self::Ball { radius_m, .. }) => -radius_m,
            (None, _) => f64::INFINITY,
        }
    }
}

/// Converts an obstacle to `f32`; its coordinates must be relative to the robot.
pub fn narrow(obstacle: &Obstacle<f64>) -> Obstacle<f32> {
    let flat = |v: Vec2<f64>| Vec2::new(v.x as f32, v.y as f32);
    let way = |v: Vec3<f64>| Vec3::new(v.x as f32, v.y as f32, v.z as f32);
    match *obstacle {
        Obstacle::Wall(ends) => Obstacle::Wall(ends.map(flat)),
        Obstacle::Ball { center_m, radius_m } => Obstacle::Ball { center_m: way(center_m), radius_m: radius_m as f32 },
        Obstacle::Plane { normal, distance_m } => {
            Obstacle::Plane { normal: way(normal), distance_m: distance_m as f32 }
        }
    }
}
