//! Rooms from files: an outline and obstacles.

use crate::{Function, System, shape};
use anyhow::{Result, anyhow, bail};
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

pub const CORNERS: &str = "give three corners or more, finite, no two in a row equal";

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
    /// The text with line or field and the remedy.
    pub fn read(text: &str) -> Result<Self> {
        let room: Self = toml::from_str(text).map_err(|error| anyhow!("{}", error.to_string().trim()))?;
        room.check()?;
        Ok(room)
    }

    fn check(&self) -> Result<()> {
        if !is_polygon(&self.outline) {
            bail!("outline: {CORNERS}");
        }
        for (number, circle) in (1..).zip(&self.circles) {
            if !circle.center.iter().all(|x| x.is_finite()) {
                bail!("circle {number}: center: give two finite numbers");
            }
            if !(circle.radius > 0.0 && circle.radius.is_finite()) {
                bail!("circle {number}: radius: give a number above 0");
            }
        }
        for (number, polygon) in (1..).zip(&self.polygons) {
            if !is_polygon(&polygon.corners) {
                bail!("polygon {number}: corners: {CORNERS}");
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
