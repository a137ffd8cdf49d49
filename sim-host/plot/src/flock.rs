//! Robots in the plane at one moment: positions, velocities, neighbours, obstacles.
//!
//! A [`Snapshot`] is one moment, a [`Sheet`] has several side by side. [`View`] projects three
//! dimensions to two.
//!
//! ```ignore
//! use staya_plot::flock::{Obstacle, Sheet, Snapshot};
//! # fn main() -> Result<(), staya_sim::record::Error> {
//! let moment = Snapshot {
//!     title: "t = 0 s".into(),
//!     positions_m: vec![[0.0, 0.0], [7.0, 0.0]],
//!     velocities_mps: vec![[1.0, 0.0], [0.0, 1.0]],
//!     radius_m: 0.5,
//!     edges_within_m: Some(8.4),
//!     obstacles: vec![Obstacle::Disc { centre_m: [20.0, 3.0], radius_m: 4.0 }],
//!     ..Snapshot::default()
//! };
//! Sheet::new("Two robots", 2).with(moment.clone()).with(moment).draw().write("out/two".as_ref())?;
//! # Ok(()) }
//! ```

mod frame;
mod legend;
mod marks;

use super::canvas::{Canvas, extent, longest};
use super::layout;
use frame::Frame;
use staya_sim::terrain::Terrain;
use std::sync::Arc;

/// Larger swarms are drawn as dots or small darts.
pub const MOST_DISCS: usize = 3000;

/// An obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// An area with these corners, metres.
    Polygon(Vec<[f64; 2]>),
    /// A disc.
    Disc {
        /// Centre, metres.
        centre_m: [f64; 2],
        /// Radius, metres.
        radius_m: f64,
    },
    /// A wall without thickness between two points, metres.
    Segment([[f64; 2]; 2]),
}

impl Obstacle {
    pub(crate) fn corners(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Polygon(corners) => corners.clone(),
            Self::Disc { centre_m: [x, y], radius_m: r } => vec![[x - r, y - r], [x + r, y + r]],
            Self::Segment(ends) => ends.to_vec(),
        }
    }
}

/// One moment. Items with a coordinate that is not finite are skipped.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Title above the picture.
    pub title: String,
    /// Positions, metres.
    pub positions_m: Vec<[f64; 2]>,
    /// Velocities, m/s: one per robot, or none. Stationary robots have no arrow.
    pub velocities_mps: Vec<[f64; 2]>,
    /// Speed of the longest arrow, m/s; at least that of the fastest robot.
    pub fastest_mps: f64,
    /// Radius of the bodies, metres. Bodies too small to see become darts.
    pub radius_m: f64,
    /// Radii of the bodies if they differ, metres: one per robot, or none.
    pub radii_m: Vec<f64>,
    /// Index of each robot's colour in the palette; 0 for robots without an entry.
    pub groups: Vec<usize>,
    /// Robots up to this distance are joined by a line, metres.
    pub edges_within_m: Option<f64>,
    /// Obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Goals, metres.
    pub goals_m: Vec<[f64; 2]>,
    /// Past paths, metres, one line per robot.
    pub trails_m: Vec<Vec<[f64; 2]>>,
    /// Map in the background.
    pub land: Option<Arc<Terrain>>,
    /// Visible range: smallest and largest x and y; `None` for everything.
    pub view_m: Option<[[f64; 2]; 2]>,
    /// Labels of the axes.
    pub labels: [String; 2],
    /// Width and height in units.
    pub size: [f64; 2],
}

impl Default for Snapshot {
    /// An empty snapshot of 420 x 400 units.
    fn default() -> Self {
        Self {
            title: String::new(),
            positions_m: Vec::new(),
            velocities_mps: Vec::new(),
            fastest_mps: 0.0,
            radius_m: 0.0,
            radii_m: Vec::new(),
            groups: Vec::new(),
            edges_within_m: None,
            obstacles: Vec::new(),
            goals_m: Vec::new(),
            trails_m: Vec::new(),
            land: None,
            view_m: None,
            labels: ["x (m)".into(), "y (m)".into()],
            size: [420.0, 400.0],
        }
    }
}

impl Snapshot {
    /// Draws the snapshot as a picture.
    #[must_use]
    pub fn draw(&self) -> Canvas {
        let [width, height] = self.sound_size();
        let mut canvas = Canvas::new(width, height, &self.title);
        self.draw_into(&mut canvas, [0.0, 0.0, width, height]);
        canvas
    }

    fn draw_into(&self, canvas: &mut Canvas, area: [f64; 4]) {
        let frame = Frame::new(self, area);
        frame.draw(self, canvas);
        canvas.clip(Some(frame.plot));
        marks::draw(self, &frame, canvas);
        canvas.clip(None);
    }

    fn sound_size(&self) -> [f64; 2] {
        self.size.map(|side| if side.is_nan() { 400.0 } else { side.clamp(160.0, 4000.0) })
    }

    /// Smallest and largest x and y of all items.
    fn extent(&self) -> Option<[[f64; 2]; 2]> {
        let disc = |[x, y]: [f64; 2], r: f64| [[x - r, y - r], [x + r, y + r]];
        let robots = self.positions_m.iter().flat_map(|&at| disc(at, self.radius_m.max(0.0)));
        let obstacles = self.obstacles.iter().flat_map(Obstacle::corners);
        let trails = self.trails_m.iter().flatten().copied();
        let all = robots.chain(obstacles).chain(self.goals_m.iter().copied()).chain(trails);
        let extent = extent(all.filter(|at| at.iter().all(|c| c.is_finite())));
        longest(extent).is_finite().then_some(extent)
    }
}

/// Projection of space to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From above: x and y.
    Plan,
    /// From the south: x and height.
    Elevation,
    /// From the south-east and above: east right, north to the upper right (half length), height
    /// up.
    Oblique,
}

impl View {
    /// Projects a position or a velocity.
    #[must_use]
    pub fn of(self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        match self {
            Self::Plan => [x, y],
            Self::Elevation => [x, z],
            Self::Oblique => {
                let north = y * 0.5 * std::f64::consts::FRAC_1_SQRT_2;
                [x + north, z + north]
            }
        }
    }

    /// Labels of the axes.
    #[must_use]
    pub fn labels(self) -> [String; 2] {
        match self {
            Self::Plan => ["x (m)".into(), "y (m)".into()],
            Self::Elevation => ["x (m)".into(), "z (m)".into()],
            Self::Oblique => ["x + 0.35 y (m)".into(), "z + 0.35 y (m)".into()],
        }
    }
}

/// Several snapshots in one picture, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    title: String,
    columns: usize,
    has_legend: bool,
    pub(crate) snapshots: Vec<Snapshot>,
}

impl Sheet {
    /// Creates an empty sheet with `columns` (at least 1) per row; the title may be empty.
    #[must_use]
    pub fn new(title: impl Into<String>, columns: usize) -> Self {
        Self { title: title.into(), columns: columns.max(1), has_legend: false, snapshots: Vec::new() }
    }

    /// Adds a snapshot with its own size.
    #[must_use]
    pub fn with(mut self, snapshot: Snapshot) -> Self {
        self.snapshots.push(snapshot);
        self
    }

    /// Adds a legend below the title.
    #[must_use]
    pub fn with_legend(self) -> Self {
        Self { has_legend: true, ..self }
    }

    /// Draws all snapshots as one picture.
    #[must_use]
    pub fn draw(&self) -> Canvas {
        let sizes: Vec<[f64; 2]> = self.snapshots.iter().map(Snapshot::sound_size).collect();
        let (mut canvas, areas) = layout::sheet(&self.title, self.columns, &sizes, |canvas, top| {
            if self.has_legend { legend::draw(self, canvas, top + 8.0) } else { top }
        });
        for (snapshot, area) in self.snapshots.iter().zip(areas) {
            snapshot.draw_into(&mut canvas, area);
        }
        canvas
    }
}
