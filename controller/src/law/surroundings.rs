//! The surroundings of a robot in a step, as each guidance law needs them.

use super::BadInput;
use crate::geom::{Position, Vec2, Vec3};
use crate::grid::{Cell, Window};
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use crate::time::Duration;
use core::fmt::Debug;
use serde::{Deserialize, Serialize};

/// The robot's state on the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellState {
    /// The cell that it occupies.
    pub cell: Cell,
    /// Time until it may leave the cell; not above 0 if free (A. V. Kuznetsov 2017, KUZ, eq. 6).
    pub busy: Duration,
}

/// Input of guidance laws that move cell by cell.
#[derive(Clone, Copy, Debug)]
pub struct OnGrid<'a> {
    /// Own state on the grid.
    pub cell: CellState,
    /// The visible terrain of any size, including the own cell. Without it the robot is in
    /// [`Mode::Fault`](crate::robot::Mode::Fault).
    pub window: Option<Window<'a>>,
}

impl<'a> OnGrid<'a> {
    /// Returns the own cell and the window around it.
    ///
    /// # Errors
    /// [`BadInput`] if the window is missing or does not contain the cell.
    pub fn seen(&self) -> Result<(Cell, Window<'a>), BadInput> {
        let cell = self.cell.cell;
        let window = self.window.ok_or(BadInput)?;
        let is_in_sight = window.get(cell).is_some();
        is_in_sight.then_some((cell, window)).ok_or(BadInput)
    }
}

/// Input of guidance laws that move by velocities, in the plane or in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InPlane<'a, S> {
    /// Speed limit at the current place, m/s; rough terrain reduces it. At 0 or less the robot is
    /// in [`Mode::Fault`](crate::robot::Mode::Fault).
    pub max_speed_mps: S,
    /// Visible static obstacles; see [`grid_walls`](crate::obstacle::grid_walls).
    pub obstacles: &'a [Obstacle<S>],
}

/// Input of guidance laws that plan on the grid and move by velocities.
#[derive(Clone, Copy, Debug)]
pub struct InCells<'a, S> {
    /// Own state on the grid, never busy.
    pub grid: OnGrid<'a>,
    /// Speed limit and obstacles.
    pub plane: InPlane<'a, S>,
    /// Position within its cell.
    pub in_cell: InCell<S>,
}

/// A position within a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InCell<S> {
    /// The position minus the centre of the cell, metres.
    pub offset_m: Vec2<S>,
    /// Side length of a cell, metres; above 0.
    pub cell_m: S,
}

/// Surroundings of [`AnyLaw`](crate::agent::AnyLaw). A kind that the law cannot use puts the robot
/// into [`Mode::Fault`](crate::robot::Mode::Fault).
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnySurroundings<'a, S> {
    OnGrid(OnGrid<'a>),
    InPlane(InPlane<'a, S>),
    InCells(InCells<'a, S>),
}

/// The parts of the surroundings that the agent itself needs, for beacons and the safety layer.
pub trait Surroundings<S>: Copy + Debug {
    /// Whether there may be a part in the plane or in space.
    const HAS_PLANE: bool;
    /// Whether there may be a part on the grid.
    const HAS_GRID: bool;

    /// Returns the part on the grid, if any.
    fn on_grid(&self) -> Option<OnGrid<'_>>;

    /// Returns the part in the plane or in space; `None` for a robot that moves cell by cell.
    fn in_plane(&self) -> Option<InPlane<'_, S>>;

    /// Where the cells lie, for a robot at a world position; `None` without both parts.
    fn cell_frame(&self, _own: Position) -> Option<CellFrame> {
        None
    }
}

impl<S: Scalar> Surroundings<S> for OnGrid<'_> {
    const HAS_PLANE: bool = false;
    const HAS_GRID: bool = true;

    fn on_grid(&self) -> Option<OnGrid<'_>> {
        Some(*self)
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        None
    }
}

impl<S: Scalar> Surroundings<S> for InPlane<'_, S> {
    const HAS_PLANE: bool = true;
    const HAS_GRID: bool = false;

    fn on_grid(&self) -> Option<OnGrid<'_>> {
        None
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        Some(*self)
    }
}

impl<S: Scalar> Surroundings<S> for InCells<'_, S> {
    const HAS_PLANE: bool = true;
    const HAS_GRID: bool = true;

    fn on_grid(&self) -> Option<OnGrid<'_>> {
        Some(self.grid)
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        Some(self.plane)
    }

    fn cell_frame(&self, own: Position) -> Option<CellFrame> {
        let InCell { offset_m, cell_m } = self.in_cell;
        let center = own.moved(-offset_m.extend(S::ZERO))?;
        let cell_mm = cell_m.to_milli().filter(|side| *side > 0)?;
        Some(CellFrame { cell: self.grid.cell.cell, center, cell_mm })
    }
}

impl<S: Scalar> Surroundings<S> for AnySurroundings<'_, S> {
    const HAS_PLANE: bool = true;
    const HAS_GRID: bool = true;

    fn on_grid(&self) -> Option<OnGrid<'_>> {
        match self {
            Self::OnGrid(grid) | Self::InCells(InCells { grid, .. }) => Some(*grid),
            Self::InPlane(_) => None,
        }
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        match self {
            Self::InPlane(plane) | Self::InCells(InCells { plane, .. }) => Some(*plane),
            Self::OnGrid(_) => None,
        }
    }

    fn cell_frame(&self, own: Position) -> Option<CellFrame> {
        if let Self::InCells(cells) = self { cells.cell_frame(own) } else { None }
    }
}

impl<'a, S> From<InCells<'a, S>> for InPlane<'a, S> {
    fn from(cells: InCells<'a, S>) -> Self {
        cells.plane
    }
}

impl<'a, S> From<OnGrid<'a>> for AnySurroundings<'a, S> {
    fn from(grid: OnGrid<'a>) -> Self {
        Self::OnGrid(grid)
    }
}

impl<'a, S> From<InPlane<'a, S>> for AnySurroundings<'a, S> {
    fn from(plane: InPlane<'a, S>) -> Self {
        Self::InPlane(plane)
    }
}

impl<'a, S> From<InCells<'a, S>> for AnySurroundings<'a, S> {
    fn from(cells: InCells<'a, S>) -> Self {
        Self::InCells(cells)
    }
}

impl<'a, S> TryFrom<AnySurroundings<'a, S>> for OnGrid<'a> {
    type Error = BadInput;
    fn try_from(any: AnySurroundings<'a, S>) -> Result<Self, BadInput> {
        if let AnySurroundings::OnGrid(grid) = any { Ok(grid) } else { Err(BadInput) }
    }
}

impl<'a, S> TryFrom<AnySurroundings<'a, S>> for InCells<'a, S> {
    type Error = BadInput;
    fn try_from(any: AnySurroundings<'a, S>) -> Result<Self, BadInput> {
        if let AnySurroundings::InCells(cells) = any { Ok(cells) } else { Err(BadInput) }
    }
}

/// Also from the part in the plane of [`InCells`].
impl<'a, S> TryFrom<AnySurroundings<'a, S>> for InPlane<'a, S> {
    type Error = BadInput;
    fn try_from(any: AnySurroundings<'a, S>) -> Result<Self, BadInput> {
        match any {
            AnySurroundings::InPlane(plane) | AnySurroundings::InCells(InCells { plane, .. }) => Ok(plane),
            AnySurroundings::OnGrid(_) => Err(BadInput),
        }
    }
}

/// The robot's own state, from its sensors or its autopilot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KinematicState<S> {
    /// World position.
    pub position: Position,
    /// World velocity, metres per second.
    pub velocity_mps: Vec3<S>,
}

/// Where the cells of the grid lie in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellFrame {
    /// A cell.
    pub cell: Cell,
    /// World position of its centre.
    pub center: Position,
    /// Side length of a cell, millimetres; above 0.
    pub cell_mm: i32,
}

impl CellFrame {
    /// The cell at a world position; saturates far away.
    #[must_use]
    pub fn cell_at(&self, place: Position) -> Cell {
        let ([x, y, _], [center_x, center_y, _]) = (place.mm, self.center.mm);
        let along = |mm: i32, center: i32, cell: i16| {
            let from_edge = i64::from(mm) - i64::from(center) + i64::from(self.cell_mm >> 1);
            let cells = from_edge.checked_div_euclid(self.cell_mm.into()).unwrap_or(0);
            cells.saturating_add(cell.into()).clamp(i16::MIN.into(), i16::MAX.into()) as i16
        };
        Cell::new(along(x, center_x, self.cell.x), along(y, center_y, self.cell.y))
    }
}
