//! Wire format of a robot's surroundings.

use serde::{Deserialize, Serialize};
use staya_controller::agent::InCell;
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;

/// Bytes of a packed obstacle.
pub const OBSTACLE_BYTES: usize = 17;

/// Wire format of a [`Window`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TerrainWindow<'a> {
    /// South-west cell.
    pub origin: Cell,
    /// Cells from west to east.
    pub width: u16,
    /// Cells from south to north.
    pub height: u16,
    /// Impassabilities, row by row from the south-west corner.
    pub cells: &'a [u8],
}

impl<'a> From<Window<'a>> for TerrainWindow<'a> {
    fn from(window: Window<'a>) -> Self {
        Self { origin: window.origin(), width: window.width(), height: window.height(), cells: window.cells() }
    }
}

impl<'a> TerrainWindow<'a> {
    /// Converts to a window; `None` if the cell count is not width times height.
    #[must_use]
    pub fn window(&self) -> Option<Window<'a>> {
        Window::new(self.cells, self.origin, self.width, self.height)
    }
}

/// Wire format of [`InPlane`](staya_controller::agent::InPlane), with packed obstacles, and of the
/// additional fields of [`InCells`](staya_controller::agent::InCells).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackedSurroundings<'a> {
    /// Highest speed of the body at its position, m/s.
    pub max_speed_mps: f32,
    /// Position of the robot within its cell.
    pub in_cell: Option<InCell<f32>>,
    /// Obstacles of [`OBSTACLE_BYTES`] bytes each, see [`pack`].
    pub obstacles: &'a [u8],
}

impl PackedSurroundings<'_> {
    /// Unpacks the obstacles into the device's number format; `None` for an unknown shape. Ignores
    /// trailing bytes; check [`PackedSurroundings::is_whole`].
    pub fn obstacles<S: Scalar>(&self) -> impl Iterator<Item = Option<Obstacle<S>>> {
        let (packed, _) = self.obstacles.as_chunks();
        packed.iter().map(unpack)
    }

    /// Whether the length is a multiple of [`OBSTACLE_BYTES`].
    #[must_use]
    pub const fn is_whole(&self) -> bool {
        let (_, rest) = self.obstacles.as_chunks::<OBSTACLE_BYTES>();
        rest.is_empty()
    }
}

/// Packs an obstacle: shape number (0 wall, 1 ball, 2 plane) and four `f32`, little-endian.
#[must_use]
pub fn pack(obstacle: &Obstacle<f32>) -> [u8; OBSTACLE_BYTES] {
    let (shape, numbers) = match *obstacle {
        Obstacle::Wall([a, b]) => (0, [a.x, a.y, b.x, b.y]),
        Obstacle::Ball { center_m, radius_m } => (1, [center_m.x, center_m.y, center_m.z, radius_m]),
        Obstacle::Plane { normal, distance_m } => (2, [normal.x, normal.y, normal.z, distance_m]),
    };
    let [a, b, c, d] = numbers.map(f32::to_le_bytes);
    let mut packed = [shape; OBSTACLE_BYTES];
    let bytes = a.into_iter().chain(b).chain(c).chain(d);
    for (to, from) in packed.iter_mut().skip(1).zip(bytes) {
        *to = from;
    }
    packed
}

/// Inverse of [`pack`], in any number format; `None` for an unknown shape. NaN becomes 0.
#[must_use]
pub fn unpack<S: Scalar>(packed: &[u8; OBSTACLE_BYTES]) -> Option<Obstacle<S>> {
    let (shape, numbers) = packed.split_first()?;
    let ([a, b, c, d], _) = numbers.as_chunks::<4>() else {
        return None;
    };
    let [a, b, c, d] = [a, b, c, d].map(|bytes| {
        let value = f32::from_le_bytes(*bytes);
        S::from_f32(value).unwrap_or(S::ZERO)
    });
    match shape {
        0 => Some(Obstacle::Wall([Vec2::new(a, b), Vec2::new(c, d)])),
        1 => Some(Obstacle::Ball { center_m: Vec3::new(a, b, c), radius_m: d }),
        2 => Some(Obstacle::Plane { normal: Vec3::new(a, b, c), distance_m: d }),
        _ => None,
    }
}
