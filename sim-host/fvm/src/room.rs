//! Rooms from files: an outline and obstacles.

use crate::{Function, System, shape};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::obstacle::Obstacle;
use staya_sim::scenario::{ScenarioError, Source};
use staya_sim::table;
use std::path::Path;

table! {
    /// A room with obstacles, read from TOML.
    #[derive(PartialEq)]
    pub struct Room {
        /// Corners of the outer wall, metres.
        pub outline: Vec<[f64; 2]>;
        /// Round obstacles.
        pub circle: Vec<Circle> = Vec::new();
        /// Polygonal obstacles.
        pub polygon: Vec<Polygon> = Vec::new();
    }
}

table! {
    /// A round obstacle.
    #[derive(Copy, PartialEq)]
    pub struct Circle {
        /// Centre, metres.
        pub center: [f64; 2];
        /// Radius, metres, above 0.
        pub radius: f64;
    }
}

table! {
    /// A polygonal obstacle.
    #[derive(PartialEq)]
    pub struct Polygon {
        /// Corners, metres, in either direction.
        pub corners: Vec<[f64; 2]>;
    }
}

const CORNERS: &str = "give three corners or more, finite, no two in a row equal";

impl Default for Room {
    /// The documentation's room: 8 m by 6 m with a niche, a round and a square pillar.
    fn default() -> Self {
        Self {
            outline: vec![[-4.0, -3.0], [4.0, -3.0], [4.0, 1.5], [2.5, 1.5], [2.5, 3.0], [-4.0, 3.0]],
            circle: vec![Circle { center: [-1.5, 0.8], radius: 0.5 }],
            polygon: vec![Polygon { corners: vec![[0.6, -1.2], [1.2, -0.6], [0.6, 0.0], [0.0, -0.6]] }],
        }
    }
}

impl Room {
    /// Parses the text of the file `path`.
    ///
    /// # Errors
    /// Names file, line and field, with cause and remedy.
    pub fn read(text: &str, path: &Path) -> Result<Self, ScenarioError> {
        let source = Source::new(path, text)?;
        let room: Self = source.read("docs/land.md")?;
        let polygons = room.polygon.iter().enumerate();
        let polygons = polygons.map(|(index, polygon)| (format!("polygon[{index}].corners"), &polygon.corners));
        for (field, corners) in polygons.chain([("outline".to_owned(), &room.outline)]) {
            if !is_polygon(corners) {
                return Err(source.error(&field, "this is not a polygon", CORNERS));
            }
        }
        for (index, circle) in room.circle.iter().enumerate() {
            let field = |name| format!("circle[{index}].{name}");
            if !circle.center.iter().all(|x| x.is_finite()) {
                return Err(source.error(&field("center"), "this is not a place", "give two finite numbers"));
            }
            if !(circle.radius > 0.0 && circle.radius.is_finite()) {
                return Err(source.error(&field("radius"), "this is not a radius", "give a number above 0"));
            }
        }
        Ok(room)
    }

    /// Function that is positive outside the outline and in obstacles.
    #[must_use]
    pub fn function(&self, system: System) -> Function<2> {
        let walls = !shape::polygon(self.outline.clone());
        let circles = self.circle.iter().map(|circle| shape::circle(circle.center, circle.radius));
        let polygons = self.polygon.iter().map(|polygon| shape::polygon(polygon.corners.clone()));
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
        let outlines = std::iter::once(&self.outline).chain(self.polygon.iter().map(|polygon| &polygon.corners));
        let walls = outlines.flat_map(|corners| corners.iter().zip(corners.iter().cycle().skip(1)));
        let walls = walls.map(|(from, to)| Obstacle::Wall([point(*from), point(*to)]));
        let circles = self.circle.iter().map(|circle| {
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
