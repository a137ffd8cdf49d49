//! Robots at one moment: positions, velocities, past paths, goals, obstacles.
//!
//! A [`Snapshot`] is one moment, from above or in perspective; a [`Sheet`] has several side by
//! side.
//!
//! ```ignore
//! use staya_plot::flock::{Body, Sheet, Snapshot};
//! # fn main() -> Result<(), staya_sim::record::Error> {
//! let body = |x| Body { position_m: [x, 0.0, 0.0], radius_m: 0.5, ..Body::default() };
//! let bodies = vec![body(0.0), body(7.0)];
//! let moment = Snapshot { title: "t = 0 s".into(), bodies, ..Snapshot::default() };
//! Sheet::new("Two robots", 2).with(moment.clone()).with(moment).draw().write("out/two".as_ref())?;
//! # Ok(()) }
//! ```

mod frame;
mod legend;
pub(crate) mod marks;

use super::canvas::{Canvas, extent, longest};
use super::colour::{self, Colour};
use super::layout;
use super::view::Span;
use frame::Frame;
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;
use std::sync::Arc;

/// Larger swarms are drawn as dots or small darts.
pub const MOST_DISCS: usize = 3000;

/// A robot or another body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Position, metres. With a coordinate that is not finite, the body is skipped.
    pub position_m: [f64; 3],
    /// Velocity, m/s. Stationary bodies have no arrow.
    pub velocity_mps: [f64; 3],
    /// Radius, metres; bodies without a size are darts.
    pub radius_m: f64,
    /// Its colour.
    pub colour: Colour,
    /// Whether only its edge has the full colour.
    pub is_pale: bool,
}

impl Default for Body {
    /// A stationary body without a size.
    fn default() -> Self {
        let still = [0.0; 3];
        Self { position_m: still, velocity_mps: still, radius_m: 0.0, colour: colour::nth(0), is_pale: false }
    }
}

/// One moment. Items with a coordinate that is not finite are skipped.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Title above the picture.
    pub title: String,
    /// Robots and other bodies.
    pub bodies: Vec<Body>,
    /// Speed of the longest arrow, m/s; at least that of the fastest robot.
    pub fastest_mps: f64,
    /// Pairs of bodies that are joined by a line, by index.
    pub edges: Vec<[usize; 2]>,
    /// Obstacles.
    pub solids: Arc<[Solid]>,
    /// Goals, metres, with their colours.
    pub goals: Vec<([f64; 3], Colour)>,
    /// Past paths, metres, with their colours. A point that is not finite makes a gap.
    pub trails: Vec<(Vec<[f64; 3]>, Colour)>,
    /// Map in the background, in space on the floor.
    pub land: Option<Arc<Terrain>>,
    /// Whether the picture is in perspective instead of from above.
    pub is_space: bool,
    /// Ratio of height to width of the columns of blown air below bodies in space; 1 for none.
    pub downwash: f64,
    /// Visible range; `None` for everything.
    pub span_m: Option<[[f64; 3]; 2]>,
    /// Labels of the axes.
    pub labels: [String; 2],
    /// Width and height in units.
    pub size: [f64; 2],
}

impl Default for Snapshot {
    /// An empty snapshot of 420 x 400 units, from above.
    fn default() -> Self {
        Self {
            title: String::new(),
            bodies: Vec::new(),
            fastest_mps: 0.0,
            edges: Vec::new(),
            solids: [].into(),
            goals: Vec::new(),
            trails: Vec::new(),
            land: None,
            is_space: false,
            downwash: 1.0,
            span_m: None,
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
        marks::ground(self, &frame.view, canvas);
        marks::trails(self, &frame.view, canvas);
        marks::moving(self, &frame.view, canvas);
        canvas.clip(None);
    }

    fn sound_size(&self) -> [f64; 2] {
        self.size.map(|side| if side.is_nan() { 400.0 } else { side.clamp(160.0, 4000.0) })
    }

    /// Visible range: as chosen, or around all items; in space from the floor up.
    pub(crate) fn span(&self) -> Span {
        let is_range =
            |[low, high]: &Span| (0..2).all(|axis| low[axis] < high[axis] && (high[axis] - low[axis]).is_finite());
        let mut span = self.span_m.filter(is_range).unwrap_or_else(|| {
            let balls = self.bodies.iter().map(|body| (body.position_m, body.radius_m.max(0.0)));
            let bodies = balls.flat_map(|(at, r)| [at.map(|c| c - r), at.map(|c| c + r)]);
            let solids = self.solids.iter().flat_map(corners);
            let goals = self.goals.iter().map(|(goal, _)| *goal);
            let all = bodies.chain(solids).chain(goals).chain(self.trails.iter().flat_map(|(way, _)| way.clone()));
            let [low, high] = extent(all.filter(|at| at.iter().all(|c| c.is_finite())));
            if !longest([low, high]).is_finite() {
                return [[0.0; 3], [1.0; 3]];
            }
            let margin = (longest([low, high]) * 0.04).max(1e-6);
            [low.map(|c| c - margin), high.map(|c| c + margin)]
        });
        if self.is_space {
            // The ground, unless it is far below all bodies.
            let wide = longest(span);
            span[0][2] = if span[0][2] > 2.0 * wide { span[0][2] } else { span[0][2].min(0.0) };
        }
        span
    }
}

/// Corners around an obstacle; the border of a half-space has none.
pub(crate) fn corners(solid: &Solid) -> Vec<[f64; 3]> {
    match *solid {
        Solid::Wall(ends) => ends.map(|[x, y]| [x, y, 0.0]).into(),
        Solid::Ball { center_m, radius_m } => vec![center_m.map(|c| c - radius_m), center_m.map(|c| c + radius_m)],
        Solid::Plane { .. } => Vec::new(),
    }
}

/// Several snapshots in one picture, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    title: String,
    columns: usize,
    pub(crate) snapshots: Vec<Snapshot>,
    /// Colours of the bodies in the legend; `None` without a legend.
    pub(crate) keys: Option<Vec<(String, Colour)>>,
}

impl Sheet {
    /// Creates a sheet without snapshots, with `columns` of them per row (at least 1). The title
    /// may be empty.
    #[must_use]
    pub fn new(title: impl Into<String>, columns: usize) -> Self {
        Self { title: title.into(), columns: columns.max(1), snapshots: Vec::new(), keys: None }
    }

    /// Adds a snapshot with its own size.
    #[must_use]
    pub fn with(mut self, snapshot: Snapshot) -> Self {
        self.snapshots.push(snapshot);
        self
    }

    /// Adds a legend below the title, with the meaning of the bodies' colours.
    #[must_use]
    pub fn with_legend(self, keys: Vec<(String, Colour)>) -> Self {
        Self { keys: Some(keys), ..self }
    }

    /// Draws all snapshots as one picture.
    #[must_use]
    pub fn draw(&self) -> Canvas {
        let sizes: Vec<[f64; 2]> = self.snapshots.iter().map(Snapshot::sound_size).collect();
        let (mut canvas, areas) = layout::sheet(&self.title, self.columns, &sizes, |canvas, top| match &self.keys {
            Some(keys) => legend::draw(self, keys, canvas, top + 8.0),
            None => top,
        });
        for (snapshot, area) in self.snapshots.iter().zip(areas) {
            snapshot.draw_into(&mut canvas, area);
        }
        canvas
    }
}
