//! Rooms from files: an outline and obstacles.

use crate::{Function, System, shape};
use serde::Deserialize;
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::obstacle::Obstacle;

/// A room with obstacles, read from TOML.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// Corners of the outer wall, metres.
    pub outline: Vec<[f64; 2]>,
    /// Round obstacles.
    #[serde(default, rename = "circle")]
    pub circles: Vec<Circle>,
    /// Polygonal obstacles.
    #[serde(default, rename = "polygon")]
    pub polygons: Vec<Polygon>,
}

/// A round obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Centre, metres.
    pub center: [f64; 2],
    /// Radius, metres, above 0.
    pub radius: f64,
}

/// A polygonal obstacle.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// Corners, metres, in either direction.
    pub corners: Vec<[f64; 2]>,
}

/// Why a room is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RoomError {
    /// Not TOML, or unknown fields.
    #[error("{0}")]
    Toml(String),
    /// A field has an invalid value.
    #[error("{field}: {remedy}")]
    Field {
        /// Name of the field.
        field: String,
        /// Valid values.
        remedy: &'static str,
    },
}

const CORNERS: &str = "give three corners or more, finite, no two in a row equal";

impl Default for Room {
    /// The documentation's room: 8 m by 6 m with a niche, a round and a square pillar.
    fn default() -> Self {
        Self {
            outline: vec![[-4.0, -3.0], [4.0, -3.0], [4.0, 1.5], [2.5, 1.5], [2.5, 3.0], [-4.0, 3.0]],
            circles: vec![Circle { center: [-1.5, 0.8], radius: 0.5 }],
            polygons: vec![Polygon { corners: vec![[0.6, -1.2], [1.2, -0.6], [0.6, 0.0], [0.0, -0.6]] }],
        }
    }
}

impl Room {
    /// Parses the text of a file.
    ///
    /// # Errors
    /// [`RoomError`] with line or field.
    pub fn read(text: &str) -> Result<Self, RoomError> {
        let room: Self = toml::from_str(text).map_err(|error| RoomError::Toml(error.to_string().trim().to_owned()))?;
        room.check()?;
        Ok(room)
    }

    fn check(&self) -> Result<(), RoomError> {
        let bad = |field: String, remedy| Err(RoomError::Field { field, remedy });
        if !is_polygon(&self.outline) {
            return bad("outline".into(), CORNERS);
        }
        for (index, circle) in self.circles.iter().enumerate() {
            if !circle.center.iter().all(|x| x.is_finite()) {
                return bad(format!("circle {}: center", index + 1), "give two finite numbers");
            }
            if !(circle.radius > 0.0 && circle.radius.is_finite()) {
                return bad(format!("circle {}: radius", index + 1), "give a number above 0");
            }
        }
        for (index, polygon) in self.polygons.iter().enumerate() {
            if !is_polygon(&polygon.corners) {
                return bad(format!("polygon {}: corners", index + 1), CORNERS);
            }
        }
        Ok(())
    }

    /// Function that is positive outside the outline and in obstacles.
    #[must_use]
    pub fn function(&self, system: System) -> Function<2> {
        let walls = !shape::polygon(self.outline.clone());
        let circles = self.circles.iter().map(|circle| shape::circle(circle.center, circle.radius));
        let polygons = self.polygons.iter().map(|polygon| shape::polygon(polygon.corners.clone()));
        circles.chain(polygons).fold(walls, |all, one| all.or(one, system))
    }

    /// Smallest and largest coordinates of the outline with a `margin` around it.
    #[must_use]
    pub fn extent(&self, margin: f64) -> [[f64; 2]; 2] {
        extent(&self.outline, margin)
    }

    /// Walls and obstacles for ORCA's formulas, relative to `from`.
    #[must_use]
    pub fn obstacles(&self, from: Vec2<f32>) -> Vec<Obstacle<f32>> {
        let point = |[x, y]: [f64; 2]| Vec2::new(x as f32, y as f32) - from;
        let outlines = std::iter::once(&self.outline).chain(self.polygons.iter().map(|polygon| &polygon.corners));
        let walls = outlines.flat_map(|corners| corners.iter().zip(corners.iter().cycle().skip(1)));
        let walls = walls.map(|(from, to)| Obstacle::Wall([point(*from), point(*to)]));
        let circles = self.circles.iter().map(|circle| {
            let center = point(circle.center);
            Obstacle::Ball { center_m: Vec3::new(center.x, center.y, 0.0), radius_m: circle.radius as f32 }
        });
        walls.chain(circles).collect()
    }
}

pub fn is_polygon(corners: &[[f64; 2]]) -> bool {
    let differ = corners.iter().zip(corners.iter().cycle().skip(1)).all(|(one, next)| one != next);
    corners.len() >= 3 && differ && corners.iter().flatten().all(|x| x.is_finite())
}

pub fn extent(corners: &[[f64; 2]], margin: f64) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| {
        let along = || corners.iter().map(|corner| corner[axis]);
        [along().fold(f64::INFINITY, f64::min) - margin, along().fold(f64::NEG_INFINITY, f64::max) + margin]
    })
}
