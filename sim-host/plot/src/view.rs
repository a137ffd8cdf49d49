//! Projection of metres to the picture: from above, or in perspective as in the page.

use super::canvas::{Point, extent};

/// Lowest and highest x, y and z, metres.
pub type Span = [[f64; 3]; 2];

/// Orbit of the page's camera (`camera.js`), radians.
const YAW: f64 = -0.6;
const PITCH: f64 = 0.6;
/// Distance of the camera, in diagonals of the span.
const DISTANCE: f64 = 1.2;
/// Nearer points are not drawn; a share of the camera's distance.
const NEAREST: f64 = 0.05;

#[derive(Clone, Copy, Debug)]
pub struct View {
    target: [f64; 3],
    /// Unit vectors to the right, up, and towards the camera.
    axes: [[f64; 3]; 3],
    /// From the target to the camera, metres; infinite from above.
    distance: f64,
    /// Units per metre at the target.
    pub scale: f64,
    /// The target in the picture.
    middle: Point,
}

/// A point in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub at: Point,
    /// Units per metre.
    pub scale: f64,
    /// Larger values are nearer to the camera.
    pub near: f64,
}

impl View {
    /// Fits a span into left, top, width and height.
    pub fn new(is_space: bool, span: Span, [left, top, width, height]: [f64; 4]) -> Self {
        let mut view = Self::at_origin(is_space, span);
        let [low, high] = view.shown(span);
        let sides = [0, 1].map(|axis| high[axis] - low[axis]);
        view.scale = (width / sides[0]).min(height / sides[1]);
        let centre = [left + width / 2.0, top + height / 2.0];
        view.middle = [0, 1].map(|axis| centre[axis] - view.scale * (low[axis] + high[axis]) / 2.0);
        view
    }

    /// Width and height of a span in a picture with one unit per metre.
    pub fn sides(is_space: bool, span: Span) -> [f64; 2] {
        let [low, high] = Self::at_origin(is_space, span).shown(span);
        [high[0] - low[0], high[1] - low[1]]
    }

    fn at_origin(is_space: bool, [low, high]: Span) -> Self {
        let target = [0, 1, 2].map(|axis| low[axis] + (high[axis] - low[axis]) / 2.0);
        let flat = Self {
            target,
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            distance: f64::INFINITY,
            scale: 1.0,
            middle: [0.0; 2],
        };
        if !is_space {
            return flat;
        }
        let ((sin_yaw, cos_yaw), (sin, cos)) = (libm::sincos(YAW), libm::sincos(PITCH));
        let axes =
            [[cos_yaw, sin_yaw, 0.0], [-sin * sin_yaw, sin * cos_yaw, cos], [cos * sin_yaw, -cos * cos_yaw, sin]];
        let square: f64 = (0..3).map(|axis| (high[axis] - low[axis]) * (high[axis] - low[axis])).sum();
        Self { axes, distance: DISTANCE * libm::sqrt(square), ..flat }
    }

    /// Lowest and highest x and y of the corners in the picture.
    fn shown(&self, span: Span) -> [Point; 2] {
        let corner = |corner: usize| [0, 1, 2].map(|axis| span[corner >> axis & 1][axis]);
        extent((0..8).filter_map(|number| Some(self.see(corner(number))?.at)))
    }

    /// `None` if the point is not finite, behind the camera, or so far outside that SVG readers
    /// lose precision.
    pub fn see(&self, place_m: [f64; 3]) -> Option<Seen> {
        let from: [f64; 3] = std::array::from_fn(|axis| place_m[axis] - self.target[axis]);
        let [right, up, near] = self.axes.map(|axis| axis.iter().zip(from).map(|(a, b)| a * b).sum::<f64>());
        let share = 1.0 - near / self.distance;
        let scale = self.scale / share;
        let at = [self.middle[0] + right * scale, self.middle[1] - up * scale];
        let is_seen = share > NEAREST && at.iter().all(|c| c.abs() < 1e5);
        is_seen.then_some(Seen { at, scale, near })
    }

    pub fn at(&self, place_m: [f64; 3]) -> Option<Point> {
        self.see(place_m).map(|seen| seen.at)
    }

    /// x and y of a point of a picture from above.
    pub fn metres(&self, [x, y]: Point) -> [f64; 2] {
        [self.target[0] + (x - self.middle[0]) / self.scale, self.target[1] - (y - self.middle[1]) / self.scale]
    }

    /// Direction to the right in a picture, as a vector in space.
    pub const fn right(&self) -> [f64; 3] {
        self.axes[0]
    }
}
